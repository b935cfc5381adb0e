"""The cart-pole by interconnection and damping assignment."""

from __future__ import annotations

import numpy as np

from mcgee.control.controller import Array
from mcgee.control.gains import positive, sampling
from mcgee.control.ida_pbc import IDAPBC, SOME, Energy
from mcgee.robot import Robot


class CartPoleIDAPBC(IDAPBC):
    """The cart-pole, balanced from wherever the pole is above the horizontal.

    After partial feedback linearisation, with x = (pole, cart) and the cart's acceleration u:
    M = 1, G = (−b cos x1, 1), V = a cos x1. With c, s = cos x1, sin x1,

        M_d = [[k b² c³/3, −k b c²/2], [−k b c²/2, k c + m]]
        V_d = 3 a / (k b² c²) + ½ kp z²,  z = x2 + 3/b ln(1/c + s/c) + 6 m s / (k b c)
        J_2 = j [[0, 1], [−1, 0]],  j = −k² b² c³ s y / 12,  y = Gᵀ M_d⁻¹ xd
        u = (∂V − M_d ∂H_d + J_2 M_d⁻¹ xd)_2 − kv y

    M_d > 0 for k > 0, m ≥ 0 and |x1| < π/2, where V_d grows beyond all bounds: every motion that
    starts with the pole above the horizontal keeps it there and ends upright with the cart at 0.

    Args:
        robot: `mcgee.arms.cart_pole`, its angle from 'up'
        k, m, kp, kv: above 0
        period: between samples [s]; None for a continuous law
    Logs: error −q, V = H_d, Vdot = −kv y²
    Raises: ValueError: another arm, gains that are not positive, a start below the horizontal
    Source: Acosta, Ortega, Astolfi & Mahindrakar 2005, Interconnection and damping assignment
        passivity-based control of mechanical systems with underactuation degree one, IEEE
        Transactions on Automatic Control 50(12), section V
    """

    def __init__(
        self,
        robot: Robot,
        k: float = 1.0,
        m: float = 0.01,
        kp: float = 5.0,
        kv: float = 2.0,
        *,
        period: float | None = None,
    ):
        self.robot, (self.a, self.b) = robot, _pole(robot)
        self.k, self.m = positive("k", k, ""), positive("m", m, "")
        self.kp, self.kv = positive("kp", kp, ""), positive("kv", kv, "")
        self.period = sampling(period)

    def start(self, q: Array, qd: Array) -> Array:
        if (np.cos(q[..., 1]) <= 0).any():
            worst = float(np.asarray(q[..., 1]).flat[np.cos(q[..., 1]).argmin()])
            raise ValueError(
                f"joint '{self.robot.joint_names[1]}' starts at {worst:.4g} rad, below the "
                f"horizontal, where this law has no energy. Swing it up first."
            )
        return np.zeros((*q.shape[:-1], 0))

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        a, b, k = self.a, self.b, self.k
        c, s = np.cos(q[..., 1]), np.sin(q[..., 1])
        v1, y, Md12, Md22, z_ = self._shaped(q, qd)
        first, second = -k * b**2 * c**3 / 6, k * b * c**2 / 2 + b * c * self.m  # G⊥ M_d
        d1 = k * s * y**2 / 2 - (a * s + self.kp * z_ * second) / first  # ∂H_d/∂x1
        j = k * s * first * y / 2
        u = -(Md12 * d1 + Md22 * self.kp * z_) - j * v1 - self.kv * y
        qdd = np.stack([u, a * s - b * c * u], axis=-1)
        tau = np.zeros(q.shape)
        tau[..., 0] = self.robot.inverse_dynamics(q, qd, qdd)[..., 0]
        return tau

    def energy(self, q: Array, qd: Array) -> Energy:
        v1, y, _, _, z = self._shaped(q, qd)
        c = np.cos(q[..., 1])
        v2 = y + self.b * c * v1
        kinetic = (qd[..., 1] * v1 + qd[..., 0] * v2) / 2
        height = 3 * self.a / (self.k * self.b**2) * (1 / c**2 - 1)
        return Energy(kinetic + height + self.kp * z**2 / 2, y)

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        Hd, y = self.energy(q, qd)
        return {"error": -q, "V": Hd, "Vdot": -self.kv * y**2}

    def _shaped(self, q: Array, qd: Array) -> tuple[Array, ...]:
        """(M_d⁻¹ xd)_1, y, the second column of M_d, z."""
        b, k, m = self.b, self.k, self.m
        c, s = np.cos(q[..., 1]), np.sin(q[..., 1])
        Md11, Md12, Md22 = k * b**2 * c**3 / 3, -k * b * c**2 / 2, k * c + m
        determinant = Md11 * Md22 - Md12**2
        v1 = (Md22 * qd[..., 1] - Md12 * qd[..., 0]) / determinant
        v2 = (Md11 * qd[..., 0] - Md12 * qd[..., 1]) / determinant
        z = q[..., 0] + 3 / b * np.log((1 + s) / c) + 6 * m * s / (k * b * c)
        return v1, v2 - b * c * v1, Md12, Md22, z


def _pole(robot: Robot) -> tuple[float, float]:
    """a and b of a cart-pole.

    Raises: ValueError: another arm
    """
    if robot.n == 2 and robot.limits.effort[1] == 0 != robot.limits.effort[0]:
        M, g = robot.mass_matrix(SOME), robot.gravity(SOME)
        b = M[0, 0, 1] / M[0, 1, 1]
        a = -g[1, 1] / np.sin(SOME[1, 1]) / M[0, 1, 1]
        c, s = np.cos(SOME[:, 1]), np.sin(SOME[:, 1])
        coupled = np.allclose(M[:, 0, 1], b * c * M[0, 1, 1]) and np.allclose(g[:, 0], 0.0)
        if coupled and np.allclose(M[:, 1, 1], M[0, 1, 1]) and a > 0 and b > 0:
            flat = np.allclose(M[:, 0, 0], M[0, 0, 0])
            if flat and np.allclose(g[:, 1], -a * s * M[0, 1, 1]):
                return float(a), float(b)
    raise ValueError(
        f"robot '{robot.name}' is no cart-pole with a passive pole and its angle from 'up'."
    )
