"""References that laws are given: of the right size, or a position to hold."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mcgee.control.gains import joint_vector
from mcgee.control.references import Constant, Desired
from mcgee.robot import Robot


def joint_reference(robot: Robot, given: Any) -> Callable[[float], Desired]:
    """A reference of the joints, from one or from a position to hold.

    Raises: ValueError: its arrays are not (..., n)
    """
    if not callable(given):
        return Constant(joint_vector(robot, "reference", given))

    def reference(t: float) -> Desired:
        return Desired(*(np.asarray(x, float) for x in given(t)))

    at_start = _called(given, reference)
    for name, array in zip(Desired._fields, at_start, strict=True):
        joint_vector(robot, f"{name} of the reference", array)
    return reference


def _called(given: Any, reference: Callable[[float], Desired]) -> Desired:
    try:
        return reference(0.0)
    except TypeError as error:
        raise ValueError(
            f"reference is {given!r}, expected a function t -> (q, qd, qdd) or a position; at "
            f"t = 0: {error}"
        ) from error
