"""Passivity-based tracking that learns the arm's parameters."""

from __future__ import annotations

from typing import Any

import numpy as np

from mcgee.control.controller import Array, Controller
from mcgee.control.following import joint_reference
from mcgee.control.gains import gain_matrix, joint_gain, sampling
from mcgee.control.linear import dot, quadratic, times, turned
from mcgee.control.regressor import Unknowns
from mcgee.control.sliding import Sliding, sliding
from mcgee.robot import Robot


class AdaptiveSlotineLi(Controller):
    """tau = Y_r z + (armature) qdd_r + kd s, dz/dt = gains Y_rᵀ s, z the estimates of p.

    Y_r(q, qd, qd_r, qdd_r) p = M qdd_r + C(q, qd) qd_r + g + friction(qd) is linear in the unknown
    parameters p (`regressor.Unknowns`); s = ed + lam e, qd_r = qd_d + lam e as in `SlotineLi`. With
    dp = z − p, V = ½ sᵀ M s + ½ dpᵀ gains⁻¹ dp and dV/dt = −sᵀ kd s: tracking errors die out
    whatever the estimates were; these come as close to p as the motion tells them apart.

    Args:
        robot: as far as it is known: lengths, gravity, armature, first estimates of the inertias
        reference: t -> (q, qd, qdd), or a position (..., n) to hold
        lam: of each joint or of all [1/s]
        kd: [N·m·s/rad | N·s/m]
        gains: of each parameter or of all, above 0, or a positive definite matrix (m, m), such as
            `excitation_gains` finds for a motion [parameter² / J]
        friction: whether viscous and Coulomb coefficients are estimated too, from 0 on
        friction_speed: of the regularised Coulomb friction [rad/s | m/s]
        true_parameters: p (..., m), for the log alone
        period: between samples [s]; None for a continuous law
    Logs: error e = q_d − q, s, estimates z; with true_parameters V, Vdot and
        prediction = Y_r (z − p) [N·m | N]
    Raises: ValueError: wrong shapes, negative gains
    Source: Slotine & Li 1987, On the adaptive control of robot manipulators, Int. J. Robotics
        Research 6(3); its s and parameter error have the other sign
    """

    def __init__(
        self,
        robot: Robot,
        reference: Any,
        lam: Any,
        kd: Any,
        gains: Any,
        friction: bool = True,
        *,
        friction_speed: float = 0.01,
        true_parameters: Any = None,
        period: float | None = None,
    ):
        self.robot, self.reference = robot, joint_reference(robot, reference)
        self.lam, self.kd = joint_gain(robot, "lam", lam), joint_gain(robot, "kd", kd)
        self.unknowns = Unknowns(robot, friction, friction_speed)
        of = f"robot '{robot.name}'"
        self.gains = gain_matrix(of, "gains", gains, self.unknowns.names, "parameter")
        self.weights = np.linalg.inv(self.gains)
        self.truth = (
            None
            if true_parameters is None
            else self.unknowns.checked("true_parameters", true_parameters)
        )
        self.period = sampling(period)

    def start(self, q: Array, qd: Array) -> Array:
        p = self.unknowns.described
        return np.broadcast_to(p, (*np.shape(q)[:-1], len(p))).copy()

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        x, Y = self._now(t, q, qd)
        return times(Y, z) + times(self.unknowns.rotors, x.qdd_r) + self.kd * x.s

    def slope(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        x, Y = self._now(t, q, qd)
        return times(self.gains, times(turned(Y), x.s))

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        x, Y = self._now(t, q, qd)
        found = {"error": x.e, "s": x.s, "estimates": z}
        if self.truth is None:
            return found
        dp = z - self.truth
        inertial = self.truth[..., : self.unknowns.inertial]
        M = self.unknowns.of_parameters.mass_matrix(q, inertial)
        V = (quadratic(x.s, M) + dot(dp, times(self.weights, dp))) / 2
        return found | {"prediction": times(Y, dp), "V": V, "Vdot": -dot(x.s, self.kd * x.s)}

    def _now(self, t: float, q: Array, qd: Array) -> tuple[Sliding, Array]:
        x = sliding(self.reference, self.lam, t, q, qd)
        return x, self.unknowns.two_velocities(q, qd, x.qd_r, x.qdd_r)
