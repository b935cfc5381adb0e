"""The articulated-body algorithm: accelerations from joint efforts."""

from collections.abc import Sequence

from mcgee.algorithms.motion import velocities
from mcgee.algorithms.spatial import ZERO, ArticulatedInertia, Force, Motion, Vector
from mcgee.algorithms.tree import axes, inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def aba(
    mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar], tau: Sequence[Scalar]
) -> list[Scalar]:
    """qdd = M⁻¹ (tau − C qd − g), in O(n).

    Source: Featherstone 1983; Featherstone 2008, table 7.1. Armature adds to D.
    """
    X, S, I = transforms(mechanism, q), axes(mechanism), inertias(mechanism)
    v = velocities(mechanism, X, qd)
    c = [v_i.cross(S_i * qd_i) for v_i, S_i, qd_i in zip(v, S, qd, strict=True)]
    pA = [v_i.cross_force(I_i @ v_i) for v_i, I_i in zip(v, I, strict=True)]

    IA = [ArticulatedInertia.of(body) for body in I]
    n = len(IA)
    U, d_inverse, u = [Force(ZERO, ZERO)] * n, [0] * n, [0] * n
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        U[i] = IA[i] @ S[i]
        d_inverse[i] = 1 / (S[i].dot(U[i]) + body.armature)
        u[i] = tau[i] - S[i].dot(pA[i])
        if body.parent >= 0:
            Ia = IA[i].without(U[i], d_inverse[i])
            pa = pA[i] + Ia @ c[i] + U[i] * (d_inverse[i] * u[i])
            IA[body.parent] = IA[body.parent] + X[i].articulated(Ia)
            pA[body.parent] = pA[body.parent] + X[i].force(pa)

    a: list[Motion] = []
    qdd: list[Scalar] = []
    still = Motion(ZERO, -Vector(*mechanism.gravity))
    for i, body in enumerate(mechanism.bodies):
        a_ = X[i].motion(a[body.parent] if body.parent >= 0 else still) + c[i]
        qdd.append(d_inverse[i] * (u[i] - a_.dot(U[i])))
        a.append(a_ + S[i] * qdd[i])
    return qdd
