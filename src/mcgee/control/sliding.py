"""The reference velocity of passivity-based laws."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from mcgee.control.controller import Array
from mcgee.control.references import Desired


class Sliding(NamedTuple):
    """(..., n) each. s = 0 is a plane of the state space on which the error dies out by itself."""

    e: Array
    """q_d − q"""
    s: Array
    """qd_r − qd = ed + lam e"""
    qd_r: Array
    """qd_d + lam e"""
    qdd_r: Array


def sliding(
    reference: Callable[[float], Desired], lam: Array, t: float, q: Array, qd: Array
) -> Sliding:
    d = reference(t)
    e, ed = d.q - q, d.qd - qd
    return Sliding(e, ed + lam * e, d.qd + lam * e, d.qdd + lam * ed)
