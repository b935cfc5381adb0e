"""The composite-rigid-body algorithm: the inertia matrix."""

from collections.abc import Sequence

from mcgee.algorithms.tree import axes, inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def crba(mechanism: Mechanism, q: Sequence[Scalar]) -> list[list[Scalar]]:
    """M(q).

    Source: Walker & Orin 1982; Featherstone 2008, table 6.2.
    """
    X, S, Ic = transforms(mechanism, q), axes(mechanism), inertias(mechanism)
    n = len(mechanism.bodies)
    M: list[list[Scalar]] = [[0] * n for _ in range(n)]
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        if body.parent >= 0:
            Ic[body.parent] = Ic[body.parent] + X[i].inertia(Ic[i])
        F = Ic[i] @ S[i]
        M[i][i] = S[i].dot(F) + body.armature
        j = i
        while mechanism.bodies[j].parent >= 0:
            F, j = X[j].force(F), mechanism.bodies[j].parent
            M[i][j] = M[j][i] = S[j].dot(F)
    return M
