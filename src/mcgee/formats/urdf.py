"""URDF → Robot: links, inertias and joints; no mesh is ever needed or read.

The physics is read as the file says it, but for two roundings: a rounded multiple of pi/12 is that
angle (`scalar.read_angle`), and a component below `DUST` is zero.

Source: https://wiki.ros.org/urdf/XML; where it is silent, urdfdom's urdf_parser.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace
from typing import Any, NamedTuple

from lxml import etree

from mcgee.errors import ModelError
from mcgee.formats.described import described
from mcgee.formats.xml import Node, Remarks, expand_xacro, parse, read_file, shown
from mcgee.model import KINDS, ORIGIN, Inertia, Joint, Link, Mimic, Pose, Vec3
from mcgee.robot import Robot
from mcgee.scalar import read_angle
from mcgee.validate import MOST

# Below what doubles resolve beside lengths of order one: the 6.1e-17 that cos(pi/2) leaves in
# exported axes, angles and offsets. Taken literally it costs operations where a zero belongs.
DUST = 1e-14
# A unit vector rounded to three decimals is this far from length one at most (sqrt(3) * 0.0005).
AXIS_ROUNDING = 1e-3

READ = {
    "robot": {"link", "joint"},
    "link": {"inertial"},
    "inertial": {"origin", "mass", "inertia"},
    "joint": {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"},
    "origin": {"xyz", "rpy"},
    "axis": {"xyz"},
    "limit": {"lower", "upper", "velocity", "effort"},
    "dynamics": {"damping", "friction"},
    "mimic": {"joint", "multiplier", "offset"},
    "parent": {"link"},
    "child": {"link"},
    "mass": {"value"},
    "inertia": {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"},
}
"""The elements in an element, and the attributes of those that have no elements, that we read."""

HOLDERS = ("robot", "link", "inertial", "joint")

IRRELEVANT = {
    "robot": {"material", "gazebo", "transmission", "sensor", "ros2_control", "mujoco", "group"}
    | {"self_collision_checking", "disable_collisions", "verbose"},
    "link": {"visual", "collision", "material", "gazebo", "sensor", "contact", "surface", "verbose"}
    | {"contact_coefficients", "collision_checking", "self_collision_checking", "self_filter"},
    "joint": {"safety_controller", "calibration", "gazebo", "sensor", "hardwareInterface"}
    | {"verbose"},
    "limit": {"command_effort", "current", "gear_velocity", "acceleration", "deceleration", "jerk"},
    "dynamics": {"D", "K", "mu_coulomb", "mu_viscous", "spring_stiffness", "spring_reference"},
}
"""Looks, contacts, drivers and simulators: what files carry besides, passed over in silence."""

SAYS_NOTHING = {"gravity": {"1", "true"}, "kinematic": {"0", "false"}}
"""SDF's switches that stray into URDF links, and their defaults."""


class Description(NamedTuple):
    """What a file says, before it is checked as a whole."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    remarks: tuple[str, ...]


def read_urdf(path: str | os.PathLike[str], mimic: bool = True) -> Robot:
    """The robot that a URDF file describes.

    Args:
        path: the file; messages start with its base name and the line
        mimic: False leaves joints that mimic another independent
    Raises: ModelError: the file cannot be read, or does not describe a usable robot
    Warns: ModelWarning: what loads but is probably not meant
    """
    name, links, joints, remarks = describe_file(path, mimic)
    return described(name, links, joints, remarks=remarks)


def parse_urdf(text: str | bytes, source: str = "<string>", mimic: bool = True) -> Robot:
    """The robot that a URDF text describes; source names it in messages. Else as `read_urdf`."""
    name, links, joints, remarks = describe(text, source, mimic)
    return described(name, links, joints, remarks=remarks)


def describe_file(path: str | os.PathLike[str], mimic: bool = True) -> Description:
    """What `read_urdf` hands to `described`."""
    file = os.path.basename(os.fsdecode(path))
    if file.lower().endswith(".xacro"):
        raise ModelError(f"{shown(os.fsdecode(path))} is a xacro file. {expand_xacro(file)}")
    return describe(read_file(path), file, mimic)


def describe(text: str | bytes, source: str, mimic: bool = True) -> Description:
    """What `parse_urdf` hands to `described`."""
    root, remarks = parse(text, source), Remarks()
    _check_is_urdf(root)
    if not root.all("link"):
        raise root.error("has no <link>. Describe at least a base and a moving link.")
    for what in ("link", "joint"):
        if len(root.all(what)) > MOST:
            raise root.error(f"has {len(root.all(what))} <{what}>; at most {MOST} are read.")
    name = root.name("name")
    _skip_unread(root, remarks)
    links = tuple(_link(node, remarks) for node in root.all("link"))
    joints = tuple(_joint(node, remarks) for node in root.all("joint"))
    if not mimic:
        joints = tuple(replace(joint, mimic=None) for joint in joints)
    return Description(name, links, joints, remarks.sentences())


def _check_is_urdf(root: Node) -> None:
    other = {"mujoco": "MuJoCo's MJCF", "sdf": "SDF"}.get(root.tag)
    if other is not None:
        raise root.error(f"is {other}, which is not read yet. URDF is: convert it, root <robot>.")
    if root.tag != "robot":
        raise root.error("is the root element, expected <robot>.")
    for element in root.element.iter(etree.Element):
        if element.prefix == "xacro" or "/xacro" in (etree.QName(element).namespace or ""):
            raise replace(root, element=element).error(f"is not expanded. {expand_xacro()}")


def _skip_unread(node: Node, remarks: Remarks) -> None:
    """Remark on what is neither read nor known to be irrelevant."""
    known = READ[node.tag] | IRRELEVANT.get(node.tag, set())
    if node.tag in HOLDERS:
        for child in node.children():
            says_nothing = (child.element.text or "").strip() in SAYS_NOTHING.get(child.tag, ())
            if child.tag not in known and not says_nothing:
                remarks.add(f"{node.tag} {child.tag}", child, "is not read: skipped.")
    else:
        for name in node.attributes():
            if name not in known:
                sentence = f"has {shown(name)}, which is not read: skipped."
                remarks.add(f"{node.tag} {name}", node, sentence)


# -- links ----------------------------------------------------------------------------------------


def _link(node: Node, remarks: Remarks) -> Link:
    name = node.name("name")
    node = node.named(f"link '{name}'")
    _skip_unread(node, remarks)
    inertial = node.only("inertial")
    return Link(name, None if inertial is None else _inertia(inertial, remarks), node.place)


def _inertia(node: Node, remarks: Remarks) -> Inertia:
    _skip_unread(node, remarks)
    mass, inertia = node.one("mass"), node.one("inertia")
    for part in (mass, inertia):
        _skip_unread(part, remarks)
    products = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    about_com = tuple(inertia.number(name) for name in products)
    pose = _pose(node.only("origin"), remarks)
    return Inertia(mass.number("value"), ORIGIN, about_com).seen_from(pose)


# -- joints ---------------------------------------------------------------------------------------


def _joint(node: Node, remarks: Remarks) -> Joint:
    name = node.name("name")
    node = node.named(f"joint '{name}'")
    kind = node.text("type")
    if kind not in KINDS:
        hint = {
            "floating": " Robots stand on a fixed base here: make the joint fixed, or remove it.",
            "planar": " Write two prismatic joints and a continuous one instead.",
        }.get(kind, "")
        raise node.error(f"has type {shown(kind)}, expected {', '.join(KINDS)}.{hint}")
    _skip_unread(node, remarks)
    ends = node.one("parent"), node.one("child")
    for end in ends:
        _skip_unread(end, remarks)
    parent, child = (end.name("link") for end in ends)
    pose = _pose(node.only("origin"), remarks)
    joint = Joint(name, kind, parent, child, pose, place=node.place)  # type: ignore[arg-type]
    if kind == "fixed":  # exporters leave axes of length zero and the like in these
        return joint
    return replace(
        joint,
        axis=_axis(node.only("axis"), remarks),
        mimic=_mimic(node.only("mimic"), remarks),
        **_limits(node, kind, remarks),
        **_friction(node.only("dynamics"), remarks),
    )


def _pose(node: Node | None, remarks: Remarks) -> Pose:
    if node is None:
        return Pose()
    if "quat_xyzw" in node.attributes():
        raise node.error("has quat_xyzw, which is not read. Write the rotation as rpy.")
    _skip_unread(node, remarks)
    rpy = []
    for word in node.words("rpy", 3, "0 0 0"):
        angle, remark = read_angle(word)
        if remark:
            remarks.add("angle", node, f"rpy: {remark}.")
        rpy.append(_without_dust(angle))
    return Pose.from_rpy(rpy, [_without_dust(float(w)) for w in node.words("xyz", 3, "0 0 0")])


def _axis(node: Node | None, remarks: Remarks) -> Vec3:
    """A unit vector; what has no direction is left for `validate` to refuse."""
    if node is None:
        return (1.0, 0.0, 0.0)
    _skip_unread(node, remarks)
    x, y, z = (float(word) for word in node.words("xyz", 3))
    norm = math.hypot(x, y, z)
    if not 1e-6 <= norm < math.inf:
        return x, y, z
    if abs(norm - 1) > AXIS_ROUNDING:
        written = shown(node.text("xyz"))
        remarks.add(
            "axis", node, f"has xyz {written} of length {norm:.6g}: taken as a unit vector."
        )
    return _without_dust(x / norm), _without_dust(y / norm), _without_dust(z / norm)


def _without_dust(x: float) -> float:
    return x if abs(x) >= DUST else 0.0


def _limits(joint: Node, kind: str, remarks: Remarks) -> dict[str, Any]:
    """Limits, infinite where none is set.

    URDF's default for one absent bound is 0. Taken for both it would lock the joint, so we do not.
    """
    node, bounded = joint.only("limit"), kind != "continuous"
    if node is None:
        if bounded:
            remarks.add("limit", joint, "has no <limit>: taken as unlimited.")
        return {}
    _skip_unread(node, remarks)
    written = node.attributes()
    read = dict.fromkeys(("velocity", "effort"), "inf")
    if bounded and ("lower" in written or "upper" in written):
        read |= {"lower": "0", "upper": "0"}
    absent = [name for name in ("velocity", "effort") if name not in written]
    absent += ["lower", "upper"] if "lower" not in read else []
    if bounded and absent:
        missing = ", ".join(absent)
        remarks.add(missing, node, f"does not set {missing}: taken as unlimited.")
    return {name: node.number(name, default, infinite=True) for name, default in read.items()}


def _friction(node: Node | None, remarks: Remarks) -> dict[str, Any]:
    if node is None:
        return {}
    _skip_unread(node, remarks)
    return {"viscous": node.number("damping", "0"), "coulomb": node.number("friction", "0")}


def _mimic(node: Node | None, remarks: Remarks) -> Mimic | None:
    if node is None:
        return None
    _skip_unread(node, remarks)
    return Mimic(node.name("joint"), node.number("multiplier", "1"), node.number("offset", "0"))
