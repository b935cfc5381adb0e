"""Large batches in chunks: the same bits, arrays and errors, whatever the threads."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import warnings

import numpy as np
import pytest

import mcgee
from mcgee import threads

ARM = mcgee.load("planar_3r")


@pytest.fixture(autouse=True)
def eager(monkeypatch):
    """Every batch is large."""
    monkeypatch.setattr(threads, "ENOUGH", 1)
    monkeypatch.delenv("MCGEE_NUM_THREADS", raising=False)
    yield
    mcgee.set_num_threads(None)


def states(*lead: int, count: int = 1, seed: int = 0) -> list[np.ndarray]:
    return list(np.random.default_rng(seed).normal(size=(count, *lead, ARM.n)))


def alone(name: str, *arrays: np.ndarray):
    mcgee.set_num_threads(1)
    try:
        return getattr(ARM, name)(*arrays)
    finally:
        mcgee.set_num_threads(None)


def chunks_of(monkeypatch) -> list[str]:
    """The threads that the gufunc ran on."""
    ran: list[str] = []
    rows = threads._rows

    def noted(*args):
        ran.append(threading.current_thread().name)
        return rows(*args)

    monkeypatch.setattr(threads, "_rows", noted)
    return ran


@pytest.mark.parametrize("count", [2, 3, 7])
@pytest.mark.parametrize("rows", [1, 63, 64, 65, 1000, 4099])
@pytest.mark.parametrize("name", ["mass_matrix", "kinetic_energy", "inverse_dynamics", "terms"])
def test_a_row_has_the_same_bits_on_any_number_of_threads(name, rows, count):
    inputs = {"mass_matrix": 1, "inverse_dynamics": 3}.get(name, 2)
    arrays = states(rows, count=inputs, seed=rows)
    expected = alone(name, *arrays)
    mcgee.set_num_threads(count)
    got = getattr(ARM, name)(*arrays)
    if name != "terms":
        got, expected = (got,), (expected,)
    assert [part.tobytes() for part in got] == [part.tobytes() for part in expected]


def test_chunks_run_on_other_threads(monkeypatch):
    ran = chunks_of(monkeypatch)
    mcgee.set_num_threads(3)
    ARM.mass_matrix(*states(1000))
    assert {name.startswith("mcgee") for name in ran} == {True, False}


def test_one_thread_means_the_callers(monkeypatch):
    ran = chunks_of(monkeypatch)
    mcgee.set_num_threads(1)
    ARM.mass_matrix(*states(1000))
    assert not ran


@pytest.mark.parametrize(
    "leads",
    [
        [(500,), (500,), (1,)],
        [(2, 500), (500,), (2, 1)],
        [(500, 3), (1, 3), (500, 1)],
        [(500, 1), (3,), (4, 1, 3)],
        [(3, 500, 2), (1, 1), (2,)],
    ],
)
def test_leading_dimensions_broadcast(leads):
    arrays = [states(*lead, seed=k)[0] for k, lead in enumerate(leads)]
    expected = alone("inverse_dynamics", *arrays)
    mcgee.set_num_threads(4)
    got = ARM.inverse_dynamics(*arrays)
    assert got.shape == expected.shape
    assert got.tobytes() == expected.tobytes()


def test_out_is_filled_and_returned():
    (q,) = states(1000)
    mcgee.set_num_threads(3)
    out = np.full((1000, 3, 3), np.nan)
    assert ARM.mass_matrix(q, out=out) is out
    assert out.tobytes() == alone("mass_matrix", q).tobytes()


def test_out_that_overlaps_an_input_is_as_if_it_did_not():
    held = np.random.default_rng(1).normal(size=(1001, ARM.n))
    expected = alone("gravity", held[:-1].copy())
    mcgee.set_num_threads(3)
    ARM.gravity(held[:-1], out=held[1:])
    assert held[1:].tobytes() == expected.tobytes()


def test_strided_and_single_precision_arrays():
    wide = np.random.default_rng(2).normal(size=(700, 2 * ARM.n)).astype(np.float32)
    q = wide[::-1, ::2]
    expected = alone("mass_matrix", q)
    mcgee.set_num_threads(3)
    got = ARM.mass_matrix(q)
    assert got.dtype == np.float64
    assert got.tobytes() == expected.tobytes()


def test_a_wrong_width_says_the_same():
    with pytest.raises(ValueError, match=r"q has shape \(1000, 4\), expected \(\.\.\., 3\)"):
        ARM.mass_matrix(np.zeros((1000, 4)))


def test_dimensions_that_do_not_broadcast_say_the_same():
    with pytest.raises(ValueError, match="do not broadcast"):
        ARM.coriolis(np.zeros((1000, 3)), np.zeros((999, 3)))


def test_numpys_error_state_reaches_the_threads():
    q = np.zeros((1000, 3))
    q[-1] = np.inf
    mcgee.set_num_threads(3)
    with np.errstate(invalid="raise"), pytest.raises(FloatingPointError):
        ARM.mass_matrix(q)
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isnan(ARM.mass_matrix(q)[-1]).any()


def test_the_environment_limits_threads(monkeypatch):
    monkeypatch.setenv("MCGEE_NUM_THREADS", "5")
    assert mcgee.num_threads() == 5
    mcgee.set_num_threads(2)
    assert mcgee.num_threads() == 2


def test_by_default_the_cores_this_process_may_use():
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    assert mcgee.num_threads() == cores


@pytest.mark.parametrize("text", ["0", "-1", "two", "1.5", " ", "²"])
def test_a_bad_environment_is_refused(monkeypatch, text):
    monkeypatch.setenv("MCGEE_NUM_THREADS", text)
    with pytest.raises(
        ValueError, match=r"MCGEE_NUM_THREADS is .*, expected a whole number from 1"
    ):
        mcgee.num_threads()


@pytest.mark.parametrize("n", [0, -1, 1.5, "2", True])
def test_a_bad_number_is_refused(n):
    with pytest.raises(ValueError, match=r"num_threads is .*, expected a whole number from 1"):
        mcgee.set_num_threads(n)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_child_of_fork_has_threads_of_its_own():
    text = """
import os, sys, time, numpy as np, mcgee
from mcgee import threads
threads.ENOUGH = 1
mcgee.set_num_threads(3)
arm, q = mcgee.load("planar_2r"), np.ones((1000, 2))
first = arm.mass_matrix(q)
time.sleep(0.3)  # until the pool counts its workers as idle
child = os.fork()
if child == 0:
    os._exit(0 if (arm.mass_matrix(q) == first).all() else 1)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", text]
    assert subprocess.run(command, timeout=120).returncode == 0


SHAPES = [((60, 60, 60), None), ((5000,), None), ((3, 2000), None), ((100_000, 1), (1, 0))]


@pytest.mark.parametrize(("shape", "other"), SHAPES)
def test_which_batches_are_cut(shape, other, monkeypatch):
    """Every axis counts, plain rows may come along, and nothing is no rows."""
    monkeypatch.setattr(threads, "ENOUGH", 1000)
    monkeypatch.setattr(threads, "_chosen", 3)
    arm = mcgee.load("panda")
    kernel = arm.coriolis.ufunc
    q = np.random.default_rng(1).normal(size=(*shape, 7))
    qd = np.ones(7) if other is None else np.ones((*other, 7))
    plan = threads._plan(kernel, 600, (q, qd), {})
    if other is not None:
        assert plan is None
        assert arm.coriolis(q, qd).shape == (100_000, 0, 7)
        return
    assert len(plan[2]) == 3
    one_by_one = kernel(q, qd)
    assert arm.coriolis(q, qd).tobytes() == one_by_one.tobytes()


def test_batches_after_the_main_thread_has_ended():
    text = """
import threading, time, numpy as np, mcgee
from mcgee import threads
threads.ENOUGH = 1
mcgee.set_num_threads(2)
arm, q = mcgee.load("planar_2r"), np.ones((1000, 2))
def work():
    for _ in range(4):
        arm.mass_matrix(q)
        time.sleep(0.1)
    print("done")
threading.Thread(target=work).start()
"""
    run = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=120)
    assert (run.stdout, run.stderr) == ("done\n", "")


def test_numbers_of_threads_of_other_kinds(monkeypatch):
    monkeypatch.setattr(threads, "_chosen", None)
    threads.set_num_threads(np.int64(2))
    assert threads.num_threads() == 2
    threads.set_num_threads(None)
    monkeypatch.setenv("MCGEE_NUM_THREADS", "9" * 5000)
    with pytest.raises(ValueError, match=r"MCGEE_NUM_THREADS is '9{20}', expected a whole number"):
        threads.num_threads()
