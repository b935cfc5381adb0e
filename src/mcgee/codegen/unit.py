"""What is written: a robot's functions as routines, under the names that generated code uses."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee import build
from mcgee.codegen import symbols
from mcgee.codegen.names import Names, stem, words
from mcgee.codegen.readable import dynamics
from mcgee.codegen.routine import Routine, routine
from mcgee.codegen.vectors import STATES, Vectors, vectors
from mcgee.graph.program import Array
from mcgee.kernels import singular

if TYPE_CHECKING:
    from mcgee.robot import Robot

RENAMED = {
    **{"qd": "qdot", "qdd": "qddot", "Cqd": "Cqdot", "parameters": "params"},
    **{"dtau_dqd": "dtau_dqdot", "dqdd_dq": "dqddot_dq", "dqdd_dqd": "dqddot_dqdot"},
}
"""Arrays whose names in generated code are not the library's."""

MEANINGS = {
    "q": "joint positions [rad | m]",
    "qdot": "joint velocities [rad/s | m/s]",
    "qddot": "joint accelerations [rad/s^2 | m/s^2]",
    "tau": "joint efforts [N m | N]",
    "v": "a second joint velocity [rad/s | m/s]",
    "params": "parameters in SI units",
    "M": "inertia matrix [kg m^2 | kg m | kg]",
    "Minv": "inverse of the inertia matrix",
    "C": "Coriolis matrix, Mdot - 2 C skew-symmetric",
    "Cqdot": "centrifugal and Coriolis efforts C qdot [N m | N]",
    "Cv": "C(q, qdot) v [N m | N]",
    "c": "Christoffel symbols of the first kind c_ijk",
    "g": "gravity efforts dP/dq: what holds the arm still [N m | N]",
    "dg_dq": "derivatives of the gravity efforts [N m/rad | N/m]",
    "dtau_dq": "derivatives of tau by q",
    "dtau_dqdot": "derivatives of tau by qdot",
    "dqddot_dq": "derivatives of qddot by q",
    "dqddot_dqdot": "derivatives of qddot by qdot",
    "Y": "regressor, tau = Y times the inertial parameters",
    "T": "kinetic energy [J]",
    "P": "potential energy [J]",
    "pose": "homogeneous matrix of the frame in the root frame [m]",
    "poses": "homogeneous matrices of the links at their centres of mass [m]",
    "J": "Jacobian of the frame, linear rows first, in the root frame's axes",
    "Js": "Jacobians of the links at their centres of mass, linear rows first",
    "a": "accelerations of the links, linear first",
}

OF_QUANTITY = {
    "forward_kinematics": {"T": "pose"},
    "link_poses": {"T": "poses"},
    "link_jacobians": {"J": "Js"},
}

SAYS = {
    "dynamics": "M(q), C(q, qdot) qdot and g(q)",
    "mass_matrix": "the inertia matrix M(q)",
    "mass_matrix_inverse": "the inverse of M(q)",
    "coriolis": "the centrifugal and Coriolis efforts C(q, qdot) qdot",
    "coriolis_matrix": "C(q, qdot) by the Christoffel symbols",
    "coriolis_product": "C(q, qdot) v for a second velocity v",
    "christoffel": "the Christoffel symbols of the first kind",
    "gravity": "the gravity efforts g(q)",
    "gravity_gradient": "the derivatives of g by q",
    "inverse_dynamics": "the efforts tau = M(q) qddot + C(q, qdot) qdot + g(q)",
    "forward_dynamics": "the accelerations qddot, from M(q) qddot + C(q, qdot) qdot + g(q) = tau",
    "inverse_dynamics_derivatives": "derivatives of tau by q, qdot and qddot",
    "forward_dynamics_derivatives": "derivatives of qddot by q, qdot and tau",
    "regressor": "Y, by which tau is linear in the inertial parameters",
    "kinetic_energy": "the kinetic energy T",
    "potential_energy": "the potential energy P",
    "forward_kinematics": "the pose of frame {frame} in the root frame",
    "jacobian": "the Jacobian of frame {frame}",
    "link_poses": "where the links are",
    "link_jacobians": "the Jacobians of the links",
    "link_accelerations": "how the links accelerate",
}


@dataclass(frozen=True)
class Parameter:
    name: str
    """As the description says it."""
    identifier: str
    value: float


@dataclass(frozen=True)
class Function:
    name: str
    """'dynamics' for terms, else the quantity's name."""
    says: str
    routine: Routine
    vectors: Vectors

    @property
    def inputs(self) -> tuple[Array, ...]:
        return self.routine.inputs

    @property
    def outputs(self) -> tuple[Array, ...]:
        return self.routine.outputs

    @property
    def takes_parameters(self) -> bool:
        return any(array.name == "params" for array in self.inputs)

    @property
    def state(self) -> tuple[Array, ...]:
        """The inputs but for the parameters."""
        return tuple(array for array in self.inputs if array.name != "params")


@dataclass(frozen=True)
class Unit:
    model: symbols.Model
    name: str
    """An identifier of every language, with which all others begin."""
    functions: tuple[Function, ...]
    parameters: tuple[Parameter, ...]
    frame: str
    single: bool
    """Whether numbers are float, not double."""

    @property
    def robot(self) -> Robot:
        return self.model.robot

    @property
    def n(self) -> int:
        return self.robot.n

    @property
    def title(self) -> str:
        return words(self.robot.name)

    @cached_property
    def fingerprint(self) -> str:
        """The same for descriptions that are the same to the last bit, whatever file says them."""
        r = self.robot
        links, joints = (tuple(replace(x, place="") for x in xs) for xs in (r.links, r.joints))
        described = (links, joints, r.frames, r.gravity_vector, self.parameters)
        return hashlib.sha256(repr(described).encode()).hexdigest()

    @property
    def joints(self) -> list[str]:
        """A line for each joint."""
        found = []
        for k, joint in enumerate(self.robot.independent_joints):
            moves = "slides [m]" if joint.kind == "prismatic" else "turns [rad]"
            found.append(f"{k + 1}: {words(joint.name)} {moves}")
        return found

    @property
    def conventions(self) -> list[str]:
        """What holds for every number, a sentence a line."""
        x, y, z = self.robot.gravity_vector
        field = ", ".join(str(v) if isinstance(v, float) else words(str(v)) for v in (x, y, z))
        said = [
            "M(q) qddot + C(q, qdot) qdot + g(q) = tau, in SI units and radians.",
            f"Gravity in the root frame {words(self.robot.root)}: ({field}) m/s^2.",
            "tau is what the actuators add: tau = g(q) holds the arm still.",
            "M includes armature; joint friction is left out.",
        ]
        if self.parameters and not self.model.symbolic:
            bodies = (words(body.link) for body in self.robot.mechanism.bodies)
            listed = ", ".join(f"{k} {name}" for k, name in enumerate(bodies, 1))
            said.append(
                "Parameters of body k: mass m, h = m times the centre of mass, I about the link "
                f"frame's origin. Bodies: {listed}."
            )
        return said

    # -- numbers to hold it against -------------------------------------------------------------

    def fresh_vectors(self, function: Function) -> Vectors:
        """Other states than the package's."""
        quantity = function.routine.quantity
        default = STATES if self.model.symbolic else 1  # the first row
        options = _options(quantity, self.frame)
        routine = function.routine
        return vectors(self.model, quantity, options, routine, self.single, 21, default)

    def kernel(self, function: Function, inputs: Mapping[str, np.ndarray]) -> list[np.ndarray]:
        """What the library's own kernels give for rows of inputs; symbols have their defaults."""
        quantity, given = function.routine.quantity, dict(inputs)
        params = given.pop("params", None)
        arm: Any = self._numeric
        if params is not None and not self.model.symbolic:
            arm, given["params"] = arm.with_parameters(), params
        result = getattr(arm, quantity)(*given.values(), *_options(quantity, self.frame))
        return list(result) if isinstance(result, tuple) else [result]

    @cached_property
    def _numeric(self) -> Robot:
        return self.robot.subs(self.model.defaults) if self.model.symbolic else self.robot


def unit(
    robot: Robot,
    functions: Sequence[str],
    params: bool,
    values: Mapping[Any, float],
    frame: str,
    single: bool,
) -> Unit:
    """See Robot.codegen."""
    model = symbols.model(robot, params, values)
    names = Names()
    parameters = tuple(
        Parameter(name, names.of(name, "p"), value) for name, value in model.defaults.items()
    )
    made = tuple(_function(model, quantity, frame, single) for quantity in functions)
    return Unit(model, stem(robot.name), made, parameters, frame, single)


def _options(quantity: str, frame: str) -> tuple[str, ...]:
    return (frame,) if quantity in build.OF_A_FRAME else ()


def _function(model: symbols.Model, quantity: str, frame: str, single: bool) -> Function:
    options = _options(quantity, frame)
    found = dynamics(model) if quantity == "terms" else None
    try:
        if found is None:
            traced = routine(model.trace(quantity, *options))
            found = traced.renamed(RENAMED | OF_QUANTITY.get(quantity, {}))
        made = vectors(model, quantity, options, found, single)
    except ZeroDivisionError:
        raise ValueError(singular(model.robot, quantity)) from None
    name = "dynamics" if quantity == "terms" else quantity
    return Function(name, SAYS[name].format(frame=words(frame)), found, made)
