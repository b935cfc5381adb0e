"""Long programs in parts that share functions: the same bits as straight-line code."""

from __future__ import annotations

import re

import numpy as np
import pytest
from programs import compiling_for, of_robot, program, random_program, same_bits, targets
from test_single import assert_same_bits

from mcgee import build
from mcgee.graph import cut
from mcgee.graph.node import Graph, Node
from mcgee.graph.program import Program, live
from mcgee.jit import kernel
from mcgee.jit.kernel import kernel_ir
from mcgee.jit.target import host
from mcgee.jit.ufunc import gufunc
from robots import random_tree

QUANTITIES = ["inverse_dynamics", "forward_dynamics", "coriolis_matrix", "christoffel"]


def chain(joints: int):
    return random_tree(4, bodies=joints, branching=0, prismatic=0, fixed=0, aligned=0)


@pytest.fixture
def short_is_long(monkeypatch):
    """Every program is made to repeat, and cut where it does."""
    monkeypatch.setattr(build, "LONG", 0)
    monkeypatch.setattr(kernel, "LONG", 0)
    monkeypatch.setattr(cut, "SHORTEST", 20)


def arrays(p: Program, rows: int) -> list[np.ndarray]:
    rng = np.random.default_rng(rows)
    return [rng.normal(size=(rows, a.size)) * 3 for a in p.inputs]


def functions(p: Program) -> tuple[int, int]:
    """How many there are besides the kernel, and how often they are called."""
    text = kernel_ir(p, host()).text
    return text.count("define internal void @part"), len(re.findall(r"call void @part", text))


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("name", targets())
def test_shared_functions_change_no_bit(name, quantity, short_is_long, monkeypatch):
    p = of_robot(chain(12), quantity)
    x = arrays(p, 21)
    with compiling_for(targets()[name]):
        made, called = functions(p)
        assert made < 0.9 * called
        shared = gufunc(p)(*x)
        monkeypatch.setattr(kernel, "LONG", 10**9)
        assert same_bits(gufunc(p)(*x), shared)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_row_alone(quantity, short_is_long):
    p = of_robot(chain(12), quantity)
    assert_same_bits(p, *arrays(p, 5))


def test_float32(short_is_long, monkeypatch):
    p = of_robot(chain(12), "inverse_dynamics")
    x = [a.astype(np.float32) for a in arrays(p, 37)]
    shared = gufunc(p, single=True)(*x)
    monkeypatch.setattr(kernel, "LONG", 10**9)
    straight = gufunc(p, single=True)(*x)
    assert shared.dtype == np.float32
    assert np.array_equal(shared, straight)


@pytest.mark.parametrize("seed", range(8))
def test_what_does_not_repeat(seed, short_is_long):
    p = random_program(seed, (3, 2), (2, 2), (), operations=200)
    assert_same_bits(p, *arrays(p, 9))


def test_signs_of_zeros_among_constants_are_kept(short_is_long, monkeypatch):
    """Twice the same text with other constants, -0.0 and 0.0 among them."""
    monkeypatch.setattr(cut, "SHORTEST", 1)
    monkeypatch.setattr(cut, "LONGEST", 2)

    def text(x):
        node = x[0]
        for zero, other in ((0.0, 3.0), (-0.0, 3.0), (0.0, -0.0)):
            node = node.graph._node("div", zero, node)
            yield node
            node = node.graph._node("div", other, node.graph._node("add", 2.0, node))
            yield node

    p = program(text, (1,))
    straight = 1 / np.array([[4.0], [-4.0]])
    with np.errstate(all="ignore"):
        got = gufunc(p)(straight)
        monkeypatch.setattr(kernel, "LONG", 10**9)
        want = gufunc(p)(straight)
    assert same_bits(np.signbit(got), np.signbit(want))
    assert np.array_equal(got, want, equal_nan=True)


def test_code_does_not_grow_with_the_chain():
    sizes = []
    for joints in (120, 240):
        p = build.trace(chain(joints).mechanism, "forward_dynamics")
        sizes.append(functions(p))
        assert sizes[-1][0] < 0.4 * sizes[-1][1]
    (made, called), (more, calls) = sizes
    assert calls > 1.8 * called
    assert more < 1.5 * made


def test_scratch_is_used_again():
    p = build.trace(chain(120).mechanism, "inverse_dynamics")
    left = live(p, {})
    parts = cut.evenly([node for node in left if node.op != "input"], kernel.PART)
    places, size = cut.crossing(parts, left)
    assert size < 0.8 * len(places)
    last = {}
    for k, part in enumerate(parts):
        for node in part:
            for a in left[node][1]:
                if a in places:
                    last[a] = k
    for k, part in enumerate(parts):
        alive = [places[a] for a in places if a in last and last[a] >= k and a in _before(parts, k)]
        taken = [places[node] for node in part if node in places]
        assert len({*alive, *taken}) == len(alive) + len(taken)


def _before(parts, k: int) -> set[Node]:
    return {node for part in parts[:k] for node in part}


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_signed_graphs_give_the_same(quantity, monkeypatch):
    mechanism = chain(9).mechanism
    usual = build.trace(mechanism, quantity)
    monkeypatch.setattr(build, "LONG", 10)
    signed = build.trace(mechanism, quantity)
    assert any(a < 0 for node in signed.nodes for a in node.args if isinstance(a, float))
    x = arrays(usual, 6)
    got, want = gufunc(signed)(*x), gufunc(usual)(*x)
    assert np.abs(got - want).max() <= 1e-13 * np.abs(want).max()


def test_a_signed_graph_keeps_signs_in_constants():
    signed, usual = Graph(signed=True), Graph()
    (x,), (y,) = signed.inputs("x", 1), usual.inputs("x", 1)
    assert (x * -2.0).op == "mul"
    assert (x * -2.0).args == (-2.0, x)
    assert (x * -1.0).op == "neg"
    assert (-x * 2.0).args == (-2.0, x)
    assert (y * -2.0).op == "neg"
