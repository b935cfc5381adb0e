"""Whether two closed forms are the same."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

from sympy import Expr, Symbol

from mcgee.closed_form.proof import Identity, Proof, identity
from mcgee.closed_form.reading import SAME, Needs, Reader

if TYPE_CHECKING:
    from mcgee.closed_form.form import ClosedForm

COMPARED = {"M": "the same M", "Cqd": "the same C qd", "g": "the same g"}


def compared(one: ClosedForm, other: ClosedForm) -> Proof:
    """Their elements read into one ring.

    Raises: ValueError: different numbers of coordinates
    """
    if one.n != other.n:
        raise ValueError(
            f"'{one.name}' has {one.n} coordinates and '{other.name}' {other.n}, expected as many."
        )
    same, constants = _names(one, other)
    pairs = {
        what: (_elements(one, what), [e.xreplace(same) for e in _elements(other, what)])
        for what in COMPARED
    }
    needs = Needs()
    everything = [e for sides in pairs.values() for side in sides for e in side]
    for e in everything:
        Reader(needs, constants, _refuse).number(e)
    reader = Reader(ring := needs.ring(), constants, _refuse)
    found: list[Identity] = []
    for what, sides in pairs.items():
        left, right = ([ring(reader.number(e)) for e in side] for side in sides)
        decidable = not ring.angles.loose and len(constants) < 2
        found.append(identity(what, COMPARED[what], left, right, decidable=decidable))
    return Proof(found)


def _elements(form: ClosedForm, what: str) -> list[Expr]:
    return list(getattr(form.simplified("expanded"), what))


def _names(one: ClosedForm, other: ClosedForm) -> tuple[dict[Symbol, Symbol], dict[Symbol, float]]:
    """The other's symbols as this one's, coordinates by position, parameters by name, named angles
    by value; and the values of all named angles."""
    constants = one.constants
    ours = {str(s): s for s in _symbols(one) if s not in constants}
    same = {s: ours[str(s)] for s in _symbols(other) if str(s) in ours}
    for s, value in other.constants.items():
        equal = [mine for mine, v in constants.items() if abs(v - value) < SAME]
        same[s] = equal[0] if equal else Symbol(f"{s}'")
        constants[same[s]] = value
    for a, b in ((one.q, other.q), (one.qd, other.qd), (one.qdd, other.qdd)):
        same |= dict(zip(b, a, strict=True))
    return same, constants


def _symbols(form: ClosedForm) -> list[Symbol]:
    ring = form.exact.ring
    return [*ring.symbols, *(s for angle in ring.angles.forms for s, _ in angle)]


def _refuse(x: Any) -> NoReturn:
    raise ValueError(f"{x} is no trigonometric polynomial.")
