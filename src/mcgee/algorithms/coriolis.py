"""The Coriolis matrix that the Christoffel symbols define, its products, and the symbols.

Every point of a body at c, moving with p = u + w × c, adds to the force that its body's velocity
(w, u) exerts on another motion. Summed over a body (or over all bodies of a subtree) two
quantities say everything: l = ∫ p dm, the momentum, and K = ∫ p cᵀ dm. The 6 by 6 matrix B of the
source is then [[tr(K) 1 − K, 0], [−l×, 0]].

Source: Echeandia & Wensing 2021, algorithms 1 and 2, with B reduced to these twelve numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mcgee.algorithms.motion import angular_velocities, mixed, velocities
from mcgee.algorithms.rnea import efforts
from mcgee.algorithms.spatial import (
    ZERO,
    Force,
    Inertia,
    JointTransform,
    Matrix,
    Motion,
    Vector,
    Z,
    half,
    skew,
)
from mcgee.algorithms.tree import axes, inertias, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


@dataclass(frozen=True, slots=True)
class VelocityMatrix:
    """B = ½[(v×*) I + (I v)×̄* − I (v×)] for a body, or summed over a subtree."""

    K: Matrix
    l: Vector

    @classmethod
    def of(cls, body: Inertia, v: Motion) -> VelocityMatrix:
        momentum = v.u * body.m + v.w.cross(body.h)
        return cls(Matrix.outer(v.u, body.h) + skew(v.w) * body.second_moment(), momentum)

    def __add__(self, other: VelocityMatrix) -> VelocityMatrix:
        return VelocityMatrix(self.K + other.K, self.l + other.l)

    def __matmul__(self, v: Motion) -> Force:
        """B v."""
        return Force(v.w * self.K.trace() - self.K @ v.w, v.w.cross(self.l))

    def transposed(self, v: Motion) -> Force:
        """Bᵀ v: a couple."""
        return Force(v.w * self.K.trace() - self.K.T @ v.w + self.l.cross(v.u), ZERO)

    def seen_through(self, X: JointTransform) -> VelocityMatrix:
        """Xᵀ B X: the same points about the parent's origin."""
        K, l = self.K, self.l
        if X.prismatic:
            K = K + Matrix.outer(l, Vector(0, 0, X.d))
        K, l = X.up_matrix(K), X.up(l)
        return VelocityMatrix(K + Matrix.outer(l, X.r), l)


def coriolis_matrix(
    mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar]
) -> list[list[Scalar]]:
    """C(q, qd), C_ij = Σ_k c_ijk qd_k."""
    X, S, I = transforms(mechanism, q), axes(mechanism), inertias(mechanism)
    v = velocities(mechanism, X, qd)
    Sd = [v_i.cross(S_i) for v_i, S_i in zip(v, S, strict=True)]
    B = [VelocityMatrix.of(I_i, v_i) for I_i, v_i in zip(I, v, strict=True)]
    n = len(v)
    C: list[list[Scalar]] = [[0] * n for _ in range(n)]
    for j, body in reversed(list(enumerate(mechanism.bodies))):
        F1, F2, F3 = I[j] @ Sd[j] + B[j] @ S[j], I[j] @ S[j], B[j].transposed(S[j])
        C[j][j] = S[j].dot(F1)
        i = j
        while mechanism.bodies[i].parent >= 0:
            F1, F2, F3 = (X[i].force(F) for F in (F1, F2, F3))
            i = mechanism.bodies[i].parent
            C[i][j] = S[i].dot(F1)
            C[j][i] = Sd[i].dot(F2) + S[i].dot(F3)
        if body.parent >= 0:
            I[body.parent] = I[body.parent] + X[j].inertia(I[j])
            B[body.parent] = B[body.parent] + B[j].seen_through(X[j])
    return C


def coriolis_product(
    mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar], v: Sequence[Scalar]
) -> list[Scalar]:
    """C(q, qd) v in O(n).

    The symbols are symmetric, so this is the symmetric bilinear form whose square is C(q, qd) qd:
    the Newton-Euler recursion, each product of two velocities made one of qd and v, both ways.
    """
    X = transforms(mechanism, q)
    own, other = angular_velocities(mechanism, X, qd), angular_velocities(mechanism, X, v)
    ww = [mixed(a, b) for a, b in zip(own, other, strict=True)]
    drag = [
        a.cross(Z * v_i) + b.cross(Z * qd_i)
        for a, b, qd_i, v_i in zip(own, other, qd, v, strict=True)
    ]
    weightless = replace(mechanism, gravity=(0, 0, 0))
    return [half(tau) for tau in efforts(weightless, X, ww, drag, [0] * len(X))]


def christoffel(mechanism: Mechanism, q: Sequence[Scalar]) -> list[list[list[Scalar]]]:
    """c_ijk = ½(∂M_ij/∂q_k + ∂M_ik/∂q_j − ∂M_jk/∂q_i), symmetric in j and k.

    A subtree moves as one rigid body under each joint that carries it, so that its composite
    inertia stands in for all its bodies.
    """
    X, S, Ic = transforms(mechanism, q), axes(mechanism), inertias(mechanism)
    n, parent = len(X), [body.parent for body in mechanism.bodies]
    c: list[list[list[Scalar]]] = [[[0] * n for _ in range(n)] for _ in range(n)]
    for m in reversed(range(n)):
        if parent[m] >= 0:
            Ic[parent[m]] = Ic[parent[m]] + X[m].inertia(Ic[m])
    carried: list[dict[int, Motion]] = []  # carried[j][k]: S of ancestor k in j's frame
    for j in range(n):
        above = carried[parent[j]] if parent[j] >= 0 else {}
        carried.append({k: X[j].motion(s) for k, s in above.items()} | {j: S[j]})
    for m in range(n):
        momentum = Ic[m] @ S[m]
        for k, S_k in carried[m].items():
            B = VelocityMatrix.of(Ic[m], S_k)
            F1 = Ic[m] @ S_k.cross(S[m]) + B @ S[m]
            F3 = B.transposed(S[m])
            for i, S_i in carried[m].items():
                c[i][m][k] = c[i][k][m] = S_i.dot(F1)
                if k <= i < m:
                    c[m][i][k] = c[m][k][i] = S_k.cross(S_i).dot(momentum) + S_i.dot(F3)
    return c
