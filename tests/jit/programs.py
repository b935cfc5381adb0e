"""Programs and targets to compile in tests."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from contextlib import contextmanager
from unittest import mock

import numpy as np

from mcgee import build
from mcgee.graph.node import Graph, Node, Value
from mcgee.graph.program import Array, Program
from mcgee.jit import compile as jit_compile
from mcgee.jit.target import Target, host
from mcgee.jit.ufunc import gufunc


def program(
    text: Callable[..., Iterable[Value]], inputs: tuple[int, ...], *outputs: tuple[int, ...]
) -> Program:
    """text(x0, x1, …) on lists of nodes gives the elements of all outputs in order."""
    graph = Graph()
    arrays = tuple(Array(f"x{k}", (size,)) for k, size in enumerate(inputs))
    roots = tuple(text(*(graph.inputs(a.name, a.size) for a in arrays)))
    shapes = outputs or ((len(roots),),)
    return Program(
        "p", arrays, tuple(Array(f"y{k}", shape) for k, shape in enumerate(shapes)), roots
    )


def _operation(rng, a: Node, b: Node, c: Node, d: Node, trigonometry: bool) -> Value:
    k = float(rng.choice([0.5, -0.25, 3.0, 0.1, -0.7]))
    patterns = [
        lambda: (a + b) * 0.5,
        lambda: (a * b - c) * 0.5,
        lambda: (a - b * c) * 0.4,
        lambda: (a * b + c * d) * 0.5,
        lambda: (a * b - c * d) * 0.5,
        lambda: k - a * 0.5,
        lambda: a / (2 + b * b),
        lambda: -a,
        lambda: k / (1.5 + a * a),
        lambda: a.cos_sin()[0] if trigonometry else a * 0.9,
        lambda: a.cos_sin()[1] if trigonometry else a + 0.1,
        lambda: (a * b).cos_sin()[1] if trigonometry else -a * b * 0.5,
    ]
    return patterns[rng.integers(len(patterns))]()


def of_robot(robot, quantity: str) -> Program:
    needs_frame = quantity in ("forward_kinematics", "jacobian")
    return build.trace(robot.mechanism, quantity, *([robot.end_frame] if needs_frame else []))


def random_program(
    seed: int,
    inputs: tuple[int, ...],
    *outputs: tuple[int, ...],
    operations: int = 40,
    trigonometry: bool = True,
) -> Program:
    """Every kind of operation, in every pattern that fuses; values stay near one.

    Among the roots are constants, inputs, and one root twice.
    """
    rng = np.random.default_rng(seed)

    def text(*arrays: list[Node]) -> Iterable[Value]:
        values: list[Value] = [x for array in arrays for x in array]

        def pick() -> Node:
            recent = values[-12:] if rng.random() < 0.7 else values
            return recent[rng.integers(len(recent))]

        while len(values) < operations + sum(inputs):
            new = _operation(rng, *(pick() for _ in range(4)), trigonometry)
            if isinstance(new, Node):
                values.append(new)
        size = sum(int(np.prod(shape)) for shape in outputs)
        roots: list[Value] = [values[-1 - i % len(values)] for i in range(size)]
        for i in range(1, size, 5):
            roots[i] = float(rng.choice([0.0, 1.0, -2.5, 0.0]))
        for i in range(3, size, 7):
            roots[i] = arrays[0][i % inputs[0]]
        roots[-1] = roots[0]
        return roots

    return program(text, inputs, *outputs)


def target(lanes: int, fma: bool) -> Target:
    """The host with registers of another width, or with fewer abilities."""
    if fma or "x86_64" not in host().triple:
        return dataclasses.replace(host(), lanes=lanes, fma=fma)
    plain = {2: "", 4: "+avx", 8: "+avx"}[lanes]
    if "+avx" not in host().features:
        plain = ""
    return dataclasses.replace(host(), cpu="x86-64", features=plain, lanes=lanes, fma=fma)


def targets() -> dict[str, Target]:
    """All that this machine can run."""
    fma = (True, False) if host().fma else (False,)
    every = {f"{lanes} lanes{', fma' * f}": target(lanes, f) for lanes in (2, 4, 8) for f in fma}
    return {"host": host(), **every}


@contextmanager
def compiling_for(chosen: Target):
    with mock.patch.object(jit_compile, "host", return_value=chosen):
        yield


def compiled_for(chosen: Target, p: Program) -> np.ufunc:
    with compiling_for(chosen):
        return gufunc(p)


def same_bits(a, b) -> bool:
    """Equal in every bit, NaNs and signs of zeros included."""
    a, b = np.ascontiguousarray(a), np.ascontiguousarray(b)
    return a.shape == b.shape and a.tobytes() == b.tobytes()
