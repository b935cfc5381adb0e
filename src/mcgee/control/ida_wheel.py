"""The inertia-wheel pendulum by interconnection and damping assignment."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mcgee.control.controller import Array
from mcgee.control.gains import numbers, positive, sampling
from mcgee.control.ida_pbc import IDAPBC, SOME, Energy
from mcgee.robot import Robot


class InertiaWheelIDAPBC(IDAPBC):
    """The inertia-wheel pendulum, swung up and balanced by one smooth law.

    With the wheel's absolute angle, x = (q1, q1 + q2), M = diag(I1, I2), G = (−1, 1) and
    V = m3 cos x1. M_d = [[a1, a2], [a2, a3]] is constant, J_2 = 0, and

        V_d = I1 m3 / (a1 + a2) cos x1 + ½ kp z²,  z = x2 + c x1,
        c = −I1 (a2 + a3) / (I2 (a1 + a2))
        tau_2 = a2 m3 / (a1 + a2) sin x1 − kp (a1 a3 − a2²) / (I2 (a1 + a2)) z − kv y,
        y = (a1 + a2) I2 / (a1 a3 − a2²) zd

    For a1 > 0, a1 a3 > a2² and a1 + a2 < 0 the upright pendulum with z = 0 is the minimum of H_d,
    and all motions but those of a set of measure zero end upright, at whole turns of q1.

    Args:
        robot: `mcgee.arms.inertia_wheel_pendulum`, its angle from the upward vertical
        a: (a1, a2, a3)
        kp, kv: above 0
        period: between samples [s]; None for a continuous law
    Logs: error (0 − q1 to the nearest turn, −z), V = H_d, Vdot = −kv y²
    Raises: ValueError: another arm, a that has no such minimum
    Source: Ortega et al. 2002, section V-B
    """

    def __init__(
        self,
        robot: Robot,
        a: Any = (1.0, -1.28, 1.9),
        kp: float = 0.14,
        kv: float = 5.0,
        *,
        period: float | None = None,
    ):
        M, self.m3 = _wheel(robot)
        self.robot, self.I1, self.I2 = robot, M[0, 0] - M[1, 1], M[1, 1]
        self.a = numbers("a", a)
        sound = self.a.shape == (3,) and bool(np.isfinite(self.a).all())
        a1, a2, a3 = self.a if sound else (0.0, 0.0, 0.0)
        if not (a1 > 0 and a1 * a3 > a2 * a2 and a1 + a2 < 0):
            raise ValueError(f"a is {a!r}, expected a1 > 0, a1 a3 > a2² and a1 + a2 < 0.")
        self.kp, self.kv = positive("kp", kp, ""), positive("kv", kv, "")
        self.c = -self.I1 * (a2 + a3) / (self.I2 * (a1 + a2))
        self.period = sampling(period)

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        a1, a2, a3 = self.a
        shape = self.kp * (a1 * a3 - a2**2) / (self.I2 * (a1 + a2))
        swing = a2 * self.m3 / (a1 + a2) * np.sin(q[..., 0])
        tau = np.zeros(q.shape)
        tau[..., 1] = swing - shape * self._wheel(q) - self.kv * self.energy(q, qd).y
        return tau

    def energy(self, q: Array, qd: Array) -> Energy:
        a1, a2, a3 = self.a
        p1, p2 = self.I1 * qd[..., 0], self.I2 * (qd[..., 0] + qd[..., 1])
        determinant = a1 * a3 - a2**2
        kinetic = (a3 * p1**2 - 2 * a2 * p1 * p2 + a1 * p2**2) / (2 * determinant)
        height = self.I1 * self.m3 / (a1 + a2) * (np.cos(q[..., 0]) - 1)
        y = ((a1 + a2) * p2 - (a2 + a3) * p1) / determinant
        return Energy(kinetic + height + self.kp * self._wheel(q) ** 2 / 2, y)

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        Hd, y = self.energy(q, qd)
        off = (q[..., 0] + math.pi) % (2 * math.pi) - math.pi
        error = np.stack([-off, -self._wheel(q)], axis=-1)
        return {"error": error, "V": Hd, "Vdot": -self.kv * y**2}

    def _wheel(self, q: Array) -> Array:
        """z"""
        return q[..., 0] + q[..., 1] + self.c * q[..., 0]


def _wheel(robot: Robot) -> tuple[Array, float]:
    """M and m3 of an inertia-wheel pendulum.

    Raises: ValueError: another arm
    """
    if robot.n == 2 and robot.limits.effort[0] == 0 != robot.limits.effort[1]:
        M, g = robot.mass_matrix(SOME), robot.gravity(SOME)
        m3 = float(-g[1, 0] / np.sin(SOME[1, 0]))
        wanted = np.stack([-m3 * np.sin(SOME[:, 0]), 0 * SOME[:, 0]], axis=-1)
        alike = np.allclose(M, M[0]) and np.allclose(g, wanted, atol=1e-9 * (1 + abs(m3)))
        if alike and np.isclose(M[0, 0, 1], M[0, 1, 1]) and m3 > 0:
            return M[0], m3
    raise ValueError(
        f"robot '{robot.name}' is no inertia-wheel pendulum with a passive pivot and its angle "
        f"from the upward vertical."
    )
