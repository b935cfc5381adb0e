"""Computed torque: the dynamics taken out, linear ones put in their place."""

from __future__ import annotations

from typing import Any

from mcgee.control.controller import Array, Controller
from mcgee.control.following import joint_reference
from mcgee.control.gains import joint_gain, sampling
from mcgee.control.linear import dot
from mcgee.robot import Robot


class ComputedTorque(Controller):
    """tau = M(q) (qdd_d + kd ed + kp e) + C(q, qd) qd + g(q), by inverse dynamics.

    With the true M, C and g each joint's error is its own linear equation, edd + kd ed + kp e = 0:
    a natural frequency √kp [rad/s] and the damping kd / (2 √kp). V = ½ edᵀ ed + ½ eᵀ kp e,
    dV/dt = −edᵀ kd ed.

    Args:
        robot: whose dynamics are taken out
        reference: t -> (q, qd, qdd), or a position (..., n) to hold
        kp: of each joint or of all [1/s²]
        kd: [1/s]
        period: between samples [s]; None for a continuous law
    Logs: error e = q_d − q, error_rate ed, V, Vdot
    Raises: ValueError: wrong shapes, negative gains
    Source: Markiewicz 1973, Analysis of the computed torque drive method; Luh, Walker & Paul 1980;
        Craig 2005, Introduction to Robotics, section 10.4
    """

    def __init__(
        self, robot: Robot, reference: Any, kp: Any, kd: Any, *, period: float | None = None
    ):
        self.robot, self.reference = robot, joint_reference(robot, reference)
        self.kp, self.kd = joint_gain(robot, "kp", kp), joint_gain(robot, "kd", kd)
        self.period = sampling(period)

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        d = self.reference(t)
        wanted = d.qdd + self.kd * (d.qd - qd) + self.kp * (d.q - q)
        return self.robot.inverse_dynamics(q, qd, wanted)

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        d = self.reference(t)
        e, ed = d.q - q, d.qd - qd
        V = (dot(ed, ed) + dot(e, self.kp * e)) / 2
        return {"error": e, "error_rate": ed, "V": V, "Vdot": -dot(ed, self.kd * ed)}
