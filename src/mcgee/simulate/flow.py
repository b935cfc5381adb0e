"""The differential equation of an arm, its controller and its ledger."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mcgee.control.controller import Array, Controller
from mcgee.simulate.plant import Efforts, Plant, usable

BOOKS = ("work", "dissipated", "stopped", "disturbed")
"""Energies that are integrated with the motion, joint by joint."""

DIFFERENCE = 2.0**-26
"""Of a coordinate for a Jacobian: the root of the rounding unit."""


@dataclass
class Flow:
    """dy/dt of y = (q, qd, z, the books), in any leading dimensions.

    A sampled controller's effort and slope are held from one `sample` to the next.
    """

    plant: Plant
    controller: Controller | None
    states: int
    """Of the controller."""
    held: tuple[Array, Array] | None = field(default=None)
    sampled: float | None = field(default=None)
    """When the controller looked last."""

    @property
    def n(self) -> int:
        return self.plant.robot.n

    @property
    def period(self) -> float | None:
        """Of the controller's samples [s]."""
        return None if self.controller is None else self.controller.period

    def begin(self, q: Array, qd: Array, z: Array) -> Array:
        books = np.zeros((*q.shape[:-1], len(BOOKS) * self.n))
        return np.concatenate([q, qd, z, books], axis=-1)

    def apart(self, y: Array) -> tuple[Array, Array, Array, Array]:
        """(q, qd, z, books (..., books, n))."""
        n, m = self.n, self.states
        books = y[..., 2 * n + m :]
        shaped = books.reshape(*books.shape[:-1], len(BOOKS), n)
        return y[..., :n], y[..., n : 2 * n], y[..., 2 * n : 2 * n + m], shaped

    def sample(self, t: float, y: Array) -> None:
        """Let a sampled controller look."""
        if self.controller is not None and self.controller.period is not None:
            if t == self.sampled:
                return
            self.sampled = t
            q, qd, z, _ = self.apart(y)
            self.held = self._asked(t, q, qd, z), np.array(self.controller.slope(t, q, qd, z))

    def efforts(self, t: float, q: Array, qd: Array, z: Array) -> Efforts:
        if self.controller is None:
            wanted = np.zeros_like(q)
        else:
            wanted = self._asked(t, q, qd, z) if self.held is None else self.held[0]
        return self.plant.efforts(t, q, qd, wanted)

    def __call__(self, t: float, y: Array) -> Array:
        q, qd, z, _ = self.apart(y)
        e = self.efforts(t, q, qd, z)
        qdd = self.plant.robot.forward_dynamics(q, qd, e.total)
        powers = (e.applied * qd, e.friction * qd, e.stops * qd, e.disturbance * qd)
        return np.concatenate([qd, qdd, self.controller_slope(t, q, qd, z), *powers], axis=-1)

    def jacobian(self, t: float, y: Array) -> Array:
        """∂(dy/dt)/∂y of one state, by differences; nothing depends on the books.

        SciPy's own differences grow without end in what nothing depends on.
        """
        now = self(t, y)
        found = np.zeros((len(y), len(y)))
        for k in range(2 * self.n + self.states):
            beside = y.copy()
            beside[k] += DIFFERENCE * max(1.0, abs(y[k]))
            found[:, k] = (self(t, beside) - now) / (beside[k] - y[k])
        return found

    def controller_slope(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        if self.held is not None:
            return self.held[1]
        if self.controller is None or not self.states:
            return z
        return np.asarray(self.controller.slope(t, q, qd, z), float)

    def _asked(self, t: float, q: Array, qd: Array, z: Array) -> Array:
        assert self.controller is not None
        who = f"controller {type(self.controller).__name__} gives"
        given = self.controller.effort(t, q, qd, z)
        return usable(who, given, self.plant.robot, t, q, qd)
