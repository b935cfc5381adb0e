"""mcgee: the terms of a robot arm's equation of motion, M(q) qdd + C(q, qd) qd + g(q) = tau."""

from mcgee import arms, audit
from mcgee.errors import ModelError, ModelWarning
from mcgee.formats.dh import from_dh
from mcgee.formats.load import load
from mcgee.robot import ForwardDerivatives, InverseDerivatives, Limits, Robot, Terms
from mcgee.threads import num_threads, set_num_threads

__version__ = "0.1.0"

__all__ = [
    "ForwardDerivatives",
    "InverseDerivatives",
    "Limits",
    "ModelError",
    "ModelWarning",
    "Robot",
    "Terms",
    "arms",
    "audit",
    "from_dh",
    "load",
    "num_threads",
    "set_num_threads",
]
