"""What a description must be, in one clear sentence each, and what in it looks wrong."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

from mcgee.errors import ModelError
from mcgee.mechanism import GROUND, Mechanism, reduce
from mcgee.model import KINDS, Frame, Inertia, Joint, Link, Pose, Vec3, is_number
from mcgee.scalar import Scalar

MOST = 5000
"""Links: far beyond any robot, and checked in a moment."""

# -- what must hold -------------------------------------------------------------------------------


def check(
    name: str,
    links: Sequence[Link],
    joints: Sequence[Joint],
    frames: Sequence[Frame],
    gravity: Vec3,
) -> None:
    """Raise ModelError unless this is one tree of named links with usable numbers."""
    if not isinstance(name, str) or not name.isprintable():
        raise ModelError(f"a robot is named {name!r}, expected a printable text.")
    if max(len(links), len(joints)) > MOST:
        raise ModelError(
            f"{links[0].place}robot '{name}' has {len(links)} links and {len(joints)} joints; at "
            f"most {MOST} are read."
        )
    if not links:
        raise ModelError(
            f"robot '{name}' has no links. Describe at least a base and a moving link."
        )
    _check_names(links, joints, frames)
    for joint in joints:
        _check_joint(joint, {link.name for link in links})
    _check_tree(name, links, joints)
    _check_mimics(joints)
    for link in links:
        if link.inertia is not None:
            _check_inertia(link, link.inertia)
    if not any(joint.moves and joint.mimic is None for joint in joints):
        raise ModelError(
            f"{links[0].place}robot '{name}' has no moving joint, so it has no equation of motion. "
            f"Make at least one joint revolute, continuous or prismatic."
        )
    _check_moving_links_have_inertia(links, joints)
    if len(gravity) != 3:
        raise ModelError(f"gravity_vector has {len(gravity)} components, expected 3 [m/s²].")
    _check_finite("", "gravity_vector", gravity)


def _check_names(links: Sequence[Link], joints: Sequence[Joint], frames: Sequence[Frame]) -> None:
    for what, items in (("link", links), ("joint", joints), ("frame", frames)):
        for item in items:
            if not isinstance(item.name, str) or not item.name or not item.name.isprintable():
                raise ModelError(f"a {what} is named {item.name!r}, expected a printable text.")
    for what, items in (("link", links), ("joint", joints)):
        seen: dict[str, Any] = {}
        for item in items:
            if item.name in seen:
                first = seen[item.name].place.removesuffix(": ")
                where = f", first at {first}" if first else ""
                raise ModelError(
                    f"{item.place}{what} '{item.name}' is declared twice{where}. "
                    f"Give each {what} a name of its own."
                )
            seen[item.name] = item
    taken = {link.name for link in links}
    for frame in frames:
        if frame.link not in {link.name for link in links}:
            raise ModelError(
                f"frame '{frame.name}' is fixed to link '{frame.link}', which does not exist. "
                f"Links: {_listed(link.name for link in links)}."
            )
        if frame.name in taken:
            raise ModelError(f"frame '{frame.name}' has the name of another frame or link.")
        taken.add(frame.name)


def _check_joint(joint: Joint, links: set[str]) -> None:
    at = f"{joint.place}joint '{joint.name}'"
    if joint.kind not in KINDS:
        raise ModelError(f"{at} has type '{joint.kind}'; supported are {', '.join(KINDS)}.")
    for role, link in (("parent", joint.parent), ("child", joint.child)):
        if link not in links:
            raise ModelError(
                f"{at} has {role} link '{link}', which does not exist. Links: {_listed(links)}."
            )
    for what, pose in (("origin", joint.pose), ("child pose", joint.child_pose)):
        _check_pose(joint.place, f"joint '{joint.name}': {what}", pose)
    if joint.moves:
        _check_finite(joint.place, f"joint '{joint.name}': axis", joint.axis)
        norm = math.sqrt(sum(v * v for v in joint.axis))
        if norm < 1e-6:
            raise ModelError(
                f"{at} has axis {_vector(joint.axis)}, which has no direction. "
                f"Give it a unit vector such as 0 0 1."
            )
        if abs(norm - 1) > 1e-12:
            raise ModelError(f"{at} has axis {_vector(joint.axis)} of length {norm:g}, expected 1.")
    for what in ("armature", "viscous", "coulomb"):
        value = getattr(joint, what)
        if is_number(value) and not (math.isfinite(value) and (what != "armature" or value >= 0)):
            least = ", zero or more" if what == "armature" else ""
            raise ModelError(f"{at} has {what} {value:g}, expected a finite number{least}.")
    for what in ("lower", "upper", "velocity", "effort"):
        if math.isnan(getattr(joint, what)):
            raise ModelError(f"{at} has a limit '{what}' that is not a number.")


def _check_tree(name: str, links: Sequence[Link], joints: Sequence[Joint]) -> None:
    parent: dict[str, Joint] = {}
    for joint in joints:
        if joint.child in parent:
            raise ModelError(
                f"{joint.place}link '{joint.child}' is the child of joint "
                f"'{parent[joint.child].name}' and of joint '{joint.name}'. A robot is a tree: "
                f"closed loops are not supported, so remove one of the two."
            )
        parent[joint.child] = joint
    rooted: set[str] = set()  # links known to hang on a root
    for joint in joints:
        seen, link = {joint.child: None}, joint.parent  # a dict keeps the order
        while link in parent and link not in rooted:
            if link in seen:
                path = list(seen)
                loop = " - ".join([*path[path.index(link) :][::-1], path[-1]])
                raise ModelError(
                    f"{joint.place}the joints form a cycle through the links {loop}. "
                    f"A robot is a tree with one root link."
                )
            seen[link] = None
            link = parent[link].parent
        rooted.update(seen)
    roots = [link for link in links if link.name not in parent]
    if len(roots) > 1:
        raise ModelError(
            f"{roots[1].place}robot '{name}' falls apart: no joint leads to link "
            f"'{roots[1].name}', nor to '{roots[0].name}'. A robot is a tree with one root link; "
            f"add a joint that holds '{roots[1].name}'."
        )


def _check_mimics(joints: Sequence[Joint]) -> None:
    by_name = {joint.name: joint for joint in joints}
    led: set[str] = set()  # joints known to follow an independent one in the end
    for joint in joints:
        at, seen, follower = f"{joint.place}joint '{joint.name}'", {joint.name: None}, joint
        while (mimic := follower.mimic) is not None and follower.name not in led:
            if mimic.joint not in by_name:
                movable = _listed(j.name for j in joints if j.moves)
                raise ModelError(
                    f"{at} mimics joint '{mimic.joint}', which does not exist. Joints: {movable}. "
                    f"mimic=False leaves mimic joints independent."
                )
            if not by_name[mimic.joint].moves:
                raise ModelError(f"{at} mimics joint '{mimic.joint}', which is fixed.")
            if mimic.joint in seen:
                raise ModelError(f"{at} mimics itself: {' - '.join([*seen, mimic.joint])}.")
            _check_finite(
                joint.place, f"joint '{joint.name}': mimic", (mimic.multiplier, mimic.offset)
            )
            seen[mimic.joint] = None
            follower = by_name[mimic.joint]
        led.update(seen)


def _check_inertia(link: Link, inertia: Inertia) -> None:
    mass = inertia.mass
    if is_number(mass) and not (math.isfinite(mass) and mass >= 0):
        raise ModelError(
            f"{link.place}link '{link.name}' has mass {mass:g} kg, expected a finite number, "
            f"zero or more."
        )
    _check_finite(link.place, f"link '{link.name}': centre of mass", inertia.com)
    _check_finite(link.place, f"link '{link.name}': inertia", inertia.about_com)


def _check_moving_links_have_inertia(links: Sequence[Link], joints: Sequence[Joint]) -> None:
    """Each set of links that moves as one must say somewhere what it weighs."""
    by_name = {link.name: link for link in links}
    fixed: dict[str, list[str]] = {}
    for joint in joints:
        if not joint.moves:
            fixed.setdefault(joint.parent, []).append(joint.child)
    for joint in joints:
        if not joint.moves:
            continue
        group = [joint.child]
        for link in group:
            group.extend(fixed.get(link, []))
        if all(by_name[link].inertia is None for link in group):
            raise ModelError(
                f"{by_name[joint.child].place}link '{joint.child}', moved by joint "
                f"'{joint.name}', has no <inertial>. Give it its mass and inertia; where it is "
                f"meant to weigh nothing, say so with mass 0."
            )


def _check_finite(place: str, what: str, values: Sequence[Scalar]) -> None:
    for value in values:
        if is_number(value) and not math.isfinite(value):
            raise ModelError(f"{place}{what} holds {value:g}, expected finite numbers.")


def _check_pose(place: str, what: str, pose: Pose) -> None:
    _check_finite(place, what, pose.translation)
    for row in pose.rotation:
        _check_finite(place, what, row)


def _listed(names: Any) -> str:
    names = sorted(names)
    return ", ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")


def _vector(values: Sequence[Scalar]) -> str:
    return "(" + ", ".join(f"{v:g}" for v in values) + ")"


# -- what looks wrong -----------------------------------------------------------------------------

# the share of the largest moment by which rounded figures may break the triangle inequality
TRIANGLE_ROUNDING = 1e-6
# kg·m²: what a milligram has at a millimetre; less is a zero in disguise
NO_MOMENT = 1e-12


def suspicions(links: Sequence[Link], joints: Sequence[Joint]) -> Iterator[str]:
    """One sentence for each thing that loads but is probably not meant. Expects a valid tree."""
    mechanism = reduce(links, joints, (), (0.0, 0.0, 0.0))
    on_ground = {link for link, (body, _) in mechanism.frames.items() if body == GROUND}
    for link in links:
        if link.inertia is not None and link.name not in on_ground:
            yield from _suspicious_inertia(link, link.inertia)
    yield from _weightless(mechanism, {joint.name: joint for joint in joints})
    for joint in joints:
        if joint.lower > joint.upper:
            yield (
                f"{joint.place}joint '{joint.name}' has lower limit {joint.lower:g} above its "
                f"upper limit {joint.upper:g}."
            )
        for what in ("viscous", "coulomb", "velocity", "effort"):
            value = getattr(joint, what)
            if is_number(value) and value < 0:
                yield f"{joint.place}joint '{joint.name}' has negative {what} {value:g}."


def _weightless(mechanism: Mechanism, joints: dict[str, Joint]) -> Iterator[str]:
    """Joints that move no mass; in one sentence those that move nothing at all."""
    below = [(body.mass, *body.inertia, body.armature) for body in mechanism.bodies]
    nothing, no_mass = [], []
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        if all(is_number(v) and v == 0 for v in below[i]):
            nothing.append(joints[body.name])
        elif is_number(below[i][0]) and below[i][0] == 0:
            no_mass.append(joints[body.name])
        if body.parent != GROUND:
            sums = zip(below[body.parent], below[i], strict=True)
            below[body.parent] = tuple(a + b for a, b in sums)
    for joint in reversed(no_mass):
        yield f"{joint.place}the mass below moving joint '{joint.name}' is zero."
    if nothing:
        first, others = nothing[-1], len(nothing) - 1
        also = f" (and {others} other joint{'s' if others > 1 else ''})" if others else ""
        yield (
            f"{first.place}joint '{first.name}'{also} moves nothing that has mass or inertia: "
            f"M is singular and forward dynamics is undefined."
        )


def _suspicious_inertia(link: Link, inertia: Inertia) -> Iterator[str]:
    at = f"{link.place}link '{link.name}'"
    if not all(is_number(v) for v in (inertia.mass, *inertia.about_com)):
        return
    if inertia.mass == 0 and any(v != 0 for v in inertia.about_com):
        yield f"{at} has mass 0 but a rotational inertia, which still adds to M."
    import numpy as np

    moments = np.linalg.eigvalsh(np.array(inertia.matrix))
    shown = ", ".join(f"{v:.4g}" for v in moments)
    allowed = max(TRIANGLE_ROUNDING * abs(moments).max(), NO_MOMENT)
    if moments[0] < -allowed:
        yield (
            f"{at} has an inertia that no body can have: principal moments {shown} kg·m², "
            f"one of them negative."
        )
    elif moments[0] + moments[1] < moments[2] - allowed:
        yield (
            f"{at} has an inertia that no body can have: of its principal moments {shown} kg·m² "
            f"the largest exceeds the sum of the others."
        )
