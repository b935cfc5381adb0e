"""ns per evaluation over a batch, mcgee beside Pinocchio's Python binding, in one run.

    make bench            or    .venv/bin/python benchmarks/batch.py [--batch 4096] [--repeats 11]

Every figure is the median of the repeats, the two sides taken in turn. Pinocchio has no batch for
these from Python (but rnea and aba in parallel), so its figure is a loop over the rows, the loop
itself included; mcgee's includes the allocation of the result. One thread on both sides.
"""

import argparse
import platform
import statistics
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pinocchio as pin

import mcgee
from mcgee import build

SHARE = Path(sys.prefix) / "lib"
ROBOTS = {
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "talos": "talos_data/robots/talos_reduced.urdf",
}


def find(path: str) -> Path:
    return next(SHARE.glob(f"python*/site-packages/cmeel.prefix/share/*/robots/{path}"))


def peers(model: pin.Model) -> dict:
    data = model.createData()
    return {
        "mass_matrix": lambda q: pin.crba(model, data, q),
        "gravity": lambda q: pin.computeGeneralizedGravity(model, data, q),
        "coriolis_matrix": lambda q, qd: pin.computeCoriolisMatrix(model, data, q, qd),
        "inverse_dynamics": lambda q, qd, qdd: pin.rnea(model, data, q, qd, qdd),
        "forward_dynamics": lambda q, qd, tau: pin.aba(model, data, q, qd, tau),
        "mass_matrix_inverse": lambda q: pin.computeMinverse(model, data, q),
    }


def seconds(function) -> float:
    start = time.perf_counter()
    function()
    return time.perf_counter() - start


def compare(arm: mcgee.Robot, model: pin.Model, name: str, batch: int, repeats: int):
    """Median ns per evaluation of both, taken in turn."""
    random = np.random.default_rng(0)
    arrays = [random.normal(size=(batch, arm.n)) for _ in build.SIGNATURES[name].inputs]
    rows = list(zip(*arrays, strict=True))
    ours, theirs = getattr(arm, name), peers(model)[name]
    ours(*arrays)
    pairs = [
        (seconds(lambda: ours(*arrays)), seconds(lambda: [theirs(*row) for row in rows]))
        for _ in range(repeats)
    ]
    return (statistics.median(side) / batch * 1e9 for side in zip(*pairs, strict=True))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--batch", type=int, default=4096)
    parser.add_argument("--repeats", type=int, default=11)
    options = parser.parse_args()
    warnings.simplefilter("ignore", mcgee.ModelWarning)
    print(
        f"{platform.machine()}, NumPy {np.__version__}, Pinocchio {pin.__version__}, "
        f"batch {options.batch}, median of {options.repeats}\n"
    )
    print(f"{'robot':8}{'function':22}{'operations':>11}{'mcgee ns':>10}{'pin ns':>10}{'ratio':>8}")
    for robot, path in ROBOTS.items():
        arm = mcgee.load(find(path), mimic=False)
        model = pin.buildModelFromUrdf(str(find(path)))
        for name in peers(model):
            counts = build.trace(arm.mechanism, name).operation_counts()
            operations = counts["add"] + counts["mul"] + counts["div"]
            ours, theirs = compare(arm, model, name, options.batch, options.repeats)
            print(
                f"{robot:8}{name:22}{operations:11}{ours:10.0f}{theirs:10.0f}{theirs / ours:8.1f}"
            )


if __name__ == "__main__":
    main()
