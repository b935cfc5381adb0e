"""What a robot is made of: frozen data, as its description says it.

Numbers are floats, or symbols where the author of a textbook arm wants them.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from mcgee.scalar import Scalar, constant_cos_sin

Vec3 = tuple[Scalar, Scalar, Scalar]
Mat3 = tuple[Vec3, Vec3, Vec3]
Kind = Literal["revolute", "continuous", "prismatic", "fixed"]
KINDS = ("revolute", "continuous", "prismatic", "fixed")

ORIGIN: Vec3 = (0.0, 0.0, 0.0)
UPRIGHT: Mat3 = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def _times(a: Mat3, v: Sequence[Scalar]) -> Vec3:
    x, y, z = (r[0] * v[0] + r[1] * v[1] + r[2] * v[2] for r in a)
    return x, y, z


def _transposed(a: Mat3) -> Mat3:
    return tuple(zip(*a, strict=True))  # type: ignore[return-value]


def _product(a: Mat3, b: Mat3) -> Mat3:
    x, y, z = (_times(a, column) for column in _transposed(b))
    return _transposed((x, y, z))


@dataclass(frozen=True)
class Pose:
    """T_AB, the pose of a frame B in a frame A: p_A = rotation p_B + translation [m]."""

    rotation: Mat3 = UPRIGHT
    translation: Vec3 = ORIGIN

    def __matmul__(self, other: Pose) -> Pose:
        """T_AC = T_AB @ T_BC."""
        return Pose(_product(self.rotation, other.rotation), self.apply(other.translation))

    def apply(self, point: Sequence[Scalar]) -> Vec3:
        """p_A of a point given in B."""
        x, y, z = (a + b for a, b in zip(self.turn(point), self.translation, strict=True))
        return x, y, z

    def turn(self, vector: Sequence[Scalar]) -> Vec3:
        """A free vector given in B, in the axes of A."""
        return _times(self.rotation, vector)

    def inverse(self) -> Pose:
        back = _transposed(self.rotation)
        x, y, z = _times(back, self.translation)
        return Pose(back, (-x, -y, -z))

    @classmethod
    def about(cls, axis: Literal["x", "y", "z"], angle: Scalar) -> Pose:
        """A turn by an angle [rad]; exact for multiples of pi/12."""
        c, s = constant_cos_sin(angle)
        return {
            "x": cls(((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c))),
            "y": cls(((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c))),
            "z": cls(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))),
        }[axis]

    @classmethod
    def at(cls, x: Scalar = 0.0, y: Scalar = 0.0, z: Scalar = 0.0) -> Pose:
        """A displacement without a turn [m]."""
        return cls(translation=(x, y, z))

    @classmethod
    def from_rpy(cls, rpy: Sequence[Scalar], xyz: Sequence[Scalar] = ORIGIN) -> Pose:
        """URDF's roll, pitch, yaw about the fixed axes x, y, z [rad] and displacement [m]."""
        turn = cls.about("z", rpy[2]) @ cls.about("y", rpy[1]) @ cls.about("x", rpy[0])
        return cls(turn.rotation, (xyz[0], xyz[1], xyz[2]))

    @classmethod
    def from_matrix(cls, rows: Iterable[Iterable[Scalar]]) -> Pose:
        """From a homogeneous 4 by 4 matrix."""
        a, b, c, _ = (tuple(row) for row in rows)
        return cls((a[:3], b[:3], c[:3]), (a[3], b[3], c[3]))


def frame_on_axis(axis: Sequence[float]) -> Pose:
    """A frame whose z is the given unit axis; exact where the axis is one of x, y, z."""
    x, y, z = axis
    if x == 0 and y == 0:
        return Pose(UPRIGHT if z > 0 else ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)))
    # a first axis square to z, taken from the coordinate axis that is farthest from it
    rest = min(range(3), key=lambda i: abs(axis[i]))
    a = [0.0 - axis[rest] * v for v in axis]
    a[rest] += 1.0
    norm = math.sqrt(sum(v * v for v in a))
    a = [v / norm for v in a]
    b = (y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0])
    return Pose(((a[0], b[0], x), (a[1], b[1], y), (a[2], b[2], z)))


@dataclass(frozen=True)
class Inertia:
    """Mass [kg], centre of mass [m] and inertia about it [kg·m²], in the link's frame."""

    mass: Scalar
    com: Vec3 = ORIGIN
    about_com: tuple[Scalar, ...] = (0.0,) * 6
    """Ixx, Ixy, Ixz, Iyy, Iyz, Izz; products with URDF's sign: I = [[Ixx, Ixy, Ixz], …]."""

    @property
    def matrix(self) -> Mat3:
        xx, xy, xz, yy, yz, zz = self.about_com
        return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)

    def seen_from(self, pose: Pose) -> Inertia:
        """The same body in frame A, pose being T_AB and self in B."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = _product(
            _product(pose.rotation, self.matrix), _transposed(pose.rotation)
        )
        return Inertia(self.mass, pose.apply(self.com), (xx, xy, xz, yy, yz, zz))


@dataclass(frozen=True)
class Mimic:
    """q of this joint = multiplier * q of the other + offset [rad | m]."""

    joint: str
    multiplier: Scalar = 1.0
    offset: Scalar = 0.0


@dataclass(frozen=True)
class Joint:
    """A joint between two links.

    pose is the joint's frame in the parent link, child_pose the child link's frame in the moved
    joint frame (the identity in URDF).
    """

    name: str
    kind: Kind
    parent: str
    child: str
    pose: Pose = Pose()
    axis: Vec3 = (0.0, 0.0, 1.0)
    child_pose: Pose = Pose()
    lower: float = -math.inf
    upper: float = math.inf
    velocity: float = math.inf
    effort: float = math.inf
    armature: Scalar = 0.0
    """Inertia of the rotor, reflected to the joint [kg·m² | kg]."""
    viscous: Scalar = 0.0
    """Viscous damping [N·m·s/rad | N·s/m]; data, not part of the equation of motion."""
    coulomb: Scalar = 0.0
    """Coulomb friction [N·m | N]; data, not part of the equation of motion."""
    mimic: Mimic | None = None
    place: str = dataclasses.field(default="", compare=False)
    """Where the description says it: 'arm.urdf:12: '."""

    @property
    def moves(self) -> bool:
        return self.kind != "fixed"


@dataclass(frozen=True)
class Link:
    name: str
    inertia: Inertia | None = None
    place: str = dataclasses.field(default="", compare=False)


@dataclass(frozen=True)
class Frame:
    """A named frame fixed to a link."""

    name: str
    link: str
    pose: Pose = Pose()


def map_numbers(x: Any, convert: Callable[[Scalar], Scalar]) -> Any:
    """Frozen data with every number in it converted; counts and indices (int) stay."""
    if dataclasses.is_dataclass(x) and not isinstance(x, type):
        names = (field.name for field in dataclasses.fields(x))
        return dataclasses.replace(
            x, **{name: map_numbers(getattr(x, name), convert) for name in names}
        )
    if isinstance(x, tuple):
        return tuple(map_numbers(v, convert) for v in x)
    if isinstance(x, Mapping):
        return {key: map_numbers(v, convert) for key, v in x.items()}
    return x if x is None or isinstance(x, (str, int)) else convert(x)


def is_number(x: Scalar) -> bool:
    """A plain number, as opposed to a symbol."""
    return isinstance(x, (float, int))
