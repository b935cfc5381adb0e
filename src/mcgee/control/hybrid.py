"""Force along one direction, motion along the others."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mcgee.control.controller import Array, Controller
from mcgee.control.gains import finite, joint_gain, positive, sampling, unit, zero_or_more
from mcgee.control.linear import dot, times, turned
from mcgee.control.operational_space import task_gains
from mcgee.control.task import Frame, Task, task_inertia
from mcgee.robot import Robot


class HybridForcePosition(Controller):
    """A frame presses against a surface with a wanted force and moves along it.

    With n the surface's outward normal, f the measured force along it, S = 1 − n nᵀ (and 1 for
    turns), xdd* = xdd_d + kd ed + kp e and v = n · velocity:

        force on the surface  f_c = f_d + ki z + kf (f_d − f),  dz/dt = f_d − f while f > 0
        tau = M qdd* + C qd + g − Jᵀ n f_c
        qdd* = a + M⁻¹ Jᵀ Λ (S xdd* − damping_normal n v − J̇ qd − J a)

    a = −damping qd where it does not move the frame. Against a surface of stiffness k and seen
    inertia m, m s³ + m damping_normal s² + k (1 + kf) s + ki k is stable for ki <
    (1 + kf) damping_normal, whatever k and m: f goes to f_d without an offset. Away from the
    surface f_c = f_d moves the frame towards it, against damping_normal, and z waits.

    Args:
        robot: whose dynamics are taken out
        reference: a position (3,), a pose (4, 4), or t -> (x, velocity, acceleration), root axes;
            its part along the normal is not used
        normal: from the surface towards the arm (3,), root axes; its length does not count
        force: f_d with which the frame shall press, above 0, or a function of t [N]
        sensor: f(q, qd) -> the surface's force on the frame (..., 3) [N], `Wall.force` for one
        kp, kd: a number, (3,), or (6,) for a pose [1/s²], [1/s]
        ki: of the force [1/s]
        kf: of the force, proportional [-]
        damping_normal: of motion along the normal [1/s]
        frame: one of robot.frame_names; robot.end_frame by default
        damping: of motion that does not move the frame [1/s]
        singular: eigenvalue of J M⁻¹ Jᵀ below which Λ is damped [1/kg]
        period: between samples [s]; None for a continuous law
    Logs: error S e, force f, force_error f_d − f
    Raises: ValueError: an unknown frame, wrong shapes, negative gains, an unstable ki
    Source: Khatib 1987, A unified approach for motion and force control of robot manipulators;
        Siciliano et al. 2009, Robotics, chapter 9
    """

    def __init__(
        self,
        robot: Robot,
        reference: Any,
        normal: Any,
        force: float | Callable[[float], float],
        sensor: Callable[[Array, Array], Any],
        kp: Any,
        kd: Any,
        ki: float = 5.0,
        frame: str | None = None,
        *,
        kf: float = 0.0,
        damping_normal: float = 20.0,
        damping: Any = 1.0,
        singular: float = 0.02,
        period: float | None = None,
    ):
        self.robot, self.task = robot, Task(Frame(robot, frame), reference)
        self.kp, self.kd = task_gains(self.task, kp, kd)
        self.normal = unit("normal", normal)
        self.sensor = sensor
        self.ki, self.kf = positive("ki", ki, "1/s"), zero_or_more("kf", kf)
        self.damping_normal = positive("damping_normal", damping_normal, "1/s")
        if self.ki >= (1 + self.kf) * self.damping_normal:
            raise ValueError(
                f"ki is {self.ki:g} 1/s, expected less than (1 + kf) damping_normal = "
                f"{(1 + self.kf) * self.damping_normal:g} 1/s: the force would swing up."
            )
        self.wanted = force if callable(force) else _constant(positive("force", force, "N"))
        self.damping = joint_gain(robot, "damping", damping)
        self.singular = positive("singular", singular, "1/kg")
        self.period = sampling(period)
        self.along = np.concatenate([self.normal, np.zeros(len(self.task.axes) - 3)])
        self.across = np.eye(len(self.along)) - np.outer(self.along, self.along)

    def start(self, q: Array, qd: Array) -> Array:
        return np.zeros((*np.shape(q)[:-1], 1))

    def measured(self, q: Array, qd: Array) -> Array:
        """f (...) [N]"""
        force = self.sensor(q, qd)
        return dot(finite("the sensor's force", force, (3,), "along x, y, z [N]"), self.normal)

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        now, n = self.task.motion(t, q, qd), self.along
        f_d = self.wanted(t)
        pressed = f_d + self.ki * z[..., 0] + self.kf * (f_d - self.measured(q, qd))
        wanted = times(self.across, now.acceleration + self.kd * now.rate + self.kp * now.error)
        wanted = wanted - self.damping_normal * n * dot(times(now.J, qd), n)[..., None]
        free = -self.damping * qd
        towards = self.robot.mass_matrix_inverse(q) @ turned(now.J)
        inertia = task_inertia(now.J @ towards, self.singular)
        qdd = free + times(towards, times(inertia, wanted - now.drift - times(now.J, free)))
        pressing = times(turned(now.J), n * pressed[..., None])
        return self.robot.inverse_dynamics(q, qd, qdd) - pressing

    def slope(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        f = self.measured(q, qd)
        return np.where(f > 0, self.wanted(t) - f, 0.0)[..., None]

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        f = self.measured(q, qd)
        error = times(self.across, self.task.motion(t, q, qd).error)
        return {"error": error, "force": f, "force_error": self.wanted(t) - f}


def _constant(force: float) -> Callable[[float], float]:
    return lambda t: force
