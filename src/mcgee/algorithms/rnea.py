"""The recursive Newton-Euler algorithm: joint efforts from accelerations.

In classical accelerations, as first published, rather than spatial ones: no linear velocity is
ever needed, and a quarter of the operations falls away.
"""

from collections.abc import Sequence

from mcgee.algorithms.motion import angular_velocities, square, turning
from mcgee.algorithms.spatial import (
    ZERO,
    Force,
    Inertia,
    JointTransform,
    Matrix,
    Symmetric,
    Vector,
    Z,
)
from mcgee.algorithms.tree import axes, inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def rnea(
    mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar], qdd: Sequence[Scalar]
) -> list[Scalar]:
    """tau = M qdd + C qd + g.

    Source: Luh, Walker & Paul 1980; Khalil & Kleinfinger 1987 for U.
    """
    X = transforms(mechanism, q)
    w = angular_velocities(mechanism, X, qd)
    drag = [w_i.cross(Z * qd_i) for w_i, qd_i in zip(w, qd, strict=True)]
    return efforts(mechanism, X, [square(w_i) for w_i in w], drag, qdd)


def efforts(
    mechanism: Mechanism,
    X: Sequence[JointTransform],
    ww: Sequence[Symmetric],
    drag: Sequence[Vector],
    qdd: Sequence[Scalar],
) -> list[Scalar]:
    """The recursion, linear in w wᵀ of each body, in w × z qd of each joint, and in qdd."""
    dw: list[Vector] = []
    a: list[Vector] = []  # of the bodies' origins, gravity counted as an acceleration of the base
    U: list[Matrix] = []
    f: list[Force] = []
    for i, (body, I) in enumerate(zip(mechanism.bodies, inertias(mechanism), strict=True)):
        if body.parent >= 0:
            p = body.parent
            dw_i, a_i = X[i].down(dw[p]), X[i].down(a[p] + U[p] @ X[i].r)
        else:
            dw_i, a_i = ZERO, X[i].down(-Vector(*mechanism.gravity))
        dw_i = dw_i if body.prismatic else dw_i + Z * qdd[i] + drag[i]
        U_i = turning(ww[i], dw_i)
        if body.prismatic:
            a_i = a_i + U_i @ (Z * X[i].d) + drag[i] * 2 + Z * qdd[i]
        dw.append(dw_i)
        a.append(a_i)
        U.append(U_i)
        f.append(Force(_moment(I, ww[i], dw_i, U_i) + I.h.cross(a_i), a_i * I.m + U_i @ I.h))
    return backward(mechanism, X, f, qdd)


def _moment(body: Inertia, ww: Symmetric, dw: Vector, U: Matrix) -> Vector:
    """I dw + w × I w, from entries that U already holds."""
    I = body.I
    return Vector(
        I.xx * dw.x + (I.zz - I.yy) * ww.yz + I.yz * (ww.yy - ww.zz) - I.xy * U.z.x + I.xz * U.y.x,
        I.yy * dw.y + (I.xx - I.zz) * ww.xz + I.xz * (ww.zz - ww.xx) - I.yz * U.x.y + I.xy * U.z.y,
        I.zz * dw.z + (I.yy - I.xx) * ww.xy + I.xy * (ww.xx - ww.yy) - I.xz * U.y.z + I.yz * U.x.z,
    )


def backward(
    mechanism: Mechanism, X: Sequence[JointTransform], f: list[Force], qdd: Sequence[Scalar]
) -> list[Scalar]:
    """Sum the forces of each body's subtree and project them on its joint."""
    S = axes(mechanism)
    tau: list[Scalar] = [0] * len(f)
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        tau[i] = S[i].dot(f[i]) + body.armature * qdd[i]
        if body.parent >= 0:
            f[body.parent] = f[body.parent] + X[i].force(f[i])
    return tau
