"""References that are polynomials from knot to knot: quintics and trapezoidal velocities."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from mcgee.control.controller import Array
from mcgee.control.gains import number, numbers
from mcgee.control.references.reference import Desired, Reference


class Polynomials(Reference):
    """Polynomials from knot to knot, of the time since the knot before."""

    knots: Array
    """(pieces + 1,) [s], the first one 0."""
    coefficients: Array
    """(pieces, powers, n), the constant first."""

    @property
    def duration(self) -> float:
        return float(self.knots[-1])

    @cached_property
    def orders(self) -> tuple[Array, Array, Array]:
        """The coefficients of q, qd and qdd."""
        powers = np.arange(1, self.coefficients.shape[1])[:, None]
        first = self.coefficients[:, 1:] * powers
        return self.coefficients, first, first[:, 1:] * powers[:-1]

    def __call__(self, t: Any) -> Desired:
        t = np.asarray(t, float)
        inside = np.clip(t, 0.0, self.duration)
        k = np.clip(np.searchsorted(self.knots, inside, "right") - 1, 0, len(self.knots) - 2)
        x = (inside - self.knots[k])[..., None]
        found = []
        for coefficients in self.orders:
            chosen, value = coefficients[k], np.zeros(())
            for power in reversed(range(chosen.shape[-2])):
                value = value * x + chosen[..., power, :]
            found.append(value)
        moves = ((t >= 0) & (t <= self.duration))[..., None]
        return Desired(found[0], found[1] * moves, found[2] * moves)

    def candidates(self, order: int) -> Array:
        """The knots, and the roots of the next derivative between them."""
        slopes = self.orders[order + 1]
        n = slopes.shape[-1]
        times = [np.broadcast_to(self.knots[:, None], (len(self.knots), n))]
        for k, (start, end) in enumerate(zip(self.knots, self.knots[1:], strict=False)):
            row = np.full((max(slopes.shape[1] - 1, 0), n), start)
            for j in range(n):
                roots = np.roots(slopes[k, ::-1, j])
                within = roots.real[(roots.real > 0) & (roots.real < end - start)]
                row[: len(within), j] = start + within
            times.append(row)
        return np.concatenate(times)


class Quintic(Polynomials):
    """Polynomials of the fifth degree: continuous accelerations, zero at the points.

    Args:
        q0, q1: positions at the start and at the end (n,) [rad | m]
        duration: [s]
        qd0, qd1: velocities there, zero by default
        via: points (t, q, qd) between them, in the order of their times
    Raises: ValueError: wrong shapes; times that do not grow
    Source: Craig 2005, Introduction to Robotics, section 7.3
    """

    def __init__(
        self,
        q0: Any,
        q1: Any,
        duration: float,
        *,
        qd0: Any = 0.0,
        qd1: Any = 0.0,
        via: Sequence[tuple[float, Any, Any]] = (),
    ):
        for point in via:
            if not isinstance(point, Sequence) or len(point) != 3:
                raise ValueError(f"via holds {point!r}, expected (t, q, qd).")
        points = [(0.0, q0, qd0), *via, (duration, q1, qd1)]
        knots = np.array([number("the time of a point", t) for t, _, _ in points])
        if not (np.isfinite(knots).all() and (np.diff(knots) > 0).all()):
            listed = ", ".join(f"{t:g}" for t in knots)
            raise ValueError(f"the times of the points are {listed} s, expected growing ones.")
        q = _alike("positions of the points", [q for _, q, _ in points])
        rates = [numbers("velocities of the points", v) for _, _, v in points]
        rates = [np.broadcast_to(v, q.shape[1]) if v.ndim == 0 else v for v in rates]
        qd = _alike("velocities of the points", [q[0], *rates])[1:]
        h = np.diff(knots)[:, None]
        step, v0, v1 = np.diff(q, axis=0), qd[:-1] * h, qd[1:] * h
        rising = (q[:-1], v0, 0 * step, 10 * step - 6 * v0 - 4 * v1)
        falling = (-15 * step + 8 * v0 + 7 * v1, 6 * step - 3 * v0 - 3 * v1)
        scaled = [c / h**k for k, c in enumerate((*rising, *falling))]
        self.knots, self.coefficients = knots, np.stack(scaled, axis=1)


class Trapezoidal(Polynomials):
    """A straight line, at constant acceleration, constant speed, constant deceleration.

    The joints move together, the one that needs longest as fast as it may; where the way is too
    short for its speed there is no constant part.

    Args:
        q0, q1: positions (n,) [rad | m]
        velocity: highest, of each joint or of all [rad/s | m/s]
        acceleration: so too [rad/s² | m/s²]
    Raises: ValueError: wrong shapes, limits that are not above zero
    Source: Siciliano et al. 2009, Robotics, section 4.2.1
    """

    def __init__(self, q0: Any, q1: Any, velocity: Any, acceleration: Any):
        q = _alike("q0 and q1", [q0, q1])
        way = q[1] - q[0]
        rates = []
        for name, given in (("velocity", velocity), ("acceleration", acceleration)):
            limit = numbers(name, given)
            if limit.shape not in ((), way.shape) or not (limit > 0).all():
                raise ValueError(f"{name} is {given!r}, expected {len(way)} above 0, or one.")
            rate = np.full(len(way), np.inf)
            np.divide(limit, abs(way), out=rate, where=way != 0)
            rates.append(float(rate.min()))
        if not way.any():
            self.knots, self.coefficients = np.zeros(2), np.stack([q[0], 0 * way, 0 * way])[None]
            return
        if not np.isfinite(rates[1]):
            raise ValueError(f"acceleration is {acceleration!r}, expected finite numbers.")
        a, v = rates[1], min(rates[0], float(np.sqrt(rates[1])))
        knots = [0.0, v / a, 1 / v, 1 / v + v / a]
        self.knots = np.maximum.accumulate(knots)  # rounding, where there is no constant part
        covered = v * v / (2 * a)
        pieces = [(0.0, 0.0, a / 2), (covered, v, 0.0), (1 - covered, v, -a / 2)]
        self.coefficients = np.array(pieces)[..., None] * way
        self.coefficients[:, 0] += q[0]


def _alike(what: str, rows: Sequence[Any]) -> Array:
    """(rows, n) finite numbers.

    Raises: ValueError: rows of different lengths, or not finite
    """
    arrays = [numbers(what, row) for row in rows]
    shapes = {array.shape for array in arrays}
    if len(shapes) > 1 or arrays[0].ndim != 1:
        listed = ", ".join(str(array.shape) for array in arrays)
        raise ValueError(f"the {what} have shapes {listed}, expected (n,) each.")
    found = np.stack(arrays)
    if not np.isfinite(found).all():
        raise ValueError(f"the {what} hold numbers that are not finite.")
    return found
