"""The linear-quadratic regulator about an equilibrium, and where it may take over."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mcgee.control.controller import Array, Controller
from mcgee.control.gains import joint_vector, numbers, positive, sampling
from mcgee.control.linear import quadratic, times
from mcgee.robot import Robot

BALANCE = 1e-6
"""Effort that an equilibrium may lack, as a share of the largest |g(q)| or of 1."""

RANK = 1e-9
"""Relative singular value below which a mode cannot be reached."""

NEAR = 64
"""Directions that are looked at more closely."""

SPREADS = (0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05)
"""How far about them, relative to the size of a coordinate."""


class LQR(Controller):
    """tau = tau_0 − K x with x = (q − q_0, qd): least ∫ xᵀ Q x + uᵀ R u about (q_0, 0).

    A and B are the exact derivatives of forward dynamics, K = R⁻¹ Bᵀ P, and P > 0 solves
    Aᵀ P + P A − P B R⁻¹ Bᵀ P + Q = 0. V = xᵀ P x, dV/dt = −xᵀ (Q + Kᵀ R K) x of the linear
    system; the log has the dV/dt of the arm itself, which is negative within `level`. Joints with
    the effort limit 0 are passive; angles of joints without stops count to the nearest turn.

    Args:
        robot: with an equilibrium at q
        q: q_0 (n,) [rad | m]
        tau: efforts that hold it (n,); None for g(q)
        Q: weight of x, a number, (2n,) or (2n, 2n)
        R: of the efforts of the actuated joints, a number, (m,) or (m, m)
        level: V below which `inside` says so; None for `safe_level()`, found when first needed
        period: between samples [s]; None for a continuous law
    Logs: error q_0 − q, V, Vdot
    Raises: ValueError: no equilibrium, a mode that no effort can hold, wrong weights;
        ModuleNotFoundError: SciPy is not installed (mcgee[sim])
    Source: Kalman 1960, Contributions to the theory of optimal control; Anderson & Moore 1990
    """

    def __init__(
        self,
        robot: Robot,
        q: Any,
        tau: Any = None,
        Q: Any = 1.0,
        R: Any = 1.0,
        *,
        level: float | None = None,
        period: float | None = None,
    ):
        self.robot, self.q = robot, joint_vector(robot, "q", q)
        if self.q.ndim != 1:
            raise ValueError(f"q has shape {self.q.shape}, expected ({robot.n},).")
        self.actuated = np.flatnonzero(robot.limits.effort != 0)
        self.turning = turning(robot)
        self.tau = self._holding(tau)
        self.Q = weight("Q", Q, 2 * robot.n)
        self.R = weight("R", R, len(self.actuated), definite=True)
        self.A, self.B = self._linear()
        _refuse_unreachable(robot, self.A, self.B)
        self.P = self._riccati()
        self.K = np.linalg.solve(self.R, self.B.T @ self.P)
        self.period = sampling(period)
        self._level = None if level is None else positive("level", level, "")

    @property
    def level(self) -> float:
        if self._level is None:
            self._level = self.safe_level()
        return self._level

    def deviation(self, q: Array, qd: Array) -> Array:
        """x = (q − q_0, qd) (..., 2n), angles to the nearest turn."""
        off = q - self.q
        off = np.where(self.turning, (off + math.pi) % (2 * math.pi) - math.pi, off)
        return np.concatenate([off, qd], axis=-1)

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        tau = np.zeros(q.shape) + self.tau
        tau[..., self.actuated] -= times(self.K, self.deviation(q, qd))
        return tau

    def value(self, q: Array, qd: Array) -> Array:
        """V = xᵀ P x (...)."""
        return quadratic(self.deviation(q, qd), self.P)

    def inside(self, q: Array, qd: Array) -> Array:
        """Whether V is below `level` (...): where the law may take over, and stays."""
        return self.value(q, qd) < self.level

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        x = self.deviation(q, qd)
        return {"error": -x[..., : self.robot.n], "V": self.value(q, qd), "Vdot": self._rate(q, qd)}

    def safe_level(self, directions: int = 4096, seed: int = 0) -> float:
        """The largest V below which the arm's own dV/dt is negative, by samples.

        From every one of many directions outwards until dV/dt ≥ 0 or an angle is half a turn off,
        and again from directions beside those where it is the closest: a finding, not a proof.
        Actuators are taken to give what the law asks for. Joints that do not turn all the way are
        followed a thousand radians or metres far.
        """
        n, random = self.robot.n, np.random.default_rng(seed)
        x = self._on_the_level(random.normal(size=(directions, 2 * n)))
        far = abs(x[:, :n])[:, self.turning].max(initial=0.0)
        reach = 0.999 * math.pi / far if far else 1e3 / abs(x[:, :n]).max()
        r = self._reached(x, reach * np.geomspace(1e-6, 1.0, 600))
        for spread in SPREADS:
            closest = np.argsort(self._rate(self.q + r * x[:, :n], r * x[:, n:]))[-NEAR:]
            around = random.normal(size=(directions // NEAR, NEAR, 2 * n)) * abs(x).mean(0) * spread
            x = self._on_the_level(np.concatenate([x[closest], *(x[closest] + around)]))
            r = self._reached(x, r * np.geomspace(1e-2, 1.0, 60))
        return float(r * r)

    def _on_the_level(self, x: Array) -> Array:
        """Scaled to V = 1."""
        return np.asarray(x / np.sqrt(quadratic(x, self.P))[:, None])

    def _reached(self, x: Array, radii: Array) -> float:
        """The last of growing radii up to which dV/dt is negative in all directions."""
        n, last = self.robot.n, 0.0
        for r in radii:
            if not (self._rate(self.q + r * x[:, :n], r * x[:, n:]) < 0).all():
                break
            last = float(r)
        return last

    def _rate(self, q: Array, qd: Array) -> Array:
        """dV/dt of the arm under the law."""
        qdd = self.robot.forward_dynamics(q, qd, self.effort(0.0, q, qd, qd[..., :0]))
        x = self.deviation(q, qd)
        return 2 * (times(self.P, x) * np.concatenate([qd, qdd], axis=-1)).sum(-1)

    def _holding(self, tau: Any) -> Array:
        robot = self.robot
        g = robot.gravity(self.q)
        held = g if tau is None else joint_vector(robot, "tau", tau)
        scale = max(1.0, abs(g).max(initial=0))
        passive = robot.limits.effort == 0
        missing = np.where(passive, g, g - held)
        if (abs(missing) > BALANCE * scale).any():
            k = int(abs(missing).argmax())
            why = "is passive" if passive[k] else f"gets {held[k]:.6g}"
            raise ValueError(
                f"q is no equilibrium of robot '{robot.name}': joint '{robot.joint_names[k]}' "
                f"needs {g[k]:.6g} N·m or N and {why}."
            )
        return np.where(passive, 0.0, held)

    def _linear(self) -> tuple[Array, Array]:
        n = self.robot.n
        d = self.robot.forward_dynamics_derivatives(self.q, np.zeros(n), self.tau)
        A = np.block([[np.zeros((n, n)), np.eye(n)], [d.dqdd_dq, d.dqdd_dqd]])
        return A, np.concatenate([np.zeros((n, len(self.actuated))), d.Minv[:, self.actuated]])

    def _riccati(self) -> Array:
        try:
            from scipy.linalg import LinAlgError, solve_continuous_are
        except ModuleNotFoundError as missing:
            raise ModuleNotFoundError(
                "LQR needs SciPy: install mcgee[sim].", name=missing.name
            ) from missing
        why = "it leaves a mode that does not decay"
        try:
            P = solve_continuous_are(self.A, self.B, self.Q, self.R)
        except LinAlgError as error:
            why, P = str(error).rstrip("."), np.zeros_like(self.A)
        closed = self.A - self.B @ np.linalg.solve(self.R, self.B.T @ P)
        if np.linalg.eigvals(closed).real.max() < 0:
            return P
        raise ValueError(
            f"the Riccati equation of robot '{self.robot.name}' has no stabilising solution: "
            f"{why}. Give Q weight on every state."
        )


def turning(robot: Robot) -> Array:
    """Which joints come back to where they were after a turn (n,)."""
    followed = {joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    return np.array(
        [
            joint.kind in ("revolute", "continuous")
            and math.isinf(joint.lower)
            and math.isinf(joint.upper)
            and joint.name not in followed
            for joint in robot.independent_joints
        ]
    )


def weight(name: str, given: Any, size: int, definite: bool = False) -> Array:
    """A symmetric matrix, from a number, its diagonal or itself.

    Raises: ValueError: another shape, not symmetric, not positive (semi)definite
    """
    array = numbers(name, given)
    if array.shape == ():
        array = np.broadcast_to(array, (size,))
    array = np.diag(array) if array.shape == (size,) else array
    if array.shape != (size, size):
        raise ValueError(
            f"{name} has shape {array.shape}, expected a number, ({size},) or ({size}, {size})."
        )
    least = np.linalg.eigvalsh(array).min(initial=np.inf) if np.isfinite(array).all() else np.nan
    sound = np.allclose(array, array.T) and (least > 0 if definite else least >= -1e-12)
    if not sound:
        kind = "definite" if definite else "semidefinite"
        raise ValueError(f"{name} is not a symmetric positive {kind} matrix.")
    return array


def _refuse_unreachable(robot: Robot, A: Array, B: Array) -> None:
    """Popov, Belevitch & Hautus: [A − s I, B] has full rank at every s that does not decay.

    Raises: ValueError: a mode that stays or grows whatever the efforts do
    """
    scale = np.linalg.norm(np.concatenate([A, B], axis=1))
    for s in np.linalg.eigvals(A):
        if s.real < -RANK * scale:
            continue
        pencil = np.concatenate([A - s * np.eye(len(A)), B], axis=1)
        left, values, _ = np.linalg.svd(pencil)
        if values[-1] < RANK * scale:
            part = abs(left[:, -1]).reshape(2, -1).sum(0)
            raise ValueError(
                f"robot '{robot.name}' cannot be stabilised at q: no actuated joint acts on the "
                f"mode of eigenvalue {s.real:.4g} 1/s, in which joint "
                f"'{robot.joint_names[int(part.argmax())]}' has the largest part. Joints with the "
                f"effort limit 0 are passive."
            )
