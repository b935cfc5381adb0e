"""The benchmark beside peers still runs, and gives no time for a wrong result."""

import argparse
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
import compare
import models
import peak


@pytest.fixture
def options():
    return argparse.Namespace(batch=8, rounds=1, peers="pinocchio_python")


def test_every_function_has_a_row_and_agrees(options, tmp_path):
    table = compare.measured("planar_2r", tmp_path, options, list(compare.FUNCTIONS))
    assert [line["function"] for line in table] == list(compare.FUNCTIONS)
    for line in table:
        assert set(line["ns"]) == {"mcgee", "single", "pinocchio_python"}
        assert not line["wrong"]
    text = compare.as_text("planar_2r", table)
    assert all(function in text for function in compare.FUNCTIONS)


def test_a_wrong_result_is_not_timed(options, tmp_path, monkeypatch):
    from peers import pinocchio_python

    calls = pinocchio_python.calls
    shifted = lambda file: {n: lambda *a, f=f: f(*a) + 1e-3 for n, f in calls(file).items()}  # noqa: E731
    monkeypatch.setattr(pinocchio_python, "calls", shifted)
    (line,) = compare.measured("planar_2r", tmp_path, options, ["inverse_dynamics"])
    assert set(line["ns"]) == {"mcgee", "single"}
    assert line["wrong"]["pinocchio_python"] > compare.TOLERANCE


def test_the_report(options, tmp_path):
    table = compare.measured("chain3", tmp_path, options, ["inverse_dynamics", "gravity"])
    results = {"machine": compare.machine(), "peak": peak.vectors_per_nanosecond(), "tables": {}}
    text = compare.as_markdown(results | {"tables": {"chain3": table}})
    assert text.count("\n| ") == 3
    assert "| inverse dynamics |" in text


def test_chains_are_what_they_say(tmp_path):
    import mcgee

    arm = mcgee.load(models.file("chain5", tmp_path))
    assert arm.n == 5
    assert np.linalg.eigvalsh(arm.mass_matrix(np.ones(5))).min() > 0
