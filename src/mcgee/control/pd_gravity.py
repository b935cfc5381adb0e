"""PD control with gravity compensation."""

from __future__ import annotations

from typing import Any

from mcgee.control.controller import Array, Controller
from mcgee.control.gains import joint_gain, joint_vector, sampling
from mcgee.control.linear import dot
from mcgee.robot import Robot


class PDGravity(Controller):
    """tau = kp (q_d − q) − kd qd + g(q): to a position and there.

    V = ½ qdᵀ M qd + ½ eᵀ kp e, dV/dt = −qdᵀ kd qd with e = q_d − q: every motion ends at the target
    while the controller's gravity is the arm's and nothing else acts.

    Args:
        robot: whose gravity is compensated
        target: q_d (..., n) [rad | m]
        kp: stiffness, of each joint or of all [N·m/rad | N/m]
        kd: damping [N·m·s/rad | N·s/m]
        period: between samples [s]; None for a continuous law
    Logs: error e, V, Vdot
    Raises: ValueError: wrong shapes, negative gains
    Source: Takegaki & Arimoto 1981, A new feedback method for dynamic control of manipulators
    """

    def __init__(self, robot: Robot, target: Any, kp: Any, kd: Any, *, period: float | None = None):
        self.robot, self.target = robot, joint_vector(robot, "target", target)
        self.kp, self.kd = joint_gain(robot, "kp", kp), joint_gain(robot, "kd", kd)
        self.period = sampling(period)

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        return self.kp * (self.target - q) - self.kd * qd + self.robot.gravity(q)

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        e = self.target - q
        V = self.robot.kinetic_energy(q, qd) + dot(e, self.kp * e) / 2
        return {"error": e, "V": V, "Vdot": -dot(qd, self.kd * qd)}
