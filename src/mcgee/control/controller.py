"""What a controller is to a simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mcgee.control.gains import positive

Array = np.ndarray


class Controller:
    """A law tau(t, q, qd, z); z is the law's own state, which is integrated with the arm's.

    Arrays have any leading dimensions: (..., n). Laws without a state leave `start` and `slope`
    alone.
    """

    period: float | None = None
    """Seconds between samples, tau held between them; None for a continuous law."""

    def start(self, q: Array, qd: Array) -> Array:
        """The law's state at the beginning (..., m)."""
        return np.zeros((*np.shape(q)[:-1], 0))

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        """tau (..., n) [N·m | N]."""
        raise NotImplementedError(f"{type(self).__name__} has no effort(t, q, qd, z).")

    def slope(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        """dz/dt (..., m)."""
        return np.zeros_like(z)

    def log(self, t: float, q: Array, qd: Array, z: Array) -> Mapping[str, Any]:
        """What a trajectory keeps of the law: V and its derivative, errors, estimates."""
        return {}


class Law(Controller):
    """A function tau(t, q, qd) as a controller."""

    def __init__(self, function: Callable[[float, Array, Array], Any], period: float | None = None):
        self.function = function
        self.period = None if period is None else positive("period", period, "s")

    def effort(self, t: float, q: Array, qd: Array, z: Array) -> Any:
        return self.function(t, q, qd)


def as_controller(given: Any) -> Controller | None:
    """
    Raises: TypeError: neither a controller nor a function nor None
    """
    if given is None or isinstance(given, Controller):
        return given
    if callable(given):
        return Law(given)
    raise TypeError(
        f"controller is {given!r}, expected one of mcgee.control, a function tau(t, q, qd), or "
        f"None for free motion."
    )
