"""Passivity-based tracking with known parameters."""

from __future__ import annotations

from typing import Any

from mcgee.control.controller import Array, Controller
from mcgee.control.following import joint_reference
from mcgee.control.gains import joint_gain, sampling
from mcgee.control.linear import dot
from mcgee.control.sliding import sliding
from mcgee.robot import Robot


class SlotineLi(Controller):
    """tau = M(q) qdd_r + C(q, qd) qd_r + g(q) + kd s, with s = ed + lam e, qd_r = qd_d + lam e.

    The Coriolis forces are not cancelled but kept, with one of their two velocities replaced:
    V = ½ sᵀ M s, dV/dt = −sᵀ kd s because Ṁ − 2C is skew-symmetric; s and with it e and ed die out.

    Args:
        robot: whose dynamics are used
        reference: t -> (q, qd, qdd), or a position (..., n) to hold
        lam: of each joint or of all [1/s]
        kd: [N·m·s/rad | N·s/m]
        period: between samples [s]; None for a continuous law
    Logs: error e = q_d − q, s, V, Vdot
    Raises: ValueError: wrong shapes, negative gains
    Source: Slotine & Li 1987, On the adaptive control of robot manipulators, with the parameters
        known
    """

    def __init__(
        self, robot: Robot, reference: Any, lam: Any, kd: Any, *, period: float | None = None
    ):
        self.robot, self.reference = robot, joint_reference(robot, reference)
        self.lam, self.kd = joint_gain(robot, "lam", lam), joint_gain(robot, "kd", kd)
        self.period = sampling(period)

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        x = sliding(self.reference, self.lam, t, q, qd)
        at_rest = self.robot.inverse_dynamics(q, 0 * qd, x.qdd_r)  # M qdd_r + g
        return at_rest + self.robot.coriolis_product(q, qd, x.qd_r) + self.kd * x.s

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        e, s, _, _ = sliding(self.reference, self.lam, t, q, qd)
        V = self.robot.kinetic_energy(q, s)  # ½ sᵀ M s
        return {"error": e, "s": s, "V": V, "Vdot": -dot(s, self.kd * s)}
