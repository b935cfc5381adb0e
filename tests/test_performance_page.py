"""The figures of docs/performance.md that need no clock are the program's."""

import re
from pathlib import Path

import pytest

from mcgee import build, quantities
from mcgee.graph.program import Program
from robots import built_in, loaded

PAGE = (Path(__file__).parents[1] / "docs" / "performance.md").read_text()
ROWS = {
    "inverse dynamics": ("inverse_dynamics", "inverse_dynamics"),
    "M": ("mass_matrix", "mass_matrix"),
    "forward dynamics: LᵀDL factors of M": ("forward_dynamics", "forward_dynamics_by_elimination"),
    "forward dynamics: articulated bodies": ("forward_dynamics", "forward_dynamics"),
    "derivatives of inverse dynamics: composite bodies": (
        *("inverse_dynamics_derivatives", "inverse_dynamics_derivatives"),
    ),
}


def robot(name: str):
    return built_in(name) if name == "panda" else loaded(name)


def row(title: str) -> list[int]:
    line = next(line for line in PAGE.splitlines() if line.startswith(f"| {title} |"))
    return [int(cell.replace(",", "")) for cell in re.findall(r"\| ([\d,]+)", line)]


@pytest.mark.parametrize("title", ROWS)
def test_operations(title):
    quantity, way = ROWS[title]
    assert hasattr(quantities, way)
    for name, count in zip(("ur5", "panda", "talos"), row(title), strict=True):
        program = build._traced(robot(name).mechanism, quantity, way, (), False, True)
        assert program.arithmetic() == count


def test_operations_of_derivatives_on_the_graph():
    title = "derivatives of inverse dynamics: on its graph"
    for name, count in zip(("ur5", "panda"), row(title), strict=True):
        mechanism = robot(name).mechanism
        outputs = build.arrays(mechanism, "inverse_dynamics_derivatives")[1]
        tau = build.trace(mechanism, "inverse_dynamics")
        assert build._differentiated(tau, outputs).arithmetic() == count


@pytest.mark.parametrize("name", ["ur5", "panda", "talos"])
def test_the_way_with_fewest_operations_is_taken(name):
    for quantity, titles in {
        "forward_dynamics": [t for t in ROWS if t.startswith("forward dynamics")],
        "inverse_dynamics_derivatives": [
            "derivatives of inverse dynamics: on its graph",
            "derivatives of inverse dynamics: composite bodies",
        ],
    }.items():
        at = ("ur5", "panda", "talos").index(name)
        counts = [figures[at] for figures in map(row, titles) if at < len(figures)]
        program: Program = build.trace(robot(name).mechanism, quantity)
        assert program.arithmetic() == min(counts)
