"""Rotations as vectors: what turns one orientation into another."""

from __future__ import annotations

import numpy as np

from mcgee.control.controller import Array

SMALL = 1e-4
"""Angle to a half turn below which the axis is read off the symmetric part [rad]."""


def rotation_vector(R: Array) -> Array:
    """The axis of a rotation times its angle, 0 to pi (..., 3) [rad].

    Half its squared length has the derivative vᵀ ω under the angular velocity ω of R.
    """
    w = np.stack([R[..., 2, 1], R[..., 0, 2], R[..., 1, 0]], axis=-1)
    w = (w - np.stack([R[..., 1, 2], R[..., 2, 0], R[..., 0, 1]], axis=-1)) / 2  # sin a · axis
    sine, cosine = np.linalg.norm(w, axis=-1), (np.trace(R, axis1=-2, axis2=-1) - 1) / 2
    angle = np.arctan2(sine, cosine)
    half = (sine < SMALL) & (cosine < 0)
    ratio = np.where(half, 1.0, np.divide(angle, sine, out=np.ones_like(sine), where=sine > 1e-12))
    return np.where(half[..., None], _near_half_turn(R, w, angle), ratio[..., None] * w)


def _near_half_turn(R: Array, w: Array, angle: Array) -> Array:
    """From R + Rᵀ, about 2 (axis axisᵀ) less a multiple of 1; w gives the sign where it can."""
    c = np.cos(angle)[..., None, None]
    outer = (R + np.swapaxes(R, -1, -2)) / 2 - c * np.eye(3)  # (1 − c) axis axisᵀ
    k = np.diagonal(outer, axis1=-2, axis2=-1).argmax(-1)[..., None, None]
    axis = np.take_along_axis(outer, k, axis=-1)[..., 0]
    axis = axis / np.maximum(np.linalg.norm(axis, axis=-1, keepdims=True), 1e-300)
    sign = np.where((axis * w).sum(-1, keepdims=True) < 0, -1.0, 1.0)
    return sign * axis * angle[..., None]
