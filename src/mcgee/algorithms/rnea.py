"""The recursive Newton-Euler algorithm: joint efforts from accelerations."""

from collections.abc import Sequence

from mcgee.algorithms.spatial import REST, ZERO, Force, JointTransform, Motion, Vector
from mcgee.algorithms.tree import axes, inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def rnea(
    mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar], qdd: Sequence[Scalar]
) -> list[Scalar]:
    """tau = M qdd + C qd + g.

    Source: Luh, Walker & Paul 1980; Featherstone 2008, table 5.1.
    """
    X, S, I = transforms(mechanism, q), axes(mechanism), inertias(mechanism)  # noqa: E741
    v: list[Motion] = []
    a: list[Motion] = []
    f: list[Force] = []
    still = Motion(ZERO, -Vector(*mechanism.gravity))
    for i, body in enumerate(mechanism.bodies):
        p = body.parent
        vJ = S[i] * qd[i]
        v.append(X[i].motion(v[p] if p >= 0 else REST) + vJ)
        a.append(X[i].motion(a[p] if p >= 0 else still) + S[i] * qdd[i] + v[i].cross(vJ))
        f.append(I[i] @ a[i] + v[i].cross_force(I[i] @ v[i]))
    return backward(mechanism, X, f, qdd)


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
