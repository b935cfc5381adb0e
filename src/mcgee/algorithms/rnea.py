"""The recursive Newton-Euler algorithm: joint efforts from accelerations."""

from collections.abc import Sequence

from mcgee.algorithms.motion import accelerations, velocities
from mcgee.algorithms.spatial import ZERO, Force, JointTransform, Motion, Vector
from mcgee.algorithms.tree import axes, inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def rnea(
    mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar], qdd: Sequence[Scalar]
) -> list[Scalar]:
    """tau = M qdd + C qd + g.

    Source: Luh, Walker & Paul 1980; Featherstone 2008, table 5.1.
    """
    X, I = transforms(mechanism, q), inertias(mechanism)
    v = velocities(mechanism, X, qd)
    a = accelerations(mechanism, X, v, qd, qdd, Motion(ZERO, -Vector(*mechanism.gravity)))
    f = [I_i @ a_i + v_i.cross_force(I_i @ v_i) for I_i, v_i, a_i in zip(I, v, a, strict=True)]
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
