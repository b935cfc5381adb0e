"""`load` and `read_urdf`: paths, names of built-in arms, and what is refused of either."""

import types
from pathlib import Path

import pytest
from urdf_text import ELBOW, FILE, arm, read

import mcgee
from mcgee import ModelError
from mcgee.formats import xml
from mcgee.formats.described import described
from mcgee.formats.load import load
from mcgee.formats.urdf import read_urdf
from mcgee.model import Mimic


@pytest.fixture
def path(tmp_path):
    path = tmp_path / FILE
    path.write_text(arm())
    return path


@pytest.mark.parametrize("reader", [read_urdf, load])
def test_reads_files(reader, path):
    assert reader(path) == reader(str(path)) == read(arm())
    assert reader(path).joints[1].place == f"{FILE}:14: "


def test_loads_any_suffix_and_mimic(tmp_path, monkeypatch):
    for name in ("arm.xml", "arm.URDF", "./arm", "arm"):
        (tmp_path / name).write_text(arm(ELBOW + '<mimic joint="shoulder"/>'))
    monkeypatch.chdir(tmp_path)
    for source in ("arm.xml", "arm.URDF", "./arm", Path("arm")):
        assert load(source).joints[1].mimic == Mimic("shoulder")
        assert load(source, mimic=False).joints[1].mimic is None


@pytest.mark.parametrize("reader", [read_urdf, load])
def test_refuses_paths(reader, tmp_path, path):
    empty, folder = tmp_path / "empty.urdf", tmp_path / "folder.urdf"
    empty.touch()
    folder.mkdir()
    nowhere, below = tmp_path / "no.urdf", path / "x.urdf"
    for bad, sentence in (
        (nowhere, f"'{nowhere}' does not exist, expected the path of a robot's file."),
        (folder, f"'{folder}' is a directory, expected the path of a robot's file."),
        (empty, "empty.urdf is empty, expected a robot's file."),
        (below, f"'{below}' cannot be read: Not a directory."),
        ("a\0b.urdf", "'a\\x00b.urdf' cannot be read: embedded null byte."),
        ("x/arm.urdf.xacro", "'x/arm.urdf.xacro' is a xacro file. Expand it first: "),
        ("arm.XACRO", "'arm.XACRO' is a xacro file. Expand it first: xacro arm.XACRO > arm.urdf"),
    ):
        with pytest.raises(ModelError) as caught:
            reader(bad)
        assert str(caught.value).startswith(sentence)
        assert str(caught.value).isprintable()
    with pytest.raises(ModelError, match=r"xacro arm\.urdf\.xacro > arm\.urdf$"):
        reader("x/arm.urdf.xacro")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no /dev/zero")
def test_endless_files_are_refused(monkeypatch):
    monkeypatch.setattr(xml, "SIZE_LIMIT", 1 << 20)
    with pytest.raises(ModelError, match=r"^zero is larger than 1 MiB, expected a robot's file\.$"):
        read_urdf("/dev/zero")


@pytest.fixture
def built_in(monkeypatch):
    def twin():
        robot = read(arm(ELBOW + '<mimic joint="shoulder"/>'))
        return described("twin", robot.links, robot.joints)

    arms = types.SimpleNamespace(BUILTIN={"puma560": twin, "planar_2r": lambda: read(arm())})
    monkeypatch.setattr(mcgee, "arms", arms, raising=False)


@pytest.mark.usefixtures("built_in")
def test_loads_built_in_arms():
    assert load("planar_2r") == read(arm())
    assert load("puma560").joints[1].mimic == Mimic("shoulder")
    assert load("puma560", mimic=False).joints[1].mimic is None


@pytest.mark.usefixtures("built_in")
def test_refuses_unknown_names(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robot").write_text(arm())
    rest = "Built in: planar_2r, puma560. A file ends in .urdf, .xml, .xacro."
    for name, sentence in (
        ("puma56", f"'puma56' is not the name of a built-in arm. Did you mean 'puma560'? {rest}"),
        ("zzz\n", f"'zzz\\n' is not the name of a built-in arm. {rest}"),
        ("", f"'' is not the name of a built-in arm. {rest}"),
        (
            "robot",
            "'robot' is not the name of a built-in arm. "
            f"To read the file of that name, write './robot'. {rest}",
        ),
    ):
        with pytest.raises(ModelError) as caught:
            load(name)
        assert str(caught.value) == sentence


def test_refuses_other_types():
    sentence = "^source is of type int, expected a path or the name of an arm.$"
    with pytest.raises(ModelError, match=sentence):
        load(5)
