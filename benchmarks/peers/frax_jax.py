"""frax on JAX: batches through vmap and jit, float64, one thread."""

import os
import re
import tempfile
from pathlib import Path

os.environ["JAX_ENABLE_X64"] = "1"  # all read when JAX is imported
os.environ["XLA_FLAGS"] = (
    "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1 "
    "--xla_cpu_scheduler_type=CPU_SCHEDULER_TYPE_MEMORY_OPTIMIZED"
)

import frax
import jax
import numpy as np

from peers import AbsentError

NAME = "frax (JAX)"
NOTHING = (
    '<inertial><origin xyz="0 0 0" rpy="0 0 0"/><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)
"""What frax wants of the link that stands still."""

MOST_JOINTS = 12
"""XLA compiles larger robots for minutes."""


def functions(arm, file: Path) -> dict:
    if arm.n > MOST_JOINTS:
        raise AbsentError(f"not measured beyond {MOST_JOINTS} joints")
    text = re.sub(r"<(visual|collision)\b.*?</\1>", "", file.read_text(), flags=re.DOTALL)
    root = f'<link name="{arm.root}"'
    text = re.sub(rf"{root}\s*(/>|>\s*</link>)", f"{root}>{NOTHING}</link>", text)
    with tempfile.TemporaryDirectory() as folder:
        bare = Path(folder) / file.name
        bare.write_text(text)
        robot = frax.Robot(str(bare))
    if sorted(robot.joint_names) != sorted(arm.joint_names):
        raise AbsentError(f"frax sees {robot.nv} joints, we {arm.n}")

    def inverse(q, v, a):
        return robot.crba(q) @ a + robot.nonlinear_bias(q, v)

    calls = {
        "mass_matrix": robot.crba,
        "gravity": robot.gravity_vector,
        "inverse_dynamics": inverse,
        "forward_dynamics": lambda q, v, tau: robot.forward_dynamics(q, v, tau, None),
    }

    def rows(call):
        compiled = jax.jit(jax.vmap(call))

        def batch(*arrays: np.ndarray, keep: bool = False):
            results = jax.block_until_ready(compiled(*arrays))
            return np.array(results) if keep else None

        return batch

    order = [arm.joint_names.index(name) for name in robot.joint_names]
    return {name: rows(call) for name, call in calls.items()} | {"order": np.array(order)}
