"""Arms with their parameters and the sources of these, by function and by name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from mcgee.arms.planar import (
    acrobot,
    cart_pole,
    inertia_wheel_pendulum,
    pendubot,
    pendulum,
    planar_2r,
    planar_nr,
)
from mcgee.arms.spatial import puma560, scara, stanford
from mcgee.arms.textbook import symbolic
from mcgee.robot import Robot

__all__ = [
    "BUILTIN",
    "acrobot",
    "cart_pole",
    "inertia_wheel_pendulum",
    "panda",
    "pendubot",
    "pendulum",
    "planar_2r",
    "planar_3r",
    "planar_nr",
    "puma560",
    "scara",
    "stanford",
    "symbolic",
    "ur5e",
]


def planar_3r() -> Robot:
    """planar_nr(3): three joints and a plane's three freedoms."""
    return planar_nr(3)


def panda() -> Robot:
    """The Franka Emika Panda, 7 joints; sources in mcgee/robots/panda.urdf."""
    return _shipped("panda")


def ur5e() -> Robot:
    """The Universal Robots UR5e, 6 joints; sources in mcgee/robots/ur5e.urdf."""
    return _shipped("ur5e")


def _shipped(name: str) -> Robot:
    from mcgee.formats.urdf import read_urdf  # its XML parser only where one is read

    return read_urdf(Path(__file__).parents[1] / "robots" / f"{name}.urdf")


BUILTIN: dict[str, Callable[[], Robot]] = {
    "pendulum": pendulum,
    "planar_2r": planar_2r,
    "planar_3r": planar_3r,
    "acrobot": acrobot,
    "pendubot": pendubot,
    "cart_pole": cart_pole,
    "inertia_wheel_pendulum": inertia_wheel_pendulum,
    "scara": scara,
    "stanford": stanford,
    "puma560": puma560,
    "panda": panda,
    "ur5e": ur5e,
}
"""The arms that `mcgee.load` knows by name, with their default parameters."""
