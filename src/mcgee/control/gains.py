"""What a law is told: gains, positions, directions, and one clear sentence for bad ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mcgee.robot import Robot

Array = np.ndarray


def joint_gain(robot: Robot, name: str, given: Any, *, positive: bool = False) -> Array:
    """A gain of each joint (n,).

    Raises: ValueError: neither a number nor one for each joint; negative, or not finite
    """
    return gain(f"robot '{robot.name}'", name, given, robot.joint_names, "joint", positive)


def gain(
    owner: str,
    name: str,
    given: Any,
    labels: Sequence[str],
    kind: str = "joint",
    positive: bool = False,
) -> Array:
    """One number for each label, from a number or from as many."""
    array = numbers(name, given)
    if array.shape not in ((), (len(labels),)):
        listed = ", ".join(labels) if len(labels) <= 12 else f"{len(labels)} of them"
        raise ValueError(
            f"{name} has shape {array.shape}, expected a number or ({len(labels)},) for {owner}. "
            f"{kind.capitalize()}s: {listed}."
        )
    found = np.broadcast_to(array, (len(labels),)).copy()
    bad = ~np.isfinite(found) | (found <= 0 if positive else found < 0)
    if bad.any():
        k = int(bad.argmax())
        least = "more than 0" if positive else "zero or more"
        raise ValueError(f"{name} of {kind} '{labels[k]}' is {found[k]:g}, expected {least}.")
    return found


def gain_matrix(owner: str, name: str, given: Any, labels: Sequence[str], kind: str) -> Array:
    """A symmetric, positive definite matrix, from one, from its diagonal or from a number.

    Raises: ValueError: another shape, or not so
    """
    matrix = numbers(name, given)
    if matrix.ndim < 2:
        return np.diag(gain(owner, name, matrix, labels, kind, positive=True))
    size = (len(labels), len(labels))
    if matrix.shape != size:
        raise ValueError(
            f"{name} has shape {matrix.shape}, expected a number, {size[:1]} or {size} for {owner}."
        )
    is_even = np.isfinite(matrix).all() and np.allclose(matrix, matrix.T, rtol=1e-9, atol=0)
    least = np.linalg.eigvalsh(matrix).min() if is_even else np.nan
    if not least > 0:
        what = f"with an eigenvalue {least:g}" if is_even else "not symmetric, or not finite"
        raise ValueError(f"{name} is a matrix {what}, expected one symmetric, positive definite.")
    return matrix


def number(name: str, given: Any) -> float:
    """
    Raises: ValueError: not one finite number
    """
    array = numbers(name, given)
    if array.shape != () or not np.isfinite(array):
        raise ValueError(f"{name} is {given!r}, expected a finite number.")
    return float(array)


def positive(name: str, given: Any, unit: str) -> float:
    """
    Raises: ValueError: not one finite number above zero
    """
    array = numbers(name, given)
    if array.shape != () or not (np.isfinite(array) and array > 0):
        raise ValueError(f"{name} is {given!r}, expected a number above 0 {unit}".rstrip() + ".")
    return float(array)


def zero_or_more(name: str, given: Any, unit: str = "") -> float:
    """
    Raises: ValueError: not one finite number, or a negative one
    """
    array = numbers(name, given)
    if array.shape != () or not (np.isfinite(array) and array >= 0):
        raise ValueError(f"{name} is {given!r}, expected a number, 0 or more {unit}".rstrip() + ".")
    return float(array)


def sampling(period: Any) -> float | None:
    """Seconds between samples, or None for a continuous law.

    Raises: ValueError: not above zero
    """
    return None if period is None else positive("period", period, "s")


def numbers(name: str, given: Any) -> Array:
    """
    Raises: ValueError: texts, None, truth values, lists of unlike lengths
    """
    try:
        array = np.asarray(given)
        if array.dtype.kind in "iuf" or (array.dtype.kind == "O" and None not in array.ravel()):
            return np.asarray(array, float)
    except (TypeError, ValueError):
        pass
    raise ValueError(f"{name} is {given!r}, expected numbers.")


def joint_vector(robot: Robot, name: str, given: Any) -> Array:
    """Finite numbers (..., n).

    Raises: ValueError: another shape, or not finite
    """
    array = numbers(name, given)
    if array.shape[-1:] != (robot.n,):
        raise ValueError(
            f"{name} has shape {array.shape}, expected (..., {robot.n}) for robot '{robot.name}'. "
            f"Joints: {', '.join(robot.joint_names)}."
        )
    return _finite(name, array)


def finite(name: str, given: Any, shape: tuple[int, ...], what: str = "numbers") -> Array:
    """Finite numbers, of which the last dimensions are of this shape.

    Raises: ValueError: another shape, or not finite
    """
    array = numbers(name, given)
    if array.shape[array.ndim - len(shape) :] != shape or array.ndim < len(shape):
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}: {what}.")
    return _finite(name, array)


def _finite(name: str, array: Array) -> Array:
    if not np.isfinite(array).all():
        raise ValueError(f"{name} holds {array[~np.isfinite(array)][0]}, expected finite numbers.")
    return array


def unit(name: str, given: Any) -> Array:
    """A direction (3,).

    Raises: ValueError: another shape, no length
    """
    vector = numbers(name, given)
    length = np.linalg.norm(vector)
    if vector.shape != (3,) or not (np.isfinite(length) and length > 0):
        raise ValueError(f"{name} is {given!r}, expected 3 numbers that are not all 0.")
    return vector / length
