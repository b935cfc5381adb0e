"""The Robotics Toolbox for Python on a URDF file, a call a row."""

import re
import tempfile
from pathlib import Path

import numpy as np
import roboticstoolbox

from peers import AbsentError

NAME = "Robotics Toolbox"
ROWS = 32
"""A row takes milliseconds."""


def functions(arm, file: Path) -> dict:
    text = re.sub(r"<(visual|collision)\b.*?</\1>", "", file.read_text(), flags=re.DOTALL)
    with tempfile.TemporaryDirectory() as folder:
        bare = Path(folder) / file.name
        bare.write_text(text)
        robot = roboticstoolbox.Robot.URDF(str(bare))
    if robot.n != arm.n:
        raise AbsentError(f"the toolbox sees {robot.n} joints, we {arm.n}")

    def rows(call):
        def batch(*arrays: np.ndarray, keep: bool = False):
            results = [call(*row) for row in zip(*arrays, strict=True)]
            return np.array(results) if keep else None

        return batch

    calls = {
        "mass_matrix": (robot.inertia, 1),
        "gravity": (robot.gravload, 1),
        "inverse_dynamics": (robot.rne, 3),
        "coriolis_matrix": (robot.coriolis, 2),
        "forward_dynamics": (robot.accel, 3),
    }
    able = {}
    for name, (call, takes) in calls.items():
        try:
            call(*np.zeros((takes, arm.n)))
        except Exception as reason:  # such as its own ValueError from coriolis of a URDF robot
            print(f"{NAME}, {name}: {type(reason).__name__}")
        else:
            able[name] = rows(call)
    return able | {"rows": ROWS}
