"""The articulated-body algorithm: accelerations from joint efforts."""

from collections.abc import Sequence

from mcgee.algorithms.rnea import rnea
from mcgee.algorithms.spatial import REST, ZERO, ArticulatedInertia, Force, Motion
from mcgee.algorithms.tree import axes, inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def aba(
    mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar], tau: Sequence[Scalar]
) -> list[Scalar]:
    """qdd = M⁻¹ (tau − C qd − g), in O(n).

    What velocities and gravity ask for is taken off the efforts first, by the Newton-Euler
    recursion, which leaves an arm at rest without weight: fewer operations than carrying both
    through the articulated inertias.

    Source: Featherstone 1983; Featherstone 2008, table 7.1, with v = 0. Armature adds to D.
    """
    X, S = transforms(mechanism, q), axes(mechanism)
    IA = [ArticulatedInertia.of(body) for body in inertias(mechanism)]
    bias = rnea(mechanism, q, qd, [0] * len(IA))
    u = [tau_i - bias_i for tau_i, bias_i in zip(tau, bias, strict=True)]
    pA, U = [Force(ZERO, ZERO)] * len(IA), [Force(ZERO, ZERO)] * len(IA)
    d_inverse: list[Scalar] = [0] * len(IA)
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        U[i] = IA[i] @ S[i]
        d_inverse[i] = 1 / (S[i].dot(U[i]) + body.armature)
        u[i] = u[i] - S[i].dot(pA[i])
        if body.parent >= 0:
            pa = pA[i] + U[i] * (d_inverse[i] * u[i])
            Ia = IA[i].without(U[i], d_inverse[i])
            IA[body.parent] = IA[body.parent] + X[i].articulated(Ia)
            pA[body.parent] = pA[body.parent] + X[i].force(pa)

    a: list[Motion] = []
    qdd: list[Scalar] = []
    for i, body in enumerate(mechanism.bodies):
        a_ = X[i].motion(a[body.parent]) if body.parent >= 0 else REST
        qdd.append(d_inverse[i] * (u[i] - a_.dot(U[i])))
        a.append(a_ + S[i] * qdd[i])
    return qdd
