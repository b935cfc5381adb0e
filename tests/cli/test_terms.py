"""`mcgee terms` as a person and as a program use it."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mcgee

MCGEE = str(Path(sys.executable).with_name("mcgee"))

BROKEN = """<robot name="r"><link name="a"/><link name="b"/>
<joint name="j" type="revolute"><parent link="a"/><child link="nowhere"/></joint></robot>"""

ODD = """<robot name="odd"><link name="a"/>
<link name="b"><inertial><mass value="0"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
</robot>"""


def run(*arguments, **options):
    return subprocess.run([MCGEE, *arguments], capture_output=True, text=True, **options)


def test_json_holds_the_terms_of_the_state():
    result = run("terms", "planar_2r", "--q", "0.5,0.3", "--qd", "0.1,-0.2", "--json")
    report = json.loads(result.stdout)
    terms = mcgee.load("planar_2r").terms([0.5, 0.3], [0.1, -0.2])
    assert result.returncode == 0
    for name in ("M", "Cqd", "g"):
        np.testing.assert_array_equal(report[name], getattr(terms, name))
    assert report["joints"] == ["joint1", "joint2"]
    assert report["units"]["effort"] == ["N·m", "N·m"]


def test_rest_at_zero_is_the_default():
    report = json.loads(run("terms", "planar_2r", "--json").stdout)
    assert report["q"] == report["qd"] == [0, 0]


def test_the_reference_point_of_the_lesson_is_in_the_table():
    out = run("terms", "planar_2r", "--q", "0.5,0.3", "--qd", "0.1,-0.2").stdout
    for number in ("2.6553", "0.8277", "0.3500", "16.331"):
        assert number in out
    assert "kg·m²" in out
    assert "N·m" in out


@pytest.mark.parametrize("robot", ["planar_2r", "puma560", "panda", "cart_pole", "stanford"])
def test_tables_fit_80_columns(robot):
    out = run("terms", robot, env={"COLUMNS": "80", "MCGEE_CACHE_DIR": ""}).stdout
    assert max(len(line) for line in out.splitlines()) <= 80
    assert "…" not in out  # nothing cut off


def test_degrees_are_read_and_shown():
    turned = run("terms", "planar_2r", "--q", "90,0", "--degrees", "--json")
    assert json.loads(turned.stdout)["q"] == [np.pi / 2, 0]
    assert "90" in run("terms", "planar_2r", "--q", "90,0", "--degrees").stdout
    slides = run("terms", "cart_pole", "--q", "2,90", "--degrees", "--json")
    assert json.loads(slides.stdout)["q"] == [2, np.pi / 2]  # a slide is in metres


def test_joints_by_name_and_negative_first_numbers():
    by_name = run("terms", "planar_2r", "--q", "joint2=-0.5", "--json")
    assert json.loads(by_name.stdout)["q"] == [0, -0.5]
    negative = run("terms", "planar_2r", "--q", "-1,2", "--json")
    assert json.loads(negative.stdout)["q"] == [-1, 2]


def test_help_has_an_example_that_works_as_typed():
    text = run("terms", "--help").stdout
    example = next(line for line in text.splitlines() if "Example:" in line)
    words = example.split("Example:")[1].split()
    assert words[0] == "mcgee"
    assert run(*words[1:]).returncode == 0


def test_version():
    assert run("--version").stdout == f"mcgee {mcgee.__version__}\n"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["planar_2r", "--q", "1,2,3"], "--q has 3 numbers, expected 2 for robot 'planar_2r'."),
        (["planar_2r", "--q", "1,a"], "--q holds 'a', expected finite numbers"),
        (["planar_2r", "--qd", "nan,1"], "--qd holds 'nan', expected finite numbers"),
        (["planar_2r", "--q", "1,,2"], "--q has 3 numbers"),
        (["planar_2r", "--q", "1,"], "--q holds '', expected finite numbers"),
        (["planar_2r", "--q", "elbow=1"], "--q names joint 'elbow', which robot 'planar_2r' has"),
        (["planar_2r", "--q", "joint1=x"], "--q holds 'x'"),
        (["no_such_arm"], "no_such_arm"),
        (["missing.urdf"], "missing.urdf"),
    ],
)
def test_errors_are_one_sentence_and_exit_code_2(arguments, sentence):
    result = run("terms", *arguments)
    assert result.returncode == 2
    assert result.stdout == ""
    assert sentence in result.stderr
    assert result.stderr.startswith("mcgee: error: ")
    assert result.stderr.count("\n") == 1


def test_a_broken_file_is_one_line_with_its_place(tmp_path):
    path = tmp_path / "broken.urdf"
    path.write_text(BROKEN)
    result = run("terms", str(path))
    assert result.returncode == 2
    assert "broken.urdf:2: joint 'j' has child link 'nowhere', which does not exist" in (
        result.stderr
    )
    assert result.stderr.count("\n") == 1
    assert "Traceback" not in result.stderr


def test_warnings_are_one_line_each_on_stderr(tmp_path):
    path = tmp_path / "odd.urdf"
    path.write_text(ODD)
    result = run("terms", str(path), "--json")
    assert result.returncode == 0
    json.loads(result.stdout)
    lines = result.stderr.splitlines()
    assert all(line.startswith("mcgee: warning: odd.urdf:") for line in lines)
    assert any("link 'b' has mass 0 but a rotational inertia" in line for line in lines)


def test_output_may_be_a_closed_pipe():
    command = f"{MCGEE} terms puma560 --json | head -1"
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert result.stderr == ""
