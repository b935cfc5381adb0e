"""`mcgee bench`: what it counts is what is compiled; what it times, it names."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import mcgee
from mcgee.cli import bench

MCGEE = str(Path(sys.executable).with_name("mcgee"))


def run(*arguments, **options):
    return subprocess.run([MCGEE, "bench", *arguments], capture_output=True, text=True, **options)


def test_json_holds_the_robots_own_counts():
    report = json.loads(run("puma560", "--counts", "--json").stdout)
    assert report["quantities"] == mcgee.load("puma560").operation_counts()
    assert (report["robot"], report["unit"]) == ("puma560", "operations")


def test_the_table_shows_them():
    counts = mcgee.load("puma560").operation_counts()
    out = run("puma560", "--counts", env={"COLUMNS": "80"}).stdout
    for name, row in counts.items():
        line = next(line for line in out.splitlines() if line.split()[:1] == [name])
        keys = ("add", "mul", "div", "sincos", "instructions")
        assert line.split()[1:] == [f"{row[key]:,}" for key in keys]


def test_formulations_of_old_beside_ours():
    rows = json.loads(run("stanford", "--counts", "--json").stdout)
    assert rows["inverse_dynamics_formulations"] == {}  # it slides
    rows = json.loads(run("puma560", "--counts", "--json").stdout)["inverse_dynamics_formulations"]
    assert rows["Luh, Walker & Paul"]["published"] == {"mul": 852, "add": 738}
    out = run("puma560", "--counts", env={"COLUMNS": "80"}).stdout
    assert "66,271" in out
    assert f"{rows['Waters']['mul']:,}" in out


def test_times_of_every_quantity():
    report = json.loads(run("pendulum", "--json").stdout)
    assert report["unit"] == "ns"
    assert set(report["quantities"]) == set(mcgee.load("pendulum").operation_counts())
    for row in report["quantities"].values():
        assert set(row) == {"batch", "batch float32", "one call"}
        assert min(row.values()) > 0


@pytest.mark.parametrize("options", [["planar_2r"], ["puma560", "--counts"]])
def test_tables_fit_80_columns(options):
    out = run(*options, env={"COLUMNS": "80", "MCGEE_CACHE_DIR": ""}).stdout
    assert "inverse_dynamics" in out
    assert max(len(line) for line in out.splitlines()) <= 80
    assert "…" not in out


def test_an_unknown_robot_is_one_line():
    result = run("no_such_arm")
    assert result.returncode == 2
    assert result.stderr.startswith("mcgee: error:")
    assert len(result.stderr.splitlines()) == 1


def test_one_quantity_alone():
    report = json.loads(run("puma560", "--counts", "--only", "gravity", "--json").stdout)
    assert set(report) == {"robot", "unit", "quantities"}
    assert report["quantities"] == mcgee.load("puma560").operation_counts("gravity")
    result = run("puma560", "--counts", "--only", "weight")
    assert result.returncode == 2
    assert result.stderr.startswith("mcgee: error: there is no quantity 'weight'; there are mass_")


def test_results_too_large_are_named_and_left_out(monkeypatch, capsys):
    monkeypatch.setattr(bench, "LARGEST", 100)
    bench.print_counts(mcgee.load("puma560"), [])
    out = capsys.readouterr().out
    assert "Left out: christoffel, of 216 numbers; --only christoffel asks for it." in out
    assert "mass_matrix" in out


def test_formulations_know_links_alone():
    rows = bench.formulations(mcgee.load("puma560"))
    links = mcgee.load("puma560").replace(armature={f"joint{i}": 0.0 for i in range(1, 7)})
    ours = links.operation_counts("inverse_dynamics")["inverse_dynamics"]
    assert rows["mcgee"] == {"mul": ours["mul"], "add": ours["add"]}
