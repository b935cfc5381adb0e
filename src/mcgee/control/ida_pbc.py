"""Interconnection and damping assignment: another energy in the place of the arm's own."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mcgee.control.controller import Array, Controller


class Energy(NamedTuple):
    """The wanted energy H_d (...) [of its own unit], and y = Gᵀ ∂H_d/∂p (...)."""

    Hd: Array
    y: Array


class IDAPBC(Controller):
    """Closed loops [qd, pd] = [[0, M⁻¹M_d], [−M_d M⁻¹, J_2 − G kv Gᵀ]] ∂H_d.

    H_d = ½ pᵀ M_d⁻¹(q) p + V_d(q) has its minimum at the wanted equilibrium and falls by
    dH_d/dt = −kv y². A law states M_d, V_d and J_2 that solve the matching equations

        G⊥ (∂V − M_d M⁻¹ ∂V_d) = 0
        G⊥ (∂(pᵀ M⁻¹ p) − M_d M⁻¹ ∂(pᵀ M_d⁻¹ p) + 2 J_2 M_d⁻¹ p) = 0

    of its arm, G⊥ G = 0 and ∂ by q.

    Logs: V = H_d, Vdot
    Source: Ortega, Spong, Gómez-Estern & Blankenstein 2002, Stabilization of a class of
        underactuated mechanical systems via interconnection and damping assignment, IEEE
        Transactions on Automatic Control 47(8)
    """

    kv: float

    def energy(self, q: Array, qd: Array) -> Energy:
        raise NotImplementedError(f"{type(self).__name__} has no H_d.")

    def log(self, t: float, q: Array, qd: Array, z: Array) -> dict[str, Array]:
        Hd, y = self.energy(q, qd)
        return {"V": Hd, "Vdot": -self.kv * y**2}


SOME = np.array([[0.0, 0.0], [0.3, -0.7], [-1.1, 2.0], [2.5, 0.4]])
"""Positions at which an arm is compared with what a law is for."""
