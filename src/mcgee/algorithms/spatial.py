"""Spatial vectors over any scalar, in Featherstone's notation (2008, chapter 2).

A motion is (w, u): angular velocity and velocity of the point at the origin. A force is (n, f):
moment about the origin and force. Structural zeros are the integer 0, so that exact scalars stay
exact and graph nodes fold.
"""

from __future__ import annotations

from dataclasses import dataclass

from mcgee.model import Pose
from mcgee.scalar import Scalar, cos_sin


@dataclass(frozen=True, slots=True)
class Vector:
    x: Scalar
    y: Scalar
    z: Scalar

    def __iter__(self):
        return iter((self.x, self.y, self.z))

    def __add__(self, other: Vector) -> Vector:
        return Vector(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: Vector) -> Vector:
        return Vector(self.x - other.x, self.y - other.y, self.z - other.z)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y, -self.z)

    def __mul__(self, k: Scalar) -> Vector:
        return Vector(self.x * k, self.y * k, self.z * k)

    def dot(self, other: Vector) -> Scalar:
        return self.x * other.x + self.y * other.y + self.z * other.z

    def cross(self, other: Vector) -> Vector:
        return Vector(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )


ZERO = Vector(0, 0, 0)
Z = Vector(0, 0, 1)


@dataclass(frozen=True, slots=True)
class Matrix:
    """A 3 by 3 matrix, by rows."""

    x: Vector
    y: Vector
    z: Vector

    @classmethod
    def outer(cls, a: Vector, b: Vector) -> Matrix:
        return cls(b * a.x, b * a.y, b * a.z)

    @property
    def T(self) -> Matrix:
        x, y, z = self.x, self.y, self.z
        return Matrix(Vector(x.x, y.x, z.x), Vector(x.y, y.y, z.y), Vector(x.z, y.z, z.z))

    def trace(self) -> Scalar:
        return self.x.x + self.y.y + self.z.z

    def __add__(self, other: Matrix) -> Matrix:
        return Matrix(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: Matrix) -> Matrix:
        return Matrix(self.x - other.x, self.y - other.y, self.z - other.z)

    def __matmul__(self, v: Vector) -> Vector:
        return Vector(self.x.dot(v), self.y.dot(v), self.z.dot(v))

    def __mul__(self, other: Matrix) -> Matrix:
        t = other.T
        return Matrix(t @ self.x, t @ self.y, t @ self.z)


def skew(v: Vector) -> Matrix:
    """v× as a matrix: skew(v) @ a == v.cross(a)."""
    return Matrix(Vector(0, -v.z, v.y), Vector(v.z, 0, -v.x), Vector(-v.y, v.x, 0))


@dataclass(frozen=True, slots=True)
class Symmetric:
    xx: Scalar
    xy: Scalar
    xz: Scalar
    yy: Scalar
    yz: Scalar
    zz: Scalar

    def __add__(self, other: Symmetric) -> Symmetric:
        return Symmetric(
            self.xx + other.xx,
            self.xy + other.xy,
            self.xz + other.xz,
            self.yy + other.yy,
            self.yz + other.yz,
            self.zz + other.zz,
        )

    def __matmul__(self, v: Vector) -> Vector:
        return Vector(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )

    def trace(self) -> Scalar:
        return self.xx + self.yy + self.zz

    def matrix(self) -> Matrix:
        return Matrix(
            Vector(self.xx, self.xy, self.xz),
            Vector(self.xy, self.yy, self.yz),
            Vector(self.xz, self.yz, self.zz),
        )

    @classmethod
    def upper(cls, m: Matrix) -> Symmetric:
        """From a matrix that is symmetric, its upper triangle."""
        return cls(m.x.x, m.x.y, m.x.z, m.y.y, m.y.z, m.z.z)


NO_INERTIA = Symmetric(0, 0, 0, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class Motion:
    w: Vector
    u: Vector

    def __add__(self, other: Motion) -> Motion:
        return Motion(self.w + other.w, self.u + other.u)

    def __mul__(self, k: Scalar) -> Motion:
        return Motion(self.w * k, self.u * k)

    def cross(self, m: Motion) -> Motion:
        """v × m, equation 2.33."""
        return Motion(self.w.cross(m.w), self.w.cross(m.u) + self.u.cross(m.w))

    def cross_force(self, f: Force) -> Force:
        """v ×* f, equation 2.34."""
        return Force(self.w.cross(f.n) + self.u.cross(f.f), self.w.cross(f.f))

    def dot(self, f: Force) -> Scalar:
        return self.w.dot(f.n) + self.u.dot(f.f)


@dataclass(frozen=True, slots=True)
class Force:
    n: Vector
    f: Vector

    def __add__(self, other: Force) -> Force:
        return Force(self.n + other.n, self.f + other.f)

    def __mul__(self, k: Scalar) -> Force:
        return Force(self.n * k, self.f * k)


def half(x: Scalar) -> Scalar:
    """x / 2; a structural zero stays an integer."""
    return 0 if isinstance(x, int) else x / 2


REST = Motion(ZERO, ZERO)
TURN = Motion(Z, ZERO)  # S of a revolute joint: about its own z
SLIDE = Motion(ZERO, Z)  # S of a prismatic joint: along its own z


@dataclass(frozen=True, slots=True)
class Inertia:
    """Mass, first moment and rotational inertia about the frame's origin; equation 2.63."""

    m: Scalar
    h: Vector
    I: Symmetric  #  the book's letter

    def __add__(self, other: Inertia) -> Inertia:
        return Inertia(self.m + other.m, self.h + other.h, self.I + other.I)

    def __matmul__(self, v: Motion) -> Force:
        return Force(self.I @ v.w + self.h.cross(v.u), v.u * self.m - self.h.cross(v.w))

    def second_moment(self) -> Matrix:
        """∫ c cᵀ dm = ½ tr(I) 1 − I."""
        i, mean = self.I, half(self.I.trace())
        return Symmetric(mean - i.xx, -i.xy, -i.xz, mean - i.yy, -i.yz, mean - i.zz).matrix()


@dataclass(frozen=True, slots=True)
class ArticulatedInertia:
    """A symmetric 6 by 6 matrix [[A, B], [Bᵀ, C]] from motions to forces."""

    A: Symmetric
    B: Matrix
    C: Symmetric

    @classmethod
    def of(cls, body: Inertia) -> ArticulatedInertia:
        return cls(body.I, skew(body.h), Symmetric(body.m, 0, 0, body.m, 0, body.m))

    def __add__(self, other: ArticulatedInertia) -> ArticulatedInertia:
        return ArticulatedInertia(self.A + other.A, self.B + other.B, self.C + other.C)

    def __matmul__(self, v: Motion) -> Force:
        return Force(self.A @ v.w + self.B @ v.u, self.B.T @ v.w + self.C @ v.u)

    def without(self, U: Force, d_inverse: Scalar) -> ArticulatedInertia:
        """I − U d⁻¹ Uᵀ."""
        V = U * (-d_inverse)
        return self + ArticulatedInertia(
            Symmetric.upper(Matrix.outer(U.n, V.n)),
            Matrix.outer(U.n, V.f),
            Symmetric.upper(Matrix.outer(U.f, V.f)),
        )


class JointTransform:
    """X: from the parent's body frame, through a constant pose, to a joint turned or slid by q.

    The constant part and the turn about z are applied one after the other: cheaper than their
    product where the pose has no zeros, equal where it has.
    """

    __slots__ = ("R", "c", "d", "prismatic", "r", "s")
    c: Scalar
    s: Scalar
    d: Scalar

    def __init__(self, pose: Pose, prismatic: bool, q: Scalar):
        self.R = Matrix(*(Vector(*row) for row in pose.rotation))  # p_parent = R p_child + r
        self.r = Vector(*pose.translation)
        self.prismatic = prismatic
        self.c, self.s, self.d = (1, 0, q) if prismatic else (*cos_sin(q), 0)

    def down(self, v: Vector) -> Vector:
        """A free vector in the parent's axes, in the child's."""
        v, c, s = self.R.T @ v, self.c, self.s
        return Vector(c * v.x + s * v.y, c * v.y - s * v.x, v.z)

    def up(self, v: Vector) -> Vector:
        """A free vector in the child's axes, in the parent's."""
        c, s = self.c, self.s
        return self.R @ Vector(c * v.x - s * v.y, s * v.x + c * v.y, v.z)

    def _slid(self) -> Vector:
        return Vector(0, 0, self.d)

    def motion(self, v: Motion) -> Motion:
        """X v: a motion of the parent, seen in the child's frame."""
        w = self.down(v.w)
        return Motion(w, self.down(v.u - self.r.cross(v.w)) - self._slid().cross(w))

    def force(self, f: Force) -> Force:
        """Xᵀ f: a force on the child, seen in the parent's frame."""
        n, f_ = self.up(f.n + self._slid().cross(f.f)), self.up(f.f)
        return Force(n + self.r.cross(f_), f_)

    def first_moment(self, m: Scalar, h: Vector) -> Vector:
        """The first moment of a mass m with first moment h in the child, in the parent's frame."""
        return self.up(h + self._slid() * m) + self.r * m

    def up_symmetric(self, a: Symmetric) -> Symmetric:
        """R Rz a Rzᵀ Rᵀ."""
        c, s = self.c, self.s
        if not self.prismatic:
            p = s * (a.xx - a.yy) + c * (a.xy * 2)
            xz, yz = c * a.xz - s * a.yz, s * a.xz + c * a.yz
            a = Symmetric(a.xx - s * p, c * p - a.xy, xz, a.yy + s * p, yz, a.zz)
        return Symmetric.upper(self.R * a.matrix() * self.R.T)

    def up_matrix(self, a: Matrix) -> Matrix:
        """R Rz a Rzᵀ Rᵀ."""
        rows = Matrix(*(self.up(row) for row in (a.x, a.y, a.z))).T
        return Matrix(*(self.up(column) for column in (rows.x, rows.y, rows.z))).T

    def inertia(self, body: Inertia) -> Inertia:
        """Xᵀ I X: a rigid body of the child, seen in the parent's frame."""
        slid = shifted(body, self._slid())
        return shifted(Inertia(slid.m, self.up(slid.h), self.up_symmetric(slid.I)), self.r)

    def articulated(self, body: ArticulatedInertia) -> ArticulatedInertia:
        """Xᵀ I X for an articulated body."""
        slid = _shifted_articulated(body, self._slid())
        turned = ArticulatedInertia(
            self.up_symmetric(slid.A), self.up_matrix(slid.B), self.up_symmetric(slid.C)
        )
        return _shifted_articulated(turned, self.r)


def shifted(body: Inertia, r: Vector) -> Inertia:
    """The same body about an origin from which the old one is at r."""
    a, b, old = body.h, body.h + r * body.m, body.I
    x, y, z = (r_i * (a_i + b_i) for r_i, a_i, b_i in zip(r, a, b, strict=True))
    moved = Symmetric(
        old.xx + (y + z),
        old.xy - (r.x * a.y + b.x * r.y),
        old.xz - (r.x * a.z + b.x * r.z),
        old.yy + (x + z),
        old.yz - (r.y * a.z + b.y * r.z),
        old.zz + (x + y),
    )
    return Inertia(body.m, b, moved)


def _shifted_articulated(body: ArticulatedInertia, r: Vector) -> ArticulatedInertia:
    rx = skew(r)
    B = body.B + rx * body.C.matrix()
    A = body.A.matrix() + rx * B.T - body.B * rx
    return ArticulatedInertia(Symmetric.upper(A), B, body.C)
