"""Swinging underactuated arms up by their energy, and catching them upright."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from mcgee.control.controller import Array, Controller
from mcgee.control.gains import joint_gain, number, positive, sampling, zero_or_more
from mcgee.control.linear import dot, times, turned
from mcgee.control.lqr import LQR
from mcgee.robot import Robot

NUDGE = 0.05
"""Share of `speed` by which an arm at rest seems to move."""


class EnergySwingUp(Controller):
    """Energy up to that of the equilibrium, then an LQR where its region begins.

    With E = T + P − P(q_0) − extra, a the actuated and p the passive joints, x = q − q_0, and b and
    m the accelerations qdd_a = b + m tau_a without effort and of unit efforts:

        (max(E, 0) + kv m) tau_a = kv (u − b − kp x_a − kd qd_a)
        u = push tanh(min(E, 0) / energy) 2/π atan(w / speed + 1/20)
        w = (M_pp⁻¹ M_pa)ᵀ (qd_p + M_pp⁻¹ M_pa qd_a)

    Below the energy this is collocated partial feedback linearisation, qdd_a = u − kp x_a −
    kd qd_a, and u pumps in time with w, the momentum of the passive joints, whose course gravity
    alone decides. Where the actuated joints are nearly free (√kp far below the passive joints'
    frequency) push is positive; where they follow stiffly push is negative and −push/kp is their
    reach. The twentieth lets the arm start from where it hangs at rest.

    Above the energy nothing pumps: with V = ½ E² + ½ kv (qd_aᵀ qd_a + x_aᵀ kp x_a) it is
    dV/dt = −kv qd_aᵀ kd qd_a, since dE/dt = qd_aᵀ tau_a. Once V_LQR is below the level of `catch`
    the LQR acts; that region is one it does not leave, so the state alone decides.

    Args:
        catch: the regulator of the upright equilibrium; its robot is this law's
        kp: of each joint or of all [1/s²]
        kd: [1/s]
        push: largest u [rad/s² | m/s²]
        energy: distance from the wanted energy at which u is three quarters of push [J]
        speed: w at which u is half of push [rad/s | m/s]
        kv: weight of the motion of a in V [J² s²/rad²]
        extra: energy to aim at beyond that of the equilibrium, for what friction takes on the way;
            with too much of it the arm is too fast to be caught [J]
        period: between samples [s]; None for a continuous law
    Logs: error q_0 − q, excess E [J], caught (1 where the LQR acts), V, Vdot
    Raises: ValueError: no passive joint, wrong gains
    Source: Spong 1995, The swing up control problem for the acrobot, and 1996, Energy based
        control of a class of underactuated mechanical systems; Fantoni, Lozano & Spong 2000,
        Energy based control of the pendubot; Åström & Furuta 2000, Swinging up a pendulum by
        energy control. Pumping below, passivity above, and the change between them are ours.
    """

    def __init__(
        self,
        catch: LQR,
        kp: Any,
        kd: Any,
        push: float,
        energy: float,
        speed: float,
        kv: float = 1.0,
        *,
        extra: float = 0.0,
        period: float | None = None,
    ):
        self.robot, self.catch = catch.robot, catch
        self.a = catch.actuated
        self.p = np.setdiff1d(np.arange(self.robot.n), self.a)
        if not len(self.p) or not len(self.a):
            raise ValueError(
                f"robot '{self.robot.name}' has {len(self.a)} actuated and {len(self.p)} passive "
                f"joints, expected both. A passive joint has the effort limit 0."
            )
        self.kp = joint_gain(self.robot, "kp", kp)[self.a]
        self.kd = joint_gain(self.robot, "kd", kd)[self.a]
        self.push = number("push", push)
        self.scale, self.speed = positive("energy", energy, "J"), positive("speed", speed, "rad/s")
        self.kv = positive("kv", kv, "J² s²/rad²")
        held = float(self.robot.potential_energy(catch.q))
        self.wanted = held + zero_or_more("extra", extra, "J")
        self.period = sampling(period)

    def excess(self, q: Array, qd: Array) -> Array:
        """E (...) [J]"""
        robot = self.robot
        return robot.kinetic_energy(q, qd) + robot.potential_energy(q) - self.wanted

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        caught = self.catch.inside(q, qd)[..., None]
        return np.where(caught, self.catch.effort(t, q, qd, z), self._swing(q, qd))

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        E, x = self.excess(q, qd), self.catch.deviation(q, qd)[..., : self.robot.n]
        a, v = x[..., self.a], qd[..., self.a]
        tau = self.effort(t, q, qd, z)
        qdd = self.robot.forward_dynamics(q, qd, tau)[..., self.a]
        V = (E**2 + self.kv * (dot(v, v) + dot(a, self.kp * a))) / 2
        Vdot = E * dot(v, tau[..., self.a]) + self.kv * dot(v, qdd + self.kp * a)
        caught = np.asarray(self.catch.inside(q, qd), float)
        return {"error": -x, "excess": E, "caught": caught, "V": V, "Vdot": Vdot}

    def _swing(self, q: Array, qd: Array) -> Array:
        a, E = self.a, self.excess(q, qd)
        m = self.robot.mass_matrix_inverse(q)[..., a[:, None], a]
        b = self.robot.forward_dynamics(q, qd, 0 * qd)[..., a]
        x = self.catch.deviation(q, qd)[..., a]
        wanted = self._pump(q, qd, E) - self.kp * x - self.kd * qd[..., a]
        above = np.maximum(E, 0.0)[..., None, None] * np.eye(len(a))
        tau = np.zeros(q.shape)
        tau[..., a] = (
            self.kv * np.linalg.solve(above + self.kv * m, (wanted - b)[..., None])[..., 0]
        )
        return tau

    def _pump(self, q: Array, qd: Array, E: Array) -> Array:
        """u (..., actuated)"""
        a, p, M = self.a, self.p, self.robot.mass_matrix(q)
        coupling = np.linalg.solve(M[..., p[:, None], p], M[..., p[:, None], a])
        w = times(turned(coupling), qd[..., p] + times(coupling, qd[..., a]))
        lacking = np.tanh(np.minimum(E, 0.0) / self.scale)[..., None]
        return self.push * lacking * np.arctan(w / self.speed + NUDGE) * (2 / math.pi)


class Tuning(NamedTuple):
    """What swings one textbook arm up: upright, the LQR's weights, the law's gains."""

    q: tuple[float, ...]
    Q: tuple[float, ...]
    R: float
    gains: dict[str, float]


TUNED = {
    "acrobot": Tuning(
        (math.pi / 2, 0.0),
        (100.0, 100.0, 10.0, 10.0),
        0.01,
        {"kp": 30.0, "kd": 10.0, "push": -60.0, "energy": 5.0, "speed": 0.2, "kv": 0.5},
    ),
    "pendubot": Tuning(
        (math.pi / 2, 0.0),
        (100.0, 100.0, 1.0, 1.0),
        0.1,
        {"kp": 10.0, "kd": 6.0, "push": 20.0, "energy": 5.0, "speed": 0.5, "kv": 10.0},
    ),
    "cart_pole": Tuning(
        (0.0, 0.0),
        (1.0, 1.0, 1.0, 1.0),
        1.0,
        {"kp": 1.0, "kd": 1.0, "push": 10.0, "energy": 0.2, "speed": 0.5, "kv": 1.0},
    ),
}
"""For the default figures of mcgee.arms, found by trial on random starts."""


def swing_up(robot: Robot, kind: str | None = None, **changes: Any) -> EnergySwingUp:
    """EnergySwingUp with the gains for an arm like one of the textbook's.

    Args:
        kind: 'acrobot', 'pendubot' or 'cart_pole'; the robot's name by default
        changes: other gains, and period
    Raises: ValueError: another kind
    """
    name = robot.name if kind is None else kind
    if name not in TUNED:
        raise ValueError(
            f"there are no gains for kind '{name}', only for: {', '.join(TUNED)}. Give kind, or "
            f"take EnergySwingUp with gains of your own."
        )
    q, Q, R, gains = TUNED[name]
    return EnergySwingUp(LQR(robot, q, Q=Q, R=R), **(gains | changes))


def upright_since(law: EnergySwingUp, trajectory: Any) -> Array:
    """When an arm was caught for good (...) [s]; NaN where it was not.

    np.isfinite(upright_since(law, trajectory)).sum() counts the successes of a batch.
    """
    inside = law.catch.inside(trajectory.q, trajectory.qd)  # (..., times)
    out = np.flip(np.cumprod(np.flip(inside, -1), -1), -1) == 0  # not yet, or not for good
    first = np.minimum(out.sum(-1), inside.shape[-1] - 1)
    return np.where(out[..., -1], np.nan, trajectory.t[first])
