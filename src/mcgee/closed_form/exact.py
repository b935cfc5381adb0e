"""A robot over exact polynomials.

Every body is seen in axes that do not turn with the joints of its run of parallel axes: what the
recursions then meet are the cosines and sines of absolute angles, q1 + q2 and not q1 and q2, and
few of them. The recursions hold in any axes that coincide with the body's for the instant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NoReturn

from sympy import Symbol

from mcgee.algorithms.parameters import with_parameters
from mcgee.algorithms.spatial import JointTransform
from mcgee.algorithms.tree import inertia
from mcgee.closed_form.angles import Form, form, plus
from mcgee.closed_form.reading import Needs, Reader
from mcgee.closed_form.ring import Polynomial, Ring, rational, simplest
from mcgee.mechanism import GROUND, Body, Mechanism, reduce
from mcgee.model import Inertia, Joint, Link, Mimic, Pose, frame_on_axis
from mcgee.scalar import Scalar

if TYPE_CHECKING:
    from mcgee.robot import Robot

PARAMETERS = ("m", "hx", "hy", "hz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
"""Of a body, with its number behind: m1, hx1 = m1 cx1, …; Robot.inertial_parameters' order."""


class Standing(int):
    """A joint position of 0 that stays an integer when a mimic's factor multiplies it."""

    def __mul__(self, times: Scalar) -> int:
        return 0


@dataclass(frozen=True)
class ExactRobot:
    """A mechanism over a ring, at the configuration that the ring's angles stand for."""

    ring: Ring
    mechanism: Mechanism
    """Its joint positions are in its poses: evaluate it `at_rest`."""
    q: tuple[Symbol, ...]
    qd: tuple[Symbol, ...]
    qdd: tuple[Symbol, ...]
    constants: dict[Symbol, float]
    """The values of the named angles [rad]."""
    inertial: tuple[Symbol, ...]
    """The symbols that stand for the inertial parameters (10 bodies,), or none."""
    still: Mechanism
    """The same without positions, every body in its own frame: constants only."""
    turns: tuple[Pose, ...]
    """Each body's own frame in the axes that `mechanism` sees it in."""

    @property
    def at_rest(self) -> list[Scalar]:
        return [Standing()] * len(self.q)

    def positions(self) -> list[Scalar]:
        """The joint positions that `still` has in this configuration, body by body.

        Raises: ValueError: a joint's own angle is no sum of the ring's
        """
        found: list[Scalar] = []
        for body in self.still.bodies:
            if body.prismatic:
                found.append(self.ring.symbol(self.q[body.coordinate]) * body.multiplier)
            else:
                found.append(self.ring.turn(_turned(body, self.q)))
        return found

    @property
    def rates(self) -> tuple[list[Polynomial], list[Polynomial]]:
        """qd and qdd as polynomials."""
        qd, qdd = ([self.ring.symbol(s) for s in names] for names in (self.qd, self.qdd))
        return qd, qdd


def exact(robot: Robot, symbolic_inertias: bool = False) -> ExactRobot:
    """The robot's numbers read exactly, its inertial parameters replaced by symbols if wanted."""
    n = robot.n
    q, qd, qdd = (tuple(Symbol(f"{x}{i + 1}") for i in range(n)) for x in ("q", "qd", "qdd"))
    constants: dict[Symbol, float] = {}
    needs = Needs()
    _read(robot, Reader(needs, constants, _refuse(robot), robot.symbols))
    count = len(robot.mechanism.bodies) if symbolic_inertias else 0
    inertial = tuple(Symbol(f"{x}{i + 1}") for i in range(count) for x in PARAMETERS)
    _check_names(robot, (*q, *qd, *qdd, *inertial))
    small = needs.ring(symbols=inertial)
    mechanism = _reduced(robot, Reader(small, constants, _refuse(robot), robot.symbols))
    if symbolic_inertias:
        mechanism = with_parameters(mechanism, [small.symbol(s) for s in inertial])
    places = _placed(mechanism, q)
    slides = [q[b.coordinate] for b in mechanism.bodies if b.prismatic]
    symbols = (*dict.fromkeys(slides), *qd, *qdd, *inertial)
    ring = needs.ring([p.angle for p in places if p.angle], symbols)
    lifted = mechanism.map(lambda x: ring(x) if isinstance(x, Polynomial) else x)
    turns = tuple(_about_z(ring, place.angle if place.back else ()) for place in places)
    moved = _instant(lifted, places, turns, ring, q)
    return ExactRobot(ring, moved, q, qd, qdd, constants, inertial, lifted, turns)


def _refuse(robot: Robot) -> Any:
    def refuse(x: Any) -> NoReturn:
        raise ValueError(
            f"robot '{robot.name}' has the parameter {x}, expected a polynomial in symbols and in "
            f"cosines and sines of symbolic angles, divided by symbols at most. Write a symbol "
            f"for what is none, and put its value in afterwards with .subs."
        )

    return refuse


def _check_names(robot: Robot, own: Sequence[Symbol]) -> None:
    clash = [str(s) for s in own if str(s) in robot.symbols]
    if clash:
        raise ValueError(
            f"robot '{robot.name}' has the symbol '{clash[0]}', which closed_form() uses itself. "
            f"Give the parameter another one: robot.subs({{'{clash[0]}': sympy.Symbol('p')}})."
        )


# -- reading a robot ------------------------------------------------------------------------------


def _read(
    robot: Robot, reader: Reader
) -> tuple[tuple[Link, ...], tuple[Joint, ...], tuple[Scalar, Scalar, Scalar]]:
    links = tuple(
        replace(link, inertia=link.inertia and _inertia(link.inertia, reader))
        for link in robot.links
    )
    joints = tuple(_joint(joint, robot, reader) for joint in robot.joints)
    x, y, z = (reader.number(v) for v in robot.gravity_vector)
    return links, joints, (x, y, z)


def _inertia(given: Inertia, reader: Reader) -> Inertia:
    x, y, z = (reader.number(v) for v in given.com)
    return Inertia(reader.number(given.mass), (x, y, z), tuple(map(reader.number, given.about_com)))


def _pose(given: Pose, reader: Reader) -> Pose:
    x, y, z = (reader.number(v) for v in given.translation)
    return Pose(reader.rotation(given.rotation), (x, y, z))


def _joint(joint: Joint, robot: Robot, reader: Reader) -> Joint:
    """Its axis turned to z and its mimic's offset gone into the pose."""
    pose, child = _pose(joint.pose, reader), _pose(joint.child_pose, reader)
    if not joint.moves:
        return replace(joint, pose=pose, child_pose=child, armature=0, viscous=0, coulomb=0)
    seat = Pose(reader.rotation(frame_on_axis(joint.axis).rotation))
    start, mimic = Pose(), joint.mimic
    if mimic is not None:
        leader, _, offset = _followed(joint, robot)
        start = _start(joint, offset, reader)
        mimic = Mimic(leader, 1, 0)
    return replace(
        joint,
        pose=pose @ seat @ start,
        child_pose=seat.inverse() @ child,
        axis=(0.0, 0.0, 1.0),
        armature=reader.number(joint.armature),
        viscous=0,
        coulomb=0,
        mimic=mimic,
    )


def _start(joint: Joint, offset: Fraction, reader: Reader) -> Pose:
    """A mimic's offset as a pose."""
    if joint.kind == "prismatic":
        return Pose.at(z=reader.number(offset))
    turn = reader.constant_turn(float(offset)) if offset else None
    if turn is None:
        return Pose()
    return Pose(((turn.c, -turn.s, 0), (turn.s, turn.c, 0), (0, 0, 1)))


def _followed(joint: Joint, robot: Robot) -> tuple[str, Fraction, Fraction]:
    """(independent joint, multiplier, offset) behind a chain of mimic joints, exactly."""
    by_name = {j.name: j for j in robot.joints}
    multiplier, offset = Fraction(1), Fraction(0)
    while joint.mimic is not None:
        offset += multiplier * _constant(joint.mimic.offset, joint, robot)
        multiplier *= _constant(joint.mimic.multiplier, joint, robot)
        joint = by_name[joint.mimic.joint]
    return joint.name, multiplier, offset


def _constant(x: Scalar, joint: Joint, robot: Robot) -> Fraction:
    if hasattr(x, "free_symbols"):
        raise ValueError(
            f"joint '{joint.name}' of robot '{robot.name}' mimics with the factor or offset {x}, "
            f"expected a number. Put one in with .subs."
        )
    return rational(x)


def _reduced(robot: Robot, reader: Reader) -> Mechanism:
    links, joints, gravity = _read(robot, reader)
    found = reduce(links, joints, (), gravity).map(_exact_number)
    gears = {j.name: _followed(j, robot)[1] for j in robot.joints if j.moves}
    bodies = (
        replace(b, multiplier=1 if gears[b.name] == 1 else gears[b.name]) for b in found.bodies
    )
    return replace(found, bodies=tuple(bodies))


def _exact_number(x: Scalar) -> Scalar:
    """Of the floats only the 0, 1 and -1 of poses and empty bodies are left."""
    return int(x) if isinstance(x, float) else simplest(x)


# -- axes that do not turn with their run ---------------------------------------------------------


@dataclass(frozen=True)
class Place:
    """How a body stands against axes that do not turn with its run of parallel joints."""

    angle: Form
    """By how much it has turned about the run's axis."""
    axis: tuple[Scalar, ...]
    """The run's axis in the body's own frame."""
    back: bool
    """Whether the body is seen in axes turned back by the angle."""
    sense: int
    """1 or -1 where the joint is parallel to the run of the body before, 0 where a run begins."""


_Z = (0, 0, 1)


def _placed(mechanism: Mechanism, q: Sequence[Symbol]) -> list[Place]:
    places: list[Place] = []
    for body in mechanism.bodies:
        along = tuple(row[2] for row in body.pose.rotation)
        above = places[body.parent] if body.parent != GROUND else None
        sense = _sense(along, above.axis) if above else 0
        if body.prismatic:
            if above is None:
                places.append(Place((), _Z, False, 0))
                continue
            axis = body.pose.inverse().turn(above.axis)
            angle = plus((), above.angle, sense or 1)
            places.append(Place(angle, _Z if sense else axis, bool(sense), sense))
            continue
        own = _turned(body, q)
        angle = plus(own, above.angle, sense) if above else own
        places.append(Place(angle, _Z, True, sense))
    return places


def _turned(body: Body, q: Sequence[Symbol]) -> Form:
    """By how much its own joint turns a body."""
    return form([(q[body.coordinate], Fraction(body.multiplier))])


def _sense(a: Sequence[Scalar], b: Sequence[Scalar]) -> int:
    """1 or -1 where the directions are parallel, else 0."""
    for sense in (1, -1):
        if all(simplest(x - y * sense) == 0 for x, y in zip(a, b, strict=True)):
            return sense
    return 0


def _instant(
    mechanism: Mechanism,
    places: Sequence[Place],
    turns: Sequence[Pose],
    ring: Ring,
    q: Sequence[Symbol],
) -> Mechanism:
    bodies = tuple(
        _seen_so(body, mechanism.bodies, places, turns, ring, q, i)
        for i, body in enumerate(mechanism.bodies)
    )
    masses = tuple(
        replace(mass, inertia=mass.inertia.seen_from(turns[mass.body])) for mass in mechanism.masses
    )
    frames = {
        name: (i, pose if i == GROUND else turns[i] @ pose)
        for name, (i, pose) in mechanism.frames.items()
    }
    return Mechanism(bodies, masses, frames, mechanism.gravity, mechanism.n)


def _seen_so(
    body: Body,
    bodies: Sequence[Body],
    places: Sequence[Place],
    turns: Sequence[Pose],
    ring: Ring,
    q: Sequence[Symbol],
    i: int,
) -> Body:
    """The body in its place's axes, its joint's position gone into the pose."""
    above = turns[body.parent] if body.parent != GROUND else Pose()
    carried = above @ body.pose
    if body.prismatic:
        slid = ring.symbol(q[body.coordinate]) * body.multiplier
        carried = carried @ Pose.at(z=slid)
    if places[i].sense:  # turned back, as the axes of its run are
        if places[body.parent].back:
            carried = Pose(body.pose.rotation, carried.translation)
        else:
            own = () if body.prismatic else _turned(body, q)
            carried = carried @ _about_z(ring, plus(own, places[i].angle, -1))
    own_inertia = JointTransform(turns[i], True, 0).inertia(inertia(body))
    I = own_inertia.I
    return replace(
        body,
        pose=Pose(_mapped(carried.rotation), _mapped(carried.translation)),
        mass=own_inertia.m,
        first_moment=tuple(own_inertia.h),
        inertia=(I.xx, I.xy, I.xz, I.yy, I.yz, I.zz),
    )


def _mapped(x: Any) -> Any:
    return tuple(map(_mapped, x)) if isinstance(x, tuple) else _exact_number(x)


def _about_z(ring: Ring, angle: Form) -> Pose:
    if not angle:
        return Pose()
    turn = ring.turn(angle)
    return Pose(((turn.c, -turn.s, 0), (turn.s, turn.c, 0), (0, 0, 1)))
