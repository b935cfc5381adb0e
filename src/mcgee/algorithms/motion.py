"""How bodies move: velocities and accelerations, out from the root."""

from collections.abc import Sequence

from mcgee.algorithms.spatial import REST, JointTransform, Motion, Vector
from mcgee.algorithms.tree import axes
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def velocities(
    mechanism: Mechanism, X: Sequence[JointTransform], qd: Sequence[Scalar]
) -> list[Motion]:
    """The velocity of each body, in its own frame."""
    v: list[Motion] = []
    for i, (body, S_i) in enumerate(zip(mechanism.bodies, axes(mechanism), strict=True)):
        v.append(X[i].motion(v[body.parent] if body.parent >= 0 else REST) + S_i * qd[i])
    return v


def accelerations(
    mechanism: Mechanism,
    X: Sequence[JointTransform],
    v: Sequence[Motion],
    qd: Sequence[Scalar],
    qdd: Sequence[Scalar],
    base: Motion = REST,
) -> list[Motion]:
    """The spatial acceleration of each body, in its own frame, with the base accelerating."""
    S = axes(mechanism)
    a: list[Motion] = []
    for i, body in enumerate(mechanism.bodies):
        above = a[body.parent] if body.parent >= 0 else base
        a.append(X[i].motion(above) + S[i] * qdd[i] + v[i].cross(S[i] * qd[i]))
    return a


def acceleration_at(v: Motion, a: Motion, point: Vector) -> Vector:
    """The acceleration of a point fixed to a body, as an observer at rest would measure it."""
    return a.u + a.w.cross(point) + v.w.cross(v.u + v.w.cross(point))
