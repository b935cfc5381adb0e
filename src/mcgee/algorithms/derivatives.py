"""How inverse dynamics changes with positions and velocities, from composites of subtrees.

Moving joint i moves its whole subtree as one rigid body. What that changes at i, below or above
takes no more of the subtree than its inertia I, its velocity matrix B and its force f. Forces on
the subtree go towards the root once, and meet the motions of the joints on the way.

Source: Singh, Russell & Wensing 2022, with B as `VelocityMatrix`. In body frames, and for joints
of one degree of freedom, their Ψ̇ and Ṡ are both v × S, and Ψ̈ is a × S + v × (v × S).
"""

from collections.abc import Sequence

from mcgee.algorithms.coriolis import VelocityMatrix
from mcgee.algorithms.motion import accelerations, velocities
from mcgee.algorithms.spatial import ZERO, Force, Motion, Vector
from mcgee.algorithms.tree import axes, inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar

Rows = list[list[Scalar]]


class Linearization:
    """∂tau/∂qdd = M and ∂tau/∂qd = 2 C at q, qd, and ∂tau/∂q once qdd is known."""

    M: Rows
    dtau_dqd: Rows

    def __init__(self, mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar]):
        self.mechanism, self.qd = mechanism, qd
        X, S, I = transforms(mechanism, q), axes(mechanism), inertias(mechanism)
        v = velocities(mechanism, X, qd)
        B = [VelocityMatrix.of(I_i, v_i) for I_i, v_i in zip(I, v, strict=True)]
        self.X, self.S, self.v, self.own = X, S, v, list(zip(I, B, strict=True))
        for i, body in reversed(list(enumerate(mechanism.bodies))):
            if body.parent >= 0:
                I[body.parent] = I[body.parent] + X[i].inertia(I[i])
                B[body.parent] = B[body.parent] + B[i].seen_through(X[i])
        self.I, self.B, self.Sd = I, B, [v_i.cross(S_i) for v_i, S_i in zip(v, S, strict=True)]
        # I S and 2 Bᵀ S of each joint's subtree, seen from the joint and from all above it
        self.IS = [self._upwards(i, I[i] @ S[i]) for i in range(len(I))]
        self.BS = [self._upwards(i, B[i].transposed(S[i] * 2)) for i in range(len(I))]
        self.M, self.dtau_dqd = self._square(), self._square()
        for i, body in enumerate(mechanism.bodies):
            F = self._upwards(i, I[i] @ (self.Sd[i] * 2) + B[i] @ (S[i] * 2))
            for j, F_j in F.items():
                IS, BS = self.IS[i][j], self.BS[i][j]
                self.M[i][j] = self.M[j][i] = S[j].dot(IS)
                self.dtau_dqd[i][j] = (self.Sd[j] * 2).dot(IS) + S[j].dot(BS)
                self.dtau_dqd[j][i] = S[j].dot(F_j)
            self.M[i][i] = self.M[i][i] + body.armature

    def dtau_dq(self, qdd: Sequence[Scalar]) -> Rows:
        X, S, v, Sd, field = self.X, self.S, self.v, self.Sd, Vector(*self.mechanism.gravity)
        a = accelerations(self.mechanism, X, v, self.qd, qdd, Motion(ZERO, -field))
        Sdd = [
            a_i.cross(S_i) + v_i.cross(Sd_i)
            for a_i, S_i, v_i, Sd_i in zip(a, S, v, Sd, strict=True)
        ]
        f = [I_i @ a_i + B_i @ v_i for (I_i, B_i), a_i, v_i in zip(self.own, a, v, strict=True)]
        rows = self._square()
        for i, body in reversed(list(enumerate(self.mechanism.bodies))):
            F = self.B[i] @ (Sd[i] * 2) + self.I[i] @ Sdd[i] + S[i].cross_force(f[i])
            for j, F_j in self._upwards(i, F).items():
                rows[j][i] = S[j].dot(F_j)
                rows[i][j] = Sd[j].dot(self.BS[i][j]) + Sdd[j].dot(self.IS[i][j])
            if body.parent >= 0:
                f[body.parent] = f[body.parent] + X[i].force(f[i])
        return rows

    def _upwards(self, i: int, F: Force) -> dict[int, Force]:
        """A force on body i, seen from i and from every body that carries it."""
        seen = {i: F}
        while self.mechanism.bodies[i].parent >= 0:
            F, i = self.X[i].force(F), self.mechanism.bodies[i].parent
            seen[i] = F
        return seen

    def _square(self) -> Rows:
        n = len(self.mechanism.bodies)
        return [[0] * n for _ in range(n)]
