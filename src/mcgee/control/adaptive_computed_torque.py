"""Computed torque that learns the arm's parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mcgee.control.controller import Array, Controller
from mcgee.control.following import joint_reference
from mcgee.control.gains import gain, joint_gain, numbers, positive, sampling
from mcgee.control.linear import dot, times, turned
from mcgee.control.regressor import Unknowns
from mcgee.robot import Robot

LEAST_INERTIA = 0.01
"""Share of the first estimate's smallest principal inertia below which M̂⁻¹ is cut off."""


class AdaptiveComputedTorque(Controller):
    """tau = M̂ qdd* + Ĉ qd + ĝ with qdd* = qdd_d + kd ed + kp e and estimates z that learn.

    W(q, qd, qdd) p = M qdd + C qd + g + friction is linear in the unknown parameters p
    (`regressor.Unknowns`). The error obeys edd + kd ed + kp e = −M̂⁻¹ W dp, dp = z − p, so with
    dz/dt = gains Wᵀ M̂⁻¹ (ed + psi e) and V = ½ edᵀ ed + psi eᵀ ed + ½ eᵀ (kp + kd psi) e
    + ½ dpᵀ gains⁻¹ dp it is dV/dt = −eᵀ kp psi e − edᵀ (kd − psi) ed; an estimate that stops at a
    bound only adds to the decrease if p is within the bounds.

    What it assumes, and passivity-based adaptation does not: qdd is known, and M̂ is invertible.
    `acceleration` is the measurement; without one, qdd is estimated as bandwidth (qd − v),
    dv/dt = bandwidth (qd − v), and dV/dt holds but for its lag. Bounds shall keep M̂ positive
    definite; where they fail, M̂⁻¹ is cut off rather than let adaptation run away, which
    least_inertia in the log shows.

    Args:
        robot: as far as it is known: lengths, gravity, armature, first estimates of the inertias
        reference: t -> (q, qd, qdd), or a position (..., n) to hold
        kp: of each joint or of all [1/s²]
        kd: above psi [1/s]
        gains: of each parameter or of all, above 0 [parameter² s² / rad² or m²]
        friction: whether viscous and Coulomb coefficients are estimated too, from 0 on
        psi: share of the error beside its rate, kd/2 by default [1/s]
        bounds: (lower, upper) of the parameters, numbers or (m,) each; None for half of the first
            estimates more or less (`around`), and friction not negative
        acceleration: f(t, q, qd, tau) -> qdd as measured (..., n); None for the estimate
        bandwidth: of the estimate, at most 1 in a period [1/s]
        friction_speed: of the regularised Coulomb friction [rad/s | m/s]
        true_parameters: p (..., m), for the log alone
        period: between samples [s]; None for a continuous law
    Logs: error e = q_d − q, error_rate ed, estimates, least_inertia: the smallest eigenvalue of M̂;
        with true_parameters V, Vdot
    Raises: ValueError: wrong shapes, negative gains, psi not between 0 and kd
    Source: Craig, Hsu & Sastry 1987, Adaptive control of mechanical manipulators, Int. J. Robotics
        Research 6(2)
    """

    def __init__(
        self,
        robot: Robot,
        reference: Any,
        kp: Any,
        kd: Any,
        gains: Any,
        friction: bool = True,
        *,
        psi: Any = None,
        bounds: tuple[Any, Any] | None = None,
        acceleration: Callable[[float, Array, Array, Array], Any] | None = None,
        bandwidth: float = 200.0,
        friction_speed: float = 0.01,
        true_parameters: Any = None,
        period: float | None = None,
    ):
        self.robot, self.reference = robot, joint_reference(robot, reference)
        self.kp, self.kd = joint_gain(robot, "kp", kp), joint_gain(robot, "kd", kd)
        self.psi = joint_gain(robot, "psi", self.kd / 2 if psi is None else psi, positive=True)
        self.unknowns = known = Unknowns(robot, friction, friction_speed)
        of = f"robot '{robot.name}'"
        self.gains = gain(of, "gains", gains, known.names, "parameter", positive=True)
        self.bounds = around(known, 0.5) if bounds is None else _bounds(known, bounds)
        self.acceleration, self.bandwidth = acceleration, positive("bandwidth", bandwidth, "1/s")
        given = true_parameters
        self.truth = None if given is None else known.checked("true_parameters", given)
        self.period = sampling(period)
        self._check()
        M = self._inertia(self.reference(0.0).q, known.described)
        self.floor = LEAST_INERTIA * float(np.linalg.eigvalsh(M).min())

    def _check(self) -> None:
        if not (self.psi < self.kd).all():
            k = int((self.psi >= self.kd).argmax())
            raise ValueError(
                f"psi of joint '{self.robot.joint_names[k]}' is {self.psi[k]:g}, expected less "
                f"than kd, which is {self.kd[k]:g}."
            )
        if self.acceleration is None and self.period and self.bandwidth * self.period > 1:
            raise ValueError(
                f"bandwidth is {self.bandwidth:g} 1/s, expected at most one in a period, "
                f"{1 / self.period:g} 1/s: the estimate of qdd would run away."
            )

    def start(self, q: Array, qd: Array) -> Array:
        p = self.unknowns.described
        z = np.broadcast_to(p, (*np.shape(q)[:-1], len(p)))
        return z.copy() if self.acceleration is not None else np.concatenate([z, qd], axis=-1)

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        d = self.reference(t)
        wanted = d.qdd + self.kd * (d.qd - qd) + self.kp * (d.q - q)
        Y = self.unknowns.regressor(q, qd, wanted)
        return times(Y, self._estimates(z)) + times(self.unknowns.rotors, wanted)

    def slope(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        d, p = self.reference(t), self._estimates(z)
        qdd = self._acceleration(t, q, qd, z)
        w, turn = np.linalg.eigh(self._inertia(q, p))
        filtered = d.qd - qd + self.psi * (d.q - q)
        pushed = times(turn, times(turned(turn), filtered) / np.maximum(w, self.floor))
        change = self.gains * times(turned(self.unknowns.regressor(q, qd, qdd)), pushed)
        lower, upper = self.bounds
        change = np.where((p <= lower) & (change < 0) | (p >= upper) & (change > 0), 0.0, change)
        if self.acceleration is not None:
            return change
        return np.concatenate([change, qdd], axis=-1)

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        d, p = self.reference(t), self._estimates(z)
        e, ed = d.q - q, d.qd - qd
        least = np.linalg.eigvalsh(self._inertia(q, p)).min(-1)
        found = {"error": e, "error_rate": ed, "estimates": p, "least_inertia": least}
        if self.truth is None:
            return found
        dp = p - self.truth
        energy = (
            dot(ed, ed) + 2 * dot(e, self.psi * ed) + dot(e, (self.kp + self.kd * self.psi) * e)
        )
        Vdot = -dot(e, self.kp * self.psi * e) - dot(ed, (self.kd - self.psi) * ed)
        return found | {"V": (energy + dot(dp, dp / self.gains)) / 2, "Vdot": Vdot}

    def _estimates(self, z: Array) -> Array:
        return z[..., : len(self.unknowns.names)]

    def _inertia(self, q: Array, p: Array) -> Array:
        return self.unknowns.of_parameters.mass_matrix(q, p[..., : self.unknowns.inertial])

    def _acceleration(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        if self.acceleration is None:
            return self.bandwidth * (qd - z[..., len(self.unknowns.names) :])
        tau = self.effort(t, q, qd, z)
        return np.asarray(self.acceleration(t, q, qd, tau), float)


def around(unknowns: Unknowns, share: float) -> tuple[Array, Array]:
    """Bounds (m,) about the description's parameters; friction coefficients from zero up.

    Masses may move by the share of themselves, other parameters by that of their scale.
    """
    p, m, width = unknowns.described, unknowns.inertial, share * unknowns.scales
    lower, upper = np.zeros_like(p), np.full_like(p, np.inf)
    lower[:m], upper[:m] = (p - width)[:m], (p + width)[:m]
    return lower, upper


def _bounds(unknowns: Unknowns, given: tuple[Any, Any]) -> tuple[Array, Array]:
    p = unknowns.described
    try:
        lower, upper = (np.broadcast_to(numbers("bounds", x), p.shape) for x in given)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"bounds are {given!r}, expected (lower, upper), a number or {p.shape} each."
        ) from error
    outside = ~((lower <= p) & (p <= upper))
    if outside.any():
        k = int(outside.argmax())
        raise ValueError(
            f"bounds of '{unknowns.names[k]}' are {lower[k]:g} and {upper[k]:g}, expected to hold "
            f"the first estimate, {p[k]:g}."
        )
    return lower, upper
