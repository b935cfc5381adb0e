"""A stiff plane that an arm can press against."""

from __future__ import annotations

from typing import Any

import numpy as np

from mcgee.control.controller import Array
from mcgee.control.gains import numbers, positive, unit, zero_or_more
from mcgee.control.linear import dot, times, turned
from mcgee.control.task import Frame
from mcgee.robot import Robot


class Wall:
    """A plane without friction, as the `disturbance` of a simulation.

    At the depth x > 0 of the frame's origin behind the plane it pushes back with
    stiffness x (1 + damping xd), never pulling (Hunt & Crossley 1975): no jump at the first touch.

    Args:
        point: of the plane (3,), root axes [m]
        normal: out of the wall (3,), root axes; its length does not count
        stiffness: [N/m]
        damping: [s/m]
        frame: what touches, one of robot.frame_names; robot.end_frame by default
    Raises: ValueError: an unknown frame, wrong shapes, a stiffness that is not above 0
    """

    def __init__(
        self,
        robot: Robot,
        point: Any,
        normal: Any,
        stiffness: float = 1e4,
        damping: float = 1.0,
        frame: str | None = None,
    ):
        self.frame, self.normal = Frame(robot, frame), unit("normal", normal)
        self.point = numbers("point", point)
        if self.point.shape != (3,) or not np.isfinite(self.point).all():
            raise ValueError(f"point is {point!r}, expected 3 numbers [m].")
        self.stiffness = positive("stiffness", stiffness, "N/m")
        self.damping = zero_or_more("damping", damping, "s/m")

    def __call__(self, t: float, q: Array, qd: Array) -> Array:
        """Jᵀ force: the joint efforts (..., n) [N·m | N]."""
        return times(turned(self.frame.jacobian(q)[..., :3, :]), self.force(q, qd))

    def force(self, q: Array, qd: Array) -> Array:
        """Of the wall on the frame's origin (..., 3), root axes [N]."""
        depth = np.maximum(-self.distance(q), 0.0)
        rate = -dot(times(self.frame.jacobian(q)[..., :3, :], qd), self.normal)
        size = self.stiffness * depth * np.maximum(1 + self.damping * rate, 0.0)
        return size[..., None] * self.normal

    def distance(self, q: Array) -> Array:
        """Of the frame's origin from the plane, negative behind it (...) [m]."""
        return dot(self.frame.pose(q)[..., :3, 3] - self.point, self.normal)
