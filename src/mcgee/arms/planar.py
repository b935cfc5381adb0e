"""Planar textbook arms. Every parameter takes a number or a SymPy expression.

They move in the x-y plane, joints about z. plane='vertical': y is up, gravity is (0, -g0, 0).
plane='horizontal': z is up, gravity is (0, 0, -g0) and does no work. angle_from='horizontal': at
q = 0 the arm lies along x, to the right. angle_from='down': at q = 0 it hangs along -y. Angles
grow counterclockwise. A planar inertia I, about the z axis through the centre of mass, becomes the
tensor diag(0, I, I) of a thin rod along x, which a body can have. The end is the frame 'tip'.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from mcgee.arms.textbook import textbook
from mcgee.errors import ModelError
from mcgee.formats.described import described
from mcgee.formats.dh import read_number
from mcgee.model import Frame, Inertia, Joint, Link, Pose, Vec3, is_number
from mcgee.robot import Robot
from mcgee.scalar import Scalar

UPRIGHT = math.pi / 2
HANGING = -math.pi / 2
UNITS = {"m": "[kg]", "l": "[m]", "d": "[m]", "I": "[kg·m²]", "g": "[m/s²]"}
"""Of a parameter, by its first letter."""


@textbook
def pendulum(
    m: Scalar = 1.0,
    l: Scalar = 1.0,
    lc: Scalar = 0.5,
    I: Scalar = 0.1,
    g0: Scalar = 9.81,
    plane: str = "vertical",
    angle_from: str = "down",
) -> Robot:
    """A single pendulum.

    From the downward vertical: M = I + m lc², P = m g0 lc (1 - cos q), g = m g0 lc sin q. P is
    zero at q = 0 because the pivot stands lc above the origin; from the horizontal it is at it.

    Args:
        m: mass [kg]
        l: distance of the tip from the pivot [m]
        lc: distance of the centre of mass from the pivot [m]
        I: inertia about the centre of mass [kg·m²]
        g0: gravity [m/s²]
        plane: 'vertical' or 'horizontal'
        angle_from: what q = 0 means, 'down' or 'horizontal'
    Source: Spong, Hutchinson & Vidyasagar 2006, Robot Modeling and Control, sec. 7.1. The default
        figures are round ones of ours.
    """
    hangs = plane == "vertical" and angle_from == "down"
    pivot = Pose.at(y=read_number(lc, "lc", "[m]")) if hangs else Pose()
    return _planar("pendulum", [(m, l, lc, I)], g0, plane, angle_from, pivot)


@textbook
def planar_2r(
    m1: Scalar = 1.0,
    m2: Scalar = 1.0,
    l1: Scalar = 1.0,
    lc1: Scalar = 0.5,
    lc2: Scalar = 0.5,
    I1: Scalar = 0.1,
    I2: Scalar = 0.1,
    g0: Scalar = 9.81,
    plane: str = "vertical",
    angle_from: str = "horizontal",
    l2: Scalar = 1.0,
) -> Robot:
    """The planar arm with two revolute joints; q2 = 0 stretches it.

    M11 = I1 + I2 + m1 lc1² + m2 (l1² + lc2² + 2 l1 lc2 cos q2), and so on; from the horizontal
    g2 = m2 lc2 g0 cos(q1 + q2), from the downward vertical sin in its place.

    Args:
        m1, m2: masses [kg]
        l1, l2: lengths [m]; l2 only places the tip
        lc1, lc2: distances of the centres of mass from the own joint [m]
        I1, I2: inertias about the centres of mass [kg·m²]
        g0: gravity [m/s²]
        plane: 'vertical' or 'horizontal'
        angle_from: what q = 0 means, 'horizontal' or 'down'
    Source: Spong, Hutchinson & Vidyasagar 2006, sec. 7.3 (equations). The default figures are
        round ones for teaching, not of a built arm.
    """
    rods = [(m1, l1, lc1, I1), (m2, l2, lc2, I2)]
    return _planar("planar_2r", rods, g0, plane, angle_from)


@textbook
def planar_nr(
    n: int,
    m: Scalar | Iterable[Scalar] = 1.0,
    l: Scalar | Iterable[Scalar] = 1.0,
    lc: Scalar | Iterable[Scalar] = 0.5,
    I: Scalar | Iterable[Scalar] = 0.1,
    g0: Scalar = 9.81,
    plane: str = "vertical",
    angle_from: str = "horizontal",
) -> Robot:
    """The planar arm with n revolute joints, each angle relative to the link before.

    Args:
        n: number of joints
        m: mass [kg], one for all links or a sequence of n; so for l, lc and I
        l: length [m]
        lc: distance of the centre of mass from the own joint [m]
        I: inertia about the centre of mass [kg·m²]
        g0: gravity [m/s²]
        plane: 'vertical' or 'horizontal'
        angle_from: what q = 0 means, 'horizontal' or 'down'
    Source: the chain of planar_2r continued; the default figures are its.
    """
    if not isinstance(n, int) or n < 1:
        raise ModelError(f"n is {n!r}, expected a whole number of joints, one or more.")
    columns = [_each(v, n, what) for v, what in ((m, "m"), (l, "l"), (lc, "lc"), (I, "I"))]
    return _planar(f"planar_{n}r", zip(*columns, strict=True), g0, plane, angle_from)


@textbook
def acrobot(
    m1: Scalar = 1.0,
    m2: Scalar = 1.0,
    l1: Scalar = 1.0,
    l2: Scalar = 2.0,
    lc1: Scalar = 0.5,
    lc2: Scalar = 1.0,
    I1: Scalar = 0.083,
    I2: Scalar = 0.33,
    g0: Scalar = 9.8,
    angle_from: str = "horizontal",
) -> Robot:
    """The planar 2R arm with a motor at the elbow only: the shoulder's effort limit is 0.

    Spong's angles: q1 from the horizontal, so it hangs at (-pi/2, 0). Drake takes the same arm
    with g0=9.81, angle_from='down'; Gymnasium's Acrobot is
    acrobot(l2=1, lc2=0.5, I1=1, I2=1, angle_from='down').

    Args: as for planar_2r
    Source: Spong 1995, The swing up control problem for the acrobot, IEEE Control Systems
        Magazine 15(1): equations and figures
    """
    rods = [(m1, l1, lc1, I1), (m2, l2, lc2, I2)]
    return _planar("acrobot", rods, g0, "vertical", angle_from, passive=1)


@textbook
def pendubot(
    m1: Scalar = 1.0,
    m2: Scalar = 1.0,
    l1: Scalar = 1.0,
    l2: Scalar = 1.0,
    lc1: Scalar = 0.5,
    lc2: Scalar = 0.5,
    I1: Scalar = 0.1,
    I2: Scalar = 0.1,
    g0: Scalar = 9.81,
    angle_from: str = "horizontal",
) -> Robot:
    """The planar 2R arm with a motor at the shoulder only: the elbow's effort limit is 0.

    Args: as for planar_2r
    Source: Spong & Block 1995, The Pendubot: a mechatronic system for control research and
        education (equations). The default figures are those of planar_2r, not of a built arm.
    """
    rods = [(m1, l1, lc1, I1), (m2, l2, lc2, I2)]
    return _planar("pendubot", rods, g0, "vertical", angle_from, passive=2)


@textbook
def inertia_wheel_pendulum(
    m1: Scalar = 1.0,
    m2: Scalar = 1.0,
    l1: Scalar = 1.0,
    lc1: Scalar = 0.5,
    I1: Scalar = 0.1,
    I2: Scalar = 0.2,
    g0: Scalar = 9.81,
    angle_from: str = "up",
) -> Robot:
    """A pendulum without a motor (its effort limit is 0), and at its end a balanced wheel with one.

    M = [[m1 lc1² + m2 l1² + I1 + I2, I2], [I2, I2]] is the same everywhere, C = 0. 'up': q1 = 0
    stands, P = (m1 lc1 + m2 l1) g0 cos q1; 'down': q1 = 0 hangs. q2 is the wheel's angle relative
    to the pendulum; both grow counterclockwise.

    Args:
        m1, m2: masses of pendulum and wheel [kg]
        l1: distance of the wheel's axle from the pivot [m]
        lc1: distance of the pendulum's centre of mass from the pivot [m]
        I1, I2: inertias about the centres of mass [kg·m²]
        g0: gravity [m/s²]
        angle_from: 'up' or 'down'
    Source: Spong, Corke & Lozano 2001, Nonlinear control of the reaction wheel pendulum,
        Automatica 37 (equations). The default figures are round ones of ours.
    """
    _one_of("angle_from", angle_from, ("up", "down"))
    m1, m2, l1, lc1, I1, I2, g0 = numbers(m1=m1, m2=m2, l1=l1, lc1=lc1, I1=I1, I2=I2, g0=g0)
    pivot = Pose.about("z", UPRIGHT if angle_from == "up" else HANGING)
    disc = Inertia(m2, about_com=(I2 / 2, 0.0, 0.0, I2 / 2, 0.0, I2))
    links = Link("base"), Link("pendulum", _rod(m1, lc1, I1)), Link("wheel", disc)
    joints = (
        Joint("pivot", "revolute", "base", "pendulum", pose=pivot, effort=0.0),
        Joint("axle", "revolute", "pendulum", "wheel", pose=Pose.at(x=l1)),
    )
    tip = Frame("tip", "pendulum", Pose.at(x=l1))
    return described("inertia_wheel_pendulum", links, joints, (tip,), (0.0, -g0, 0.0))


@textbook
def cart_pole(
    mc: Scalar = 1.0,
    mp: Scalar = 0.1,
    lc: Scalar = 0.5,
    I: Scalar | None = None,
    g0: Scalar = 9.8,
    angle_from: str = "up",
) -> Robot:
    """A cart on the x axis, y up, and on it a pole without a motor: its effort limit is 0.

    'up': q2 = 0 stands, q2 > 0 leans to +x, clockwise; g2 = -mp g0 lc sin q2.
    'down': q2 = 0 hangs, q2 > 0 swings to +x, counterclockwise; g2 = mp g0 lc sin q2.
    In both M = [[mc + mp, mp lc cos q2], [., I + mp lc²]], C qd = [-mp lc qd2² sin q2, 0].

    Args:
        mc, mp: masses of cart and pole [kg]
        lc: distance of the pole's centre of mass from the pivot, half the pole's length [m]
        I: inertia of the pole about its centre of mass [kg·m²]; None: mp lc²/3, a uniform pole
        g0: gravity [m/s²]
        angle_from: 'up' or 'down'
    Source: 'up' and the figures: Barto, Sutton & Anderson 1983, IEEE Trans. SMC 13(5), appendix
        (the uniform pole is its factor 4/3); Florian 2007, Correct equations for the dynamics of
        the cart-pole system. 'down': Tedrake, Underactuated Robotics, ch. 3, where I = 0.
    """
    _one_of("angle_from", angle_from, ("up", "down"))
    mc, mp, lc, g0 = numbers(mc=mc, mp=mp, lc=lc, g0=g0)
    (I,) = numbers(I=mp * lc * lc / 3 if I is None else I)
    links = Link("base"), Link("cart", Inertia(mc)), Link("pole", _rod(mp, lc, I))
    start, sense = (UPRIGHT, -1.0) if angle_from == "up" else (HANGING, 1.0)
    pose, axis = Pose.about("z", start), (0.0, 0.0, sense)
    joints = (
        Joint("cart", "prismatic", "base", "cart", axis=(1.0, 0.0, 0.0)),
        Joint("pole", "revolute", "cart", "pole", pose=pose, axis=axis, effort=0.0),
    )
    tip = Frame("tip", "pole", Pose.at(x=2 * lc))
    return described("cart_pole", links, joints, (tip,), (0.0, -g0, 0.0))


def _planar(
    name: str,
    rods: Iterable[tuple[Scalar, ...]],
    g0: Scalar,
    plane: str,
    angle_from: str,
    pivot: Pose | None = None,
    passive: int | None = None,
) -> Robot:
    """A chain of rods (m, l, lc, I), each along its x, turning about z.

    passive: the joint that has no motor
    """
    _one_of("plane", plane, ("vertical", "horizontal"))
    _one_of("angle_from", angle_from, ("horizontal", "down"))
    (g0,) = numbers(g0=g0)
    gravity: Vec3 = (0.0, -g0, 0.0) if plane == "vertical" else (0.0, 0.0, -g0)
    pose = (pivot or Pose()) @ (Pose.about("z", HANGING) if angle_from == "down" else Pose())
    links, joints = [Link("base")], []
    for k, (m, l, lc, I) in enumerate(rods, 1):
        m, l, lc, I = numbers(k, m=m, l=l, lc=lc, I=I)
        links.append(Link(f"link{k}", _rod(m, lc, I)))
        effort = 0.0 if k == passive else math.inf
        parent = links[k - 1].name
        joints.append(Joint(f"joint{k}", "revolute", parent, f"link{k}", pose=pose, effort=effort))
        pose = Pose.at(x=l)
    tip = Frame("tip", links[-1].name, pose)
    return described(name, tuple(links), tuple(joints), (tip,), gravity)


def _rod(m: Scalar, lc: Scalar, I: Scalar) -> Inertia:
    return Inertia(m, (lc, 0.0, 0.0), (0.0, 0.0, 0.0, I, 0.0, I))


def numbers(link: int | None = None, **values: Any) -> list[Scalar]:
    """The values as floats or symbols; masses and inertias not negative."""
    found = []
    for key, value in values.items():
        what = key if link is None else f"link {link}: {key}"
        number = read_number(value, what, UNITS[key[0]])
        if key[0] in "mI" and is_number(number) and number < 0:
            raise ModelError(f"{what} is {number:g}, expected zero or more {UNITS[key[0]]}.")
        found.append(number)
    return found


def _each(value: Any, n: int, what: str) -> list[Any]:
    values = list(value) if isinstance(value, Iterable) and not isinstance(value, str) else value
    if not isinstance(values, list):
        return [values] * n
    if len(values) != n:
        raise ModelError(f"{what} has {len(values)} values, expected one or n = {n}.")
    return values


def _one_of(what: str, value: Any, options: tuple[str, str]) -> None:
    if value not in options:
        raise ModelError(f"{what} is {value!r}, expected '{options[0]}' or '{options[1]}'.")
