"""`mcgee derive` as a person and as a program use it."""

import json
import subprocess
import sys

import numpy as np
import pytest
import sympy

import mcgee


def run(*arguments, **options):
    command = [sys.executable, "-m", "mcgee", "derive", *arguments]
    return subprocess.run(command, capture_output=True, text=True, **options)


def test_the_lessons_arm():
    out = run("planar_2r").stdout
    for line in (
        "M11 = cos(q2) + 1.7",
        "M12 = cos(q2)/2 + 0.35",
        "c211 = sin(q2)/2",
        "g1 = 14.715*cos(q1) + 4.905*cos(q1 + q2)",
    ):
        assert line in out.splitlines()
    assert "FALSE" not in out
    assert out.count("proved  ") >= 10


@pytest.mark.parametrize("options", [[], ["--simplify", "lumped"], ["--symbolic"]])
def test_reports_fit_80_columns(options):
    result = run("scara", *options, env={"COLUMNS": "80", "PYTHONPATH": ":".join(sys.path)})
    assert result.returncode == 0
    assert max(len(line.rstrip()) for line in result.stdout.splitlines()) <= 80


def test_json_is_the_kernels():
    """Every formula of a report, read by SymPy, gives the compiled numbers."""
    arm = mcgee.load("stanford")
    report = json.loads(run("stanford", "--json", "--simplify", "expanded").stdout)
    q, qd = np.random.default_rng(0).normal(size=(2, 6))
    values = {f"q{i + 1}": q[i] for i in range(6)} | {f"qd{i + 1}": qd[i] for i in range(6)}

    def number(formula):
        if isinstance(formula, list):
            return [number(f) for f in formula]
        return float(sympy.sympify(formula).subs(values))

    for name, want in (
        ("M", arm.mass_matrix(q)),
        ("C", arm.coriolis_matrix(q, qd)),
        ("Cqd", arm.coriolis(q, qd)),
        ("g", arm.gravity(q)),
        ("christoffel", arm.christoffel(q)),
    ):
        np.testing.assert_allclose(number(report[name]), want, atol=1e-12 * np.abs(want).max())
    assert number(report["T"]) == pytest.approx(arm.kinetic_energy(q, qd), rel=1e-12)
    assert all(p["holds"] for p in report["proofs"])
    assert report["terms"]["M"] == arm.closed_form().terms("M")


def test_files(tmp_path):
    tex, page = tmp_path / "a.tex", tmp_path / "a.html"
    result = run("planar_2r", "--latex", str(tex), "--html", str(page))
    assert (result.returncode, result.stdout) == (0, "")
    assert result.stderr.splitlines() == [f"mcgee: wrote {tex}", f"mcgee: wrote {page}"]
    assert tex.read_text().startswith("\\documentclass")
    assert page.read_text().startswith("<!doctype html>")


def test_a_limit():
    assert "left out" in run("puma560", "--limit", "5").stdout
    assert "left out" not in run("planar_3r", "--limit", "0").stdout


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["nothing"], "mcgee: error: "),
        (["planar_2r", "--simplify", "much"], "mcgee: error: simplify is 'much', expected one of"),
        (
            ["planar_2r", "--html", "x", "--latex", "x"],
            "mcgee: error: --latex and --html both name",
        ),
        (["planar_2r", "--html", "/nowhere/a.html"], "mcgee: error: cannot write the page to"),
    ],
)
def test_what_is_wrong_is_one_line(arguments, sentence):
    result = run(*arguments)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith(sentence)
    assert len(result.stderr.splitlines()) == 1


def test_long_work_is_announced():
    result = run("panda", "--symbolic", "--json", "--simplify", "expanded")
    assert result.stderr.startswith("mcgee: ")
    assert "terms to write, some" in result.stderr
    assert len(json.loads(result.stdout)["M"]) == 7
