"""Motion: integrators, friction, stops, controllers, and the ledger of the energy."""

from mcgee.simulate.plant import Friction, Stops
from mcgee.simulate.rollout import Rollout, rollout
from mcgee.simulate.run import SimulationError, simulate
from mcgee.simulate.trajectory import Trajectory

__all__ = [
    "Friction",
    "Rollout",
    "SimulationError",
    "Stops",
    "Trajectory",
    "rollout",
    "simulate",
]
