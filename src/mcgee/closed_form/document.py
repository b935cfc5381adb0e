"""A derivation section by section: what pages and papers are made of."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import sympy
from sympy import Expr, Symbol

from mcgee.closed_form.ring import Polynomial
from mcgee.closed_form.text import DIGITS, is_rounded
from mcgee.mechanism import GROUND, Body

if TYPE_CHECKING:
    from mcgee.closed_form.form import ClosedForm

LIMIT = 1_000
"""Terms that a section shows; what is left out is said."""


@dataclass(frozen=True)
class Name:
    """A left side: a letter of the equation of motion with its place, as in (C qd)_1."""

    letter: str
    """'T', 'P', 'M', 'c', 'C', 'Cqd', 'g', 'tau' or 'X', a pose."""
    place: str = ""
    above: str = ""


@dataclass(frozen=True)
class Equation:
    """left = the sum of the terms, or a matrix of sums; exact, for printers to round."""

    left: Name | Symbol
    terms: tuple[Expr, ...] = ()
    rows: tuple[tuple[Expr, ...], ...] = ()


@dataclass(frozen=True)
class Section:
    title: str
    sentences: tuple[str, ...]
    equations: tuple[Equation, ...] = ()
    left_out: str = ""
    lines: tuple[str, ...] = ()


@dataclass(frozen=True)
class Document:
    title: str
    sections: tuple[Section, ...]
    form: ClosedForm


def document(form: ClosedForm, limit: int | None = LIMIT) -> Document:
    """Args:
    limit: terms that a section shows at most; None for all
    """
    sections = [*_frames(form), *_energies(form, limit), *_terms(form, limit), _motion(form)]
    sections += [*_lumps(form), *_constants(form), *_base(form), _proofs(form)]
    if any(is_rounded(e) for s in sections for e in _expressions(s)):
        first = sections[0]
        sections[0] = replace(first, sentences=(*first.sentences, _DIGITS))
    return Document(f"Closed form of {form.name}", tuple(sections), form)


_DIGITS = (
    f"Numbers are exact, decimals as they were written; those of many digits are shown to {DIGITS}."
)


def _expressions(section: Section) -> Iterator[Expr]:
    for equation in section.equations:
        yield from equation.terms
        for row in equation.rows:
            yield from row


# -- sections in order ----------------------------------------------------------------------------


def _frames(form: ClosedForm) -> Iterator[Section]:
    robot = form.robot
    if robot is None:
        return
    equations = []
    sentences = ["X is the pose of a joint's frame in the one before it, at the joint's position."]
    for i, body in enumerate(robot.still.bodies):
        before = "the ground" if body.parent == GROUND else f"frame {body.parent + 1}"
        does = "slides along" if body.prismatic else "turns about"
        sentences.append(
            f"Joint {i + 1}, {body.name}, {does} the z axis of frame {i + 1}, which stands in "
            f"{before}{_follows(body, i)}."
        )
        name = Name("X", str(i + 1), str(body.parent + 1))
        equations.append(Equation(name, rows=_pose(form, body)))
    field = tuple((_said(form, x),) for x in robot.still.gravity)
    equations.append(Equation(Name("field"), rows=field))
    sentences.append("The field is the acceleration of free fall [m/s²], seen from the ground.")
    yield Section("Frames", tuple(sentences), tuple(equations))


def _follows(body: Body, i: int) -> str:
    if body.multiplier == 1 and body.coordinate == i:
        return ""
    return f"; its position is {body.multiplier} times q{body.coordinate + 1}"


def _pose(form: ClosedForm, body: Body) -> tuple[tuple[Expr, ...], ...]:
    at = form.q[body.coordinate] * _said(form, body.multiplier)
    R = sympy.Matrix([[_said(form, x) for x in row] for row in body.pose.rotation])
    p = sympy.Matrix([_said(form, x) for x in body.pose.translation])
    if body.prismatic:
        p = p + R[:, 2] * at
    else:
        c, s = sympy.cos(at), sympy.sin(at)
        R = R * sympy.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    rows = R.row_join(p).tolist()
    return (*map(tuple, rows), tuple(map(sympy.Integer, (0, 0, 0, 1))))


def _said(form: ClosedForm, x: Any) -> Expr:
    return form.write(form.exact.ring(x))


def _energies(form: ClosedForm, limit: int | None) -> Iterator[Section]:
    if form.robot is None:
        origin = ("As it was given.",)
    else:
        origin = (
            "The sum over the links of ½ m v² of the centre of mass and ½ ωᵀ I ω about it, and of "
            "½ armature qd² of the rotors.",
        )
    yield _section("Kinetic energy", origin, [(Name("T"), form.exact.T)], form, limit)
    given = "The work done against gravity: the sum of −m (field · centre of mass)."
    sentences = (given,) if form.robot is not None else ("As it was given.",)
    yield _section("Potential energy", sentences, [(Name("P"), form.exact.P)], form, limit)


def _terms(form: ClosedForm, limit: int | None) -> Iterator[Section]:
    d, n = form.exact, range(form.n)
    place = _places(form.n)
    still = [str(q) for k, q in enumerate(form.q) if not any(x for row in d.slopes[k] for x in row)]
    about: tuple[str, ...] = (
        "M_ij is the effort that joint i needs for a unit acceleration of joint j alone, at rest "
        "and without gravity: ∂²T/∂qd_i ∂qd_j. M is symmetric.",
        f"M does not depend on {', '.join(still)}." if still else "M depends on every joint.",
    )
    entries = [(Name("M", place(i, j)), d.M[i][j]) for i in n for j in n if i <= j]
    yield _section("Inertia matrix M(q)", about, entries, form, limit)
    about = (
        "c_ijk = ½ (∂M_ij/∂q_k + ∂M_ik/∂q_j − ∂M_jk/∂q_i), symmetric in j and k. c_ijj is the "
        "centrifugal effort at joint i for a unit speed of joint j, 2 c_ijk the Coriolis effort "
        "for unit speeds of joints j and k. Those that are not shown are 0.",
    )
    entries = [
        (Name("c", place(i, j, k)), d.christoffel[i][j][k])
        for i in n
        for j in n
        for k in n
        if j <= k and d.christoffel[i][j][k]
    ]
    yield _section("Christoffel symbols", about, entries, form, limit)
    about = ("C_ij = Σ_k c_ijk qd_k, so that Ṁ − 2C is skew-symmetric. What is not shown is 0.",)
    entries = [(Name("C", place(i, j)), d.C[i][j]) for i in n for j in n if d.C[i][j]]
    yield _section("Coriolis matrix C(q, qd)", about, entries, form, limit)
    about = ("The efforts that speeds alone ask for, quadratic in them.",)
    entries = [(Name("Cqd", place(i)), d.Cqd[i]) for i in n]
    yield _section("Coriolis and centrifugal efforts", about, entries, form, limit)
    about = ("The efforts that hold the arm still against gravity: ∂P/∂q.",)
    yield _section("Gravity g(q)", about, [(Name("g", place(i)), d.g[i]) for i in n], form, limit)


def _motion(form: ClosedForm) -> Section:
    sentence = "M(q) qdd + C(q, qd) qd + g(q) = tau, with tau the efforts of the joints [N·m | N]."
    return Section("Equation of motion", (sentence,))


def _lumps(form: ClosedForm) -> Iterator[Section]:
    if form.lumps:
        about = ("Combinations of parameters that come together, each named once.",)
        equations = [Equation(s, _summands(e)) for s, e in form.lumps.items()]
        yield Section("Lumped constants", about, tuple(equations))


def _constants(form: ClosedForm) -> Iterator[Section]:
    if form.constants:
        lines = tuple(f"{s} = {value:.12g} rad" for s, value in form.constants.items())
        about = ("Angles of the description that are not multiples of 15°, by name.",)
        yield Section("Constant angles", about, lines=lines)


def _base(form: ClosedForm) -> Iterator[Section]:
    if form.robot is None:
        return
    try:
        base = form.base_parameters()
    except ValueError as error:
        yield Section("Base parameters", (f"They were not found: {error}",))
        return
    unseen = ", ".join(base.unseen)
    about = (
        f"The efforts depend on {len(base)} combinations of the bodies' inertial parameters, "
        "each in the frame of the body's joint: m, h = m c, I about the frame's origin.",
        f"No effort depends on {unseen}." if unseen else "Every parameter is seen.",
    )
    equations = [Equation(Symbol(b.name), _summands(b.formula)) for b in base if b.formula != 0]
    yield Section("Base parameters", about, tuple(equations))


def _proofs(form: ClosedForm) -> Section:
    about = ("Each difference was reduced to its normal form, and that is the polynomial 0.",)
    try:
        lines = tuple(map(str, form.prove()))
    except ValueError as error:  # its sums are longer than the formulas themselves
        about, lines = (f"Nothing was decided: {error}",), ()
    return Section("What was proved", about, lines=lines)


# -- parts of sections ----------------------------------------------------------------------------


def _places(n: int) -> Callable[..., str]:
    """12 of joints 1 and 2; 1,12 where numbers have two digits."""
    between = "," if n > 9 else ""
    return lambda *indices: between.join(str(i + 1) for i in indices)


def _section(
    title: str,
    sentences: Sequence[str],
    entries: Iterable[tuple[Name, Polynomial]],
    form: ClosedForm,
    limit: int | None,
) -> Section:
    """Entries in order while they fit into the limit, shorter ones behind a long one too."""
    shown, total, hidden, terms = [], 0, 0, 0
    for name, x in entries:
        if limit is not None and total + len(x) > limit:
            hidden, terms = hidden + 1, terms + len(x)
            continue
        total += len(x)
        shown.append(Equation(name, _summands(form.write(x))))
    left_out = ""
    if hidden:
        them = "1 formula" if hidden == 1 else f"{hidden:,} formulas"
        left_out = f"{them} of {terms:,} terms together left out."
    return Section(title, tuple(sentences), tuple(shown), left_out)


def _summands(e: Expr) -> tuple[Expr, ...]:
    return tuple(e.as_ordered_terms())
