"""The closed forms of a system, as users hold them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy
from sympy import Expr, Matrix, Symbol

from mcgee import quantities as on
from mcgee.closed_form import identities
from mcgee.closed_form.base import BaseParameters, base_parameters
from mcgee.closed_form.compare import compared
from mcgee.closed_form.definite import definiteness
from mcgee.closed_form.document import LIMIT, document
from mcgee.closed_form.dynamics import Dynamics
from mcgee.closed_form.evaluate import Compiled, values_of
from mcgee.closed_form.exact import ExactRobot, exact
from mcgee.closed_form.expression import WAYS, Writer
from mcgee.closed_form.lumps import Lumps
from mcgee.closed_form.proof import Definiteness, Proof
from mcgee.closed_form.ring import Polynomial
from mcgee.closed_form.terms import readable
from mcgee.closed_form.text import plain_text
from mcgee.writing import write_whole

if TYPE_CHECKING:
    from mcgee.robot import Robot

QUANTITIES = ("T", "P", "M", "C", "Cqd", "g", "tau", "christoffel")


class Symbols:
    """c[i, j, k] or c[i][j][k]: Christoffel symbols, each made an expression when asked for."""

    def __init__(self, entries: Sequence[Any], write: Callable[[Polynomial], Expr]):
        self._entries, self.write = entries, write

    @property
    def shape(self) -> tuple[int, ...]:
        n = len(self._entries)
        return (n, *(Symbols(self._entries[0], self.write).shape if self._nested else ()))

    @property
    def _nested(self) -> bool:
        return isinstance(self._entries[0], list)

    def __len__(self) -> int:
        return len(self._entries)

    def __getitem__(self, index: int | tuple[int, ...]) -> Any:
        first, *rest = index if isinstance(index, tuple) else (index,)
        entry = self._entries[first]
        if not self._nested:
            return self.write(entry)
        inner = Symbols(entry, self.write)
        return inner[tuple(rest)] if rest else inner

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))


class ClosedForm:
    """T, P, M, C, g and tau as formulas that are exact.

    Expressions are SymPy's, made from the polynomials in `exact` when asked for: q1, q2, … are the
    joint positions, qd1, … and qdd1, … their rates. A float parameter is the decimal it was written
    as (0.1 is 1/10). Rotations by multiples of 15° are exact; the turn by another angle about one
    axis has a named angle (`constants` holds its value); any other rotation is the exactly
    orthogonal one with rational entries that rounds to the description's floats.

    Made by `Robot.closed_form()` and `mcgee.lagrange`.
    """

    def __init__(
        self,
        name: str,
        dynamics: Dynamics,
        robot: ExactRobot | None = None,
        simplify: str = "expanded",
    ):
        if simplify not in WAYS:
            raise ValueError(f"simplify is {simplify!r}, expected one of: {', '.join(WAYS)}.")
        self.name, self.exact, self.simplify = name, dynamics, simplify
        self.robot = robot
        self.made_by: tuple[Callable[..., ClosedForm], tuple] | None = None
        self._compiled: dict[str, list[Compiled]] = {}
        self.writer = Writer(dynamics.ring, dynamics.q, (*dynamics.qd, *dynamics.qdd))

    # -- what it is in ----------------------------------------------------------------------------

    @property
    def n(self) -> int:
        return self.exact.n

    @property
    def q(self) -> tuple[Symbol, ...]:
        """The joint positions [rad | m]."""
        return self.exact.q

    @property
    def qd(self) -> tuple[Symbol, ...]:
        return self.exact.qd

    @property
    def qdd(self) -> tuple[Symbol, ...]:
        return self.exact.qdd

    @property
    def constants(self) -> dict[Symbol, float]:
        """The named angles of the description, with their values [rad]."""
        return dict(self.exact.constants)

    @cached_property
    def lumps(self) -> dict[Symbol, Expr]:
        """What the names of simplify='lumped' stand for; empty otherwise."""
        return {s: self.writer.sum(found) for s, found in self._lumps.named.items()}

    @cached_property
    def _lumps(self) -> Lumps:
        lumps = Lumps()
        if self.simplify == "lumped":
            taken = {str(s) for s in self.exact.ring.symbols}
            while any(str(s).rstrip("0123456789") == lumps.letter for s in taken):
                lumps.letter += "_"
            for group in (self._flat("M"), self._flat("g"), [self.exact.P]):
                found = (self.writer.by_configuration(readable(x)) for x in group)
                lumps.learn([part for parts in found for part in parts.values()])
        return lumps

    # -- the formulas -----------------------------------------------------------------------------

    @cached_property
    def T(self) -> Expr:
        """The kinetic energy [J]."""
        return self.write(self.exact.T)

    @cached_property
    def P(self) -> Expr:
        """The potential energy [J]."""
        return self.write(self.exact.P)

    @cached_property
    def M(self) -> Matrix:
        """The inertia matrix (n, n)."""
        return self._matrix(self.exact.M)

    @cached_property
    def C(self) -> Matrix:
        """C (n, n) by the Christoffel symbols, C_ij = Σ_k c_ijk qd_k."""
        return self._matrix(self.exact.C)

    @cached_property
    def Cqd(self) -> Matrix:
        """Centrifugal and Coriolis efforts (n, 1)."""
        return self._column(self.exact.Cqd)

    @cached_property
    def g(self) -> Matrix:
        """The gravity vector ∂P/∂q (n, 1)."""
        return self._column(self.exact.g)

    @cached_property
    def tau(self) -> Matrix:
        """M qdd + C qd + g (n, 1)."""
        return self._column(self.exact.tau)

    @property
    def christoffel(self) -> Symbols:
        """c[i, j, k] = ½(∂M_ij/∂q_k + ∂M_ik/∂q_j − ∂M_jk/∂q_i), made when asked for."""
        return Symbols(self.exact.christoffel, self.write)

    def simplified(self, simplify: str) -> ClosedForm:
        """The same, written another way: 'expanded', 'collected' or 'lumped'."""
        form = ClosedForm(self.name, self.exact, self.robot, simplify)
        form.made_by = self.made_by
        return form

    def __reduce__(self) -> tuple:
        """Derived again where it is unpickled, which takes less than reading polynomials would."""
        if self.made_by is None:
            raise TypeError("only closed forms of robots and of energies can be pickled.")
        return _again, (*self.made_by, self.simplify)

    def terms(self, quantity: str) -> int:
        """How many terms the polynomials of 'M', 'christoffel', … have together."""
        return sum(len(x) for x in self._flat(quantity))

    def write(self, x: Polynomial) -> Expr:
        """A polynomial of `exact` as SymPy's, in the way of `simplify`."""
        return self.writer.write(x, self.simplify, self._lumps)

    def _matrix(self, rows: Sequence[Sequence[Polynomial]]) -> Matrix:
        return sympy.ImmutableMatrix([[self.write(x) for x in row] for row in rows])

    def _column(self, entries: Sequence[Polynomial]) -> Matrix:
        return self._matrix([[x] for x in entries])

    def _flat(self, quantity: str) -> list[Polynomial]:
        if quantity not in QUANTITIES:
            known = ", ".join(QUANTITIES)
            raise ValueError(f"closed forms have no quantity {quantity!r}. Quantities: {known}.")
        return list(_flattened(getattr(self.exact, quantity)))

    # -- numbers ----------------------------------------------------------------------------------

    def evaluate(
        self,
        quantity: str,
        q: Any,
        qd: Any = None,
        qdd: Any = None,
        values: Mapping[Any, float] | None = None,
    ) -> np.ndarray:
        """A quantity in numbers, from its polynomials.

        Args:
            quantity: 'T', 'P', 'M', 'C', 'Cqd', 'g', 'tau' or 'christoffel'
            q, qd, qdd: (..., n); zero by default
            values: of the symbolic parameters, by symbol or name
        Returns: (...), (..., n), (..., n, n) or (..., n, n, n)
        Raises: ValueError: an unknown quantity, a wrong shape, a symbol without a value
        """
        if quantity not in self._compiled:
            self._compiled[quantity] = [Compiled(x) for x in self._flat(quantity)]
        table: dict[Symbol, Any] = dict(self.constants)
        table |= {s: float(v) for s, v in self._by_symbol(values or {}).items()}
        q = np.asarray(q, float)
        leads = []
        for what, symbols, given in (("q", self.q, q), ("qd", self.qd, qd), ("qdd", self.qdd, qdd)):
            array = np.zeros_like(q) if given is None else np.asarray(given, float)
            if array.shape[-1:] != (self.n,):
                raise ValueError(
                    f"{what} has shape {array.shape}, expected (..., {self.n}) for '{self.name}'."
                )
            table |= dict(zip(symbols, np.moveaxis(array, -1, 0), strict=True))
            leads.append(array.shape[:-1])
        generators = values_of(self.exact.ring, table)
        lead = np.broadcast_shapes(*leads)
        entries = [np.broadcast_to(x(generators), lead) for x in self._compiled[quantity]]
        shape = np.shape(np.empty([self.n] * _depth(getattr(self.exact, quantity))))
        return np.stack(entries, -1).reshape((*lead, *shape))

    def _by_symbol(self, values: Mapping[Any, float]) -> dict[Symbol, float]:
        ring = self.exact.ring
        names = {str(s): s for s in (*ring.symbols, *(s for f in ring.angles.forms for s, _ in f))}
        for key in values:
            if str(key) not in names:
                raise ValueError(
                    f"'{self.name}' has no symbol '{key}'. Its symbols: {', '.join(sorted(names))}."
                )
        return {names[str(key)]: v for key, v in values.items()}

    # -- what holds -------------------------------------------------------------------------------

    def prove(self) -> Proof:
        """The identities of the equation of motion, decided exactly.

        Returns: the identities by position or name, true where all hold; print() it. Each has its
            two sides' numbers of terms and their `differences`, which are the polynomial 0
        """
        d, robot = self.exact, self.robot
        if robot is None:
            found = [*identities.of_any(d, d.tau), *identities.still(d)]
            why = "a system's own energies are not known to be sums of squares."
            return Proof([*found, Definiteness("undecided", why)])
        tau = identities.newton_euler(robot)
        found = [*identities.of_robot(robot, d, tau), *identities.of_any(d, tau)]
        return Proof([*found, *identities.still(d), definiteness(robot, d)])

    def compare(self, other: ClosedForm) -> Proof:
        """Whether M, C qd and g are the other's, exactly; symbols of one name are the same.

        Returns: the identities 'M', 'Cqd' and 'g', true where all hold
        """
        return compared(self, other)

    def base_parameters(self) -> BaseParameters:
        """The fewest combinations of the inertial parameters that the efforts depend on.

        Raises: ValueError: the form is not a robot's
        Source: Gautier & Khalil 1990, and elimination where their general rules leave more
        """
        if self.robot is None:
            raise ValueError(
                f"'{self.name}' was made from energies and has no links, so no inertial "
                f"parameters. Ask the closed form of a robot."
            )
        return base_parameters(self.robot)

    def __repr__(self) -> str:
        return f"ClosedForm of '{self.name}': {self.n} joints, M has {self.terms('M')} terms"

    def __str__(self) -> str:
        return plain_text(self)

    def latex(self) -> str:
        """T, P, M, C, C qd and g as LaTeX, an equation each."""
        from mcgee.closed_form.latex import latex

        return latex(self)

    def to_latex(self, path: str | os.PathLike[str], limit: int | None = LIMIT) -> Path:
        """Write the derivation as an article that pdflatex takes as it is.

        Args:
            limit: terms that a section shows at most; None for all
        Returns: the path, written whole or not at all
        Raises: ValueError: the path cannot be written
        """
        from mcgee.closed_form.latex import paper

        return write_whole(Path(path), "the article", lambda: paper(document(self, limit)))

    def to_html(self, path: str | os.PathLike[str], limit: int | None = LIMIT) -> Path:
        """Write the derivation as one page that needs no network and no other file.

        Args:
            limit: terms that a section shows at most; None for all
        Returns: the path, written whole or not at all
        Raises: ValueError: the path cannot be written
        """
        from mcgee.closed_form.html import page

        return write_whole(Path(path), "the page", lambda: page(document(self, limit)))


def closed_form(robot: Robot, symbolic_inertias: bool, simplify: str) -> ClosedForm:
    """See Robot.closed_form."""
    form = of_exact(robot.name, exact(robot, symbolic_inertias), simplify)
    form.made_by = closed_form, (robot, symbolic_inertias, "expanded")
    return form


def _again(make: Callable[..., ClosedForm], given: tuple, simplify: str) -> ClosedForm:
    form = make(*given)
    return form if form.simplify == simplify else form.simplified(simplify)


def of_exact(name: str, e: ExactRobot, simplify: str) -> ClosedForm:
    """By the algorithms on the robot's ring."""
    ring, m, (qd, _) = e.ring, e.mechanism, e.rates
    M = [[ring(x) for x in row] for row in on.mass_matrix(m, e.at_rest)]
    g = [ring(x) for x in on.gravity(m, e.at_rest)]
    T = ring(on.kinetic_energy(m, e.at_rest, qd))
    P = ring(on.potential_energy(m, e.at_rest))
    return ClosedForm(name, Dynamics(ring, e.q, e.qd, e.qdd, M, g, T, P, e.constants), e, simplify)


def _flattened(x: Any) -> Iterator[Polynomial]:
    if isinstance(x, list):
        for part in x:
            yield from _flattened(part)
    else:
        yield x


def _depth(x: Any) -> int:
    return 1 + _depth(x[0]) if isinstance(x, list) else 0
