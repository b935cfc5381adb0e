"""What moves an arm besides its own dynamics: actuators, friction, stops, disturbances.

M(q) qdd + C(q, qd) qd + g(q) = applied − friction(qd) + stops(q, qd) + disturbance(t, q, qd)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from mcgee.control.gains import numbers, positive, zero_or_more
from mcgee.mechanism import friction
from mcgee.robot import Robot

Array = np.ndarray
Disturbance = Callable[[float, Array, Array], Any]


@dataclass(frozen=True)
class Friction:
    """Viscous and Coulomb friction of the description's joints.

    viscous qd + coulomb tanh(qd / speed): tanh stands for the sign, which no integrator can follow
    through zero; at `speed` three quarters of the Coulomb friction are there, and below it joints
    creep where in truth they would stick.

    Args:
        viscous, coulomb: whether each is there
        speed: of the regularisation [rad/s | m/s]
    """

    viscous: bool = True
    coulomb: bool = True
    speed: float = 0.01

    def __post_init__(self) -> None:
        positive("speed of friction", self.speed, "rad/s")


@dataclass(frozen=True)
class Stops:
    """Springs and dampers beyond the joints' limits.

    stiffness x (1 + damping xd), never pulling, x being how far the joint is beyond its limit
    (Hunt & Crossley 1975): no jump at the first touch, and what a rebound loses grows with speed.

    Args:
        stiffness: [N·m/rad | N/m]
        damping: [s/rad | s/m]
    """

    stiffness: float = 1e4
    damping: float = 0.5

    def __post_init__(self) -> None:
        zero_or_more("stiffness of stops", self.stiffness)
        zero_or_more("damping of stops", self.damping)


class Efforts(NamedTuple):
    """(..., n) each; they add up to what the dynamics see."""

    applied: Array
    """By the actuators."""
    friction: Array
    """Against the motion: subtracted."""
    stops: Array
    disturbance: Array

    @property
    def total(self) -> Array:
        return self.applied - self.friction + self.stops + self.disturbance


@dataclass(frozen=True)
class Plant:
    robot: Robot
    friction: Friction | None = None
    stops: Stops | None = None
    effort_limits: bool = False
    """Whether actuators give no more than the description's effort."""
    disturbance: Disturbance | None = None

    def efforts(self, t: float, q: Array, qd: Array, wanted: Array) -> Efforts:
        """
        Args:
            wanted: by the controller (..., n)
        """
        if self.effort_limits:
            effort = self.robot.limits.effort
            wanted = np.clip(wanted, -effort, effort)
        nothing = np.zeros_like(q)
        return Efforts(
            wanted,
            nothing if self.friction is None else self._rubbing(qd),
            nothing if self.stops is None else self._stopping(self.stops, q, qd),
            nothing if self.disturbance is None else self._disturbing(t, q, qd),
        )

    @cached_property
    def _coefficients(self) -> tuple[Array, Array]:
        viscous, coulomb = np.array(friction(self.robot.joints, self.robot.joint_names)).T
        return viscous, coulomb

    def _rubbing(self, qd: Array) -> Array:
        assert self.friction is not None
        viscous, coulomb = self._coefficients
        found = viscous * qd if self.friction.viscous else np.zeros_like(qd)
        return found + coulomb * np.tanh(qd / self.friction.speed) * self.friction.coulomb

    def _stopping(self, stops: Stops, q: Array, qd: Array) -> Array:
        lower, upper = self.robot.limits.lower, self.robot.limits.upper
        below, above = np.maximum(lower - q, 0), np.maximum(q - upper, 0)
        up = stops.stiffness * below * np.maximum(1 - stops.damping * qd, 0)
        return up - stops.stiffness * above * np.maximum(1 + stops.damping * qd, 0)

    def _disturbing(self, t: float, q: Array, qd: Array) -> Array:
        assert self.disturbance is not None
        given = self.disturbance(t, q, qd)
        return usable("the disturbance gives", given, self.robot, t, q, qd)


class EffortError(ValueError):
    """A controller or a disturbance gives what is no effort."""


def usable(who: str, given: Any, robot: Robot, t: float, q: Array, qd: Array) -> Array:
    """Efforts (..., n) as numbers.

    Args:
        who: how the sentence begins
    Raises: EffortError: no numbers, another shape, not finite though the state is
    """
    try:
        efforts = np.broadcast_to(numbers(who, given), q.shape)
    except ValueError:
        shape = getattr(given, "shape", None)
        what = repr(given) if shape is None else f"an array of shape {shape}"
        raise EffortError(
            f"{who} {what[:80]}, expected numbers of shape {q.shape} for robot '{robot.name}'."
        ) from None
    bad = ~np.isfinite(efforts)
    if bad.any() and np.isfinite(q).all() and np.isfinite(qd).all():
        what = efforts[bad][0]
        joint = robot.joint_names[int(bad.reshape(-1, robot.n).any(0).argmax())]
        raise EffortError(f"{who} {what} for joint '{joint}' at t = {t:.6g} s, expected a number.")
    return efforts
