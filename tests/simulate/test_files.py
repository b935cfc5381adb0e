"""Trajectories in files, as data frames, as dictionaries, as pictures and as pages."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from chromium import found, tab
from mcgee.simulate import simulate
from mcgee.simulate.files import columns
from robots import built_in


@pytest.fixture(scope="module")
def motion():
    arm = built_in("planar_2r").replace(viscous={"joint2": 0.2})
    return simulate(arm, [0.3, 0.4], [0, 0], 1.0, step=0.02, friction=True)


def test_numpy(motion, tmp_path):
    path = motion.save(tmp_path / "run.npz")
    with np.load(path) as kept:
        assert np.array_equal(kept["q"], motion.q)
        assert np.array_equal(kept["work"], motion.work)
        assert list(kept["joints"]) == ["joint1", "joint2"]


def test_csv(motion, tmp_path):
    motion.save(tmp_path / "run.csv")
    head, *rows = (tmp_path / "run.csv").read_text().splitlines()
    names = [name.strip('"') for name in head.split(",")]
    assert names[:5] == ["t", "q_joint1", "q_joint2", "qd_joint1", "qd_joint2"]
    table = np.array([[float(x) for x in row.split(",")] for row in rows])
    assert np.array_equal(table[:, 0], motion.t)
    for name, values in (
        ("residual", motion.residual),
        ("T", motion.kinetic),
        ("P", motion.potential),
        ("work_joint2", motion.work[:, 1]),
        ("dissipated_joint2", motion.dissipated[:, 1]),
    ):
        assert np.array_equal(table[:, names.index(name)], values)


def test_logs_hide_no_column(motion):
    named = dataclasses.replace(motion, log={"t": 2 * motion.t, "T": motion.q})
    table = columns(named)
    assert np.array_equal(table["t"], motion.t)
    assert np.array_equal(table["log_t"], 2 * motion.t)
    assert np.array_equal(table["T"], motion.kinetic)
    assert np.array_equal(table["T_2"], motion.q[:, 1])


def test_parquet_and_data_frames(motion, tmp_path):
    import pandas

    motion.save(tmp_path / "run.parquet")
    read, frame = pandas.read_parquet(tmp_path / "run.parquet"), motion.to_dataframe()
    assert read.equals(frame)
    assert np.array_equal(frame["qd_joint2"], motion.qd[:, 1])


def test_json(motion):
    said = json.loads(json.dumps(motion.to_dict()))
    assert said["joints"] == ["joint1", "joint2"]
    assert np.array_equal(said["tau"], motion.tau)
    assert said["status"] == "complete"


def test_other_endings(motion, tmp_path):
    with pytest.raises(ValueError, match=r"ends in '.xls', expected one of: .npz, .csv, .parquet"):
        motion.save(tmp_path / "run.xls")
    with pytest.raises(ValueError, match="there is no folder"):
        motion.save(tmp_path / "nowhere" / "run.npz")


def test_batches_are_no_tables(tmp_path):
    batch = simulate(built_in("planar_2r"), np.zeros((3, 2)), [0, 0], 0.1, step=0.05)
    with pytest.raises(ValueError, match=r"a batch of shape \(3,\) is no table"):
        batch.save(tmp_path / "run.csv")
    with pytest.raises(ValueError, match=r"a batch of shape \(3,\) is no picture"):
        batch.figure()
    with pytest.raises(ValueError, match="is no picture"):
        batch.to_html(tmp_path / "run.html")
    assert list(tmp_path.iterdir()) == []
    assert batch.save(tmp_path / "run.npz").is_file()


def test_a_trajectory_says_what_it_is(motion):
    assert repr(motion).startswith("Trajectory of 'planar_2r': 1 s in 51 times, complete, energy")


def test_figure(motion):
    made = motion.figure()
    names = {trace.name for trace in made.data}
    assert {"joint1", "joint2", "T", "P", "T + P", "lost to friction"} <= names
    assert "stops" not in names


@pytest.mark.parametrize("name", ["planar_2r", "panda"])
def test_the_page_moves(name, tmp_path):
    if found() is None:
        pytest.skip("needs Chromium")
    arm = built_in(name)
    moved = simulate(arm, np.full(arm.n, 0.3), np.zeros(arm.n), 1.0, step=0.05)
    path = moved.to_html(tmp_path / "run.html")
    with tab() as page:
        page.look(1100)
        page.open(path, "document.querySelector('#efforts .plot-container') !== null")
        where = "JSON.stringify(document.getElementById('arm').data[0].x)"
        before = page.run(where)
        page.run(
            "const s = document.getElementById('time'); s.value = 15;"
            "s.dispatchEvent(new Event('input')); 1"
        )
        assert page.run("document.getElementById('now').value") == "0.75 s"
        assert page.run(where) != before
        page.run("document.getElementById('play').click(); 1")
        page.wait("Number(document.getElementById('time').value) === 20")
        page.wait("document.getElementById('play').textContent === 'Play'")
        assert page.problems == []
        assert [url for url in page.requests if not url.startswith("file:")] == []
