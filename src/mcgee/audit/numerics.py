"""How far apart arrays are, and numerical derivatives, on batches."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Array = np.ndarray


def apart(a: Array, b: Array, *sizes: Array, axes: int = 1) -> Array:
    """|a − b| over the largest of |a|, |b| and the sizes, along the last axes."""
    along = tuple(range(-axes, 0))
    scale = np.maximum(abs(a).max(along, initial=0), abs(b).max(along, initial=0))
    for size in sizes:
        scale = np.maximum(scale, size)
    return abs(a - b).max(along, initial=0) / np.where(scale == 0, 1, scale)


# central differences of eighth order
_STEP = 0.02
_WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)


def slope(f: Callable[[float], Array]) -> Array:
    """df/dt at t = 0."""
    pairs = (w * (f(k * _STEP) - f(-k * _STEP)) for k, w in enumerate(_WEIGHTS, 1))
    return sum(pairs, start=np.zeros(())) / _STEP


def gradient(f: Callable[[Array], Array], q: Array) -> Array:
    """∂f/∂q_k, k along a new last axis."""
    n = q.shape[-1]

    def along(e: Array) -> Array:
        return slope(lambda t: f(q + t * e))

    return np.stack([along(e) for e in np.eye(n)], axis=-1)


def times(M: Array, v: Array) -> Array:
    return (M @ v[..., None])[..., 0]


def dot(a: Array, b: Array) -> Array:
    return (a * b).sum(-1)
