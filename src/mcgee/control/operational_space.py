"""A frame follows a position or a pose, by its own dynamics."""

from __future__ import annotations

from typing import Any

import numpy as np

from mcgee.control.controller import Array, Controller
from mcgee.control.gains import gain, joint_gain, joint_vector, positive, sampling
from mcgee.control.linear import dot, times, turned
from mcgee.control.task import Frame, Motion, Task, task_inertia
from mcgee.robot import Robot


class OperationalSpace(Controller):
    """tau = M qdd* + C qd + g, qdd* = a + M⁻¹ Jᵀ Λ (xdd* − J̇ qd − J a).

    Λ = (J M⁻¹ Jᵀ)⁻¹ is the inertia that is felt at the frame and Λ (xdd* − J̇ qd) the force there;
    xdd* = xdd_d + kd ed + kp e. What a = posture_gain (posture − q) − damping qd asks for acts only
    where it does not move the frame. The error obeys edd + kd ed + kp e = 0, orientation by the
    rotation vector e of R_d Rᵀ and its angular velocity ed: V = ½ edᵀ ed + ½ eᵀ kp e,
    dV/dt = −edᵀ kd ed, from anywhere less than half a turn away, and while no eigenvalue of
    J M⁻¹ Jᵀ is below `singular`: from there on Λ is damped.

    Args:
        robot: whose dynamics are taken out
        reference: a position (3,), a pose (4, 4), or t -> (x, velocity, acceleration), root axes
        kp: a number, (3,), or (6,) for a pose, whose last three are alike [1/s²]
        kd: a number, (3,) or (6,) [1/s]
        frame: one of robot.frame_names; robot.end_frame by default
        damping: of motion that does not move the frame [1/s]
        posture: q (n,) towards which it goes; None for no such thing
        posture_gain: [1/s²]
        singular: [1/kg, 1/(kg·m²)]
        period: between samples [s]; None for a continuous law
    Logs: error (..., 3 or 6), error_rate, V, Vdot, least: the smallest eigenvalue of J M⁻¹ Jᵀ
    Raises: ValueError: an unknown frame or one that does not move, wrong shapes, negative gains
    Source: Khatib 1987, A unified approach for motion and force control of robot manipulators:
        the operational space formulation, IEEE J. Robotics and Automation 3(1)
    """

    def __init__(
        self,
        robot: Robot,
        reference: Any,
        kp: Any,
        kd: Any,
        frame: str | None = None,
        *,
        damping: Any = 1.0,
        posture: Any = None,
        posture_gain: Any = 1.0,
        singular: float = 0.02,
        period: float | None = None,
    ):
        self.robot, self.task = robot, Task(Frame(robot, frame), reference)
        self.kp, self.kd = task_gains(self.task, kp, kd)
        self.damping = joint_gain(robot, "damping", damping)
        self.posture = None if posture is None else joint_vector(robot, "posture", posture)
        self.posture_gain = joint_gain(robot, "posture_gain", posture_gain)
        self.singular = positive("singular", singular, "1/kg")
        self.period = sampling(period)

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        now = self.task.motion(t, q, qd)
        wanted = now.acceleration + self.kd * now.rate + self.kp * now.error
        return self.robot.inverse_dynamics(q, qd, self.accelerations(q, qd, now, wanted))

    def accelerations(self, q: Array, qd: Array, now: Motion, wanted: Array) -> Array:
        """qdd* that gives the frame the wanted acceleration (..., n)."""
        free = -self.damping * qd
        if self.posture is not None:
            free = free + self.posture_gain * (self.posture - q)
        towards = self.robot.mass_matrix_inverse(q) @ turned(now.J)
        inertia = task_inertia(now.J @ towards, self.singular)
        force = times(inertia, wanted - now.drift - times(now.J, free))
        return free + times(towards, force)

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        now = self.task.motion(t, q, qd)
        e, ed = now.error, now.rate
        V = (dot(ed, ed) + dot(e, self.kp * e)) / 2
        A = now.J @ self.robot.mass_matrix_inverse(q) @ turned(now.J)
        least = np.linalg.eigvalsh(A).min(-1)
        found = {"error": e, "error_rate": ed, "V": V, "Vdot": -dot(ed, self.kd * ed)}
        return found | {"least": least}


def task_gains(task: Task, kp: Any, kd: Any) -> tuple[Array, Array]:
    """
    Raises: ValueError: wrong shapes, negative gains, turns of unlike stiffness
    """
    of = f"the {'pose' if task.posed else 'position'} of frame '{task.frame.name}'"
    found = gain(of, "kp", kp, task.axes, "direction"), gain(of, "kd", kd, task.axes, "direction")
    if task.posed and np.ptp(found[0][3:]) > 0:
        raise ValueError(
            f"kp of the turns is {found[0][3:]}, expected three alike: a rotation vector has no "
            f"axes of its own."
        )
    return found
