"""Kinetic and potential energy."""

from collections.abc import Sequence

from mcgee.algorithms.motion import velocities
from mcgee.algorithms.spatial import Vector
from mcgee.algorithms.tree import inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def kinetic_energy(mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar]) -> Scalar:
    """T = ½ Σ vᵢᵀ Iᵢ vᵢ + ½ Σ armatureᵢ qdᵢ²."""
    v, I = velocities(mechanism, transforms(mechanism, q), qd), inertias(mechanism)
    twice: Scalar = 0
    for i, body in enumerate(mechanism.bodies):
        twice = twice + v[i].dot(I[i] @ v[i]) + body.armature * (qd[i] * qd[i])
    return twice / 2


def potential_energy(mechanism: Mechanism, q: Sequence[Scalar]) -> Scalar:
    """P = −Σ mᵢ (gravity · CoMᵢ) over the moving bodies; zero at the height of the root frame."""
    X = transforms(mechanism, q)
    m = [body.mass for body in mechanism.bodies]
    h = [Vector(*body.first_moment) for body in mechanism.bodies]
    energy: Scalar = 0
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        moment = X[i].first_moment(m[i], h[i])
        if body.parent >= 0:
            h[body.parent] = h[body.parent] + moment
            m[body.parent] = m[body.parent] + m[i]
        else:
            energy = energy - moment.dot(Vector(*mechanism.gravity))
    return energy
