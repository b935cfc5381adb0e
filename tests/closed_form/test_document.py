"""Derivations on paper and in a browser: whole, readable, safe."""

import dataclasses
import re
import shutil
import subprocess
from html.parser import HTMLParser

import numpy as np
import pytest
import sympy

import chromium
import mcgee
from mcgee.closed_form import ring
from mcgee.closed_form.document import document
from mcgee.closed_form.latex import symbol, text
from mcgee.closed_form.terminal import report
from mcgee.closed_form.text import rounded

EVIL = "a_b%$#{}~^\\é漢&<script>document.title='hacked'</script>"
TITLES = [
    *("Frames", "Kinetic energy", "Potential energy", "Inertia matrix M(q)"),
    *("Christoffel symbols", "Coriolis matrix C(q, qd)", "Coriolis and centrifugal efforts"),
    *("Gravity g(q)", "Equation of motion", "Base parameters", "What was proved"),
]


def symbolic():
    names = "m1 m2 l1 lc1 lc2 I1 I2 g0"
    return mcgee.arms.planar_2r(**{s: sympy.Symbol(s, positive=True) for s in names.split()})


def evil():
    arm = mcgee.arms.planar_2r(m1=sympy.Symbol("m_{\\alpha}$%"), m2=sympy.Symbol("漢"))
    joints = tuple(dataclasses.replace(j, name=EVIL + j.name) for j in arm.joints)
    return dataclasses.replace(arm, name=EVIL, joints=joints)


def general():
    """An angle with a name, lumps, a slide and decimals."""
    rows = [{"d": 0.3, "alpha": 0.7}, {"sigma": 1, "alpha": 1.2}, {"a": 0.25}]
    body = {"m": 1.5, "r": (0.1, 0.02, 0), "I": [[0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.25]]}
    return mcgee.from_dh([{**row, **body} for row in rows])


ROBOTS = {
    "symbols": lambda: symbolic().closed_form(simplify="collected"),
    "lumped": lambda: mcgee.load("scara").closed_form(simplify="lumped", symbolic_inertias=True),
    "evil": lambda: evil().closed_form(),
    "general": lambda: general().closed_form(simplify="lumped"),
    "puma560": lambda: mcgee.load("puma560").closed_form(),
}


@pytest.fixture(params=ROBOTS)
def form(request):
    return ROBOTS[request.param]()


def test_the_derivation_goes_in_order():
    d = document(symbolic().closed_form())
    assert [s.title for s in d.sections] == TITLES
    lumped = document(mcgee.load("scara").closed_form(simplify="lumped", symbolic_inertias=True))
    assert [s.title for s in lumped.sections][9:11] == ["Lumped constants", "Base parameters"]


def test_every_formula_is_the_forms_own(form):
    """Sums and signs as shown give back M, C, g and the Christoffel symbols."""
    shown = {}
    for section in document(form, limit=None).sections:
        assert not section.left_out
        for e in section.equations:
            if not isinstance(e.left, sympy.Symbol) and e.terms:
                shown[e.left.letter, e.left.place] = sympy.Add(*e.terms)
    for i in range(form.n):
        assert shown["g", f"{i + 1}"] == (form.g[i])
        assert shown["Cqd", f"{i + 1}"] == (form.Cqd[i])
        for j in range(form.n):
            assert shown.get(("C", f"{i + 1}{j + 1}"), 0) == (form.C[i, j])
            assert shown["M", f"{min(i, j) + 1}{max(i, j) + 1}"] == (form.M[i, j])
            for k in range(j, form.n):
                found = shown.get(("c", f"{i + 1}{j + 1}{k + 1}"), 0)
                assert found == (form.christoffel[i, j, k])
    assert (shown["T", ""], shown["P", ""]) == ((form.T), (form.P))


def test_what_is_too_long_is_said():
    sections = {s.title: s for s in document(mcgee.load("puma560").closed_form(), 50).sections}
    form = mcgee.load("puma560").closed_form()
    M = sections["Inertia matrix M(q)"]
    shown = sum(len(e.terms) for e in M.equations)
    upper = sum(len(form.exact.M[i][j]) for i in range(6) for j in range(i, 6))
    said = re.fullmatch(r"(\d+) formulas of (\d+) terms together left out\.", M.left_out)
    count, terms = said.groups()
    assert int(count) + len(M.equations) == 21
    assert shown <= 55  # products are folded back on paper
    assert int(terms) + shown >= upper - 21  # zeros are a term on paper


def test_frames_are_the_poses():
    """X at q, put one behind the other, is the forward kinematics."""
    arm = general()
    d = document(arm.closed_form())
    q = [0.3, 0.2, -0.4]
    X = sympy.eye(4)
    for e in d.sections[0].equations:
        if getattr(e.left, "letter", "") == "X":
            values = dict(zip(d.form.q, q, strict=True)) | d.form.constants
            X = X * sympy.Matrix(e.rows).subs(values)
    tip = arm.mechanism.frames[arm.link_names[-1]][1]
    want = arm.forward_kinematics(q, arm.link_names[-1])
    placed = np.vstack([np.column_stack([tip.rotation, tip.translation]), [0, 0, 0, 1]])
    assert np.abs(np.array(X, float) @ placed.astype(float) - want).max() < 1e-12


# -- paper ----------------------------------------------------------------------------------------


def compiled(path):
    if not shutil.which("pdflatex"):
        pytest.skip("needs pdflatex, of Debian's texlive-latex-base")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", path.name]
    return subprocess.run(
        command, cwd=path.parent, capture_output=True, text=True, errors="replace"
    )


def test_the_article_compiles(form, tmp_path):
    path = form.to_latex(tmp_path / "arm.tex")
    run = compiled(path)
    assert run.returncode == 0, run.stdout[-2000:]
    assert "Undefined control sequence" not in run.stdout
    assert (tmp_path / "arm.pdf").stat().st_size > 20_000


def test_every_single_formula_of_latex_compiles(form, tmp_path):
    lines = form.latex().splitlines()
    assert len(lines) == 6 + len(form.lumps)
    path = tmp_path / "lines.tex"
    head = "\\documentclass{article}\\usepackage[utf8]{inputenc}\\usepackage{amsmath}"
    body = "\n".join(lines).replace(r"\begin{matrix}", r"\begin{matrix}")
    path.write_text(
        f"{head}\\begin{{document}}\\setcounter{{MaxMatrixCols}}{{20}}\n{body}\n\\end{{document}}"
    )
    assert compiled(path).returncode == 0


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("lc1", "l_{c1}"),
        ("m1", "m_{1}"),
        ("Ixx1", "I_{xx1}"),
        ("alpha2", r"\alpha_{2}"),
        ("m_arm", "m_{arm}"),
        ("g", "g"),
        ("x$", r"\text{x\$}"),
        ("漢", r"\text{[U+6F22]}"),
    ],
)
def test_symbols_on_paper(name, written):
    assert symbol(sympy.Symbol(name)) == written


def test_rates_have_dots():
    assert symbol(sympy.Symbol("qd12"), is_rate=True) == r"\dot{q}_{12}"
    assert symbol(sympy.Symbol("qdd1"), is_rate=True) == r"\ddot{q}_{1}"
    assert symbol(sympy.Symbol("qd1")) == "q_{d1}"


def test_sentences_on_paper():
    assert text("M_ij is ½ & 3 %") == r"$M_{ij}$ is $\tfrac12 $ \& 3 \%"
    assert text("joint shoulder_i_pan") == r"joint shoulder\_i\_pan"


# -- pages ----------------------------------------------------------------------------------------


class Tags(HTMLParser):
    VOID = ("meta", "link", "none", "mprescripts")

    def __init__(self):
        super().__init__()
        self.open, self.seen = [], []

    def handle_starttag(self, tag, attrs):
        self.seen.append(tag)
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_pages_are_well_formed_and_safe(form, tmp_path):
    text = form.to_html(tmp_path / "arm.html").read_text()
    tags = Tags()
    tags.feed(text)
    assert not tags.open
    assert "script" not in tags.seen
    assert text.count("<section") == len(document(form).sections)


def test_a_page_in_a_browser(tmp_path):
    if not chromium.found():
        pytest.skip("needs chromium")
    for k, make in enumerate((evil, lambda: mcgee.load("puma560"))):
        path = make().closed_form().to_html(tmp_path / f"{k}.html")
        with chromium.tab() as tab:
            for width in (400, 1000):
                tab.look(width, dark=width < 500)
                tab.open(path, "document.readyState === 'complete'")
                assert tab.run("document.documentElement.scrollWidth") == width
            assert tab.run("document.title") != "hacked"
            high = "document.querySelector('.sum math').getBoundingClientRect().height"
            assert 10 < tab.run(high) < 60
            assert tab.problems == []


def test_files_are_written_whole_or_not_at_all(tmp_path):
    form = mcgee.arms.planar_2r().closed_form()
    with pytest.raises(ValueError, match=r"cannot write the article to '.*': it is a folder"):
        form.to_latex(tmp_path)
    with pytest.raises(ValueError, match=r"cannot write the page to .*there is no folder"):
        form.to_html(tmp_path / "none" / "arm.html")
    assert list(tmp_path.iterdir()) == []


def test_a_link_stays_a_link(tmp_path):
    target, link = tmp_path / "arm.html", tmp_path / "link.html"
    link.symlink_to(target)
    assert mcgee.arms.planar_2r().closed_form().to_html(link) == link
    assert link.is_symlink()
    assert target.read_text().startswith("<!doctype html>")


# -- text -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [80, 120])
def test_reports_fit(form, width):
    assert max(map(len, report(document(form), width).splitlines())) <= max(width, 100)


def test_numbers_for_readers():
    third, gravity = sympy.Rational(1, 3), sympy.Rational(981, 100)
    assert str(rounded(third)) == "1/3"
    assert str(rounded(sympy.Rational(5, 8))) == "5/8"
    assert str(rounded(gravity)) == "9.81"
    assert str(rounded(sympy.Rational(123456789, 10**8))) == "1.23457"
    assert str(rounded(sympy.Rational(22, 7))) == "22/7"
    assert str(rounded(sympy.Rational(2200001, 70001))) == "31.4281"
    assert rounded(sympy.Integer(12)) == 12


def test_formulas_are_shown_where_proofs_would_be_too_long(monkeypatch):
    form = mcgee.load("puma560").closed_form()
    form.exact.tau, form.exact.Cqd  # noqa: B018
    monkeypatch.setattr(ring, "MOST", 150)
    last = document(form).sections[-1]
    assert last.sentences[0].startswith(
        "Nothing was decided: the closed form has a formula of more"
    )
