"""Writes the table of docs/codegen.md: how well every target agrees with 60-digit arithmetic.

python docs/agreement.py
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from pathlib import Path

import mcgee
from mcgee.codegen import LANGUAGES

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
import models
from tables import fill

PAGE = Path(__file__).parent / "codegen.md"
ROBOTS = {"planar 2R": "planar_2r", "PUMA 560": "puma560", "UR5": "ur5", "Panda": "panda"}
FUNCTIONS = ("terms", "inverse_dynamics", "forward_dynamics")
SLOW = ("wolfram",)
"""Where terms alone take minutes."""
HEAD = "| largest error, ulp | planar 2R | PUMA 560 | UR5 | Panda |\n|---|--:|--:|--:|--:|\n"


def error(name: str, target: str, folder: Path) -> float:
    """The largest of the functions, with numbers folded in and with parameters open."""
    source = str(models.file(name, folder)) if name == "ur5" else name
    arm = mcgee.load(source)
    worst = 0.0
    for params in (False, True):
        with tempfile.TemporaryDirectory() as place:
            functions = FUNCTIONS[:1] if target in SLOW else FUNCTIONS
            made = arm.codegen(target, f"{place}/x", functions, params=params, verify=True)
        done = made.verification
        assert done is not None
        assert done.done, f"{target} needs {done.missing}"
        worst = max(worst, *(a.exact for a in done.agreements))
    return worst


def table() -> str:
    warnings.simplefilter("ignore", mcgee.ModelWarning)
    rows = ""
    with tempfile.TemporaryDirectory() as folder:
        for target in LANGUAGES:
            cells = [f"{error(name, target, Path(folder)):.1f}" for name in ROBOTS.values()]
            rows += f"| `{target}` | {' | '.join(cells)} |\n"
            print(rows.splitlines()[-1], flush=True)
    return rows


if __name__ == "__main__":
    fill(PAGE, HEAD, table())
