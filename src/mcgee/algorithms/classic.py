"""Inverse dynamics as it was formulated before few operations were wanted, and around that time.

Five formulations that Hollerbach compared, each from matrices of its own: slow on purpose, they are
what our counts are measured against, and oracles that share nothing with `rnea`. They know links
alone: what rotors add, armature·qdd, is the caller's.

Source: Hollerbach 1980, "A recursive Lagrangian formulation of manipulator dynamics and a
comparative study of dynamics formulation complexity", IEEE Transactions on Systems, Man, and
Cybernetics 10.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar, cos_sin

Rows = list[list[Scalar]]


@dataclass(frozen=True)
class Chain:
    """A serial arm of revolute joints at some q: what every formulation takes as given."""

    A: list[Rows]
    """Of each joint, the pose of its body in the one before, 4 by 4."""
    dA: list[Rows]
    ddA: list[Rows]
    """Its derivatives by the joint's angle."""
    J: list[Rows]
    """∫ r rᵀ dm over each body, r = (x, y, z, 1) in its own frame."""
    mass: list[Scalar]
    com: list[list[Scalar]]
    I: list[Rows]
    """About the centre of mass."""
    gravity: list[Scalar]

    @classmethod
    def at(cls, mechanism: Mechanism, q: Sequence[Scalar]) -> Chain:
        """Raises: ValueError: joints that slide, follow others or branch"""
        bodies = mechanism.bodies
        if mechanism.coupled or any(b.prismatic or b.parent != i - 1 for i, b in enumerate(bodies)):
            raise ValueError(
                "the classic formulations are for chains of revolute joints: this mechanism "
                "branches, slides or has joints that follow others."
            )
        A: list[Rows] = []
        dA: list[Rows] = []
        ddA: list[Rows] = []
        for body, q_i in zip(bodies, q, strict=True):
            c, s = cos_sin(body.position(q_i))
            turns = ((c, -s, 1), (-s, -c, 0), (-c, s, 0))
            for matrices, (x, y, z) in zip((A, dA, ddA), turns, strict=True):
                R, r = body.pose.rotation, body.pose.translation
                rows = [[a * x - b * y, a * y + b * x, d * z] for a, b, d in R]
                matrices.append(
                    [[*row, r_i * z] for row, r_i in zip(rows, r, strict=True)] + [[0, 0, 0, z]]
                )
        parts = [_mass_distribution(b.mass, b.first_moment, b.inertia) for b in bodies]
        J, com, I = ([part[k] for part in parts] for k in range(3))
        return cls(A, dA, ddA, J, [b.mass for b in bodies], com, I, list(mechanism.gravity))

    def map(self, convert: Callable[[Scalar], Scalar]) -> Chain:
        def converted(x: Any) -> Any:
            return [converted(y) for y in x] if isinstance(x, list) else convert(x)

        return Chain(*(converted(getattr(self, name)) for name in self.__dataclass_fields__))


def _mass_distribution(
    m: Scalar, h: Sequence[Scalar], inertia: Sequence[Scalar]
) -> tuple[Rows, list[Scalar], Rows]:
    """(J, centre of mass, I about it) from mass, first moment and I about the origin."""
    xx, xy, xz, yy, yz, zz = inertia
    half = (xx + yy + zz) / 2
    J = [[half - xx, -xy, -xz, h[0]], [-xy, half - yy, -yz, h[1]], [-xz, -yz, half - zz, h[2]]]
    com = [x / m for x in h] if m != 0 else [x * 0 for x in h]
    dot = sum(c * x for c, x in zip(com, h, strict=True))
    about = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    I = [
        [about[i][j] - ((dot if i == j else 0) - com[i] * h[j]) for j in range(3)] for i in range(3)
    ]
    return [*J, [*h, m]], com, I


# -- matrices of any size, nothing simplified -----------------------------------------------------


def _dot(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    total = a[0] * b[0]
    for x, y in zip(a[1:], b[1:], strict=True):
        total = total + x * y
    return total


def _product(a: Rows, b: Rows) -> Rows:
    columns = _transposed(b)
    return [[_dot(row, column) for column in columns] for row in a]


def _transposed(a: Rows) -> Rows:
    return [list(row) for row in zip(*a, strict=True)]


def _times(a: Rows, v: Sequence[Scalar]) -> list[Scalar]:
    return [_dot(row, v) for row in a]


def _sum(a: Any, b: Any) -> Any:
    return [_sum(x, y) for x, y in zip(a, b, strict=True)] if isinstance(a, list) else a + b


def _scaled(a: Any, k: Scalar) -> Any:
    return [_scaled(x, k) for x in a] if isinstance(a, list) else a * k


def _trace_of_product(a: Rows, b: Rows) -> Scalar:
    """tr(a b)."""
    pairs = zip(a, _transposed(b), strict=True)
    first, *rest = (_dot(row, column) for row, column in pairs)
    for diagonal in rest:
        first = first + diagonal
    return first


def _cross(a: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


# -- the formulations -----------------------------------------------------------------------------


def uicker_kahn(arm: Chain, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[Scalar]:
    """Lagrange's equations in 4 by 4 matrices, as they stand: O(n⁴). Uicker 1965, Kahn 1969."""
    n = len(arm.A)

    @cache
    def W(j: int, *by: int) -> Rows:
        """The derivative of body j's pose by the angles of some joints, in ascending order."""
        factor = (arm.A, arm.dA, arm.ddA)[by.count(j)][j]
        return _product(W(j - 1, *(i for i in by if i < j)), factor) if j else factor

    tau = []
    for i in range(n):
        total: Scalar = 0
        for j in range(i, n):
            W_i = W(j, i)
            P = _product(W_i, arm.J[j])
            for k in range(j + 1):
                total = total + _trace_of_product(P, _transposed(W(j, k))) * qdd[k]
                for l in range(j + 1):
                    rate = qd[k] * qd[l]
                    total = total + _trace_of_product(P, _transposed(W(j, *sorted((k, l))))) * rate
            total = total - _dot(arm.gravity, _times(W_i[:3], arm.J[j][3]))
        tau.append(total)
    return tau


def _poses(
    arm: Chain, qd: Sequence[Scalar], qdd: Sequence[Scalar]
) -> tuple[list[Rows], list[Rows]]:
    """W, the poses of the bodies, and their second time derivatives."""
    W, Wd, Wdd = [arm.A[0]], [_scaled(arm.dA[0], qd[0])], []
    rate = _sum(_scaled(arm.ddA[0], qd[0] * qd[0]), _scaled(arm.dA[0], qdd[0]))
    Wdd.append(rate)
    for i in range(1, len(arm.A)):
        rate = _sum(_scaled(arm.ddA[i], qd[i] * qd[i]), _scaled(arm.dA[i], qdd[i]))
        turn = _scaled(_product(Wd[-1], arm.dA[i]), qd[i])
        Wdd.append(_sum(_sum(_product(Wdd[-1], arm.A[i]), _scaled(turn, 2)), _product(W[-1], rate)))
        Wd.append(_sum(_product(Wd[-1], arm.A[i]), _scaled(_product(W[-1], arm.dA[i]), qd[i])))
        W.append(_product(W[-1], arm.A[i]))
    return W, Wdd


def waters(arm: Chain, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[Scalar]:
    """Accelerations of the poses by recursion, O(n²). Waters 1979."""
    W, Wdd = _poses(arm, qd, qdd)
    tau = []
    for i in range(len(W)):
        slope = _product(W[i - 1], arm.dA[i]) if i else arm.dA[i]
        total: Scalar = 0
        for j in range(i, len(W)):
            slope = _product(slope, arm.A[j]) if j > i else slope
            force = _product(arm.J[j], _transposed(Wdd[j]))
            total = total + _trace_of_product(slope, force)
            total = total - _dot(arm.gravity, _times(slope[:3], arm.J[j][3]))
        tau.append(total)
    return tau


def hollerbach_4x4(arm: Chain, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[Scalar]:
    """Forces by recursion too, O(n). Hollerbach 1980."""
    W, Wdd = _poses(arm, qd, qdd)
    tau: list[Scalar] = [0] * len(W)
    D: Rows = []
    c: list[Scalar] = []
    for i in reversed(range(len(W))):
        own, moment = _product(arm.J[i], _transposed(Wdd[i])), arm.J[i][3]
        D = _sum(own, _product(arm.A[i + 1], D)) if D else own
        c = _sum(moment, _times(arm.A[i + 1], c)) if c else moment
        slope = _product(W[i - 1], arm.dA[i]) if i else arm.dA[i]
        tau[i] = _trace_of_product(slope, D) - _dot(arm.gravity, _times(slope[:3], c))
    return tau


def hollerbach_3x3(arm: Chain, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[Scalar]:
    """The same with rotations and origins apart, O(n). Hollerbach 1980."""

    def blocks(matrices: list[Rows]) -> list[Rows]:
        return [[row[:3] for row in rows[:3]] for rows in matrices]

    A, dA, ddA, J = (blocks(m) for m in (arm.A, arm.dA, arm.ddA, arm.J))
    offset = [[row[3] for row in rows[:3]] for rows in arm.A]
    W, Wdd = _poses(Chain(A, dA, ddA, J, arm.mass, arm.com, arm.I, arm.gravity), qd, qdd)
    n, origin = len(W), [[x * 0 for x in offset[0]]]  # accelerations of the origins
    for i in range(1, n):
        origin.append(_sum(origin[-1], _times(Wdd[i - 1], offset[i])))
    tau: list[Scalar] = [0] * n
    D, e, c, m = _products_of_body(arm, J[-1], Wdd[-1], origin[-1], n - 1)
    for i in reversed(range(n)):
        if i + 1 < n:
            r, up = offset[i + 1], A[i + 1]
            D_i, e_i, c_i, m_i = _products_of_body(arm, J[i], Wdd[i], origin[i], i)
            D = _sum(D_i, _sum(_product(up, D), [[x * y for y in e] for x in r]))
            c = _sum(c_i, _sum(_times(up, c), _scaled(r, m)))
            e, m = _sum(e_i, e), m_i + m
        slope = _product(W[i - 1], dA[i]) if i else dA[i]
        tau[i] = _trace_of_product(slope, D) - _dot(arm.gravity, _times(slope, c))
    return tau


def _products_of_body(
    arm: Chain, J: Rows, Wdd: Rows, origin: list[Scalar], i: int
) -> tuple[Rows, list[Scalar], list[Scalar], Scalar]:
    """∫ r aᵀ dm, ∫ a dm, ∫ r dm, ∫ dm over one body, a the acceleration of its point r."""
    h, m = arm.J[i][3][:3], arm.mass[i]
    D = _sum(_product(J, _transposed(Wdd)), [[x * a for a in origin] for x in h])
    return D, _sum(_scaled(origin, m), _times(Wdd, h)), h, m


def luh_walker_paul(arm: Chain, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[Scalar]:
    """Newton's and Euler's equations in link coordinates, O(n). Luh, Walker & Paul 1980."""
    n = len(arm.A)
    R = [[row[:3] for row in rows[:3]] for rows in arm.A]
    offset = [[row[3] for row in rows[:3]] for rows in arm.A]
    zero = [x * 0 for x in offset[0]]
    w, dw, a = zero, zero, _scaled(arm.gravity, -1)
    F, N = [], []
    for i in range(n):
        back = _transposed(R[i])
        a = _times(back, _sum(a, _sum(_cross(dw, offset[i]), _cross(w, _cross(w, offset[i])))))
        w, dw = _times(back, w), _times(back, dw)
        dw = [dw[0] + w[1] * qd[i], dw[1] - w[0] * qd[i], dw[2] + qdd[i]]
        w = [w[0], w[1], w[2] + qd[i]]
        at_com = _sum(_sum(_cross(dw, arm.com[i]), _cross(w, _cross(w, arm.com[i]))), a)
        F.append(_scaled(at_com, arm.mass[i]))
        N.append(_sum(_times(arm.I[i], dw), _cross(w, _times(arm.I[i], w))))
    tau: list[Scalar] = [0] * n
    f: list[Scalar] = []
    m: list[Scalar] = []
    for i in reversed(range(n)):
        moment, force = _sum(N[i], _cross(arm.com[i], F[i])), F[i]
        if f:
            above = _times(R[i + 1], f)
            moment = _sum(moment, _sum(_times(R[i + 1], m), _cross(offset[i + 1], above)))
            force = _sum(force, above)
        f, m = force, moment
        tau[i] = m[2]
    return tau


FORMULATIONS: dict[str, Callable[..., list[Scalar]]] = {
    "Uicker & Kahn": uicker_kahn,
    "Waters": waters,
    "Hollerbach, 4 by 4": hollerbach_4x4,
    "Hollerbach, 3 by 3": hollerbach_3x3,
    "Luh, Walker & Paul": luh_walker_paul,
}


# -- counting -------------------------------------------------------------------------------------

PUBLISHED = {
    "Uicker & Kahn": (66_271, 51_548),
    "Waters": (7_051, 5_652),
    "Hollerbach, 4 by 4": (4_388, 3_586),
    "Hollerbach, 3 by 3": (2_195, 1_719),
    "Luh, Walker & Paul": (852, 738),
}
"""Multiplications and additions for six joints, as Hollerbach 1980 counted them."""


class Counted:
    """A number that counts its multiplications and additions, those by zeros and ones too."""

    __slots__ = ("count", "value")

    def __init__(self, value: float, count: dict[str, int]):
        self.value, self.count = value, count

    def _made(self, what: str, value: float) -> Counted:
        self.count[what] += 1
        return Counted(value, self.count)

    def __add__(self, other: Any) -> Counted:
        return self._made("add", self.value + getattr(other, "value", other))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Counted:
        return self._made("add", self.value - getattr(other, "value", other))

    def __rsub__(self, other: Any) -> Counted:
        return self._made("add", other - self.value)

    def __mul__(self, other: Any) -> Counted:
        return self._made("mul", self.value * getattr(other, "value", other))

    __rmul__ = __mul__


def counted(name: str, mechanism: Mechanism) -> tuple[int, int]:
    """Multiplications and additions of a formulation as written here, nothing simplified.

    Entries of the joints' matrices and their derivatives are given. Products are of whole matrices,
    their zeros and ones counted. Fewer than published: the first joint's products with the fixed
    base are not made, and no derivative of a pose is computed twice, which for Uicker & Kahn is
    most of the difference.
    """
    count = {"mul": 0, "add": 0}
    n = len(mechanism.bodies)
    numbers = [0.1 * (i + 1) for i in range(n)]
    arm = Chain.at(mechanism, numbers).map(lambda x: Counted(float(x), count))
    rates = [Counted(x, count) for x in numbers]
    FORMULATIONS[name](arm, rates, rates)
    return count["mul"], count["add"]
