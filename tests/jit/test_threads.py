"""Compiling and computing on many threads at once."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from programs import of_robot, program, random_program, same_bits

from mcgee import arms
from mcgee.graph.program import evaluate
from mcgee.jit.ufunc import gufunc

THREADS = 12


def at_once(work, count: int = THREADS) -> list:
    """work(i) on threads that start together."""
    barrier = threading.Barrier(count)

    def start(i):
        barrier.wait()
        return work(i)

    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(start, range(count)))


def test_many_threads_compile_at_once():
    """Some the same program, some their own."""

    def work(i):
        p = random_program(100 + i % 4, (3,), (2, 2), trigonometry=False)
        x = np.random.default_rng(i).normal(size=(19, 3))
        return np.abs(gufunc(p)(x) - evaluate(p, x)[0]).max()

    assert max(at_once(work)) < 1e-12


def test_a_robot_compiles_a_quantity_once_for_all_threads(monkeypatch):
    from mcgee import kernels

    made = []
    make = kernels.gufunc

    def counted(program, **options):
        made.append(program.name)
        return make(program, **options)

    monkeypatch.setattr(kernels, "gufunc", counted)
    arm = arms.planar_2r()
    q = np.random.default_rng(0).normal(size=(9, 2))
    results = at_once(lambda i: arm.mass_matrix(q) if i % 2 else arm.gravity(q))
    assert sorted(made) == ["gravity", "mass_matrix"]
    for i, result in enumerate(results):
        assert same_bits(result, results[i % 2])


def test_parts_of_files_do_not_stay_behind(tmp_path, monkeypatch):
    monkeypatch.setenv("MCGEE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", None)
    at_once(lambda i: gufunc(program(lambda x: (x[0] + i % 3,), (1,))))
    assert len(list((tmp_path / "cache").iterdir())) == 3
    assert {path.suffix for path in (tmp_path / "cache").iterdir()} == {".o"}
    assert list((tmp_path / "tmp").iterdir()) == []


def test_no_file_is_left_open():
    if not Path("/proc/self/fd").exists():  # a look at this process that only Linux gives
        return
    gufunc(program(lambda x: (x[0] + 1,), (1,)))
    before = len(os.listdir("/proc/self/fd"))
    for k in range(10):
        gufunc(program(lambda x, k=k: (x[0] + k + 2,), (1,)))
    assert len(os.listdir("/proc/self/fd")) <= before


def test_other_python_runs_during_a_long_batch():
    """Python on another thread goes on while a batch is computed: the GIL is free."""
    p = of_robot(arms.panda(), "christoffel")
    function = gufunc(p)
    q = np.random.default_rng(0).normal(size=(400, 7))
    again = np.broadcast_to(q, (100, 400, 7))
    out = np.empty((100, 400, 7, 7, 7))
    moments, done = [], threading.Event()

    def work():
        start = time.perf_counter()
        function(again, out=out)
        moments.append((start, time.perf_counter()))
        done.set()

    thread = threading.Thread(target=work)
    ticks = []
    thread.start()
    while not done.is_set():
        ticks.append(time.perf_counter())
        time.sleep(0.0005)
    thread.join()
    ((start, end),) = moments
    within = [t for t in ticks if start < t < end]
    assert len(within) >= 5
    # the longest silence is far from the whole batch
    silence = np.diff([start, *within, end]).max()
    assert silence < 0.5 * (end - start)


SMALL_STACKS = """
import threading
import numpy as np
from mcgee import arms
arm, results = arms.panda(), []
q = np.random.default_rng(0).normal(size=(33, 7))
whole = arm.christoffel(q)
threading.stack_size(512 * 1024)  # what a thread has on macOS
def work():
    results.append(arm.christoffel(q).tobytes() == whole.tobytes())
threads = [threading.Thread(target=work) for _ in range(4)]
for t in threads: t.start()
for t in threads: t.join()
assert results == [True] * 4
"""


def test_small_stacks_suffice():
    subprocess.run([sys.executable, "-c", SMALL_STACKS], check=True, timeout=60)


FORKED = """
import os
import numpy as np
from mcgee import arms
arm = arms.planar_2r()
q = np.ones((9, 2))
before = arm.mass_matrix(q)
child = os.fork()
if child == 0:
    same = arm.mass_matrix(q).tobytes() == before.tobytes() and arm.gravity(q).shape == (9, 2)
    os._exit(0 if same else 1)
assert os.waitpid(child, 0)[1] == 0
"""


def test_kernels_survive_a_fork():
    if hasattr(os, "fork"):
        subprocess.run([sys.executable, "-c", FORKED], check=True, timeout=60)
