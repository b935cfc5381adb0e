"""Compares planar_2r with the vectors; exits non-zero where one is missed."""

import sys
from pathlib import Path

import numpy as np

import planar_2r as robot

FOLDER = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "vectors")
PARAMETERS = None


def errors(result, row, outputs):
    """In units in the last place of the scale; infinite where a result is NaN."""
    results = result if isinstance(result, tuple) else (result,)
    for got, (at, size, scale) in zip(results, outputs):
        difference = abs(np.ravel(got) - row[at : at + size])
        worst = (difference / (row[scale] * np.finfo(float).eps)).max()
        yield np.inf if np.isnan(worst) else worst


def test(name, compute, inputs, outputs, width):
    rows = np.loadtxt(FOLDER / f"{name}.txt", ndmin=2)
    assert rows.shape[1:] == (width,), f"the rows of {name} are not as they should be"
    worst = 0.0
    for k, row in enumerate(rows):
        given = []
        for key, at, size in inputs:
            part = row[at : at + size]
            if key == "params":
                part = PARAMETERS(*part.tolist())
                if k == 0 and part != PARAMETERS():
                    worst = np.inf  # the first row holds the description's
            given.append(part)
        worst = max(worst, *errors(compute(*given), row, outputs))
    state = [rows[:, at : at + size] for key, at, size in inputs if key != "params"]
    if len(state) == len(inputs):  # the whole batch in one call
        whole = compute(*state)
        whole = whole if isinstance(whole, tuple) else (whole,)
        for k, row in enumerate(rows):
            worst = max(worst, *errors(tuple(part[k] for part in whole), row, outputs))
    print(f"{name}: {len(rows)} states, largest error {worst:.3g} ulp")
    return worst <= 32


passed = [
    test(
        "dynamics",
        robot.planar_2r_dynamics,
        [("q", 0, 2), ("qdot", 2, 2)],
        [(4, 4, 12), (8, 2, 13), (10, 2, 14)],
        15,
    ),
    test(
        "inverse_dynamics",
        robot.planar_2r_inverse_dynamics,
        [("q", 0, 2), ("qdot", 2, 2), ("qddot", 4, 2)],
        [(6, 2, 8)],
        9,
    ),
]
sys.exit(not all(passed))
