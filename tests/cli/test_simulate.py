"""`mcgee simulate`: a motion, its ledger, its files."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

MCGEE = Path(sys.executable).with_name("mcgee")


def run(*words: str, cwd: Path) -> subprocess.CompletedProcess:
    return subprocess.run([MCGEE, "simulate", *words], cwd=cwd, capture_output=True, text=True)


def test_free_motion(tmp_path):
    done = run("planar_2r", "--q", "0.3,0.4", "--duration", "1", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "planar_2r: 1 s in 501 times, complete" in done.stdout
    assert "kinetic energy T" in done.stdout
    assert "lost to friction" not in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80


@pytest.mark.parametrize("law", ["pd-gravity", "computed-torque", "slotine-li", "adaptive", "lqr"])
def test_controlled_motion(law, tmp_path):
    words = ("--controller", law, "--target", "panda_joint4=-90,panda_joint2=20", "--degrees")
    q = "--q=panda_joint4=-70"
    done = run("panda", q, *words, "--duration", "2", "--json", cwd=tmp_path)
    assert done.returncode == 0
    said = json.loads(done.stdout)
    goal = np.zeros(7)
    goal[3], goal[1] = -np.pi / 2, np.pi / 9
    assert abs(np.array(said["q"][-1]) - goal).max() < 5e-3
    assert said["status"] == "complete"


def test_swing_up(tmp_path):
    words = ("--q", "-90,0", "--degrees", "--controller", "swing-up", "--duration", "8")
    fixed = ("--method", "rk4", "--dt", "0.004", "--json")
    done = run("pendubot", *words, *fixed, cwd=tmp_path)
    assert done.returncode == 0
    off = np.subtract(json.loads(done.stdout)["q"][-1], [np.pi / 2, 0])
    assert abs(np.sin(off / 2)).max() < 1e-2  # whole turns aside


def test_files(tmp_path):
    words = ("--html", "run.html", "-o", "run.npz", "--friction", "--step", "0.05")
    done = run("puma560", "--duration", "0.5", *words, cwd=tmp_path)
    assert done.returncode == 0
    assert done.stderr.splitlines() == ["mcgee: wrote run.html", "mcgee: wrote run.npz"]
    assert (tmp_path / "run.html").stat().st_size > 100_000
    with np.load(tmp_path / "run.npz") as kept:
        assert kept["q"].shape == (11, 6)
    assert "lost to friction" in done.stdout


REFUSED = [
    (("--duration", "0"), "duration is 0.0, expected a number above 0"),
    (("--duration", "1", "--q", "1"), "--q has 1 number, expected 2"),
    (("--duration", "1", "--target", "1,1"), "--target needs a --controller"),
    (("--duration", "1", "--controller", "pid"), "--controller is 'pid', expected one of: none"),
    (("--duration", "1", "--controller", "swing-up"), "no gains for kind 'planar_2r'"),
    (("--duration", "1", "--controller", "swing-up", "--target", "1,1"), "takes no --target"),
    (("--duration", "1", "--controller", "pd-gravity"), "pd-gravity needs a --target"),
    (("--duration", "1", "--method", "euler"), "method is 'euler'"),
    (("--duration", "1e6", "--step", "1", "-o", "run.xls"), "ends in '.xls'"),
    (("--duration", "1e6", "--step", "1", "--html", "no/run.html"), "there is no folder"),
]


@pytest.mark.parametrize(("words", "says"), REFUSED, ids=range(len(REFUSED)))
def test_refusals_are_one_line(words, says, tmp_path):
    done = run("planar_2r", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr
    assert done.stderr.startswith("mcgee: error: ")
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_a_target_beyond_the_limits(tmp_path):
    words = ("--controller", "computed-torque", "--target", "panda_joint4=1", "--duration", "1")
    done = run("panda", "--q=panda_joint4=-1", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert "panda_joint4" in done.stderr
    assert len(done.stderr.splitlines()) == 1
