"""`mcgee codegen`: what it writes, says, and tells by its exit code."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

MCGEE = Path(sys.executable).with_name("mcgee")


def run(*words: str, cwd: Path, **environment: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [MCGEE, "codegen", *words],
        cwd=cwd,
        capture_output=True,
        text=True,
        env=os.environ | environment,
    )


def test_a_verified_package(tmp_path):
    done = run("planar_2r", "--target", "c", "--params", "-o", "arm", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "planar_2r.c" in done.stdout
    assert "tried with gcc" in done.stdout
    assert "ulp from 60 digits" in done.stdout
    assert "| dynamics | 20 |" in (tmp_path / "arm" / "VERIFIED.md").read_text()
    assert max(map(len, done.stdout.splitlines())) <= 100


def test_several_targets_have_a_folder_each(tmp_path):
    done = run(
        *("panda", "--target", "python,javascript", "-o", "out", "--json"),
        *("--functions", "terms,inverse_dynamics"),
        cwd=tmp_path,
    )
    assert done.returncode == 0
    said = json.loads(done.stdout)
    assert [p["target"] for p in said["written"]] == ["python", "javascript"]
    assert all(p["verified"] for p in said["written"])
    assert said["written"][0]["ulp"].keys() == {"dynamics", "inverse_dynamics"}
    assert said["written"][0]["ulp"]["dynamics"]["60 digits"] < 4
    assert (tmp_path / "out" / "python" / "panda.py").is_file()
    assert (tmp_path / "out" / "javascript" / "panda.js").is_file()


def test_a_missing_toolchain_is_said_and_told(tmp_path):
    done = run("planar_2r", "--target", "java", "-o", "arm", cwd=tmp_path, PATH="/nowhere")
    assert done.returncode == 3
    assert "java is not verified: no javac" in done.stderr
    assert (tmp_path / "arm" / "Planar2rDynamics.java").is_file()
    assert not (tmp_path / "arm" / "VERIFIED.md").exists()


def test_unverified_when_told(tmp_path):
    words = ("planar_2r", "--target", "java", "--no-verify", "-o", "arm")
    done = run(*words, cwd=tmp_path, PATH="/nowhere")
    assert (done.returncode, done.stderr) == (0, "")
    assert not (tmp_path / "arm" / "VERIFIED.md").exists()


def test_wrong_code_is_not_written(tmp_path):
    """A compiler that makes programs that fail."""
    bin_ = tmp_path / "bin"
    bin_.mkdir()
    program = "#!/bin/sh\necho bad; exit 7"
    (bin_ / "gcc").write_text(f"#!/bin/sh\necho '{program}' > selftest; chmod +x selftest\n")
    (bin_ / "gcc").chmod(0o755)
    path = f"{bin_}:{os.environ['PATH']}"
    words = ("planar_2r", "--target", "c,python", "-o", "arm")
    done = run(*words, cwd=tmp_path, PATH=path)
    assert done.returncode == 1
    assert "the C code was refused or is wrong" in done.stderr
    assert "'./selftest'" in done.stderr
    assert not (tmp_path / "arm" / "c").exists()
    assert (tmp_path / "arm" / "python" / "planar_2r.py").is_file()


def test_a_refused_target_is_told_with_the_others(tmp_path):
    """An arm whose last link has no inertia has no forward dynamics, which an FMU needs."""
    link = "<link name='{}'><inertial><mass value='{}'/><inertia ixx='{}' iyy='{}' izz='{}' {}/>"
    off = "ixy='0' ixz='0' iyz='0'"
    made = [link.format(name, m, I, I, I, off) for name, m, I in (("a", 1, 0.1), ("b", 0, 0))]
    joint = "<joint name='{}' type='continuous'><parent link='{}'/><child link='{}'/></joint>"
    joints = joint.format("j", "base", "a") + joint.format("k", "a", "b")
    text = "<robot name='r'><link name='base'/>{}</inertial></link>{}</inertial></link>{}</robot>"
    (tmp_path / "r.urdf").write_text(text.format(*made, joints))
    words = ("r.urdf", "--target", "c,fmu,python", "-o", "out", "--no-verify", "--json")
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert "joint 'k' moves nothing that has inertia" in done.stderr
    said = json.loads(done.stdout)
    assert [package["target"] for package in said["written"]] == ["c", "python"]
    assert said["refused"] == ["fmu"]
    assert sorted(os.listdir(tmp_path / "out")) == ["c", "python"]


def test_nothing_is_written_where_a_folder_is_in_use(tmp_path):
    (tmp_path / "arm" / "python").mkdir(parents=True)
    (tmp_path / "arm" / "python" / "mine.txt").write_text("mine")
    done = run("planar_2r", "--target", "c,python", "-o", "arm", cwd=tmp_path)
    assert done.returncode == 2
    assert "exists and is not empty" in done.stderr
    assert os.listdir(tmp_path / "arm") == ["python"]
    forced = ("planar_2r", "--target", "c,python", "-o", "arm", "--force", "--no-verify")
    assert run(*forced, cwd=tmp_path).returncode == 0
    assert (tmp_path / "arm" / "python" / "mine.txt").read_text() == "mine"


REFUSED = [
    (("planar_2r", "--target", "cobol", "-o", "x"), "target is 'cobol', expected one of"),
    (("planar_2r", "--target", "c,cobol", "-o", "x"), "target is 'cobol'"),
    (("planar_2r", "--target", "c", "--functions", "M", "-o", "x"), "there is no function 'M'"),
    (("planar_2r", "--target", "c", "--frame", "hand", "-o", "x"), "frame is 'hand'"),
    (("planar_2r", "--target", "java", "--float", "-o", "x"), "has no float numbers"),
    (("planar_2r", "--target", "", "-o", "x"), "no target is named"),
    (("nowhere.urdf", "--target", "c", "-o", "x"), "nowhere.urdf"),
]


@pytest.mark.parametrize(("words", "says"), REFUSED, ids=range(len(REFUSED)))
def test_refusals_are_one_line(words, says, tmp_path):
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr
    assert done.stderr.startswith("mcgee: error: ")
    assert os.listdir(tmp_path) == []


def test_float(tmp_path):
    done = run("planar_2r", "--target", "c", "--float", "-o", "arm", cwd=tmp_path)
    assert done.returncode == 0
    text = (tmp_path / "arm" / "planar_2r.c").read_text()
    assert "cosf(" in text
    assert "double" not in text
