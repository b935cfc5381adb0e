"""Memory: nothing outside the arrays is written, whatever their shapes and strides.

The fuzz runs in a process of its own under allocators that notice: freed and fresh memory is filled
with rubbish, and blocks have guards at their ends.
"""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mcgee import arms, build
from mcgee.jit import compile, loop
from mcgee.jit.ufunc import gufunc

HERE = Path(__file__).parent
PATH = os.pathsep.join(filter(None, [str(HERE), str(HERE.parent), os.environ.get("PYTHONPATH")]))
GUARD = 777.0
CASES = 260


def fuzz(seed: int, cases: int) -> None:
    from programs import compiled_for, random_program, target, targets

    from mcgee.graph.program import evaluate

    rng = np.random.default_rng(seed)
    pool = []
    for k, lanes in enumerate((2, 4, 8, 8)):
        sizes = [int(rng.integers(1, 12)) for _ in range(rng.integers(1, 4))]
        shapes = [
            tuple(int(n) for n in rng.integers(1, 5, rng.integers(0, 4)))
            for _ in range(rng.integers(1, 4))
        ]
        p = random_program(seed * 10 + k, tuple(sizes), *shapes, trigonometry=False)
        pool.append((p, compiled_for(target(lanes, fma=False), p)))
    p = random_program(seed, (3, 2), (3,), (2, 2))
    pool += [(p, compiled_for(t, p)) for t in list(targets().values())[:2]]
    for _ in range(cases):
        p, function = pool[rng.integers(len(pool))]
        lead = tuple(int(n) for n in rng.integers(0, 7, rng.integers(0, 4)))
        inputs = [guarded(rng, (*broken(rng, lead), a.size)) for a in p.inputs]
        for _, view in inputs:
            view[...] = rng.uniform(-1, 1, view.shape)
        kept = [whole.copy() for whole, _ in inputs]
        full = np.broadcast_shapes(lead, *(view.shape[:-1] for _, view in inputs))
        outputs = [guarded(rng, (*full, *a.shape)) for a in p.outputs]
        views = [view for _, view in inputs]
        function(*views, out=tuple(view for _, view in outputs))
        wanted = evaluate(p, *(np.broadcast_to(v, (*full, v.shape[-1])) for v in views))
        for (whole, view), want in zip(outputs, wanted, strict=True):
            assert np.allclose(view, want, rtol=1e-12, atol=1e-12)
            view[...] = GUARD
            assert (whole == GUARD).all()
        for (whole, _), before in zip(inputs, kept, strict=True):
            assert np.array_equal(whole, before)


def broken(rng, lead: tuple[int, ...]) -> tuple[int, ...]:
    """Leading dimensions that broadcast to lead: some are one, some are missing."""
    shape = tuple(1 if n and rng.random() < 0.2 else n for n in lead)
    return shape[rng.integers(0, len(shape) + 1) :] if rng.random() < 0.2 else shape


def guarded(rng, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """A block filled with GUARD, and a view of the shape in it: permuted, spread, backwards."""
    order = rng.permutation(len(shape)) if rng.random() < 0.5 else np.arange(len(shape))
    spread = rng.random() < 0.5
    slices, sizes = [], []
    for axis in order:
        n = shape[axis]
        step = int(rng.integers(1, 4)) if spread else 1
        before, after = (int(v) for v in rng.integers(0, 3, 2) * spread)
        last = before + step * (n - 1)
        sizes.append(before + max(step * (n - 1) + 1, 0) + after)
        if n and rng.random() < 0.3:
            slices.append(slice(last, before - 1 if before else None, -step))
        else:
            slices.append(slice(before, before + step * (n - 1) + 1 if n else before, step))
    edge = int(rng.integers(1, 9))
    whole = np.full(int(np.prod(sizes)) + 2 * edge, GUARD)
    inner = whole[edge:-edge].reshape(sizes)[(*slices, ...)]
    view = inner.transpose(np.argsort(order)) if len(shape) else inner
    assert view.shape == shape
    assert np.shares_memory(view, whole) or view.size == 0
    return whole, view


ALLOCATORS = {
    "plain": {},
    "debug hooks": {"PYTHONMALLOC": "debug"},
    "glibc checks": {"PYTHONMALLOC": "malloc", "MALLOC_CHECK_": "3", "MALLOC_PERTURB_": "165"},
}


@pytest.mark.parametrize("allocator", ALLOCATORS)
def test_fuzz(allocator):
    seed = 1 + list(ALLOCATORS).index(allocator)
    text = f"import test_memory; test_memory.fuzz({seed}, {CASES}); print('done')"
    run = subprocess.run(
        [sys.executable, "-c", text],
        env={**os.environ, "PYTHONPATH": PATH, **ALLOCATORS[allocator]},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (run.returncode, run.stderr, run.stdout) == (0, "", "done\n")


READ_AT_THE_EDGE = """
import ctypes, mmap
import numpy as np
from programs import compiled_for, random_program, targets
page = mmap.PAGESIZE
libc = ctypes.CDLL(None, use_errno=True)
block = mmap.mmap(-1, 8 * page)
start = ctypes.addressof(ctypes.c_char.from_buffer(block))
for forbidden in (start, start + 7 * page):  # any touch of the first or last page is a crash
    assert libc.mprotect(ctypes.c_void_p(forbidden), page, 0) == 0
inside = np.frombuffer(block, np.float64)[page // 8 : 7 * page // 8]
for seed, t in enumerate(targets().values()):
    for n in (1, 2, 3, 5, 8, 13):
        p = random_program(seed, (n,), (n,))
        f = compiled_for(t, p)
        for rows in (1, 2, t.lanes - 1, t.lanes, t.lanes + 1, 3 * t.lanes):
            for place in (slice(None, rows * n), slice(-rows * n, None)):
                x = inside[place].reshape(rows, n)
                for sign in (1, -1):
                    x[...] = 0.5
                    wanted = f(x.copy())
                    assert np.array_equal(f(x[::sign]), wanted)
                    f(wanted * 0 + 0.5, out=x[::sign, ::sign])
                    assert np.array_equal(x[::sign, ::sign], wanted)
print("done")
"""


def test_no_byte_beyond_an_array_is_touched():
    """Arrays that end, or begin, where the memory that may be touched ends or begins."""
    if sys.platform == "win32":  # its mprotect has another name
        return
    run = subprocess.run(
        [sys.executable, "-c", READ_AT_THE_EDGE],
        env={**os.environ, "PYTHONPATH": PATH},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (run.returncode, run.stderr, run.stdout) == (0, "", "done\n")


def test_repeated_calls_do_not_leak():
    """Tiles on the heap come back, and so do results."""
    import tracemalloc

    from programs import random_program

    from mcgee.jit import loop
    from mcgee.jit.ufunc import gufunc

    stack, loop.STACK = loop.STACK, 0
    try:
        function = gufunc(random_program(1, (3,), (4, 4)))
    finally:
        loop.STACK = stack
    x = np.ones((5, 3))
    tracemalloc.start()
    try:
        function(x)
        before = tracemalloc.get_traced_memory()[0]
        for _ in range(2000):
            function(x)
        assert tracemalloc.get_traced_memory()[0] - before < 20_000
    finally:
        tracemalloc.stop()


def test_a_tile_that_cannot_be_had_is_a_memory_error(monkeypatch):
    """Where the heap gives nothing, NumPy raises; nobody reads what was never computed."""
    refuse = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_size_t)(lambda size: None)
    symbols = dict(compile._symbols())
    symbols["PyMem_RawMalloc"] = ctypes.cast(refuse, ctypes.c_void_p).value
    monkeypatch.setattr(compile, "_symbols", lambda: symbols)
    monkeypatch.setattr(loop, "STACK", 0)
    starved = gufunc(build.trace(arms.planar_2r().mechanism, "mass_matrix"))
    with pytest.raises(MemoryError):
        starved(np.zeros((5, 2)))
