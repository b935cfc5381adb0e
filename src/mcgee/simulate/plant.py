"""What moves an arm besides its own dynamics: actuators, friction, stops, disturbances.

M(q) qdd + C(q, qd) qd + g(q) = applied − friction(qd) + stops(q, qd) + disturbance(t, q, qd)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

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
        if not (np.isfinite(self.speed) and self.speed > 0):
            raise ValueError(f"speed is {self.speed!r}, expected more than 0 rad/s.")


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
        for name in ("stiffness", "damping"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"{name} of stops is {value!r}, expected zero or more.")


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
        joints = self.robot.independent_joints
        viscous, coulomb = (
            np.array([float(getattr(joint, what)) for joint in joints])
            for what in ("viscous", "coulomb")
        )
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
        given = np.asarray(self.disturbance(t, q, qd), float)
        try:
            return np.broadcast_to(given, q.shape)
        except ValueError:
            raise ValueError(
                f"the disturbance gives shape {given.shape}, expected {q.shape} for robot "
                f"'{self.robot.name}'."
            ) from None
