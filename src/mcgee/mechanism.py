"""A description reduced to what the algorithms need.

Fixed joints are merged, every joint turns about or slides along its own z, joints that mimic
another share its coordinate. Body i carries the frame of its joint; the parent of body i comes
before it; -1 is the ground.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

from mcgee.model import Frame, Inertia, Joint, Link, Pose, Vec3, frame_on_axis, map_numbers
from mcgee.scalar import Scalar, Turn, cos_sin

GROUND = -1


@dataclass(frozen=True)
class Body:
    """One rigid body: all the links that move with one joint, in the frame of that joint."""

    name: str
    parent: int
    pose: Pose
    """Of this body's frame in its parent's, at joint position zero."""
    prismatic: bool
    mass: Scalar
    first_moment: Vec3
    inertia: tuple[Scalar, ...]
    """Ixx, Ixy, Ixz, Iyy, Iyz, Izz about the origin of the body's frame."""
    armature: Scalar
    coordinate: int
    multiplier: Scalar
    """Joint position = multiplier * q[coordinate]; a mimic's offset is part of the pose."""
    link: str
    """The link that the joint moves."""
    offset: Turn | None = None
    """The pose turns the frame by this less than it is turned at joint position zero."""

    def position(self, q: Scalar) -> Scalar:
        """What the joint's frame is turned or slid by, from its pose on.

        The offset turns (cos q, sin q): the angle itself would be rounded, and no longer an input.
        """
        return q if self.offset is None else Turn(*cos_sin(q)) + self.offset


@dataclass(frozen=True)
class Mass:
    """A link's own inertia, seen in the frame of the body that carries it."""

    link: str
    body: int
    inertia: Inertia


@dataclass(frozen=True)
class Mechanism:
    bodies: tuple[Body, ...]
    masses: tuple[Mass, ...]
    frames: Mapping[str, tuple[int, Pose]]
    gravity: Vec3
    n: int

    @cached_property
    def coupled(self) -> bool:
        """Whether some coordinate moves more than one body, or moves it with a factor."""
        return len(self.bodies) != self.n or any(b.multiplier != 1 for b in self.bodies)

    def map(self, convert: Callable[[Scalar], Scalar]) -> Mechanism:
        """The same mechanism with every number converted: to fractions.Fraction, say."""
        return map_numbers(self, convert)

    def joint_space(self, x: Sequence[Scalar]) -> list[Scalar]:
        """Each body's own joint position or velocity from the coordinates."""
        if len(x) != self.n:
            raise ValueError(f"got {len(x)} joint coordinates, expected {self.n}.")
        return [
            x[b.coordinate] if b.multiplier == 1 else x[b.coordinate] * b.multiplier
            for b in self.bodies
        ]


def depth_first(links: Sequence[Link], joints: Sequence[Joint]) -> list[Joint]:
    """The joints from the root outwards, subtree by subtree, siblings in the file's order."""
    children: dict[str, list[Joint]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint)
    order: list[Joint] = []
    stack = list(reversed(children.get(root_of(links, joints), [])))
    while stack:
        joint = stack.pop()
        order.append(joint)
        stack.extend(reversed(children.get(joint.child, [])))
    return order


def root_of(links: Sequence[Link], joints: Sequence[Joint]) -> str:
    moved = {joint.child for joint in joints}
    return next(link.name for link in links if link.name not in moved)


def coordinate_of(joint: Joint, joints: dict[str, Joint]) -> tuple[str, Scalar, Scalar]:
    """(independent joint, multiplier, offset) behind a chain of mimic joints."""
    multiplier, offset = 1.0, 0.0
    while joint.mimic is not None:
        offset = offset + multiplier * joint.mimic.offset
        multiplier = multiplier * joint.mimic.multiplier
        joint = joints[joint.mimic.joint]
    return joint.name, multiplier, offset


def friction(joints: Sequence[Joint], independent: Sequence[str]) -> list[tuple[float, float]]:
    """(viscous, Coulomb) coefficients of independent joints, those that mimic them included.

    A follower at m qd takes the powers b (m qd)² and c |m qd|: m² b and |m| c to its leader.
    """
    by_name = {joint.name: joint for joint in joints}
    found = dict.fromkeys(independent, (0.0, 0.0))
    for joint in joints:
        if joint.moves:
            leader, m, _ = coordinate_of(joint, by_name)
            b, c = found[leader]
            found[leader] = b + float(joint.viscous * m * m), c + float(joint.coulomb * abs(m))
    return list(found.values())


def reduce(
    links: Sequence[Link], joints: Sequence[Joint], frames: Sequence[Frame], gravity: Vec3
) -> Mechanism:
    """Merge fixed joints, put every joint on its own z, resolve mimic joints.

    Expects a valid tree. Coordinates are numbered along `depth_first`.
    """
    order = depth_first(links, joints)
    by_name = {joint.name: joint for joint in joints}
    independent = [joint.name for joint in order if joint.moves and joint.mimic is None]
    coordinates = {name: k for k, name in enumerate(independent)}
    # where each link's frame is: (body, pose of the link's frame in the body's)
    seats: dict[str, tuple[int, Pose]] = {root_of(links, joints): (GROUND, Pose())}
    bodies: list[Body] = []
    for joint in order:
        i, seat = seats[joint.parent]
        pose = seat @ joint.pose
        if joint.moves:
            leader, multiplier, offset = coordinate_of(joint, by_name)
            coordinate = coordinates[leader]
            bodies.append(_empty_body(joint, i, pose, coordinate, multiplier, offset))
            i, pose = len(bodies) - 1, frame_on_axis(joint.axis).inverse()
        seats[joint.child] = (i, pose @ joint.child_pose)
    masses = tuple(
        Mass(link.name, seats[link.name][0], link.inertia.seen_from(seats[link.name][1]))
        for link in links
        if link.inertia is not None and seats[link.name][0] != GROUND
    )
    for mass in masses:
        bodies[mass.body] = _with_mass(bodies[mass.body], mass.inertia)
    seats_of_frames = {
        frame.name: (seats[frame.link][0], seats[frame.link][1] @ frame.pose) for frame in frames
    }
    frames_ = MappingProxyType(seats | seats_of_frames)
    return Mechanism(tuple(bodies), masses, frames_, gravity, len(independent))


def _empty_body(
    joint: Joint, parent: int, pose: Pose, coordinate: int, multiplier: Scalar, offset: Scalar
) -> Body:
    """The body that a joint moves, before any link gives it mass; pose is the joint's frame."""
    pose, prismatic = pose @ frame_on_axis(joint.axis), joint.kind == "prismatic"
    if joint.mimic is not None:
        pose = pose @ (Pose.at(z=offset) if prismatic else Pose.about("z", offset))
    return Body(
        name=joint.name,
        parent=parent,
        pose=pose,
        prismatic=prismatic,
        mass=0.0,
        first_moment=(0.0, 0.0, 0.0),
        inertia=(0.0,) * 6,
        armature=joint.armature,
        coordinate=coordinate,
        multiplier=multiplier,
        link=joint.child,
    )


def _with_mass(body: Body, added: Inertia) -> Body:
    m, (x, y, z) = added.mass, added.com
    xx, xy, xz, yy, yz, zz = added.about_com
    about_origin = (
        xx + m * (y * y + z * z),
        xy - m * (x * y),
        xz - m * (x * z),
        yy + m * (x * x + z * z),
        yz - m * (y * z),
        zz + m * (x * x + y * y),
    )
    hx, hy, hz = body.first_moment
    return replace(
        body,
        mass=body.mass + m,
        first_moment=(hx + m * x, hy + m * y, hz + m * z),
        inertia=tuple(a + b for a, b in zip(body.inertia, about_origin, strict=True)),
    )
