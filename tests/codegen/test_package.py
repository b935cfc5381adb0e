"""Folders are written whole, keep what is not ours, and say what they hold."""

from __future__ import annotations

import hashlib
import json
import math
import os
import stat
import warnings

import pytest
import sympy

import mcgee
from mcgee.codegen import LANGUAGES, VerificationError, package
from mcgee.codegen.package import MANIFEST, write


@pytest.fixture
def two():
    return mcgee.arms.planar_2r()


def tree(folder) -> dict[str, bytes]:
    files = (p for p in folder.rglob("*") if p.is_file())
    return {str(p.relative_to(folder)): p.read_bytes() for p in files}


def test_a_package(two, tmp_path):
    made = two.codegen("c", tmp_path / "out", ["terms", "jacobian"], params=True)
    found = tree(tmp_path / "out")
    assert sorted(found) == list(made.files)
    assert made.verification is None
    assert not made.verified
    said = json.loads(found[MANIFEST])
    assert said["functions"] == ["dynamics", "jacobian"]
    assert said["parameters"]["m1"] == 1.0
    assert len(said["description_sha256"]) == 64
    for path, digest in said["files"].items():
        assert hashlib.sha256(found[path]).hexdigest() == digest
    assert set(said["files"]) == set(found) - {MANIFEST}
    assert os.listdir(tmp_path) == ["out"]


@pytest.mark.parametrize("target", LANGUAGES)
def test_the_same_bytes_twice(target, two, tmp_path):
    for name in ("a", "b"):
        two.codegen(target, tmp_path / name, ["terms", "inverse_dynamics"], params=True)
    assert tree(tmp_path / "a") == tree(tmp_path / "b")


@pytest.mark.parametrize("target", LANGUAGES)
def test_every_package_says_what_it_is(target, two, tmp_path):
    two.codegen(target, tmp_path / "out", params=True)
    readme = (tmp_path / "out" / "README.md").read_text()
    assert "your own" in readme
    assert "Self-test: `" in readme
    assert json.loads((tmp_path / "out" / MANIFEST).read_text())["description_sha256"] in readme
    assert "SI units" in readme
    assert len(readme.splitlines()) < 45
    assert any(path.startswith("vectors/") for path in tree(tmp_path / "out"))


def test_a_folder_in_use_is_left_alone(two, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(ValueError, match="exists and is not empty"):
        two.codegen("c", tmp_path)
    assert tree(tmp_path) == {"mine.txt": b"mine"}


def test_an_empty_folder_is_taken(two, tmp_path):
    two.codegen("c", tmp_path)
    assert (tmp_path / "planar_2r.c").is_file()


def test_writing_over_keeps_what_is_not_ours(two, tmp_path):
    two.codegen("c", tmp_path, ["terms", "gravity"])
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "vectors" / "mine.txt").write_text("mine too")
    (tmp_path / "planar_2r.h").write_text("edited")
    two.codegen("c", tmp_path, ["terms"], overwrite=True)
    found = tree(tmp_path)
    assert found["notes.txt"] == b"mine"
    assert found["vectors/mine.txt"] == b"mine too"
    assert found["planar_2r.h"] != b"edited"
    assert "vectors/gravity.txt" not in found  # generated, and of no function any more


def test_what_was_edited_and_is_generated_no_more_stays(two, tmp_path):
    two.codegen("c", tmp_path, ["terms", "gravity"])
    (tmp_path / "vectors" / "gravity.txt").write_text("edited")
    two.codegen("c", tmp_path, ["terms"], overwrite=True)
    assert (tmp_path / "vectors" / "gravity.txt").read_text() == "edited"


def test_a_manifest_names_no_file_outside(two, tmp_path):
    outside = tmp_path / "precious.txt"
    outside.write_text("keep me")
    digest = hashlib.sha256(b"keep me").hexdigest()
    folder = tmp_path / "out"
    folder.mkdir()
    for path in ("../precious.txt", str(outside)):
        (folder / MANIFEST).write_text(json.dumps({"files": {path: digest}}))
        two.codegen("c", folder, overwrite=True)
        assert outside.read_text() == "keep me"


@pytest.mark.parametrize("text", ["", "[]", '{"files": 3}', "{", '{"files": {"a": 1}}'])
def test_a_broken_manifest_is_no_obstacle(text, two, tmp_path):
    (tmp_path / MANIFEST).write_text(text)
    two.codegen("c", tmp_path, overwrite=True)
    assert json.loads((tmp_path / MANIFEST).read_text())["target"] == "c"


def test_links_are_replaced_not_followed(two, tmp_path):
    outside = tmp_path / "precious.c"
    outside.write_text("keep me")
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "planar_2r.c").symlink_to(outside)
    two.codegen("c", folder, overwrite=True)
    assert outside.read_text() == "keep me"
    assert not (folder / "planar_2r.c").is_symlink()


def test_a_link_to_a_folder_stays_one(two, tmp_path):
    real = tmp_path / "real"
    real.mkdir()
    (tmp_path / "link").symlink_to(real)
    two.codegen("c", tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert (real / "planar_2r.c").is_file()


def test_failures_leave_nothing(two, tmp_path, monkeypatch):
    def broken(folder, files):
        (folder / "half.c").write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(package, "put", broken)
    with pytest.raises(ValueError, match="No space left on device"):
        two.codegen("c", tmp_path / "out")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("stop", [OSError(5, "Input/output error"), KeyboardInterrupt()])
@pytest.mark.parametrize("after", range(0, 16, 3))
def test_failures_keep_what_was_there(stop, after, two, tmp_path, monkeypatch):
    """Wherever the exchange of files is stopped."""
    two.codegen("c", tmp_path / "out", ["terms", "gravity"])
    (tmp_path / "out" / "mine.txt").write_text("mine")
    before = tree(tmp_path / "out")
    real, calls = os.replace, []

    def stops(a, b):
        calls.append(b)
        if len(calls) == after + 1:
            raise stop
        real(a, b)

    monkeypatch.setattr(os, "replace", stops)
    with pytest.raises((ValueError, KeyboardInterrupt)):
        two.codegen("c", tmp_path / "out", ["terms", "inverse_dynamics"], overwrite=True)
    assert tree(tmp_path / "out") == before
    assert os.listdir(tmp_path) == ["out"]


def test_a_folder_stays_the_same_folder(two, tmp_path, monkeypatch):
    """Shells may stand in it."""
    monkeypatch.chdir(tmp_path)
    number = os.stat(".").st_ino
    for _ in range(2):
        two.codegen("c", ".", overwrite=True)
    assert os.stat(".").st_ino == number
    assert (tmp_path / "planar_2r.c").is_file()
    assert not [name for name in os.listdir() if name.startswith(".")]


def test_links_to_folders_inside_are_not_followed(two, tmp_path):
    outside, folder = tmp_path / "outside", tmp_path / "out"
    outside.mkdir()
    (outside / "dynamics.txt").write_text("keep")
    folder.mkdir()
    (folder / "vectors").symlink_to(outside)
    with pytest.raises(ValueError, match="'vectors' is a link there"):
        two.codegen("c", folder, overwrite=True)
    assert tree(outside) == {"dynamics.txt": b"keep"}
    assert os.listdir(folder) == ["vectors"]


def test_what_is_in_the_way_is_named(two, tmp_path):
    (tmp_path / "planar_2r.c").mkdir()
    with pytest.raises(ValueError, match=r"'planar_2r\.c' to .*: a folder has"):
        two.codegen("c", tmp_path, overwrite=True)
    (tmp_path / "planar_2r.c").rmdir()
    (tmp_path / "vectors").write_text("a file")
    with pytest.raises(ValueError, match="'vectors' is a file there"):
        two.codegen("c", tmp_path, overwrite=True)
    (tmp_path / "vectors").unlink()
    os.mkfifo(tmp_path / "pipe")  # somebody else's
    two.codegen("c", tmp_path, overwrite=True)
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_modes_are_those_of_other_folders(tmp_path):
    old = os.umask(0o022)
    try:
        write(tmp_path / "out", {"a.txt": "x"}, False)
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == 0o755
    assert stat.S_IMODE((tmp_path / "out" / "a.txt").stat().st_mode) == 0o644


def test_a_file_is_no_folder(two, tmp_path):
    (tmp_path / "out").write_text("x")
    with pytest.raises(ValueError, match="it is a file"):
        two.codegen("c", tmp_path / "out", overwrite=True)


REFUSED = [
    ({"target": "cobol"}, "target is 'cobol', expected one of: python, c, cpp"),
    ({"functions": ["jacobean"]}, "there is no function 'jacobean'; there are mass_matrix"),
    ({"functions": []}, "no function is asked for"),
    ({"frame": "hand"}, "frame is 'hand', which robot 'planar_2r' has not"),
    ({"target": "java", "single": True}, "has no float numbers. Targets that have: c, cpp"),
    ({"target": "fmu", "functions": ["jacobean"]}, "there is no function 'jacobean'"),
    ({"params": True, "values": {"m1": math.nan}}, "values gives 'm1' as nan, expected a finite"),
    ({"params": True, "values": {"m1": "x"}}, "values gives 'm1' as 'x', expected a finite number"),
    ({"values": {"m1": 2.0}}, "for all its numbers are folded in"),
]


@pytest.mark.parametrize(("given", "says"), REFUSED, ids=[says[:20] for _, says in REFUSED])
def test_refusals(given, says, two, tmp_path):
    with pytest.raises(ValueError, match=says):
        two.codegen(given.pop("target", "c"), tmp_path / "out", **given)
    assert os.listdir(tmp_path) == []


def test_a_singular_arm_has_no_forward_dynamics(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mcgee.ModelWarning)
        arm = mcgee.arms.planar_2r(m2=0, I2=0)
    with pytest.raises(ValueError, match="joint 'joint2' moves nothing that has inertia"):
        arm.codegen("c", tmp_path / "out", ["forward_dynamics"])
    assert os.listdir(tmp_path) == []


def test_symbols_need_values(tmp_path):
    arm = mcgee.arms.planar_2r(m1=sympy.Symbol("m1"))
    with pytest.raises(ValueError, match="without values"):
        arm.codegen("c", tmp_path / "out")
    made = arm.codegen("c", tmp_path / "out", values={"m1": 3.0})
    assert json.loads((made.folder / MANIFEST).read_text())["parameters"] == {"m1": 3.0}


def test_wrong_code_is_not_written(two, tmp_path, monkeypatch):
    from mcgee.codegen import c

    real = c.source
    monkeypatch.setattr(c, "source", lambda unit: real(unit).replace("c2", "s2", 1))
    with pytest.raises(VerificationError, match="the C code was refused or is wrong"):
        two.codegen("c", tmp_path / "out", verify=True)
    assert os.listdir(tmp_path) == []
