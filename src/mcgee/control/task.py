"""A frame of an arm as what is controlled: where it is, how it moves, what moves it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from mcgee.control.controller import Array
from mcgee.control.gains import numbers
from mcgee.control.linear import times, turned
from mcgee.control.rotation import rotation_vector
from mcgee.model import Inertia, Joint, Link, Pose
from mcgee.robot import Robot

PROBE = "probe of mcgee.control"
AXES = ("x", "y", "z", "turn about x", "turn about y", "turn about z")


class Frame:
    """A frame of a robot: kinematics and J̇ qd."""

    def __init__(self, robot: Robot, frame: str | None = None):
        self.robot, self.name = robot, robot.end_frame if frame is None else frame
        robot.forward_kinematics(np.zeros(robot.n), self.name)  # refuses unknown frames
        q = np.linspace(0.1, 0.7, robot.n)
        if not robot.jacobian(q, self.name).any():
            raise ValueError(f"frame '{self.name}' of robot '{robot.name}' does not move.")

    def pose(self, q: Array) -> Array:
        return self.robot.forward_kinematics(q, self.name)

    def jacobian(self, q: Array) -> Array:
        return self.robot.jacobian(q, self.name)

    def drift(self, q: Array, qd: Array) -> Array:
        """J̇ qd, the acceleration of the frame while qdd = 0 (..., 6): exact, no differences."""
        return self._probed.link_accelerations(q, qd, 0 * qd)[..., self._index, :]

    @cached_property
    def _probed(self) -> Robot:
        """The robot with a weightless link at the frame, whose centre of mass is its origin."""
        robot = self.robot
        found = [f for f in robot.frames if f.name == self.name]
        link, pose = (found[0].link, found[0].pose) if found else (self.name, Pose())
        probe = Link(PROBE, Inertia(0.0))
        joint = Joint(PROBE, "fixed", link, PROBE, pose=pose)
        return dataclasses.replace(
            robot, links=(*robot.links, probe), joints=(*robot.joints, joint), made_by=None
        )

    @cached_property
    def _index(self) -> int:
        return self._probed.moving_links.index(PROBE)


class Motion(NamedTuple):
    """Of a task with k coordinates, 3 or 6: linear ones first, in the root frame's axes."""

    error: Array
    """(..., k): the way to the target, and the turn to it as a rotation vector [m, rad]"""
    rate: Array
    """Its derivative, wanted less actual velocity (..., k)."""
    acceleration: Array
    """The wanted one (..., k)."""
    J: Array
    """(..., k, n)"""
    drift: Array
    """J̇ qd (..., k)"""


class Task:
    """A frame that shall follow a position, or a pose.

    Args:
        given: a position (3,), a pose (4, 4), or t -> (position, velocity, acceleration) (3,) each,
            or t -> (pose (4, 4), velocity (6,), acceleration (6,)), linear first, root axes
    Raises: ValueError: other shapes
    """

    def __init__(self, frame: Frame, given: Any):
        self.frame = frame
        self.reference = _task_reference(given)
        first = self.reference(0.0)
        self.posed = first[0].shape[-2:] == (4, 4)
        k = 6 if self.posed else 3
        wanted = ((4, 4), (6,), (6,)) if self.posed else ((3,), (3,), (3,))
        if any(x.shape[-len(s) :] != s for x, s in zip(first, wanted, strict=True)):
            shapes = ", ".join(str(x.shape) for x in first)
            raise ValueError(
                f"the reference gives shapes {shapes}, expected (3,), (3,), (3,) for a position "
                f"or (4, 4), (6,), (6,) for a pose."
            )
        if not all(np.isfinite(x).all() for x in first):
            raise ValueError("the reference holds numbers at t = 0 that are not finite.")
        if self.posed:
            _check_pose(first[0])
        self.axes = AXES[:k]

    def motion(self, t: float, q: Array, qd: Array) -> Motion:
        x, v, a = self.reference(t)
        T, k = self.frame.pose(q), len(self.axes)
        J = self.frame.jacobian(q)[..., :k, :]
        if self.posed:
            turn = rotation_vector(x[..., :3, :3] @ turned(T[..., :3, :3]))
            way = x[..., :3, 3] - T[..., :3, 3]
            error = np.concatenate(np.broadcast_arrays(way, turn), axis=-1)
        else:
            error = x - T[..., :3, 3]
        drift = self.frame.drift(q, qd)[..., :k]
        return Motion(error, v - times(J, qd), a, J, drift)


def _check_pose(T: Array) -> None:
    """Raises: ValueError: no rotation, or another last row than 0, 0, 0, 1"""
    R = T[..., :3, :3]
    if not (np.allclose(R @ turned(R), np.eye(3), atol=1e-6) and (np.linalg.det(R) > 0).all()):
        raise ValueError(
            "the reference's pose has a rotation that is none: R Rᵀ = 1 and det R = 1 are expected."
        )
    if not np.allclose(T[..., 3, :], [0, 0, 0, 1], atol=1e-6):
        raise ValueError(
            f"the reference's pose has the last row {T[..., 3, :]}, expected 0, 0, 0, 1."
        )


def _task_reference(given: Any) -> Callable[[float], tuple[Array, Array, Array]]:
    if callable(given):

        def reference(t: float) -> tuple[Array, Array, Array]:
            try:
                x, v, a = given(t)
            except (TypeError, ValueError) as error:
                raise ValueError(
                    f"the reference gives no (position, velocity, acceleration) at t = {t:.6g} s: "
                    f"{error}."
                ) from error
            what = "the reference"
            return numbers(what, x), numbers(what, v), numbers(what, a)

        return reference
    target = numbers("target", given)
    if target.shape not in ((3,), (4, 4)) or not np.isfinite(target).all():
        raise ValueError(
            f"target has shape {target.shape}, expected a position (3,) [m] or a pose (4, 4), of "
            f"finite numbers."
        )
    still = np.zeros(3 if target.shape == (3,) else 6)
    return lambda t: (target, still, still)


def task_inertia(A: Array, threshold: float) -> Array:
    """(J M⁻¹ Jᵀ)⁻¹, damped where it is near to singular (..., k, k).

    An eigenvalue s of A below the threshold is inverted as s / (s² + d²) with
    d² = (threshold² − s²) / 4: continuous, at most 1.2/threshold, and nothing in a
    direction that the arm cannot move in.

    Source: Nakamura & Hanafusa 1986, Inverse kinematic solutions with singularity robustness
    """
    s, U = np.linalg.eigh(A)
    s = np.maximum(s, 0.0)
    damping = np.maximum(threshold**2 - s**2, 0.0) / 4
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.where(s > 0, s / (s**2 + damping), 0.0)
    return (U * inverse[..., None, :]) @ turned(U)
