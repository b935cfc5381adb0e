"""How bodies move: velocities and accelerations, out from the root."""

from collections.abc import Sequence

from mcgee.algorithms.spatial import (
    REST,
    ZERO,
    JointTransform,
    Matrix,
    Motion,
    Symmetric,
    Vector,
    Z,
)
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


def angular_velocities(
    mechanism: Mechanism, X: Sequence[JointTransform], qd: Sequence[Scalar]
) -> list[Vector]:
    """The angular velocity of each body, in its own frame."""
    w: list[Vector] = []
    for i, body in enumerate(mechanism.bodies):
        carried = X[i].down(w[body.parent]) if body.parent >= 0 else ZERO
        w.append(carried if body.prismatic else carried + Z * qd[i])
    return w


def square(w: Vector) -> Symmetric:
    """w wᵀ."""
    return Symmetric(w.x * w.x, w.x * w.y, w.x * w.z, w.y * w.y, w.y * w.z, w.z * w.z)


def mixed(a: Vector, b: Vector) -> Symmetric:
    """a bᵀ + b aᵀ."""
    xx, yy, zz = a.x * b.x, a.y * b.y, a.z * b.z
    xy, xz, yz = a.x * b.y + a.y * b.x, a.x * b.z + a.z * b.x, a.y * b.z + a.z * b.y
    return Symmetric(xx * 2, xy, xz, yy * 2, yz, zz * 2)


def turning(ww: Symmetric, dw: Vector) -> Matrix:
    """U = dw× + w× w×: the point at c accelerates by U c more than the origin does."""
    return Matrix(
        Vector(-(ww.yy + ww.zz), ww.xy - dw.z, ww.xz + dw.y),
        Vector(ww.xy + dw.z, -(ww.xx + ww.zz), ww.yz - dw.x),
        Vector(ww.xz - dw.y, ww.yz + dw.x, -(ww.xx + ww.yy)),
    )
