"""Which identities a robot's closed forms must satisfy, against what does not come from them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from sympy import Symbol

from mcgee import quantities as on
from mcgee.algorithms.crba import crba
from mcgee.algorithms.definition import definition
from mcgee.algorithms.energy import potential_energy
from mcgee.algorithms.parameters import inertial_parameters
from mcgee.closed_form.dynamics import Dynamics, Row, Rows
from mcgee.closed_form.exact import ExactRobot
from mcgee.closed_form.proof import Identity, identity
from mcgee.closed_form.ring import Polynomial


def of_any(d: Dynamics, tau: Row) -> Iterator[Identity]:
    """What M, C, T and P must satisfy wherever they come from; tau: the efforts."""
    n, qd = d.n, [d.ring.symbol(s) for s in d.qd]
    Mdot = [
        [_dot(d, qd, [d.slopes[k][i][j] for k in range(n)]) for j in range(n)] for i in range(n)
    ]
    yield identity(
        "skew",
        "Ṁ − 2C is skew-symmetric: Ṁ = C + Cᵀ",
        _flat(Mdot),
        (d.C[i][j] + d.C[j][i] for i in range(n) for j in range(n)),
    )
    twice = _dot(d, qd, [_dot(d, qd, row) for row in d.M])
    yield identity("kinetic energy", "T = ½ qdᵀ M qd", [d.T], [twice / 2])
    yield identity("power", "dE/dt = d(T + P)/dt = qdᵀ tau", [_energy_rate(d)], [_dot(d, qd, tau)])


def of_robot(e: ExactRobot, d: Dynamics, tau: Row) -> Iterator[Identity]:
    """What they must satisfy besides: tau is Newton and Euler's, T and P sums over the links, g the
    moment of the links' weights, M of composite bodies."""
    columns = [[x.derivative(s) for s in e.qdd] for x in tau]
    pairs = list(combinations(range(d.n), 2))
    yield identity(
        "symmetric",
        "M_ij = M_ji, column j being the efforts that qdd_j asks of Newton and Euler",
        (columns[i][j] for i, j in pairs),
        (columns[j][i] for i, j in pairs),
    )
    yield from _in_own_frames(e, d)
    hessian = [[d.T.derivative(a).derivative(b) for b in d.qd] for a in d.qd]
    yield identity("inertia", "M = ∂²T/∂qd∂qd", _flat(d.M), _flat(hessian))
    yield identity("gravity", "g = ∂P/∂q", d.g, (d.P.derivative(s) for s in d.q))
    yield identity("Newton-Euler", "M qdd + C qd + g = tau of Newton and Euler", d.tau, tau)
    yield identity(
        "linear",
        "tau = Y π + armature qdd, linear in the inertial parameters π",
        tau,
        _by_parameters(e, *e.rates),
    )


def _in_own_frames(e: ExactRobot, d: Dynamics) -> Iterator[Identity]:
    """M and P of bodies that turn with their joints, link by link where links are known.

    Nothing of how `d` was found comes in. Left out where gears make angles of their own.
    """
    if d.ring.angles.loose:  # what is 0 might not be seen to be
        return
    try:
        positions = e.positions()
    except ValueError:
        return
    n, bodies = d.n, e.still.bodies
    inertia = crba if e.inertial else definition
    joints = inertia(e.still, positions)
    M = [[d.ring(0)] * n for _ in range(n)]
    for a, row in zip(bodies, joints, strict=True):
        for b, x in zip(bodies, row, strict=True):
            i, j = a.coordinate, b.coordinate
            M[i][j] = M[i][j] + x * (a.multiplier * b.multiplier)
    by_links = "" if e.inertial else " = Σ (m Jvᵀ Jv + Jωᵀ I Jω), link by link"
    yield identity("definition", f"M{by_links} in frames that turn", _flat(d.M), _flat(M))
    P = d.ring(potential_energy(e.still, positions))
    yield identity("height", "P = −Σ m (gravity · CoM) in frames that turn", [d.P], [P])


def newton_euler(e: ExactRobot) -> Row:
    """The efforts by the recursion."""
    return [e.ring(x) for x in on.inverse_dynamics(e.mechanism, e.at_rest, *e.rates)]


def still(d: Dynamics) -> Iterator[Identity]:
    """Of each joint coordinate that M does not depend on."""
    for s, slope in zip(d.q, d.slopes, strict=True):
        if not any(map(any, slope)):
            weight = "" if d.P.derivative(s) else f" Nor does P: ∂T/∂{_rate(d, s)} stays as it is."
            zeros = [d.ring(0)] * (d.n * d.n)
            note = f"Turning or sliding {s} changes nothing in M.{weight}"
            yield identity(f"M without {s}", f"∂M/∂{s} = 0", _flat(slope), zeros, note)


def _rate(d: Dynamics, s: Symbol) -> Symbol:
    return d.qd[d.q.index(s)]


def _energy_rate(d: Dynamics) -> Polynomial:
    """d(T + P)/dt by the chain rule."""
    total = d.ring(0)
    for s, sd, sdd in zip(d.q, d.qd, d.qdd, strict=True):
        slope = d.T.derivative(s) + d.P.derivative(s)
        total = total + slope * d.ring.symbol(sd) + d.T.derivative(sd) * d.ring.symbol(sdd)
    return total


def _by_parameters(e: ExactRobot, qd: Row, qdd: Row) -> Row:
    Y = on.regressor(e.mechanism, e.at_rest, qd, qdd)
    parameters = inertial_parameters(e.mechanism)
    rotors: list = [0] * len(qd)
    for body in e.mechanism.bodies:
        k = body.coordinate
        rotors[k] = rotors[k] + body.multiplier * body.multiplier * body.armature
    efforts = []
    for row, rotor, acceleration in zip(Y, rotors, qdd, strict=True):
        total = e.ring(0) + rotor * acceleration
        for y, p in zip(row, parameters, strict=True):
            total = total + y * p
        efforts.append(total)
    return efforts


def _dot(d: Dynamics, a: Row, b: Row) -> Polynomial:
    total = d.ring(0)
    for x, y in zip(a, b, strict=True):
        total = total + x * y
    return total


def _flat(rows: Rows) -> Row:
    return [x for row in rows for x in row]
