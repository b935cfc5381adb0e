"""`mcgee simulate`: a motion, its ledger, its files."""

from __future__ import annotations

import json
import os
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


def test_degrees_and_lengths_are_shown_as_they_are_read(tmp_path):
    done = run("scara", "--q", "10,20,0.1,30", "--degrees", "--duration", "0.1", cwd=tmp_path)
    rows = [line.split() for line in done.stdout.splitlines() if line.startswith(" joint")]
    assert [row[0] for row in rows] == ["joint1", "joint2", "joint3", "joint4"]
    assert [float(row[1]) for row in rows[:2]] == [10, 20]
    assert 0.1 < float(rows[2][1]) < 0.2
    assert rows[0][-2:] == ["deg,", "N·m"]
    assert rows[2][-2:] == ["m,", "N"]


def test_what_is_not_installed_is_said_before_the_motion(tmp_path):
    (tmp_path / "pyarrow.py").write_text("raise ModuleNotFoundError('no pyarrow', name='pyarrow')")
    words = (sys.executable, "-m", "mcgee", "simulate", "planar_2r", "--duration", "1e9")
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    done = subprocess.run(
        [*words, "--step", "1e3", "-o", "run.parquet"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 2
    assert "Parquet needs pyarrow: install mcgee[table]" in done.stderr


def test_one_file_that_cannot_be_written_costs_no_other(tmp_path):
    words = ("planar_2r", "--duration", "0.1", "--html", "/dev/full", "-o", "run.npz")
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert "cannot write the page to '/dev/full'" in done.stderr
    assert "mcgee: wrote run.npz" in done.stderr
    assert "kinetic energy T" in done.stdout
    with np.load(tmp_path / "run.npz") as kept:
        assert str(kept["status"]) == "complete"
        assert str(kept["robot"]) == "planar_2r"


def test_ctrl_c_keeps_what_there_is(tmp_path):
    """Pressed when three states are there; shells may have let it be ignored."""
    program = (
        "import os, signal, sys\n"
        "from mcgee.cli.app import main\n"
        "import mcgee.simulate.run\n"
        "run = sys.modules['mcgee.simulate.run']\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "kept = run._Run._keep\n"
        "def keep(self, y):\n"
        "    kept(self, y)\n"
        "    if len(self.states) == 3:\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "run._Run._keep = keep\n"
        "sys.argv = ['mcgee', 'simulate', 'planar_2r', '--duration', '1', '-o', 'run.npz']\n"
        "main()\n"
    )
    words = [sys.executable, "-c", program]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 130
    assert "interrupted" in done.stdout
    assert done.stderr.strip() == "mcgee: wrote run.npz"
    with np.load(tmp_path / "run.npz") as kept:
        assert str(kept["status"]) == "interrupted"
        assert len(kept["t"]) == 3


REFUSED = [
    (("--duration", "1", "--rise", "1"), "--rise needs a --controller"),
    (("--duration", "1", "--bandwidth", "1"), "--bandwidth needs a --controller"),
    (("--duration", "1", "--html", "a.csv", "-o", "a.csv"), "both name 'a.csv'"),
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
