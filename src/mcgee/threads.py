"""Large batches on all cores: a gufunc's rows in chunks, one a thread.

A row's bits do not depend on its chunk, so threads change nothing but time. How many are used is
`set_num_threads`, else the environment's MCGEE_NUM_THREADS, else the cores this process may use.
"""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

ENOUGH = 20_000_000
"""Operations that make a chunk worth waking a thread: some 0.5 ms."""

GRAIN = 64
"""Chunks begin at multiples of this row: whole tiles, whatever the lanes."""

_chosen: int | None = None
_pool: ThreadPoolExecutor | None = None


def set_num_threads(n: int | None) -> None:
    """Use up to n threads for large batches; 1 for none but the caller's, None for the default.

    Raises: ValueError: not a positive whole number
    """
    global _chosen
    if n is not None:
        whole = hasattr(n, "__index__") and not isinstance(n, bool)
        if not whole or operator.index(n) < 1:
            raise ValueError(f"num_threads is {n!r}, expected a whole number from 1, or None.")
        n = operator.index(n)
    _chosen = n


def num_threads() -> int:
    """How many threads a large batch may use.

    Raises: ValueError: MCGEE_NUM_THREADS is set to something else than a positive whole number
    """
    if _chosen is not None:
        return _chosen
    text = os.environ.get("MCGEE_NUM_THREADS", "")
    if not text:
        return _cores()
    if not (text.isascii() and text.isdigit() and len(text) < 10 and int(text) > 0):
        raise ValueError(f"MCGEE_NUM_THREADS is {text[:20]!r}, expected a whole number from 1.")
    return int(text)


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def run(ufunc: np.ufunc, operations: int, args: tuple, kwargs: dict[str, Any]) -> Any:
    """ufunc(*args, **kwargs), in chunks of rows where that pays.

    Args:
        operations: what a row costs
    """
    plan = _plan(ufunc, operations, args, kwargs)
    if plan is None:
        return ufunc(*args, **kwargs)
    lead, axis, chunks, outputs = plan

    def compute(start: int, stop: int) -> None:
        parts = [_rows(a, 1, lead, axis, start, stop) for a in args]
        into = tuple(_rows(out, out.ndim - len(lead), lead, axis, start, stop) for out in outputs)
        ufunc(*parts, **{**kwargs, "out": into})

    _on_threads(compute, chunks)
    return outputs if ufunc.nout > 1 else outputs[0]


def run_rows(
    ufunc: np.ufunc, operations: int, args: Sequence[np.ndarray], outputs: tuple[np.ndarray, ...]
) -> None:
    """Fill the outputs; the first axis of every operand is cut where that pays.

    Args:
        operations: what a row costs
    """
    rows = len(outputs[0])
    wanted = min(num_threads(), rows * operations // ENOUGH, rows)
    step = max(1, -(-rows // max(wanted, 1)))
    if step > GRAIN:
        step = -(-step // GRAIN) * GRAIN

    def compute(start: int, stop: int) -> None:
        part = slice(start, stop)
        ufunc(*(a[part] for a in args), out=tuple(out[part] for out in outputs))

    _on_threads(compute, [(at, min(at + step, rows)) for at in range(0, rows, step)])


def _on_threads(compute: Callable[[int, int], None], chunks: list[tuple[int, int]]) -> None:
    """Each chunk on a thread, the first on this one."""
    state: dict[str, Any] = {**np.geterr(), "call": np.geterrcall()}

    def alike(start: int, stop: int) -> None:
        with np.errstate(**state):  # which NumPy keeps for each thread
            compute(start, stop)

    waiting, own = [], chunks[:1]
    for chunk in chunks[1:]:
        try:
            waiting.append(_workers().submit(alike, *chunk))
        except RuntimeError:  # the interpreter is about to end and gives no more work out
            own.append(chunk)
    try:
        for chunk in own:
            compute(*chunk)
    finally:
        failures = [future.exception() for future in waiting]
    for failure in failures:
        if failure is not None:
            raise failure


def _plan(
    ufunc: np.ufunc, operations: int, args: tuple, kwargs: dict[str, Any]
) -> tuple[tuple[int, ...], int, list[tuple[int, int]], tuple[np.ndarray, ...]] | None:
    """(leading shape, axis to cut, its chunks, outputs); None where one call does as well."""
    if not all(type(a) is np.ndarray and a.ndim for a in args):
        return None
    rows = max((a.size // max(a.shape[-1], 1) for a in args), default=0)
    if rows * operations < ENOUGH // 4 or kwargs.keys() - {"out", "dtype"}:
        return None
    threads = num_threads()
    if threads < 2 or len(args) != ufunc.nin:
        return None
    sizes, shapes = _core(ufunc)
    try:
        lead = np.broadcast_shapes(*(a.shape[:-1] for a in args))
    except ValueError:
        return None
    if [a.shape[-1] for a in args] != sizes:
        return None
    outputs = _outputs(ufunc, kwargs.get("out"), [lead + shape for shape in shapes], args)
    if outputs is None:
        return None
    axis = max(range(len(lead)), key=lead.__getitem__)
    wanted = min(threads, math.prod(lead) * operations // ENOUGH)
    if wanted < 2:
        return None
    grain = GRAIN if lead[axis] >= wanted * GRAIN else 1
    step = -(-lead[axis] // (wanted * grain)) * grain
    chunks = [(at, min(at + step, lead[axis])) for at in range(0, lead[axis], step)]
    return (lead, axis, chunks, outputs) if len(chunks) > 1 else None


def _core(ufunc: np.ufunc) -> tuple[list[int], list[tuple[int, ...]]]:
    """The inputs' widths and the outputs' core shapes, which its signature spells in numbers."""
    takes, gives = str(ufunc.signature).split("->")
    return [size for (size,) in _shapes(takes)], _shapes(gives)


def _shapes(text: str) -> list[tuple[int, ...]]:
    return [
        tuple(int(size) for size in group.strip("()").split(",") if size)
        for group in text.replace("),(", ");(").split(";")
    ]


def _outputs(
    ufunc: np.ufunc, given: Any, shapes: Sequence[tuple[int, ...]], args: tuple
) -> tuple[np.ndarray, ...] | None:
    """The arrays to fill; None where the caller's own are such that NumPy should see them whole."""
    if given is None:
        kind = np.dtype(ufunc.types[0][-1])
        return tuple(np.empty(shape, kind) for shape in shapes)
    outputs = given if isinstance(given, tuple) else (given,)
    fits = len(outputs) == len(shapes) and all(
        type(out) is np.ndarray and out.shape == shape
        for out, shape in zip(outputs, shapes, strict=True)
    )
    if not fits or any(np.may_share_memory(out, a) for out in outputs for a in args):
        return None
    return outputs


def _rows(
    a: np.ndarray, core: int, lead: tuple[int, ...], axis: int, start: int, stop: int
) -> np.ndarray:
    """The part of an operand that belongs to start … stop of the leading axis."""
    own = axis - len(lead) + a.ndim - core  # broadcasting aligns leading axes at their right end
    if own < 0 or a.shape[own] == 1:
        return a
    return a[(slice(None),) * own + (slice(start, stop),)]


def _workers() -> ThreadPoolExecutor:
    global _pool
    if _pool is None:
        _pool = ThreadPoolExecutor(max_workers=max(_cores(), 64), thread_name_prefix="mcgee")
    return _pool


def _forget_workers() -> None:
    """A child of fork has none of its parent's threads."""
    global _pool
    _pool = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_workers)
