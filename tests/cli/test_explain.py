"""`mcgee explain` as a person and as a program use it."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

MCGEE = str(Path(sys.executable).with_name("mcgee"))


def run(*arguments, **options):
    return subprocess.run([MCGEE, *arguments], capture_output=True, text=True, **options)


@pytest.mark.parametrize("robot", ["planar_2r", "panda", "stanford"])
def test_reports_fit_80_columns(robot):
    result = run(
        "explain", robot, "--qd", ",".join(["0.5"] * {"planar_2r": 2, "panda": 7}.get(robot, 6))
    )
    assert result.returncode == 0
    assert max(len(line.rstrip()) for line in result.stdout.splitlines()) <= 80
    assert "…" not in result.stdout


def test_json_for_programs():
    result = run("explain", "planar_2r", "--q", "0.5,0.3", "--qd", "0.1,-0.2", "--json")
    report = json.loads(result.stdout)
    assert report["q"] == [0.5, 0.3]
    assert report["inertia"]["locked"][1] == pytest.approx(0.35)


def test_help_has_an_example_that_works_as_typed():
    text = run("explain", "--help").stdout
    example = next(line for line in text.splitlines() if "Example:" in line)
    assert run(*example.split("Example:")[1].split()[1:]).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["planar_2r", "--frame", "hand"], "frame is 'hand', which robot 'planar_2r' has not."),
        (["planar_2r", "--q", "1"], "--q has 1 number, expected 2"),
        (["planar_2r", "--qdd", "x,1"], "--qdd holds 'x', expected finite numbers"),
        (["no_arm"], "no_arm"),
    ],
)
def test_errors_are_one_sentence_and_exit_code_2(arguments, sentence):
    result = run("explain", *arguments)
    assert result.returncode == 2
    assert result.stdout == ""
    assert sentence in result.stderr
    assert result.stderr.count("\n") == 1
