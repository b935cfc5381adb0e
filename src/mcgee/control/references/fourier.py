"""References that repeat: finite Fourier series, as identification and adaptation want them."""

from __future__ import annotations

from typing import Any

import numpy as np

from mcgee.control.controller import Array
from mcgee.control.gains import numbers, positive, zero_or_more
from mcgee.control.references.reference import Desired, Reference

GRID = 64
"""Points for each half-wave of the highest harmonic in which the ramp's extremes are sought."""


class Fourier(Reference):
    """q = mean + r(t) Σ_k (sine_k sin kωt + cosine_k cos kωt).

    r is 1, or rises from rest over `ramp` seconds, twice continuously differentiable.

    Args:
        mean: (n,) [rad | m]
        sine, cosine: (harmonics, n), of k = 1, 2, …
        frequency: of the first harmonic [Hz]
        ramp: [s]; 0 starts in full motion
    Raises: ValueError: wrong shapes, no positive frequency, a negative ramp
    Source: Swevers et al. 1997, Optimal robot excitation and identification
    """

    def __init__(self, mean: Any, sine: Any, cosine: Any, frequency: float, ramp: float = 0.0):
        self.mean = numbers("mean", mean)
        self.sine, self.cosine = numbers("sine", sine), numbers("cosine", cosine)
        shape = (len(np.atleast_1d(self.sine)), *self.mean.shape)
        if self.mean.ndim != 1 or self.sine.shape != shape or self.cosine.shape != shape:
            raise ValueError(
                f"mean, sine and cosine have shapes {self.mean.shape}, {self.sine.shape} and "
                f"{self.cosine.shape}, expected (n,), (harmonics, n) and (harmonics, n)."
            )
        if not all(np.isfinite(x).all() for x in (self.mean, self.sine, self.cosine)):
            raise ValueError("mean, sine and cosine hold numbers that are not finite.")
        self.omega = 2 * np.pi * positive("frequency", frequency, "Hz")
        self.ramp = zero_or_more("ramp", ramp, "s")
        self.k = np.arange(1, shape[0] + 1)

    def __call__(self, t: Any) -> Desired:
        t = np.asarray(t, float)
        rate = self.k * self.omega
        c, s = np.cos(t[..., None] * rate), np.sin(t[..., None] * rate)
        y = s @ self.sine + c @ self.cosine
        yd = (c * rate) @ self.sine - (s * rate) @ self.cosine
        ydd = -(s * rate**2) @ self.sine - (c * rate**2) @ self.cosine
        r, rd, rdd = (x[..., None] for x in self._rise(t))
        q, qd = self.mean + r * y, rd * y + r * yd
        return Desired(q, qd, rdd * y + 2 * rd * yd + r * ydd)

    def _rise(self, t: Array) -> tuple[Array, Array, Array]:
        """r, its first and second derivative."""
        if self.ramp == 0:
            return np.ones_like(t), np.zeros_like(t), np.zeros_like(t)
        x = np.clip(t / self.ramp, 0.0, 1.0)
        r = x**3 * (10 - 15 * x + 6 * x**2)
        rd, rdd = 30 * x**2 * (1 - x) ** 2, 60 * x * (1 - x) * (1 - 2 * x)
        return r, rd / self.ramp, rdd / self.ramp**2

    def candidates(self, order: int) -> Array:
        """In full motion the roots of a trigonometric polynomial, exactly; on the ramp, bisected
        changes of sign of the next derivative on a fine grid."""
        rate = (self.k * self.omega)[:, None] ** (order + 1)
        turns = (self.sine, -self.cosine, -self.sine)  # what each derivative gives the cosine
        cosine, sine = turns[order] * rate, turns[order + 1] * rate
        found = [self._roots(cosine, sine)]
        if self.ramp:
            found += [np.zeros((1, len(self.mean))), self._on_the_ramp(order + 1)]
        return np.concatenate(found)

    def _roots(self, cosine: Array, sine: Array) -> Array:
        """Times after the ramp at which Σ cosine_k cos kωt + sine_k sin kωt is zero (k, n).

        With z = exp(iωt) it is a polynomial in z; roots off the unit circle do no harm, the
        reference being looked at there all the same.
        """
        harmonics, n = cosine.shape
        half = (cosine - 1j * sine) / 2
        polynomial = np.concatenate([half[::-1], np.zeros((1, n)), half.conj()])
        period = 2 * np.pi / self.omega
        times = np.full((2 * harmonics, n), self.ramp)
        for j in range(n):
            z = np.roots(polynomial[:, j])
            since = (np.angle(z) / self.omega - self.ramp) % period
            times[: len(z), j] = self.ramp + since
        return times

    def _on_the_ramp(self, order: int) -> Array:
        count = int(np.ceil(GRID * self.ramp * self.omega * self.k[-1] / np.pi)) + GRID
        grid = np.linspace(0.0, self.ramp, count)
        values = self(grid)[order]
        times = [np.broadcast_to(grid[-1], (1, len(self.mean)))]
        for j in range(len(self.mean)):
            at = np.flatnonzero(np.diff(np.sign(values[:, j])))
            low, high, sign = grid[at], grid[at + 1], np.sign(values[at, j])
            for _ in range(50):
                middle = (low + high) / 2
                same = np.sign(self(middle)[order][:, j]) == sign
                low, high = np.where(same, middle, low), np.where(same, high, middle)
            column = np.zeros((len(at), len(self.mean)))
            column[:, j] = (low + high) / 2
            times.append(column)
        return np.concatenate(times)
