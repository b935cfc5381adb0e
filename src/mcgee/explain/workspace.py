"""How M and g change while one or two joints move and the others stay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mcgee.explain.gravity import ranges
from mcgee.explain.inertia import Array
from mcgee.robot import Robot


@dataclass(frozen=True, eq=False)
class Sweep:
    """M, g and what follows from them on a grid of one joint's positions, or of two."""

    joints: tuple[str, ...]
    at: tuple[Array, ...]
    """The grid's positions of each swept joint [rad | m]."""
    q: Array
    """(..., n), one leading dimension for each swept joint"""
    M: Array
    """(..., n, n)"""
    g: Array
    """(..., n)"""
    condition: Array
    """Of M (...)"""

    def extremes(self, values: Array) -> tuple[tuple[float, Array], tuple[float, Array]]:
        """((least, where), (most, where)) of a quantity on the grid (...), where being q (n,)."""
        flat, poses = values.ravel(), self.q.reshape(-1, self.q.shape[-1])
        low, high = int(flat.argmin()), int(flat.argmax())
        return (float(flat[low]), poses[low]), (float(flat[high]), poses[high])


def sweep(robot: Robot, q: Array, joints: Sequence[str], points: int = 73) -> Sweep:
    """Move one or two joints over their ranges, the others staying at q.

    Args:
        q: joint positions (n,)
        joints: one or two joint names
    Raises: ValueError: an unknown joint, or not one or two of them
    """
    if not 1 <= len(joints) <= 2:
        raise ValueError(f"sweep takes one or two joints, got {len(joints)}.")
    for name in joints:
        if name not in robot.joint_names:
            raise ValueError(
                f"sweep names joint '{name}', which robot '{robot.name}' has not. "
                f"Joints: {', '.join(robot.joint_names)}."
            )
    lower, upper = ranges(robot, q)
    moved = [robot.joint_names.index(name) for name in joints]
    at = tuple(np.linspace(lower[i], upper[i], points) for i in moved)
    poses = np.broadcast_to(q, (*[points] * len(moved), robot.n)).copy()
    for axis, (i, positions) in enumerate(zip(moved, at, strict=True)):
        shape = [1] * len(moved)
        shape[axis] = points
        poses[..., i] = positions.reshape(shape)
    M = robot.mass_matrix(poses)
    moments = np.linalg.eigvalsh(M)
    return Sweep(
        tuple(joints), at, poses, M, robot.gravity(poses), moments[..., -1] / moments[..., 0]
    )


@dataclass(frozen=True)
class Extremes:
    """The least and the most that the first joint feels while one joint moves over its range."""

    joint: str
    least: float
    at_least: float
    most: float
    at_most: float


def felt_extremes(robot: Robot, s: Sweep) -> Extremes:
    """The extremes of M_11 along a sweep of one joint, refined between its grid points."""
    k = robot.joint_names.index(s.joints[0])
    found = []
    for sign in (1.0, -1.0):
        at = s.at[0]
        for _ in range(5):  # each round looks twenty times closer
            poses = np.repeat(s.q[:1], len(at), axis=0)
            poses[:, k] = at
            felt = sign * robot.mass_matrix(poses)[:, 0, 0]
            best = int(felt.argmin())
            place, value = float(at[best]), sign * float(felt[best])
            at = np.linspace(at[max(best - 1, 0)], at[min(best + 1, len(at) - 1)], 41)
        found += [value, place]
    return Extremes(s.joints[0], *found)
