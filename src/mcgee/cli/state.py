"""Joint positions and velocities as a user types them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mcgee.robot import Robot


@dataclass(frozen=True)
class State:
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    degrees: bool
    """Whether the user speaks of angles in degrees; q, qd and qdd are in radians all the same."""


def read_state(robot: Robot, q: str, qd: str, qdd: str = "", *, degrees: bool = False) -> State:
    """
    Raises: ValueError: not numbers, not n of them, or an unknown joint
    """
    turns = np.array([joint.kind != "prismatic" for joint in robot.independent_joints])
    unit = np.where(turns & degrees, math.pi / 180, 1.0)
    options = (("--q", q), ("--qd", qd), ("--qdd", qdd))
    values = [_numbers(robot, option, text) * unit for option, text in options]
    return State(values[0], values[1], values[2], degrees)


def as_shown(robot: Robot, degrees: bool) -> tuple[np.ndarray, list[tuple[str, str]]]:
    """What positions and velocities are multiplied with for people; units of position, effort."""
    turns = np.array([joint.kind != "prismatic" for joint in robot.independent_joints])
    angle = "deg" if degrees else "rad"
    units = [(angle, "N·m") if turn else ("m", "N") for turn in turns]
    return np.where(turns & degrees, 180 / math.pi, 1.0), units


def _numbers(robot: Robot, option: str, text: str) -> np.ndarray:
    """(n,) from '1,2,3' or 'joint=1,other=2'; zeros from nothing."""
    values = np.zeros(robot.n)
    parts = [part.strip() for part in text.strip().strip("[]()").split(",")]
    if parts == [""]:
        return values
    if any("=" in part for part in parts):
        given: set[str] = set()
        for part in parts:
            joint, equals, number = (piece.strip() for piece in part.rpartition("="))
            if not equals:
                raise ValueError(
                    f"{option} mixes '{part}' with names; give every joint by name, or none."
                )
            if joint in given:
                raise ValueError(f"{option} gives joint '{joint}' twice.")
            given.add(joint)
            if joint not in robot.joint_names:
                raise ValueError(
                    f"{option} names joint '{joint}', which robot '{robot.name}' has not. "
                    f"Joints: {', '.join(robot.joint_names)}."
                )
            values[robot.joint_names.index(joint)] = _number(option, number)
        return values
    if len(parts) != robot.n:
        raise ValueError(
            f"{option} has {len(parts)} number{'s' if len(parts) > 1 else ''}, expected {robot.n} "
            f"for robot '{robot.name}'. Joints: {', '.join(robot.joint_names)}."
        )
    return np.array([_number(option, part) for part in parts])


def _number(option: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(
            f"{option} holds '{text}', expected finite numbers separated by commas, "
            f"such as 0.5,0.3."
        )
    return value
