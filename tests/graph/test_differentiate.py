"""Derivatives of programs: by hand, by complex step, and against the recursion of the physics."""

import numpy as np
import pytest

from mcgee import arms, build
from mcgee.graph.differentiate import PARTIALS, jacobian
from mcgee.graph.node import OPERATIONS, Graph
from mcgee.graph.program import Array, Program, evaluate
from robots import apart, loaded, random_state, random_tree

ROUNDING = 1e-14
"""Of the largest element: the same numbers by other operations."""

modes = pytest.mark.parametrize("reverse", [False, True], ids=["forward", "reverse"])


def program(text, *sizes):
    graph = Graph()
    arrays = tuple(Array(f"x{k}", (size,)) for k, size in enumerate(sizes))
    roots = text(*(graph.inputs(array.name, array.size) for array in arrays))
    return Program("test", arrays, (Array("y", (len(roots),)),), tuple(roots))


def everything(x, y):
    """Every operation, constants on either side, a root that is an input, one that is a number."""
    (c, s), (cc, _) = x[0].cos_sin(), (3 * x[1] - y[0]).cos_sin()
    return (
        c * s + y[0] / (2 + x[1] * x[1]),
        -(s / 3) - cc,
        5 - x[0] * x[0] * y[1],
        x[1],
        2.0,
        -y[1],
    )


@modes
def test_every_operation(reverse, rng):
    p = program(everything, 2, 2)
    assert {node.op for node in p.nodes} - {"input"} == set(OPERATIONS) == set(PARTIALS)
    x, y = rng.normal(size=(2, 2))
    by_x, by_y = evaluate(jacobian(p, ("x0", "x1"), reverse=reverse), x, y)
    for k, e in enumerate(np.eye(2) * 1e-200j):
        (c, s), d = (np.cos(x + e), np.sin(x + e)), np.array
        assert by_x.shape == by_y.shape == (6, 2)
        for got, u, v in ((by_x, x + e, y), (by_y, x, y + e)):
            c, s = np.cos(u[0]), np.sin(u[0])
            want = d(
                [
                    c * s + v[0] / (2 + u[1] * u[1]),
                    -s / 3 - np.cos(3 * u[1] - v[0]),
                    5 - u[0] * u[0] * v[1],
                    u[1],
                    2.0,
                    -v[1],
                ]
            )
            assert apart(got[:, k], np.imag(want) / 1e-200) <= ROUNDING


@modes
def test_names_and_shapes(reverse):
    p = program(everything, 2, 2)
    d = jacobian(p, ["x1"], reverse=reverse)
    assert d.outputs == (Array("dy_dx1", (6, 2)),)
    assert d.inputs == p.inputs
    assert d.roots[6:10] == (0.0, 0.0, 0.0, 0.0)  # of x0 and of a number


@modes
@pytest.mark.parametrize("name", ["planar_2r", "ur5", "random"])
def test_another_way_to_the_derivatives_of_dynamics(name, reverse, rng):
    robot = {
        "planar_2r": lambda: arms.planar_2r(),
        "ur5": lambda: loaded("ur5"),
        "random": lambda: random_tree(8, bodies=5, mimic=0.4, armature=0.5),
    }[name]()
    for quantity in ("inverse_dynamics", "forward_dynamics"):
        tau = build.trace(robot.mechanism, quantity)
        slopes = jacobian(tau, [array.name for array in tau.inputs], reverse=reverse)
        state = random_state(robot, rng, 3)
        recursion = build.trace(robot.mechanism, f"{quantity}_derivatives")
        assert [a.name for a in slopes.outputs][:2] == [a.name for a in recursion.outputs][:2]
        for one, other in zip(evaluate(slopes, *state), evaluate(recursion, *state), strict=True):
            assert apart(one, other, 1.0) <= ROUNDING


@pytest.mark.parametrize("name", ["planar_2r", "ur5", "panda"])
def test_of_the_ways_to_derivatives_the_cheapest_is_compiled(name):
    """The graph's, for arms with few lengths; the recursion's for others."""
    m = (arms.planar_2r() if name == "planar_2r" else loaded(name)).mechanism
    p = build.trace(m, "inverse_dynamics")
    graph = jacobian(p, ("q", "qd", "qdd"), reverse=False).arithmetic()
    recursion = build._traced(m, *["inverse_dynamics_derivatives"] * 2, (), False, True)
    chosen = build.trace(m, "inverse_dynamics_derivatives").arithmetic()
    assert chosen <= min(graph, recursion.arithmetic())
    assert (chosen == recursion.arithmetic()) == (name == "panda")
