"""M, C and g from a user's own energies, by the Euler-Lagrange equations."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any, NoReturn

import sympy
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from mcgee.closed_form.dynamics import Dynamics
from mcgee.closed_form.form import ClosedForm
from mcgee.closed_form.reading import Needs, Reader
from mcgee.closed_form.ring import Polynomial, Ring

REWRITE = (
    "Closed forms know sums and products of numbers, symbols, velocities, and cosines and sines of "
    "sums of coordinates. Write other functions of constants as symbols."
)


def lagrange(T: Any, P: Any, q: Sequence[Any], qd: Sequence[Any]) -> ClosedForm:
    """M, C and g of the system with kinetic energy T and potential energy P, exactly.

    d/dt ∂T/∂qd − ∂T/∂q + ∂P/∂q = tau, so M = ∂²T/∂qd∂qd, C by the Christoffel symbols, g = ∂P/∂q.

    Args:
        T: a SymPy expression [J], a homogeneous quadratic in the velocities
        P: a SymPy expression [J] without velocities
        q, qd: the coordinates and their velocities (n,): symbols, or functions of time such as
            q1(t) with q1(t).diff(t), for which symbols of their names then stand
    Returns: a ClosedForm: .M .C .Cqd .g .tau .christoffel, .prove(), .compare(…)
    Raises: ValueError: energies that are not polynomials in qd, symbols and cosines and sines of
        sums of coordinates; the sentence names the energy and the term
    """
    given = {"T": _expression("T", T), "P": _expression("P", P)}
    old = _listed("q", q), _listed("qd", qd)
    names, rates = _symbols(*old)
    _check_names(given, old, (*names, *rates))
    puts = [
        dict(zip(a, b, strict=True)) for a, b in zip(reversed(old), (rates, names), strict=True)
    ]
    energies = {w: e.xreplace(puts[0]).xreplace(puts[1]) for w, e in given.items()}
    _check_time(energies, old[0])
    taken = {str(s) for e in energies.values() for s in e.free_symbols} | set(map(str, names))
    accelerations = [_free(_rate_name(str(s), "dd"), taken) for s in names]
    constants: dict[Symbol, float] = {}
    needs = Needs()
    for what, energy in energies.items():
        Reader(needs, constants, _refuse(what), taken).number(energy)
    _check_needs(needs, names, rates)
    ring = needs.ring(symbols=(*rates, *accelerations))
    t, p = (ring(Reader(ring, constants, _refuse(w), taken).number(x)) for w, x in energies.items())
    _check_degree("T", t, ring, rates, 2, "A term without velocities belongs to P.")
    _check_degree("P", p, ring, rates, 0, "Energies of motion belong to T.")
    M = [[t.derivative(a).derivative(b) for b in rates] for a in rates]
    g = [p.derivative(s) for s in names]
    symbols = tuple(names), tuple(rates), tuple(accelerations)
    form = ClosedForm("your energies", Dynamics(ring, *symbols, M, g, t, p, constants))
    form.made_by = lagrange, (T, P, q, qd)
    return form


def _expression(what: str, energy: Any) -> Expr:
    try:
        found = sympy.sympify(energy)
    except (sympy.SympifyError, TypeError, SyntaxError):
        found = None
    if not isinstance(found, Expr):
        raise ValueError(f"{what} is {energy!r}, expected a SymPy expression.")
    strange = [s for s in found.free_symbols if not s.is_commutative]
    if found.has(sympy.I) or strange:
        shown = strange[0] if strange else "the imaginary unit"
        raise ValueError(f"{what} has {shown} in it, expected real numbers and symbols alone.")
    return found


def _listed(what: str, given: Any) -> list[Expr]:
    if isinstance(given, (sympy.Basic, str)) or not isinstance(given, Iterable):
        raise ValueError(f"{what} is {given}, expected a list, one entry a coordinate.")
    return [x if isinstance(x, str) else sympy.sympify(x) for x in given]


def _check_names(
    energies: dict[str, Expr], old: tuple[list[Expr], list[Expr]], new: Sequence[Symbol]
) -> None:
    """No symbol of the energies has a coordinate's or velocity's name without being it."""
    own = {*old[0], *old[1]}
    moving = {str(s): s for s in new}
    for what, energy in energies.items():
        for s in energy.free_symbols - own:
            if str(s) in moving:
                raise ValueError(
                    f"{what} has a symbol '{s}' that is not the coordinate or velocity of that "
                    f"name. Use the same object for both (assumptions count), or another name for "
                    f"a parameter."
                )


def _check_time(energies: dict[str, Expr], q: list[Expr]) -> None:
    times = {x.args[0] for x in q if isinstance(x, AppliedUndef)}
    for what, energy in energies.items():
        if times & energy.free_symbols:
            raise ValueError(
                f"{what} depends on time by itself, not by the coordinates alone; closed forms are "
                f"of systems that do not change with time."
            )


def _symbols(q: list[Any], qd: list[Any]) -> tuple[list[Symbol], list[Symbol]]:
    """q and qd as symbols; functions of time by their names."""
    if not q or len(q) != len(qd):
        raise ValueError(
            f"q has {len(q)} coordinates and qd {len(qd)} velocities, expected as many of both, "
            f"one or more."
        )
    names, rates = [], []
    for x, rate in zip(q, qd, strict=True):
        if isinstance(x, AppliedUndef) and isinstance(rate, sympy.Derivative):
            if rate != x.diff(x.args[0]):
                raise ValueError(f"velocity {rate} is not {x.diff(x.args[0])}, that of {x}.")
            x, rate = Symbol(str(x.func)), Symbol(_rate_name(str(x.func), "d"))
        for what, s in (("coordinate", x), ("velocity", rate)):
            if not isinstance(s, Symbol):
                raise ValueError(
                    f"{what} {s} is no SymPy symbol. Write q = sympy.symbols('q1 q2'), or "
                    f"functions of time and their derivatives."
                )
        names.append(x)
        rates.append(rate)
    if len({*names, *rates}) != 2 * len(names):
        shown = ", ".join(map(str, (*names, *rates)))
        raise ValueError(f"coordinates and velocities are {shown}, expected each once.")
    return names, rates


def _rate_name(name: str, dots: str) -> str:
    """q1 → qd1."""
    letters, number = re.fullmatch(r"(.*?)(_?\d*)", name, re.DOTALL).groups()  # type: ignore[union-attr]
    return f"{letters}{dots}{number}"


def _free(name: str, taken: set[str]) -> Symbol:
    while name in taken:
        name += "_"
    return Symbol(name)


def _refuse(what: str) -> Any:
    def refuse(x: Any) -> NoReturn:
        raise ValueError(
            f"{what} has the part {x}, which is no trigonometric polynomial. {REWRITE}"
        )

    return refuse


def _check_needs(needs: Needs, names: Iterable[Symbol], rates: Iterable[Symbol]) -> None:
    for s in needs.inverses:
        if s in (*names, *rates):
            raise ValueError(f"the energies divide by {s}, which moves. {REWRITE}")
    for angle in needs.angles:
        for s, _ in angle:
            if s in rates:
                raise ValueError(f"the energies have velocity {s} in an angle. {REWRITE}")


def _check_degree(
    what: str, x: Polynomial, ring: Ring, rates: Sequence[Symbol], want: int, advice: str
) -> None:
    at = [ring.at[s] for s in rates]
    for exponents, _ in x.terms():
        degree = sum(exponents[i] for i in at)
        if degree != want:
            raise ValueError(
                f"{what} has a term of degree {degree} in the velocities, expected {want} in every "
                f"term. {advice}"
            )
