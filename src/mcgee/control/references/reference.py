"""What a reference is, and whether it keeps to the limits of an arm.

A reference is called with a time or an array of times (...) [s] and gives (q, qd, qdd), (..., n)
each. Where it has a start and an end, it stands still before and after.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from mcgee.control.controller import Array
from mcgee.control.gains import numbers
from mcgee.robot import Limits


class Desired(NamedTuple):
    """Positions, velocities and accelerations (..., n) [rad | m], [rad/s | m/s], …"""

    q: Array
    qd: Array
    qdd: Array


class Extremes(NamedTuple):
    """Of each joint, (n,) each, and the times [s] at which they are reached."""

    lowest: Array
    t_lowest: Array
    highest: Array
    t_highest: Array


class Reference:
    """What all references have."""

    @property
    def duration(self) -> float:
        """Of the motion [s]; infinite where it never ends."""
        return np.inf

    def __call__(self, t: Any) -> Desired:
        raise NotImplementedError(f"{type(self).__name__} gives no (q, qd, qdd).")

    def candidates(self, order: int) -> Array:
        """Times (k, n) among which each joint's extreme q (order 0) or qd (order 1) is."""
        raise NotImplementedError(f"{type(self).__name__} does not know its extremes.")

    def extremes(self, order: int = 0) -> Extremes:
        """The lowest and highest positions (order 0) or velocities (order 1)."""
        t = self.candidates(order)
        values = np.diagonal(self(t)[order], axis1=-2, axis2=-1)  # joint j at its own times
        low, high = values.argmin(0), values.argmax(0)
        j = np.arange(t.shape[-1])
        return Extremes(values[low, j], t[low, j], values[high, j], t[high, j])

    def check(self, limits: Limits, joints: Sequence[str] = ()) -> None:
        """Positions and velocities against the limits of `robot.limits`, at their extremes.

        Args:
            joints: `robot.joint_names`, for the sentence of the error
        Raises: ValueError: the first joint that leaves its limits: value, limit and time
        """
        q, qd = self.extremes(0), self.extremes(1)
        if q.lowest.shape != limits.lower.shape:
            raise ValueError(
                f"the reference is one of {q.lowest.shape[-1]} joints, and the limits are of "
                f"{len(limits.lower)}."
            )
        below, above = q.lowest < limits.lower, q.highest > limits.upper
        slow, fast = qd.lowest < -limits.velocity, qd.highest > limits.velocity
        for bad, value, t, limit, what in (
            (below, q.lowest, q.t_lowest, limits.lower, "lower limit {:.6g}"),
            (above, q.highest, q.t_highest, limits.upper, "upper limit {:.6g}"),
            (slow, qd.lowest, qd.t_lowest, limits.velocity, "velocity limit {:.6g}"),
            (fast, qd.highest, qd.t_highest, limits.velocity, "velocity limit {:.6g}"),
        ):
            if bad.any():
                k = int(bad.argmax())
                name = f"'{joints[k]}'" if len(joints) > k else str(k + 1)
                raise ValueError(
                    f"the reference takes joint {name} to {value[k]:.6g} at t = {t[k]:.4g} s, "
                    f"beyond its {what.format(limit[k])}. Slow the motion down or move its points."
                )


class Constant(Reference):
    """A position to hold (..., n)."""

    def __init__(self, q: Any):
        self.q = numbers("q", q)
        if not self.q.ndim or not np.isfinite(self.q).all():
            raise ValueError(f"q is {q!r}, expected finite numbers, one for each joint.")

    @property
    def duration(self) -> float:
        return 0.0

    def __call__(self, t: Any) -> Desired:
        q = np.broadcast_to(self.q, (*np.shape(t), *self.q.shape))
        return Desired(q, np.zeros_like(q), np.zeros_like(q))

    def candidates(self, order: int) -> Array:
        return np.zeros((1, self.q.shape[-1]))
