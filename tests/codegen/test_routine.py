"""Routines compute what their graphs say, however they are cut, and print what they are."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mcgee import build
from mcgee.codegen.expression import Syntax, decimal, lines, text
from mcgee.codegen.routine import (
    WORK,
    Expression,
    Item,
    Let,
    Local,
    Number,
    Operation,
    Put,
    Routine,
    Turn,
    arrays_of,
    op,
    routine,
)
from mcgee.codegen.statements import pieces, turns_first, unused
from mcgee.graph.program import Array, evaluate, live
from robots import random_tree

ARITHMETIC = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "cos": lambda a: float(np.cos(a)),
    "sin": lambda a: float(np.sin(a)),
}


def run(of: Routine, *arrays: np.ndarray) -> list[np.ndarray]:
    """What a routine's statements say, one after the other, as languages would run them."""
    held = {a.name: list(map(float, x)) for a, x in zip(of.inputs, arrays, strict=True)}
    held |= {a.name: [math.nan] * a.size for a in of.outputs}
    held[WORK] = [math.nan] * of.work

    def value(x: Expression, names: dict[str, float]) -> float:
        if isinstance(x, Number):
            return x.value
        if isinstance(x, Local):
            return names[x.name]
        if isinstance(x, Item):
            return held[x.array][x.index]
        return ARITHMETIC[x.op](*(value(a, names) for a in x.args))

    for part in of.parts:
        names: dict[str, float] = {}
        for step in part:
            if isinstance(step, Turn):
                angle = value(step.angle, names)
                if step.cosine:
                    names[step.cosine] = float(np.cos(angle))
                if step.sine:
                    names[step.sine] = float(np.sin(angle))
            elif isinstance(step, Let):
                assert step.name not in names
                names[step.name] = value(step.value, names)
            else:
                held[step.place.array][step.place.index] = value(step.value, names)
    return [np.reshape(held[a.name], a.shape) for a in of.outputs]


QUANTITIES = ["terms", "forward_dynamics", "regressor", "inverse_dynamics_derivatives", "jacobian"]


@pytest.mark.parametrize("longest", [500, 7, 1])
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_statements_give_the_graphs_bits(quantity, longest, rng):
    robot = random_tree(6, bodies=5, mimic=0.3)
    frame = (robot.end_frame,) if quantity == "jacobian" else ()
    program = build.trace(robot.mechanism, quantity, *frame)
    arithmetic = [node for node in live(program, {}) if node.op != "input"]
    made = routine(program, longest)
    assert len(made.parts) == math.ceil(len(arithmetic) / longest)
    for _ in range(3):
        arrays = [rng.normal(size=a.size) * 2 for a in program.inputs]
        for got, want in zip(run(made, *arrays), evaluate(program, *arrays), strict=True):
            assert np.array_equal(got, want)


@pytest.mark.parametrize("longest", [50, 500])
def test_parts_are_short(longest):
    program = build.trace(random_tree(3, bodies=9).mechanism, "forward_dynamics_derivatives")
    for part in routine(program, longest).parts:
        count = 0
        for step in part:
            if isinstance(step, Turn):
                count += (step.cosine is not None) + (step.sine is not None)
            elif not (isinstance(step, Put) and isinstance(step.value, Local | Item | Number)):
                count += operations(step.value)
        assert count <= longest


def operations(x: Expression) -> int:
    return 1 + sum(map(operations, x.args)) if isinstance(x, Operation) else 0


def test_outputs_that_are_constants_or_inputs():
    cart = random_tree(1, bodies=1, prismatic=1, fixed=0)
    made = routine(build.trace(cart.mechanism, "mass_matrix"))
    ((step,),) = made.parts
    assert isinstance(step, Put)
    assert isinstance(step.value, Number)
    assert [a.name for a in unused(made)] == ["q"]


def test_pieces_say_what_they_use():
    program = build.trace(random_tree(2, bodies=6).mechanism, "terms")
    made = routine(program, 40)
    for piece in pieces(made):
        used = arrays_of(piece.part)
        assert {a.name for a in (*piece.inputs, *piece.outputs)} == used - {WORK}
        assert piece.work == (WORK in used)


def test_turns_come_first():
    program = build.trace(random_tree(2, bodies=6, prismatic=0).mechanism, "gravity")
    turns, rest = turns_first(routine(program).parts[0])
    assert len(turns) >= 2
    assert not any(isinstance(step, Turn) for step in rest)


def test_renamed_arrays():
    program = build.trace(random_tree(2, bodies=3).mechanism, "coriolis")
    made = routine(program).renamed({"qd": "qdot", "Cqd": "Cqdot"})
    assert [a.name for a in (*made.inputs, *made.outputs)] == ["q", "qdot", "Cqdot"]
    assert set().union(*map(arrays_of, made.parts)) <= {"q", "qdot", "Cqdot"}


# -- text -----------------------------------------------------------------------------------------

PYTHON = Syntax(lambda item: f"{item.array}[{item.index}]")


def random_expression(rng: np.random.Generator, depth: int) -> Expression:
    if depth == 0 or rng.random() < 0.1:
        kind = rng.integers(3)
        if kind == 0:
            return Number(float(rng.choice([-2.5, 0.1, 1e-17, 3.0, -1.0, 1e22])))
        return Item("x", int(rng.integers(4))) if kind == 1 else Local(f"t{rng.integers(3)}")
    name = str(rng.choice(["add", "sub", "mul", "div", "neg", "add", "sub", "mul", "cos"]))
    count = 1 if name in ("neg", "cos", "sin") else 2
    return op(name, *(random_expression(rng, depth - 1) for _ in range(count)))


@pytest.mark.parametrize("seed", range(200))
def test_text_means_the_tree(seed):
    """Read back by Python, whose arithmetic has the precedences of all the languages."""
    rng = np.random.default_rng(seed)
    tree = random_expression(rng, 5)
    x, names = [0.3, -1.7, 2.9, 1e-3], {"t0": 0.7, "t1": -1.1, "t2": 5.0}

    def value(e: Expression) -> float:
        if isinstance(e, Number):
            return e.value
        if isinstance(e, Local):
            return names[e.name]
        if isinstance(e, Item):
            return x[e.index]
        return ARITHMETIC[e.op](*map(value, e.args))

    functions = {"cos": ARITHMETIC["cos"], "sin": ARITHMETIC["sin"]}
    written = text(tree, PYTHON)
    wrapped = lines(f"({written})", "    ", PYTHON, width=20)
    assert " ".join(wrapped.split()) == f"({written})"
    for source in (written, wrapped.strip()):
        try:
            want = value(tree)
        except ZeroDivisionError:
            return
        assert eval(source, {**names, "x": x, **functions}) == want


@pytest.mark.parametrize("x", [0.1, 1.0, -0.0, 1e-5, 1e22, 5e-324, 1.7976931348623157e308, 2 / 3])
def test_numbers_read_back(x):
    written = decimal(x)
    assert float(written) == x
    assert "." in written or "e" in written


@pytest.mark.parametrize("x", [math.inf, math.nan])
def test_what_is_no_number_is_refused(x):
    with pytest.raises(ValueError, match="which no generated code can hold"):
        decimal(x)


def test_long_statements_are_broken_before_operators():
    total: Expression = Item("x", 0)
    for k in range(1, 40):
        total = op("add", total, Item("x", k))
    broken = lines(f"y = {text(total, PYTHON)}", "  ", Syntax(PYTHON.item, continued=" ..."), 60)
    first, *others = broken.splitlines()
    assert first.startswith("  y = x[0] + x[1]")
    assert all(line.endswith(" ...") for line in [first, *others[:-1]])
    assert all(line.startswith("      + ") for line in others)
    assert max(map(len, broken.splitlines())) <= 64


def test_arrays_by_name():
    made = Routine("r", (Array("q", (2,)),), (Array("T", ()),), ((),), work=3)
    assert made.array("q").shape == (2,)
    assert made.array(WORK).size == 3
