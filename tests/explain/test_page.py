"""The page: written whole or not at all, safe, and alive in a browser without a network."""

import dataclasses
import json
import os
import re
import stat
import sys

import numpy as np
import pytest

import chromium
from mcgee.explain.page import page, script_json, write_page
from robots import built_in, loaded

EVIL = "</script><script>document.title='hacked'</script><img src=x onerror=alert(1)>&\"'"
READY = "document.body?.dataset.ready === 'yes'"
PANDA = [0, -0.8, 0, -2.4, 0, 1.6, 0.8], [0.5, 0, 0, 0.5, 0, 0, 1]


def explained(name):
    return {
        "planar_2r": lambda: built_in("planar_2r").explain([0.5, 0.3], [0.7, -0.4]),
        "panda": lambda: built_in("panda").explain(*PANDA),
        "cart_pole": lambda: built_in("cart_pole").explain([0.2, 0.3], [0.7, -0.4]),
        "pendulum": lambda: built_in("pendulum").explain([0.2]),
    }[name]()


def renamed(robot, **names):
    joints = tuple(dataclasses.replace(j, name=names.get(j.name, j.name)) for j in robot.joints)
    return dataclasses.replace(robot, name=EVIL, joints=joints)


def words(text):
    """The page's own text, without its scripts."""
    return re.sub(r"<script.*?</script>|<style>.*?</style>", "", text, flags=re.S)


# -- what is written ------------------------------------------------------------------------------


def test_opens_with_the_conventions_then_sentences_and_tables():
    e = explained("planar_2r")
    text = words(page(e)).replace("&#x27;", "'")
    told = [text.index(line) for line in e.conventions.lines()]
    assert told == sorted(told)
    assert told[-1] < min(text.index(sentence) for sentence in e.sentences)
    for sentence in e.sentences:
        assert sentence in text
    for title in ("What each joint feels", "Holding efforts", "The worst holding effort"):
        assert title in text


def test_needs_no_network():
    text = page(explained("planar_2r"))
    tags = re.findall(r"<(?:script|img|iframe|link|source)[^>]*>", text)
    assert not [tag for tag in tags if re.search(r"(src|href)=", tag) and "data:," not in tag]
    assert "default-src 'none'" in text
    assert text.count("plotly.js v") == 1


def test_is_the_same_each_time():
    assert page(explained("planar_2r")) == page(explained("planar_2r"))


def test_is_light():
    assert len(page(explained("panda")).encode()) < 8e6


def test_big_robots_stay_usable():
    e = loaded("talos").explain(np.full(32, 0.1), np.full(32, 0.2))
    text = page(e)
    assert len(text.encode()) < 15e6
    assert "Maps are drawn for the pairs among the 6 joints" in text


def test_names_from_files_are_only_names():
    text = page(renamed(built_in("planar_2r"), joint1=EVIL).explain([0.5, 0.3], [0.1, 0.2]))
    assert "<script>document.title" not in text
    assert "<img" not in words(text)
    assert text.count("</script>") == 3


def test_script_json_cannot_be_ended():
    held = {"name": "</script><!--\u2028", "x": [1.5, None]}
    text = script_json(held)
    assert "<" not in text
    assert "\u2028" not in text
    assert json.loads(text) == held


# -- the file -------------------------------------------------------------------------------------


def test_writes_and_overwrites(tmp_path):
    path = tmp_path / "arm.html"
    path.write_text("old")
    assert write_page(explained("pendulum"), path) == path
    assert path.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert [p.name for p in tmp_path.iterdir()] == ["arm.html"]
    assert stat.S_IMODE(path.stat().st_mode) & 0o400


def test_to_html_returns_the_path(tmp_path):
    assert explained("pendulum").to_html(str(tmp_path / "a.html")) == tmp_path / "a.html"


def test_leaves_nothing_half_written(tmp_path, monkeypatch):
    path = tmp_path / "arm.html"
    path.write_text("old")

    def full(*args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(ValueError, match=r"cannot write the page to '.*arm.html': No space left"):
        write_page(explained("pendulum"), path)
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["arm.html"]


def test_refuses_places_it_cannot_write(tmp_path):
    e = explained("pendulum")
    with pytest.raises(ValueError, match=r"there is no folder '.*missing'. Make it first"):
        write_page(e, tmp_path / "missing" / "arm.html")
    with pytest.raises(ValueError, match=r"it is a folder. Name a file in it"):
        write_page(e, tmp_path)
    with pytest.raises(ValueError, match=r"cannot write the page to .*arm.html"):
        write_page(e, tmp_path / ("x" * 300 + "arm.html"))


def test_missing_plotly_writes_nothing(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly", None)
    monkeypatch.setitem(sys.modules, "plotly.graph_objects", None)
    with pytest.raises(ModuleNotFoundError, match=r"install mcgee\[plot\]"):
        write_page(explained("pendulum"), tmp_path / "arm.html")
    assert not list(tmp_path.iterdir())


def test_missing_scipy_is_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    with pytest.raises(ModuleNotFoundError, match=r"needs SciPy: install mcgee\[plot\]"):
        page(explained("pendulum"))


# -- in a browser ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def tab():
    if not chromium.found():
        pytest.skip("needs Debian's chromium")
    with chromium.tab() as opened:
        opened.look(1280)
        yield opened


def opened(tab, path, e):
    tab.problems.clear()
    tab.requests.clear()
    write_page(e, path)
    tab.open(path, READY)


def unharmed(tab, path):
    """No console error, and nothing asked for but the file itself and pictures it holds."""
    assert tab.problems == []
    asked = [url for url in tab.requests if not url.startswith(("data:", "blob:"))]
    assert asked == [path.resolve().as_uri()]


def data(tab, plot, what):
    return tab.run(f"JSON.parse(JSON.stringify(document.getElementById('{plot}').data))[{what}]")


def slide(tab, to):
    """Move the slider with the keyboard."""
    tab.run("document.getElementById('position').focus()")
    tab.press(*to)


HOME, END, RIGHT = ("Home", 36), ("End", 35), ("ArrowRight", 39)


def arrived(tab, joint, place):
    tab.wait(f"document.body.dataset.place === '{joint}:{place}'")


def test_slider_moves_the_planar_arm(tab, tmp_path):
    path, e = tmp_path / "arm.html", explained("planar_2r")
    opened(tab, path, e)
    assert tab.run("document.querySelectorAll('.plot .main-svg').length") > 10
    M = np.array(data(tab, "M", 0)["z"])
    np.testing.assert_allclose(M, e.inertia.M, rtol=1e-5)

    slide(tab, END)
    arrived(tab, 1, 72)
    q = [0.5, np.pi]
    np.testing.assert_allclose(data(tab, "M", 0)["z"], e.robot.mass_matrix(q), rtol=1e-5)
    np.testing.assert_allclose(data(tab, "holding", 0)["x"], e.robot.gravity(q), rtol=1e-4)
    frame = next(
        t
        for t in tab.run(
            "document.getElementById('arm').data.map(t => ({name: t.name, x: t.x, y: t.y}))"
        )
        if t["name"] == "frame"
    )
    tip = e.robot.forward_kinematics(q)[:2, 3]
    np.testing.assert_allclose([frame["x"][0], frame["y"][0]], tip, atol=1e-5)
    assert "joint2 = 3.14 rad" in tab.run("document.getElementById('said').textContent")

    slide(tab, HOME)
    arrived(tab, 1, 0)
    slide(tab, RIGHT)
    arrived(tab, 1, 1)
    unharmed(tab, path)


def choose(tab, select, value):
    tab.run(
        f"document.getElementById('{select}').value = '{value}';"
        f"document.getElementById('{select}').dispatchEvent(new Event('change'))"
    )


def test_every_control_changes_its_picture(tab, tmp_path):
    path, e = tmp_path / "arm.html", explained("planar_2r")
    opened(tab, path, e)
    before = data(tab, "entry", 0)["x"]
    choose(tab, "column", 0)
    tab.wait(f"document.getElementById('entry').data[0].x[0] != {before[0]}")
    parts = e.inertia.translation[:, 0, 0]
    np.testing.assert_allclose(data(tab, "entry", 0)["x"][:2], parts, rtol=1e-5)

    choose(tab, "quantity", "g:0")
    tab.wait("document.getElementById('extremes').textContent.includes('N·m')")
    shown = np.array(data(tab, "map", 0)["z"])
    assert shown.max() == pytest.approx(e.worst[0].effort, rel=0.02)
    choose(tab, "quantity", "condition")

    tab.run("document.getElementById('least').click()")
    tab.wait("document.getElementById('said').textContent.includes('joint1 feels 0.7 ')")
    tab.run("document.getElementById('back').click()")
    tab.wait("document.getElementById('said').textContent.includes('joint2 = 0.3 rad')")
    choose(tab, "joint", 0)
    tab.wait("document.getElementById('said').textContent.includes('joint1 = 0.5 rad')")
    choose(tab, "look", 1)
    tab.wait("document.getElementById('said').textContent.includes('joint2 feels')")
    unharmed(tab, path)


def test_arm_in_space(tab, tmp_path):
    path, e = tmp_path / "arm.html", explained("panda")
    opened(tab, path, e)
    assert tab.run(
        "!!document.querySelector('#arm canvas').getContext('webgl2') || "
        "document.querySelectorAll('#arm canvas').length > 0"
    )
    slide(tab, HOME)
    arrived(tab, 3, 0)
    q = e.q.copy()
    q[3] = e.robot.limits.lower[3]
    frame = next(
        t
        for t in tab.run(
            "document.getElementById('arm').data.map(t => "
            "({name: t.name, p: t.name === 'frame' && [t.x[0], t.y[0], t.z[0]]}))"
        )
        if t["name"] == "frame"
    )
    np.testing.assert_allclose(frame["p"], e.robot.forward_kinematics(q)[:3, 3], atol=1e-5)
    unharmed(tab, path)


@pytest.mark.parametrize("name", ["cart_pole", "pendulum"])
def test_small_robots(tab, tmp_path, name):
    """A slide without limits is not swept; one joint has no pairs and no coupling."""
    path = tmp_path / "arm.html"
    opened(tab, path, explained(name))
    unharmed(tab, path)


def test_evil_names_narrow_and_dark(tab, tmp_path):
    path = tmp_path / "arm.html"
    robot = renamed(built_in("planar_2r"), joint1=EVIL, joint2="<img src=x onerror=alert(2)>")
    try:
        tab.look(400, dark=True)
        opened(tab, path, robot.explain([0.5, 0.3], [0.7, -0.4]))
        slide(tab, END)
        arrived(tab, 1, 72)
        assert tab.run("document.title") == f"{EVIL} explained"
        assert tab.run("document.querySelectorAll('img').length") == 0
        assert tab.run("document.documentElement.scrollWidth") == 400
        ink = "document.getElementById('M').layout.font.color"
        dark = tab.run(ink)
        tab.look(400, dark=False)
        tab.wait(f"{ink} !== '{dark}'")
        unharmed(tab, path)
    finally:
        tab.look(1280)
