"""adam, on CasADi functions, a call a row from Python."""

from pathlib import Path

import numpy as np
from adam.casadi import KinDynComputations

NAME = "adam CasADi"


def functions(arm, file: Path) -> dict:
    dynamics = KinDynComputations(str(file), list(arm.joint_names), gravity=(0, 0, -9.81, 0, 0, 0))
    base, mass, bias = np.eye(4), dynamics.mass_matrix_fun(), dynamics.bias_force_fun()
    still = np.zeros(6)

    def mass_matrix(q):
        return np.array(mass(base, q))[6:, 6:]

    def inverse(q, v, a):
        return mass_matrix(q) @ a + np.array(bias(base, q, still, v))[6:, 0]

    def rows(call):
        def batch(*arrays: np.ndarray, keep: bool = False):
            results = [call(*row) for row in zip(*arrays, strict=True)]
            return np.array(results) if keep else None

        return batch

    return {"mass_matrix": rows(mass_matrix), "inverse_dynamics": rows(inverse)}
