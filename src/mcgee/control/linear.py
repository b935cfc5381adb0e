"""Products of matrices and vectors in leading dimensions."""

from __future__ import annotations

import numpy as np

from mcgee.control.controller import Array


def times(M: Array, v: Array) -> Array:
    """M v: (..., i, j) and (..., j) to (..., i)."""
    return (M @ v[..., None])[..., 0]


def turned(M: Array) -> Array:
    """The transpose (..., j, i)."""
    return np.swapaxes(M, -1, -2)


def dot(a: Array, b: Array) -> Array:
    """aᵀb (...)."""
    return (a * b).sum(-1)


def quadratic(v: Array, M: Array) -> Array:
    """vᵀ M v (...)."""
    return dot(v, times(M, v))
