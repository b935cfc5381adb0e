"""Spatial textbook arms, from published Denavit-Hartenberg tables. The end is the frame 'tip'."""

from __future__ import annotations

import math
import warnings
from typing import Any

from mcgee.arms.planar import numbers
from mcgee.arms.textbook import textbook
from mcgee.errors import ModelWarning
from mcgee.formats.dh import from_dh
from mcgee.robot import Robot
from mcgee.scalar import Scalar

PI = math.pi
HALF = math.pi / 2
INCH = 0.0254


def _degrees(lower: float, upper: float) -> dict[str, float]:
    return {"lower": math.radians(lower), "upper": math.radians(upper)}


# -- SCARA ----------------------------------------------------------------------------------------


@textbook
def scara(
    m1: Scalar = 10.0,
    m2: Scalar = 6.0,
    m3: Scalar = 1.0,
    m4: Scalar = 0.5,
    l1: Scalar = 0.325,
    l2: Scalar = 0.275,
    d1: Scalar = 0.387,
    I4: Scalar = 0.001,
    g0: Scalar = 9.81,
) -> Robot:
    """A four-axis SCARA arm: two arms about the vertical, a quill that slides down, a wrist.

    Joints 3 and 4 point down: q3 > 0 lowers the quill, q4 turns about the downward axis. The arms
    are thin uniform rods and the quill, of mass m = m3 + m4 with the wrist, lies on its axis:
    M11 = (m1/3 + m2 + m) l1² + (m2 + 2 m) l1 l2 cos q2 + (m2/3 + m) l2² + I4, g3 = -m g0.

    Args:
        m1, m2, m3, m4: masses of the two arms, quill and wrist [kg]
        l1, l2: lengths of the arms [m]
        d1: height of the arms above the base [m]
        I4: inertia of the wrist about its axis [kg·m²]
        g0: gravity [m/s²]
    Source: geometry and limits: Adept Cobra 600, as in the Robotics Toolbox's Cobra600. Uniform
        rods: Tsai 1999, Robot Analysis, ex. 9.8.2. No source gives this arm's masses: the
        defaults are round figures of ours for its size.
    """
    m1, m2, m3, m4 = numbers(m1=m1, m2=m2, m3=m3, m4=m4)
    l1, l2, d1, I4, g0 = numbers(l1=l1, l2=l2, d1=d1, I4=I4, g0=g0)
    rows = [
        _uniform_rod(m1, l1) | {"d": d1} | _degrees(-50, 50),
        _uniform_rod(m2, l2) | {"alpha": PI} | _degrees(-88, 88),
        {"sigma": 1, "m": m3, "lower": 0.0, "upper": 0.210},
        {"m": m4, "I": (I4 / 2, I4 / 2, I4)},
    ]
    return from_dh(rows, name="scara", gravity_vector=(0, 0, -g0))


def _uniform_rod(m: Scalar, length: Scalar) -> dict[str, Any]:
    """A thin rod from the DH frame before to this one."""
    i = m * length * length / 12
    return {"a": length, "m": m, "r": (-length / 2, 0, 0), "I": (0, i, i)}


# -- Stanford arm ---------------------------------------------------------------------------------

# theta, d, alpha, sigma | m [kg], centre of mass [cm], I about the frame's origin [kg·m²] | drive
STANFORD: list[tuple[Any, ...]] = [
    (0, 0.412, -HALF, 0, 9.29, (0, 1.75, -11.05), (0.276, 0.255, 0.071), 0.953),
    (0, 0.154, HALF, 0, 5.01, (0, -10.54, 0), (0.108, 0.018, 0.100), 2.193),
    (-HALF, 0, 0, 1, 4.25, (0, 0, -64.47), (2.51, 2.51, 0.006), 0.782),
    (0, 0, -HALF, 0, 1.08, (0, 0.92, -0.54), (0.002, 0.001, 0.001), 0.106),
    (0, 0, HALF, 0, 0.63, (0, 0, 5.66), (0.003, 0.003, 0.0004), 0.097),
    (0, 0, 0, 0, 0.51, (0, 0, 15.54), (0.013, 0.013, 0.0003), 0.020),
]
STANFORD_LIMITS = [
    *(_degrees(-170, 170),) * 2,
    {"lower": 12 * INCH, "upper": 50 * INCH},
    _degrees(-170, 170),
    _degrees(-90, 90),
    _degrees(-170, 170),
]


def stanford() -> Robot:
    """The Stanford arm of Scheinman: two revolute joints, a prismatic one, a wrist.

    The figures are read as centimetres and as inertias about the origins of the link frames, of
    which the wrist's three share the wrist's centre, and moved to the centres of mass here; the
    tip lies 0.263 m out. The Robotics Toolbox's model of this arm instead has the centres of mass
    of links 2 to 6 ten times as far out (link 3's at 6.4 m), inertias as about the centres of
    mass, and link 6's frame at the tip. With our reading M_ii ranges as Bejczy found it, from
    1.4, 3.5, 7.25, 0.108 and 0.113 upwards; with the other, M22 reaches 170 kg·m².
    Armatures are the drives' reflected inertias, joint 3's in kg.

    Source: kinematics: Paul 1972, Stanford AIM-177, fig. 2.3. Dynamics: Paul 1981, Robot
        Manipulators, tables 6.4 to 6.6, after Bejczy 1974, JPL TM 33-669; the figures by way of
        the Robotics Toolbox. Limits: Dobrotin & Scheinman 1973; the stroke is Corke's estimate.
    """
    rows = []
    for cells, limits in zip(STANFORD, STANFORD_LIMITS, strict=True):
        theta, d, alpha, sigma, m, centimetres, about_origin, drive = cells
        r = tuple(v / 100 for v in centimetres)
        row = {"theta": theta, "d": d, "alpha": alpha, "sigma": sigma, "armature": drive}
        rows.append(row | {"m": m, "r": r, "I": _about_com(m, r, about_origin)} | limits)
    tool: list[list[float]] = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.263], [0, 0, 0, 1]]
    return from_dh(rows, tool=tool, name="stanford")


def _about_com(m: float, r: tuple[float, ...], about_origin: tuple[float, ...]) -> list[Any]:
    """The tensor about the centre of mass from the diagonal one about the origin."""
    rr = sum(v * v for v in r)
    return [
        [(about_origin[i] - m * rr if i == j else 0.0) + m * r[i] * r[j] for j in range(3)]
        for i in range(3)
    ]


# -- PUMA 560 -------------------------------------------------------------------------------------

# d, a, alpha | m [kg], centre of mass [m], I about it [kg·m²]
PUMA560: list[tuple[Any, ...]] = [
    (0, 0, HALF, 0, (0, 0, 0), (0.175, 0.35, 0.175)),
    (0, 0.4318, 0, 17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539)),
    (0.15005, 0.0203, -HALF, 4.8, (-0.0203, -0.0141, 0.070), (0.066, 0.086, 0.0125)),
    (0.4318, 0, HALF, 0.82, (0, 0.019, 0), (1.8e-3, 1.3e-3, 1.8e-3)),
    (0, 0, -HALF, 0.34, (0, 0, 0), (0.3e-3, 0.4e-3, 0.3e-3)),
    (0, 0, 0, 0.09, (0, 0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3)),
]
# Jm [kg·m²], G, B [N·m·s/rad], Tc in the two directions [N·m], all at the motor | limits
PUMA560_DRIVES: list[tuple[Any, ...]] = [
    (200e-6, -62.6111, 1.48e-3, (0.395, 0.435), _degrees(-160, 160)),
    (200e-6, 107.815, 0.817e-3, (0.126, 0.071), _degrees(-45, 225)),
    (200e-6, -53.7063, 1.38e-3, (0.132, 0.105), _degrees(-225, 45)),
    (33e-6, 76.0364, 71.2e-6, (11.2e-3, 16.9e-3), _degrees(-110, 170)),
    (33e-6, 71.923, 82.6e-6, (9.26e-3, 14.5e-3), _degrees(-100, 100)),
    (33e-6, 76.686, 36.7e-6, (3.96e-3, 10.5e-3), _degrees(-266, 266)),
]


def puma560() -> Robot:
    """The Unimation PUMA 560, with its drives, in standard Denavit-Hartenberg frames.

    The zero pose is the 'L': upper arm along x, forearm up. Frame 0 is at the height of the
    shoulder, 0.672 m above the floor. Armature is Jm G², viscous friction B G², Coulomb friction
    |G| times the mean of the two directions' Tc.

    Of link 1 only the inertia about joint 1, 0.35 kg·m², was measured, and only it can be felt. Its
    mass is 0, as in the sources, and its other two moments, 0 there, are half of that, the least
    that a body can have. Link 3's measured tensor (0.066, 0.086, 0.0125) breaks the triangle
    inequality; it is kept, and said in the robot's `warnings`. Kept too: Corke has link 4's centre
    of mass 19 mm beyond the wrist, the 1986 paper as far before it (0.3 N·m at joints 2 and 3).

    Source: Armstrong, Khatib & Burdick 1986, The explicit dynamic model and inertial parameters
        of the PUMA 560 arm, ICRA; in these frames and with the drives: Corke &
        Armstrong-Hélouvry 1994, A search for consensus among model parameters reported for the
        PUMA 560 robot, ICRA, by way of the Robotics Toolbox. Limits: Wang & Chen 1991, IEEE
        Trans. RA 7(4).
    """
    rows = []
    for link, drive in zip(PUMA560, PUMA560_DRIVES, strict=True):
        row = dict(zip(("d", "a", "alpha", "m", "r", "I"), link, strict=True))
        Jm, G, B, Tc, limits = drive
        friction = {"viscous": B * G * G, "coulomb": abs(G) * sum(Tc) / 2}
        rows.append(row | {"armature": Jm * G * G} | friction | limits)
    with warnings.catch_warnings():
        # what looks wrong is said above and stays in the robot's `warnings`
        warnings.simplefilter("ignore", ModelWarning)
        return from_dh(rows, name="puma560")
