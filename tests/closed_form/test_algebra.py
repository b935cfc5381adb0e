"""The ring's normal form, the angles that generate others, exact constants."""

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from mcgee.closed_form.angles import Basis, form, plus, scaled
from mcgee.closed_form.reading import Needs, Reader, _recognised, _value, nearest_rotation
from mcgee.closed_form.ring import Polynomial, Ring, rational
from mcgee.model import Pose

a, b, x, y = sympy.symbols("a b x y")
A, B = form([(a, 1)]), form([(b, 1)])
RING = Ring(Basis([A, B]), [x, y], [y], [2, 3])
GENERATORS = [RING.generator(i) for i in range(RING.context.nvars())]


def value(p: Polynomial, at):
    """In floats."""
    total = 0.0
    for exponents, k in p.terms():
        total += float(k) * math.prod(v**e for v, e in zip(at, exponents, strict=True))
    return total


AT = [
    *(math.sin(0.7), math.cos(0.7), math.sin(-1.1), math.cos(-1.1)),
    *(0.3, 1.7, 1 / 1.7, 2**0.5, 3**0.5),
]
words = st.lists(st.tuples(st.integers(0, 8), st.integers(-3, 3)), min_size=1, max_size=5)
sums = st.lists(words, min_size=1, max_size=4)


def built(sum_of_products):
    total, number = RING(0), 0.0
    for word in sum_of_products:
        product, size = RING(1), 1.0
        for i, k in word:
            product, size = product * (GENERATORS[i] + k), size * (AT[i] + k)
        total, number = total + product, number + size
    return total, number


@given(sums, sums)
def test_products_are_reduced_and_right(one, other):
    (p, u), (q, v) = built(one), built(other)
    product = p * q
    assert value(product, AT) == pytest.approx(u * v, rel=1e-9, abs=1e-6)
    for exponents, _ in product.terms():
        assert max((*exponents[:4:2], *exponents[7:])) <= 1  # no s², no √2²
        assert not (exponents[5] and exponents[6])  # no y · 1/y
    assert product == q * p
    assert (p - q) * (p + q) == p * p - q * q


def test_equal_is_equal_however_it_was_written():
    s, c = GENERATORS[:2]
    y_, inverse, two = GENERATORS[5], GENERATORS[6], GENERATORS[7]
    assert s * s + c * c == 1
    assert (s + c) ** 2 == 2 * s * c + 1
    assert y_ * inverse == 1
    assert two * two == 2
    assert RING.turn(plus(A, B)).c == c * GENERATORS[3] - s * GENERATORS[2]
    assert not RING(0)
    assert len(s * c + 1) == 2


def test_derivatives():
    s, c = GENERATORS[:2]
    assert s.derivative(a) == c
    assert c.derivative(a) == -s
    assert (s * c * GENERATORS[4]).derivative(a) == (2 * c * c - 1) * GENERATORS[4]
    assert (GENERATORS[4] ** 3).derivative(x) == 3 * GENERATORS[4] ** 2
    half = Ring(Basis([scaled(A, Fraction(1, 2))]))
    turn = half.turn(A)
    assert turn.c.derivative(a) == -turn.s


def test_numbers_are_the_decimals_that_were_written():
    assert rational(0.1) == Fraction(1, 10)
    assert rational(1e-7) == Fraction(1, 10**7)
    assert RING(0.25) * 4 == 1
    assert 1 - RING(0.25) == Fraction(3, 4)
    assert RING(3) / 2 == 1.5


def test_a_basis_has_few_angles():
    both = Basis([A, plus(A, B), B, scaled(A, 2), plus(A, B, -1)])
    assert both.forms == [A, plus(A, B)]
    assert both.multiples(plus(A, B, -1)) == [(0, 2), (1, -1)]
    halves = Basis([A, scaled(A, Fraction(3, 2))])
    assert halves.forms == [scaled(A, Fraction(1, 2))]
    assert halves.multiples(A) == [(0, 2)]
    assert halves.multiples(scaled(A, Fraction(-3, 2))) == [(0, -3)]


def test_a_strange_gear_is_an_angle_of_its_own():
    odd = scaled(A, Fraction("0.123456789"))
    assert Basis([A, odd]).forms == [A, odd]
    assert Basis([A, odd]).multiples(scaled(odd, -1)) == [(1, -1)]
    with pytest.raises(ValueError, match="is not among those of the ring"):
        Basis([A]).multiples(B)


@pytest.mark.parametrize("k", range(24))
def test_multiples_of_fifteen_degrees(k):
    for f in (math.cos, math.sin):
        found = _recognised(f(k * math.pi / 12))
        assert _value(found) == pytest.approx(f(k * math.pi / 12), abs=2e-15)


def test_other_numbers_are_not_recognised(rng):
    assert not any(_recognised(v) for v in rng.uniform(-1, 1, 2000))
    assert _recognised(0.7071067811) is None


@pytest.mark.parametrize("seed", range(5))
def test_the_nearest_rotation_is_a_rotation(seed):
    rpy = np.random.default_rng(seed).uniform(-3, 3, 3)
    R = Pose.from_rpy(rpy).rotation
    found = nearest_rotation(R)
    for i in range(3):
        for j in range(3):
            assert sum(found[i][k] * found[j][k] for k in range(3)) == int(i == j)
    assert np.allclose(np.array(found, float), R, rtol=0, atol=4e-16)
    assert np.linalg.det(np.array(found, float)) > 0


def read(expression):
    def refuse(part):
        raise ValueError(f"refused {part}")

    needs, constants = Needs(), {}
    Reader(needs, constants, refuse).number(expression)
    ring = needs.ring()
    return ring(Reader(ring, constants, refuse).number(expression)), constants


@pytest.mark.parametrize(
    "expression",
    [
        "x*(y + 1)**2/y",
        "cos(a + b)*sin(2*a - b) + sin(a/2)",
        "sqrt(12)*x + 8**(1/2) + x/sqrt(6)**3",
        "cos(a + pi/12) - sin(pi/8 + b)",
        "0.1*x + 1/3",
    ],
)
def test_expressions_are_read_exactly(expression):
    e = sympy.sympify(expression, rational=False)
    found, constants = read(e)
    numbers = {a: 0.7, b: -1.1, x: 0.3, y: 1.7, **constants}
    from mcgee.closed_form.evaluate import evaluate, values_of

    got = evaluate(found, values_of(found.ring, numbers))
    assert got == pytest.approx(float(e.subs(numbers)), rel=1e-13)


@pytest.mark.parametrize("expression", ["x/(y + 1)", "sqrt(x)", "tan(a)", "cos(a*b)", "x**a"])
def test_what_is_no_trigonometric_polynomial_is_refused(expression):
    with pytest.raises(ValueError, match="refused"):
        read(sympy.sympify(expression))


def test_two_symbols_of_one_name():
    with pytest.raises(ValueError, match="two symbols are called 'x' and differ in their assumpt"):
        read(x + sympy.Symbol("x", positive=True))
