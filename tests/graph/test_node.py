"""Folding: each rule, and that no legal program can break them."""

from __future__ import annotations

import math
import sys
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from legality import violations

from mcgee.graph.node import Graph, Node
from mcgee.graph.program import Array, Program, evaluate

EPS = sys.float_info.epsilon


@pytest.fixture
def graph():
    return Graph()


@pytest.fixture
def xyz(graph):
    return graph.inputs("x", 3)


def is_node(value, op: str, *args) -> bool:
    """Whether the value is op on exactly these arguments."""
    return isinstance(value, Node) and value.op == op and value.args == args


# -- zeros and ones -------------------------------------------------------------------------------


@pytest.mark.parametrize("zero", [0, 0.0, -0.0, np.float64(0), False, Fraction(0)])
def test_zero_adds_nothing_and_swallows_products(xyz, zero):
    x = xyz[0]
    assert x + zero is x
    assert zero + x is x
    assert x - zero is x
    assert is_node(zero - x, "neg", x)
    for product in (x * zero, zero * x, (zero / (x + 1))):
        assert product == 0.0
        assert type(product) is float


@pytest.mark.parametrize("one", [1, 1.0, np.float64(1), True, Fraction(1)])
def test_one_and_minus_one_need_no_multiplication(xyz, one):
    x = xyz[0]
    assert x * one is x
    assert one * x is x
    assert x / one is x
    for minus in (x * -one, -one * x, x / -one) if one is not True else ():
        assert is_node(minus, "neg", x)


def test_constants_stay_numbers(graph, xyz):
    assert graph.add(2, 3) == 5.0
    assert graph.mul(2, 3) == 6.0
    assert graph.div(3, 2) == 1.5
    assert graph.div(1, 3) == 1 / 3
    assert graph.neg(2.5) == -2.5
    assert graph.nodes == xyz


# -- negation moves outward -----------------------------------------------------------------------


def test_a_double_negation_is_gone(xyz):
    minus = -xyz[0]
    assert -minus is xyz[0]


def test_products_of_negations(xyz):
    x, y, _ = xyz
    assert (-x) * (-y) is x * y
    assert is_node(-x * y, "neg", x * y)
    assert is_node(x * -y, "neg", x * y)
    assert -x * 3 is -(x * 3)
    assert x * -3 is -(x * 3)
    assert -x * -3 is x * 3


def test_quotients_of_negations(xyz):
    x, y, _ = xyz
    assert -x / -y is x / y
    assert is_node(-x / y, "neg", x / y)
    assert is_node(x / -y, "neg", x / y)
    assert is_node(x / -3, "neg", x / 3)
    assert -x / 3 is -(x / 3)
    assert -x / -3 is x / 3
    assert is_node(-3 / x, "neg", 3 / x)
    assert -3 / -x is 3 / x


def test_sums_of_negations(xyz):
    x, y, _ = xyz
    assert is_node(-x - y, "neg", x + y)
    assert is_node(x + -y, "sub", x, y)
    assert -y + x is x - y
    assert x - -y is x + y


def test_cosine_and_sine_of_a_negation(graph, xyz):
    x = xyz[0]
    cos, sin = x.cos_sin()
    cos_of_minus, sin_of_minus = (-x).cos_sin()
    assert cos_of_minus is cos
    assert is_node(sin_of_minus, "neg", sin)
    assert is_node(cos, "cos", x)
    assert is_node(sin, "sin", x)


# -- constants merge ------------------------------------------------------------------------------


def test_constants_of_a_sum_merge(xyz):
    x = xyz[0]
    assert is_node((x + 1) + 2, "add", 3.0, x)
    assert is_node(2 + (1 + x), "add", 3.0, x)
    assert is_node((x - 1) + 3, "add", 2.0, x)
    assert (x + 1) - 1 is x
    assert is_node((1 - x) + 2, "sub", 3.0, x)
    assert is_node(2 - (x + 1), "sub", 1.0, x)
    assert is_node((x + 1) - 3, "add", -2.0, x)
    assert 1 - (1 - x) is x
    assert is_node(1 - (x + 1), "neg", x)
    assert is_node((1 - x) - 1, "neg", x)


def test_constants_of_a_product_merge(xyz):
    x = xyz[0]
    assert is_node(2 * (x * 3), "mul", 6.0, x)
    assert (x * 2) * 0.5 is x
    assert is_node((x * 2) * -0.5, "neg", x)
    assert is_node((x * 3) / 4, "mul", 0.75, x)
    assert (x * 1e-200) * 1e-200 == 0.0


def test_only_exact_divisions_become_products(xyz):
    x = xyz[0]
    assert is_node(x / 4, "mul", 0.25, x)
    assert is_node(x / -8, "neg", x * 0.125)
    assert is_node(x / 3, "div", x, 3.0)
    assert is_node(x / 0.1, "div", x, 0.1)
    assert is_node(x / 2.0**1022, "mul", 2.0**-1022, x)
    # the reciprocal of the smallest denormal is no float
    assert is_node(x / 5e-324, "div", x, 5e-324)
    assert is_node(3 / x, "div", 3.0, x)


def test_division_by_a_constant_zero(xyz):
    assert is_node(xyz[0] / 0, "div", xyz[0], 0.0)
    with pytest.raises(ZeroDivisionError):
        xyz[0].graph.div(1, 0)


# -- value numbering ------------------------------------------------------------------------------


def test_equal_expressions_are_one_node(xyz):
    x, y, z = xyz
    assert x + y is y + x
    assert x * y is y * x
    assert x + 2 is 2.0 + x
    assert (x + y) * z is z * (y + x)
    assert x - y is x - y
    assert x / y is x / y
    assert x / y is not y / x
    assert x.cos_sin() == x.cos_sin()
    assert len(set(x.graph.nodes)) == len(x.graph.nodes)


def test_a_difference_and_its_opposite_share_one_node(xyz):
    x, y, z = xyz
    d = x - y
    assert is_node(d, "sub", x, y)
    assert is_node(y - x, "neg", d)
    assert is_node(-d, "neg", d)
    assert -(y - x) is d
    assert (y - x) * z is -(d * z)
    assert (y - x) * (y - x) is d * d
    assert z + (y - x) is z - d
    assert [node.op for node in x.graph.nodes].count("sub") == 2


def test_sums_of_equals(xyz):
    x = xyz[0]
    assert is_node(x + x, "mul", 2.0, x)
    assert x - x == 0.0
    assert is_node(-x - x, "neg", x * 2)
    assert x + -x == 0.0


def test_sums_keep_their_order(xyz):
    x, y, z = xyz
    assert is_node((x + y) + z, "add", z, x + y)
    assert (x + y) + z is not x + (y + z)
    assert (x * y) * z is not x * (y * z)


def test_inputs_are_known_by_name_and_place(graph):
    a, b = graph.inputs("a", 2), graph.inputs("b", 1)
    assert a == graph.inputs("a", 2)
    assert len({*a, *b}) == 3
    assert a[0] != b[0]


def test_numpy_scalars_leave_the_arithmetic_to_nodes(xyz):
    x = xyz[0]
    assert np.float64(2) * x is x * 2
    assert np.float64(2) + x is x + 2
    assert is_node(np.float64(2) - x, "sub", 2.0, x)
    assert is_node(np.float32(3) / x, "div", 3.0, x)
    assert np.int64(1) * x is x


def test_repr_reads_as_an_assignment(xyz):
    x, y, _ = xyz
    assert repr(x) == "%0 = input('x', 0)"
    assert repr(x * 2 + y) == "%4 = add(%1, %3)"
    assert repr(x * 2) == "%3 = mul(2.0, %0)"


# -- random programs ------------------------------------------------------------------------------

CONSTANTS = [0.0, -0.0, 1.0, -1.0, 2.0, -2.0, 0.5, 4.0, 3.0, -3.0, 0.1, -7.25, 1 / 3, 1, -1, 2]

leaves = st.one_of(
    st.integers(0, 2).map(lambda i: ("x", i)), st.sampled_from(CONSTANTS).map(lambda k: ("k", k))
)
expressions = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.tuples(st.sampled_from(["+", "-", "*", "/"]), inner, inner),
        st.tuples(st.sampled_from(["neg", "cos", "sin"]), inner),
    ),
    max_leaves=25,
)
programs = st.lists(expressions, min_size=1, max_size=5)


def run(expression, x, cosine, sine):
    """The expression on any scalars; None where it divides by a constant zero."""
    op, *rest = expression
    if op == "x":
        return x[rest[0]]
    if op == "k":
        return rest[0]
    args = [run(part, x, cosine, sine) for part in rest]
    if op in ("neg", "cos", "sin"):
        return {"neg": lambda a: -a, "cos": cosine, "sin": sine}[op](args[0])
    a, b = args
    if op == "/":
        return a / b
    return a + b if op == "+" else a - b if op == "-" else a * b


def traced(program_text) -> Program:
    graph = Graph()
    x = graph.inputs("x", 3)

    def cosine(a):
        return graph.cos(a) if isinstance(a, Node) else math.cos(a)

    def sine(a):
        return graph.sin(a) if isinstance(a, Node) else math.sin(a)

    roots = tuple(run(e, x, cosine, sine) for e in program_text)
    return Program("p", (Array("x", (3,)),), (Array("y", (len(roots),)),), roots)


class Bounded:
    """A float with a bound of its rounding error, whichever way constants are merged."""

    def __init__(self, value, error=0.0):
        self.value, self.error = float(value), error

    @staticmethod
    def of(x):
        return x if isinstance(x, Bounded) else Bounded(x)

    def __add__(self, other):
        other = Bounded.of(other)
        a, b = self.value, other.value
        return Bounded(a + b, self.error + other.error + EPS * (abs(a) + abs(b)))

    __radd__ = __add__

    def __neg__(self):
        return Bounded(-self.value, self.error)

    def __sub__(self, other):
        return self + -Bounded.of(other)

    def __rsub__(self, other):
        return Bounded.of(other) - self

    def __mul__(self, other):
        other = Bounded.of(other)
        a, b = self.value, other.value
        error = abs(a) * other.error + abs(b) * self.error + self.error * other.error
        return Bounded(a * b, error + EPS * abs(a * b) + 1e-300)

    __rmul__ = __mul__

    def __truediv__(self, other):
        other = Bounded.of(other)
        assume(abs(other.value) > 2 * other.error)
        low = abs(other.value) - other.error
        error = (self.error + abs(self.value / other.value) * other.error) / low
        return Bounded(self.value / other.value, error + EPS * abs(self.value / low) + 1e-300)

    def __rtruediv__(self, other):
        return Bounded.of(other) / self

    def cos(self):
        return Bounded(math.cos(self.value), self.error + EPS)

    def sin(self):
        return Bounded(math.sin(self.value), self.error + EPS)


numbers = st.floats(-4, 4, allow_nan=False).filter(lambda v: v == 0 or abs(v) > 1e-3)


@settings(max_examples=200, deadline=None)
@given(programs, st.lists(numbers, min_size=3, max_size=3))
def test_a_traced_program_computes_what_its_text_says(text, x):
    try:
        wanted = [
            Bounded.of(run(e, [Bounded(v) for v in x], lambda a: Bounded.of(a).cos(),
                           lambda a: Bounded.of(a).sin()))
            for e in text
        ]  # fmt: skip
        program = traced(text)
    except (ZeroDivisionError, OverflowError):
        assume(False)
    assume(all(math.isfinite(w.value) and math.isfinite(w.error) for w in wanted))
    with np.errstate(all="ignore"):
        (got,) = evaluate(program, x)
    for value, want in zip(got, wanted, strict=True):
        assert abs(value - want.value) <= 4 * want.error


@settings(max_examples=200, deadline=None)
@given(programs)
def test_every_traced_program_is_legal(text):
    try:
        program = traced(text)
    except ZeroDivisionError:
        assume(False)
    assert violations(program.nodes) == []
    for graph in {node.graph for node in program.nodes}:  # and what no output needs
        assert violations(graph.nodes) == []


@settings(max_examples=100, deadline=None)
@given(programs)
def test_tracing_is_deterministic(text):
    try:
        first, second = traced(text), traced(text)
    except ZeroDivisionError:
        assume(False)
    assert [repr(n) for n in first.nodes] == [repr(n) for n in second.nodes]
    assert [repr(r) for r in first.roots] == [repr(r) for r in second.roots]
