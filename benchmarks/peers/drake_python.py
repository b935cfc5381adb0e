"""Drake from Python, a call a row."""

import re
from pathlib import Path

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces

from peers import AbsentError

NAME = "Drake Python"


def functions(arm, file: Path) -> dict:
    plant = MultibodyPlant(0.0)
    text = re.sub(r"<(visual|collision)\b.*?</\1>", "", file.read_text(), flags=re.DOTALL)
    text = re.sub(r"<dynamics[^>]*/>", "", text)  # whose damping Drake counts in
    Parser(plant).AddModelsFromString(text, "urdf")
    if arm.root != "world":
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(arm.root))
    plant.Finalize()
    if plant.num_positions() != arm.n:
        raise AbsentError(f"Drake sees {plant.num_positions()} joints, we {arm.n}")
    context = plant.CreateDefaultContext()
    forces = MultibodyForces(plant)

    def gravity(q):
        plant.SetPositions(context, q)
        return -plant.CalcGravityGeneralizedForces(context)

    def mass_matrix(q):
        plant.SetPositions(context, q)
        return plant.CalcMassMatrix(context)

    def inverse(q, v, a):
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        plant.CalcForceElementsContribution(context, forces)
        return plant.CalcInverseDynamics(context, a, forces)

    def rows(call):
        def batch(*arrays: np.ndarray, keep: bool = False):
            results = [call(*row) for row in zip(*arrays, strict=True)]
            return np.array(results) if keep else None

        return batch

    calls = {"gravity": gravity, "mass_matrix": mass_matrix, "inverse_dynamics": inverse}
    names = [plant.get_joint(i).name() for i in plant.GetJointIndices()]
    order = [arm.joint_names.index(name) for name in names if name in arm.joint_names]
    return {name: rows(call) for name, call in calls.items()} | {"order": np.array(order)}
