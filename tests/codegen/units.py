"""Units of generated code that several tests look at, each made once."""

from __future__ import annotations

from functools import cache

from mcgee.codegen.unit import Unit, unit
from robots import built_in, loaded

FUNCTIONS = (
    *("terms", "inverse_dynamics", "forward_dynamics", "coriolis_matrix", "jacobian"),
    *("forward_kinematics", "regressor", "inverse_dynamics_derivatives"),
    *("forward_dynamics_derivatives", "kinetic_energy", "christoffel"),
)
"""Every shape of result there is: numbers, vectors, matrices, several, and c_ijk."""


def arm(name: str):
    return loaded(name) if name == "ur5" else built_in(name)


@cache
def made(
    name: str,
    functions: tuple[str, ...] = ("terms",),
    params: bool = False,
    single: bool = False,
) -> Unit:
    robot = arm(name)
    return unit(robot, functions, params, {}, robot.end_frame, single)
