"""Pinocchio from Python, a call a row."""

from pathlib import Path

import numpy as np
import pinocchio as pin

NAME = "Pinocchio Python"


def calls(file: Path) -> dict:
    model = pin.buildModelFromUrdf(str(file))
    data = model.createData()
    return {
        "inverse_dynamics": lambda q, v, a: pin.rnea(model, data, q, v, a),
        "forward_dynamics": lambda q, v, tau: pin.aba(model, data, q, v, tau),
        "gravity": lambda q: pin.computeGeneralizedGravity(model, data, q),
        "mass_matrix": lambda q: pin.crba(model, data, q),
        "mass_matrix_inverse": lambda q: pin.computeMinverse(model, data, q),
        "coriolis_matrix": lambda q, v: pin.computeCoriolisMatrix(model, data, q, v),
        "inverse_dynamics_derivatives": lambda q, v, a: pin.computeRNEADerivatives(
            model, data, q, v, a
        ),
        "forward_dynamics_derivatives": lambda q, v, tau: pin.computeABADerivatives(
            model, data, q, v, tau
        ),
        "regressor": lambda q, v, a: pin.computeJointTorqueRegressor(model, data, q, v, a),
    }


def functions(arm, file: Path) -> dict:
    def batch(call):
        def rows(*arrays: np.ndarray, keep: bool = False) -> np.ndarray | None:
            if keep:  # results are views of its data, which the next call fills again
                return np.array([flat(call(*row)) for row in zip(*arrays, strict=True)])
            for row in zip(*arrays, strict=True):
                call(*row)
            return None

        return rows

    return {name: batch(call) for name, call in calls(file).items()} | {"order": order(arm, file)}


def order(arm, file: Path) -> np.ndarray:
    """Our joints in Pinocchio's order, which is that of their names."""
    model = pin.buildModelFromUrdf(str(file))
    return np.array([arm.joint_names.index(name) for name in list(model.names)[1:]])


def flat(result) -> np.ndarray:
    parts = result if isinstance(result, tuple) else (result,)
    return np.concatenate([np.array(part).ravel() for part in parts])
