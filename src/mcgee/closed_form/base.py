"""Base parameters: the fewest combinations of inertial parameters that the efforts depend on.

The general rules regroup three parameters of each revolute joint's body, and all moments of a
prismatic one's, with the parameters of the body before it. What these rules leave dependent
(unseen parameters of the first joints, parallel axes) is found among the regressor's columns, exact
at random rational configurations, velocities and accelerations.

Source: Gautier & Khalil 1990.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NoReturn, TypeAlias

import sympy
from flint import fmpq, fmpq_mat, fmpz, nmod_mat
from sympy import Expr, Symbol

from mcgee import quantities as on
from mcgee.algorithms.parameters import TEN
from mcgee.algorithms.regroup import regrouped
from mcgee.closed_form.exact import PARAMETERS, ExactRobot
from mcgee.closed_form.expression import Writer
from mcgee.closed_form.lumps import Lumps
from mcgee.closed_form.proof import Identity, identity
from mcgee.closed_form.reading import Reader
from mcgee.closed_form.ring import Polynomial, Ring
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar

Factor: TypeAlias = Fraction | Expr

REVOLUTE, PRISMATIC = (1, 2, 4, 5, 7, 8, 9), (0, 1, 2, 3)
"""Of a body's ten parameters, those that the general rules leave; revolute: Ixx stands for
Ixx − Iyy."""


@dataclass(frozen=True)
class BaseParameter:
    """One combination that the efforts depend on."""

    name: str
    """IzzR2: the regrouped Izz of the second body."""
    joint: str
    """Whose body it is; in the axes of the joint's frame."""
    formula: Expr
    column: int
    """Among the ten parameters of each body."""


class BaseParameters(tuple):
    """The base parameters, from the root outwards; armatures are apart and not among them."""

    unseen: tuple[str, ...]
    """Parameters that no effort depends on, alone or regrouped."""
    identity: Identity | None
    """tau = Y β + armature qdd as an exact identity; None where a factor of β is no polynomial."""

    def __str__(self) -> str:
        width = max((len(b.name) for b in self), default=0)
        lines = [f"{b.name:<{width}} = {b.formula}" for b in self]
        unseen = f"unseen: {', '.join(self.unseen)}" if self.unseen else "every one is seen"
        return "\n".join([f"{len(self)} base parameters; {unseen}", *lines])


def base_parameters(e: ExactRobot) -> BaseParameters:
    """Of an exact robot.

    Relations that hold at too few states are found out by the identity; more are then drawn.
    """
    for times in (1, 4, 16):
        found = _base_parameters(e, times)
        if found.identity is None or found.identity.holds:
            break
    return found


def _base_parameters(e: ExactRobot, times: int) -> BaseParameters:
    light = _light(e)
    columns = [
        TEN * i + k
        for i, body in enumerate(light.bodies)
        for k in (PRISMATIC if body.prismatic else REVOLUTE)
    ]
    grouped = _grouped(e)
    base, others = _relations(e, light, columns, times)
    writer = Writer(e.ring, e.q, (*e.qd, *e.qdd))
    found, sums = [], []
    for c in base:
        total, extra = grouped[c], sympy.Integer(0)
        for d, factors in others.items():
            factor = _in_ring(e.ring, factors.get(c, Fraction(0)))
            if factor is not None:
                total = total + grouped[d] * factor
            else:
                extra += factors[c] * writer.write(e.ring(grouped[d]), "expanded", Lumps())
        total = e.ring(total)
        formula = writer.write(total, "expanded", Lumps()) + sympy.expand(extra)
        found.append(BaseParameter(_regrouped_name(c), light.bodies[c // TEN].name, formula, c))
        sums.append(None if extra else total)
    result = BaseParameters(found)
    result.unseen = tuple(_name(d) for d, factors in others.items() if not factors)
    result.identity = _identity(e, light, base, sums)
    return result


def _name(column: int) -> str:
    return f"{PARAMETERS[column % TEN]}{column // TEN + 1}"


def _regrouped_name(column: int) -> str:
    return f"{PARAMETERS[column % TEN]}R{column // TEN + 1}"


def _in_ring(ring: Ring, factor: Factor) -> Scalar | None:
    """A factor as a polynomial, None where it is none."""
    if isinstance(factor, Fraction):
        return factor
    try:
        return Reader(ring, {}, _refuse).number(factor)
    except (KeyError, ValueError):  # it needs what the ring has not
        return None


def _refuse(x: object) -> NoReturn:
    raise ValueError(f"{x} is no polynomial")


def _light(e: ExactRobot) -> Mechanism:
    """Without inertias, the frames of the links those of their bodies' joints."""
    bodies = tuple(
        replace(b, mass=0, first_moment=(0, 0, 0), inertia=(0,) * 6) for b in e.mechanism.bodies
    )
    frames = {b.link: (i, e.turns[i]) for i, b in enumerate(bodies)}
    return Mechanism(bodies, (), frames, e.mechanism.gravity, e.mechanism.n)


def _grouped(e: ExactRobot) -> list[Scalar]:
    """The regrouped parameters, ten a body, in the frames of the joints."""
    parameters: list[Scalar] = []
    for b in regrouped(e.still).bodies:
        xx, xy, xz, yy, yz, zz = b.inertia
        parameters += [b.mass, *b.first_moment, xx, xy, yy, xz, yz, zz]
    return parameters


def _identity(
    e: ExactRobot, light: Mechanism, base: Sequence[int], sums: Sequence[Polynomial | None]
) -> Identity | None:
    (qd, qdd), zero = e.rates, e.at_rest
    Y = on.regressor(light, zero, qd, qdd)
    rotors = on.inverse_dynamics(light, zero, qd, qdd)  # of a robot without links
    efforts = [e.ring(x) for x in rotors]
    for i, row in enumerate(Y):
        for c, total in zip(base, sums, strict=True):
            if total is None:
                return None
            efforts[i] = efforts[i] + total * row[c]
    tau = [e.ring(x) for x in on.inverse_dynamics(e.mechanism, zero, qd, qdd)]
    statement = f"tau = Y β + armature qdd with {len(base)} base parameters β"
    return identity("base parameters", statement, tau, efforts)


# -- relations among the regressor's columns ------------------------------------------------------


def _relations(
    e: ExactRobot, light: Mechanism, columns: Sequence[int], times: int
) -> tuple[list[int], dict[int, dict[int, Factor]]]:
    """(base columns, every other one as a sum of these)."""
    rows = _samples(e, light, columns, times)
    constants = [[e.ring(x) for x in row] for row in rows]
    if all(x.p.is_constant() for row in constants for x in row):
        matrix = fmpq_mat([[_number(x) for x in row] for row in constants])
        reduced, rank = matrix.rref()
        pivots = _pivots(reduced, rank)
        others = {
            columns[j]: {
                columns[p]: Fraction(int(reduced[r, j].p), int(reduced[r, j].q))
                for r, p in enumerate(pivots)
                if reduced[r, j]
            }
            for j in range(len(columns))
            if j not in pivots
        }
        return [columns[p] for p in pivots], others
    return _symbolic_relations(e.ring, constants, columns)


def _pivots(reduced: fmpq_mat | nmod_mat, rank: int) -> list[int]:
    return [next(j for j in range(reduced.ncols()) if reduced[r, j]) for r in range(rank)]


def _number(x: Polynomial) -> fmpq:
    return x.p.leading_coefficient() if x else fmpq(0)


def _samples(
    e: ExactRobot, light: Mechanism, columns: Sequence[int], times: int
) -> list[list[Scalar]]:
    """Rows of the regressor at random rational states, constants left as they are."""
    draw, rows = random.Random(0), []
    names = e.ring.context.names()
    moving = {*e.q, *e.qd, *e.qdd}
    felt = Counter(light.bodies[c // TEN].coordinate for c in columns)
    states = max(len(columns) // e.mechanism.n, *felt.values()) + 3
    for _ in range(times * states):
        values: dict[str | int, int | fmpz | fmpq] = {}
        for i, angle in enumerate(e.ring.angles.forms):
            if any(s in moving for s, _ in angle):
                t = fmpq(draw.randint(1, 30), draw.randint(1, 30))
                values[names[2 * i]] = 2 * t / (1 + t * t)
                values[names[2 * i + 1]] = (1 - t * t) / (1 + t * t)
        for s in moving & set(e.ring.at):
            values[names[e.ring.at[s]]] = fmpq(draw.randint(-30, 30), draw.randint(1, 9))

        def put(x: Scalar, values: dict[str | int, int | fmpz | fmpq] = values) -> Scalar:
            return e.ring.element(x.p.subs(values)) if isinstance(x, Polynomial) else x

        qd, qdd = (list(map(put, rates)) for rates in e.rates)
        Y = on.regressor(light.map(put), e.at_rest, qd, qdd)
        rows += [[row[c] for c in columns] for row in Y]
    return rows


PRIME = 2**61 - 1


def _symbolic_relations(
    ring: Ring, rows: list[list[Polynomial]], columns: Sequence[int]
) -> tuple[list[int], dict[int, dict[int, Factor]]]:
    """Which columns depend on which, by constants drawn modulo a prime; then by which factors."""
    prime, table = _drawn(ring)
    matrix = nmod_mat(
        len(rows), len(columns), [_modulo(x, table, prime) for row in rows for x in row], prime
    )
    reduced, rank = matrix.rref()
    pivots = _pivots(reduced, rank)
    writer = Writer(ring, (), ())
    others: dict[int, dict[int, Factor]] = {}
    for j in range(len(columns)):
        if j in pivots:
            continue
        support = [p for r, p in enumerate(pivots) if int(reduced[r, j])]
        wanted = [[row[p] for p in (*support, j)] for row in rows]
        factors = _factors(wanted, writer, table, prime) if support else []
        others[columns[j]] = {
            columns[p]: factor for p, factor in zip(support, factors, strict=True)
        }
    return [columns[p] for p in pivots], others


def _factors(
    rows: list[list[Polynomial]], writer: Writer, table: list[int], prime: int
) -> list[Factor]:
    """The last column as a sum of the others."""
    n = len(rows[0]) - 1
    transposed = [[_modulo(row[k], table, prime) for row in rows] for k in range(n)]
    reduced, rank = nmod_mat(n, len(rows), [x for t in transposed for x in t], prime).rref()
    chosen = [rows[i] for i in _pivots(reduced, rank)]
    written = [[writer.write(x, "expanded", Lumps()) for x in row] for row in chosen]
    matrix = sympy.Matrix([row[:n] for row in written])
    found = matrix.LUsolve(sympy.Matrix([row[n] for row in written]))
    factors = [sympy.trigsimp(sympy.radsimp(sympy.cancel(x))) for x in found]
    return [Fraction(int(x.p), int(x.q)) if x.is_Rational else x for x in factors]


def _drawn(ring: Ring) -> tuple[int, list[int]]:
    """A prime modulo which the ring's square roots exist, and values of its generators."""
    prime, draw = PRIME, random.Random(1)
    while prime % 4 != 3 or any(pow(p, (prime - 1) // 2, prime) != 1 for p in ring.roots):
        prime = int(sympy.prevprime(prime))
    table: list[int] = []
    for _ in ring.angles.forms:
        t = draw.randrange(1, prime)
        d = pow(1 + t * t, -1, prime)
        table += [2 * t * d % prime, (1 - t * t) * d % prime]
    drawn: dict[Symbol, int] = {s: draw.randrange(1, prime) for s in ring.symbols}
    table += drawn.values()
    table += [pow(drawn[s], -1, prime) for s in ring.inverses]
    return prime, table + [pow(p, (prime + 1) // 4, prime) for p in ring.roots]


def _modulo(x: Polynomial, table: list[int], prime: int) -> int:
    total = 0
    for exponents, k in x.terms():
        term = k.numerator * pow(k.denominator, -1, prime)
        for i, e in enumerate(exponents):
            if e:
                term = term * pow(table[i], e, prime) % prime
        total += term
    return total % prime
