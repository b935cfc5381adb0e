"""Traced programs: legal, deterministic, counted, and evaluated by the reference interpreter."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from legality import violations

from mcgee import build
from mcgee.arms import BUILTIN
from mcgee.graph.node import Graph
from mcgee.graph.program import Array, Program, evaluate
from robots import random_tree

QUANTITIES = sorted(build.SIGNATURES)
TREES = {f"tree{seed}": seed for seed in range(6)}


def robot(name: str):
    if name in TREES:
        return random_tree(TREES[name], bodies=5, mimic=0.3 * (TREES[name] % 2))
    return BUILTIN[name]()


def traced(robot, quantity: str) -> Program:
    needs_frame = quantity in ("forward_kinematics", "jacobian")
    return build.trace(robot.mechanism, quantity, *([robot.end_frame] if needs_frame else []))


@pytest.mark.parametrize("name", [*BUILTIN, *TREES])
def test_programs_of_robots_are_legal(name):
    arm = robot(name)
    for quantity in QUANTITIES:
        program = traced(arm, quantity)
        assert violations(program.nodes) == []
        assert program.nodes == sorted(set(program.nodes), key=lambda node: node.index)
        assert len(program.roots) == sum(array.size for array in program.outputs)


@pytest.mark.parametrize("name", ["panda", "tree1"])
def test_tracing_a_robot_twice_gives_the_same_text(name):
    for quantity in QUANTITIES:
        first, second = traced(robot(name), quantity), traced(robot(name), quantity)
        assert list(map(repr, first.nodes)) == list(map(repr, second.nodes))
        assert list(map(repr, first.roots)) == list(map(repr, second.roots))


def test_tracing_does_not_depend_on_hashes():
    text = (
        "from mcgee import arms, build\n"
        "p = build.trace(arms.puma560().mechanism, 'coriolis_matrix')\n"
        "print(hash('x'), p.nodes, p.roots, sep='\\n')"
    )
    first, second = (
        subprocess.run(
            [sys.executable, "-c", text],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split("\n", 1)
        for seed in ("1", "2")
    )
    assert first[0] != second[0]
    assert first[1] == second[1]


def program(function, *sizes: int, outputs=None) -> Program:
    """The function of node lists, traced; its result is flat."""
    graph = Graph()
    inputs = tuple(Array(f"x{k}", (size,)) for k, size in enumerate(sizes))
    roots = tuple(function(*(graph.inputs(a.name, a.size) for a in inputs)))
    return Program("p", inputs, outputs or (Array("y", (len(roots),)),), roots)


def test_operations_are_counted_once_and_only_where_needed():
    def text(x):
        c, s = x[0].cos_sin()
        (c1, _), (_, s2) = (-x[1]).cos_sin(), (x[1] + 1).cos_sin()
        _unused = x[0] / x[1] + x[1] * 7
        return c * s, c * s + x[1], -(c - x[1]), c1, s2, x[0] / 3, 5.0, x[0]

    assert program(text, 2).operation_counts() == {
        "add": 3,  # + x1, c − x1, x1 + 1
        "mul": 1,
        "div": 1,
        "neg": 1,
        "sincos": 3,  # of x0, of x1 by its cosine, of x1 + 1 by its sine
        "fma": 1,  # c * s + x1, and c * s is asked for itself
        "instructions": 6,
    }


def test_a_program_without_operations():
    p = program(lambda x: (x[1], 2.0, x[0], x[1]), 2)
    assert set(p.operation_counts().values()) == {0}
    assert len(p.nodes) == 2
    (got,) = evaluate(p, [[3.0, 4.0], [5.0, 6.0]])
    assert got.tolist() == [[4, 2, 3, 4], [6, 2, 5, 6]]


def test_evaluate_every_operation():
    def text(x, y):
        c, s = x[0].cos_sin()
        return x[0] + y[0], x[0] - y[0], x[0] * y[0], x[0] / y[0], -x[0], c, s, 1.5

    x, y = np.random.default_rng(1).normal(size=(2, 9, 1))
    (got,) = evaluate(program(text, 1, 1), x, y)
    wanted = [x + y, x - y, x * y, x / y, -x, np.cos(x), np.sin(x), np.full_like(x, 1.5)]
    assert np.array_equal(got, np.hstack(wanted))


def test_evaluate_broadcasts_and_shapes_outputs(rng):
    outputs = (Array("a", (2, 3)), Array("b", ()), Array("c", (1, 2, 1)))
    p = program(
        lambda x, y: (*(x[0] * k for k in range(1, 7)), y[0] - x[0], y[1], 4.0),
        1,
        2,
        outputs=outputs,
    )
    x, y = rng.normal(size=(4, 1, 1)), rng.normal(size=(3, 2))
    a, b, c = evaluate(p, x, y)
    assert a.shape == (4, 3, 2, 3)
    assert b.shape == (4, 3)
    assert c.shape == (4, 3, 1, 2, 1)
    k = np.arange(1.0, 7.0).reshape(2, 3)
    assert np.array_equal(a, np.broadcast_to(x[..., None] * k, (4, 3, 2, 3)))
    assert np.array_equal(b, y[:, 0] - x[..., 0])
    assert np.array_equal(c[..., 0, 0, 0], np.broadcast_to(y[:, 1], (4, 3)))
    assert np.array_equal(c[..., 0, 1, 0], np.full((4, 3), 4.0))


def test_evaluate_a_single_row_an_empty_batch_and_a_mismatch():
    p = program(lambda x, y: (x[0] + y[0],), 1, 1)
    assert evaluate(p, [1.0], [2])[0].shape == (1,)
    assert evaluate(p, np.zeros((0, 1)), [2])[0].shape == (0, 1)
    with pytest.raises(ValueError, match="shape mismatch"):
        evaluate(p, np.zeros((3, 1)), np.zeros((2, 1)))
    with pytest.raises(ValueError, match="shorter"):
        evaluate(p, [1.0])


def test_evaluate_agrees_with_the_algorithms_on_floats(rng):
    from mcgee import quantities
    from mcgee.algorithms.regroup import regrouped

    arm = robot("tree3")
    q, qd, qdd = rng.normal(size=(3, arm.n))
    (got,) = evaluate(traced(arm, "inverse_dynamics"), q, qd, qdd)
    mechanism = regrouped(arm.mechanism)
    wanted = quantities.inverse_dynamics(mechanism, q.tolist(), qd.tolist(), qdd.tolist())
    assert np.allclose(got, wanted, rtol=1e-13, atol=1e-13 * np.abs(wanted).max())
