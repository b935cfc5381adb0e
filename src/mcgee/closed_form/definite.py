"""Whether M is positive definite: from the definition of T as a sum of squares, or by samples."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from sympy import Symbol

from mcgee.closed_form.dynamics import Dynamics
from mcgee.closed_form.evaluate import evaluate, values_of
from mcgee.closed_form.exact import ExactRobot
from mcgee.closed_form.proof import Definiteness
from mcgee.closed_form.ring import Polynomial
from mcgee.mechanism import Body, Mass, Mechanism
from mcgee.scalar import Scalar

SAMPLES = 200
SINGULAR = 1e-12
"""Of the largest eigenvalue, what the smallest must exceed in a sample."""


def definiteness(e: ExactRobot, d: Dynamics) -> Definiteness:
    """T is Σ ½ m |v|² + ½ ωᵀ I ω + ½ armature qd². No link can make it negative, and if it is zero
    then each joint in turn from the root stands still, because what moves with it alone has inertia
    about or along its axis."""
    if not e.inertial:
        refused = _refused(e.still)
        if refused is None:
            return Definiteness(
                "proved",
                "no square of T is negative, and every joint moves something: "
                f"{len(e.still.masses)} links, {len(e.still.bodies)} joints.",
            )
    else:
        refused = "the symbolic inertial parameters are not known to be a body's"
    if any(s not in e.constants for s in _parameters(e)):
        return Definiteness("undecided", f"{refused}. Declare symbols positive=True, or .subs.")
    return _sampled(e, d, refused)


def _parameters(e: ExactRobot) -> set[Symbol]:
    ring = e.ring
    everything = {*ring.symbols, *(s for angle in ring.angles.forms for s, _ in angle)}
    return everything - {*e.q, *e.qd, *e.qdd}


def _refused(m: Mechanism) -> str | None:
    """Why the sum of squares decides nothing, or None where it does."""
    for mass in m.masses:
        if _sign(mass.inertia.mass) is None:
            return f"the mass of '{mass.link}' is not known to be zero or more"
        if not _semidefinite(mass):
            return f"the inertia of '{mass.link}' is not known to have no negative moment"
    for i, body in enumerate(m.bodies):
        if _sign(body.armature) is None:
            return f"the armature of '{body.name}' is not known to be zero or more"
        if not any(x is not None and x > 0 for x in _own(m, i, body)):
            return f"'{body.name}' alone is not known to move any inertia"
    return None


def _own(m: Mechanism, i: int, body: Body) -> list[int | None]:
    """Signs of what makes up the body's inertia along or about its joint's axis."""
    signs = [_sign(body.armature)]
    for mass in m.masses:
        if mass.body != i:
            continue
        x, y, _ = mass.inertia.com
        if body.prismatic:
            signs.append(_sign(mass.inertia.mass))
        else:
            signs.append(_sign(mass.inertia.about_com[5]))
            signs.append(_sign(mass.inertia.mass * (x * x + y * y)))
    return signs


def _semidefinite(mass: Mass) -> bool:
    """All principal minors are zero or more."""
    I = mass.inertia.matrix
    if any(_sign(I[k][k]) is None for k in range(3)):
        return False
    minors = [I[a][a] * I[b][b] - I[a][b] * I[b][a] for a, b in combinations(range(3), 2)]
    (a, b, c), (_, d, e), (_, _, f) = I
    minors.append(a * (d * f - e * e) - b * (b * f - e * c) + c * (b * e - d * c))
    return all(_sign(x) is not None for x in minors)


def _sign(x: Scalar) -> int | None:
    """1 where it is known to be positive, 0 where not negative, None where neither is known."""
    if not isinstance(x, Polynomial):
        return None if x < 0 else int(x > 0)
    ring, positive = x.ring, 0
    if not x:
        return 0
    for exponents, coefficient in x.terms():
        sure = True
        for i, e in enumerate(exponents):
            if not e or i >= ring.first_root:
                continue
            if i < ring.first_symbol:
                return None
            inverse = i >= ring.first_inverse
            s = (
                ring.inverses[i - ring.first_inverse]
                if inverse
                else ring.symbols[i - ring.first_symbol]
            )
            if e % 2 and not s.is_nonnegative:
                return None
            sure = sure and bool(s.is_positive or (e % 2 == 0 and s.is_nonzero))
        if coefficient < 0:
            return None
        positive += sure
    return int(positive > 0)


def _sampled(e: ExactRobot, d: Dynamics, refused: str | None) -> Definiteness:
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (SAMPLES, d.n))
    table = dict(e.constants) | {s: q[:, k] for k, s in enumerate(d.q)}
    table |= {s: np.zeros(SAMPLES) for s in (*d.qd, *d.qdd)}
    generators = values_of(d.ring, table)
    M = np.empty((SAMPLES, d.n, d.n))
    for i in range(d.n):
        for j in range(d.n):
            M[:, i, j] = evaluate(d.M[i][j], generators)
    moments = np.linalg.eigvalsh(M)
    least = float(moments[:, 0].min())
    holds = bool((moments[:, 0] > SINGULAR * moments[:, -1]).all())
    return Definiteness(
        "sampled" if holds else "false",
        f"{refused}; of {SAMPLES} random configurations the smallest eigenvalue is {least:.3g}.",
    )
