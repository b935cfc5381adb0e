"""mcgee: the terms of a robot arm's equation of motion, M(q) qdd + C(q, qd) qd + g(q) = tau."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mcgee import arms, audit, control
from mcgee.errors import ModelError, ModelWarning
from mcgee.formats.dh import from_dh
from mcgee.formats.load import load
from mcgee.robot import ForwardDerivatives, InverseDerivatives, Limits, Robot, Terms
from mcgee.simulate import (  # the function over its package, whose modules import by name
    Friction,
    Rollout,
    SimulationError,
    Stops,
    Trajectory,
    rollout,
    simulate,
)
from mcgee.threads import num_threads, set_num_threads

__version__ = "0.1.0"

if TYPE_CHECKING:
    from mcgee.closed_form import lagrange

__all__ = [
    "ForwardDerivatives",
    "Friction",
    "InverseDerivatives",
    "Limits",
    "ModelError",
    "ModelWarning",
    "Robot",
    "Rollout",
    "SimulationError",
    "Stops",
    "Terms",
    "Trajectory",
    "arms",
    "audit",
    "control",
    "from_dh",
    "lagrange",
    "load",
    "num_threads",
    "rollout",
    "set_num_threads",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """`lagrange` brings SymPy, which takes longer to import than all else."""
    if name == "lagrange":
        from mcgee.closed_form import lagrange

        return lagrange
    raise AttributeError(f"module 'mcgee' has no attribute {name!r}")
