"""Angles: what a decimal text means, exact cosines of constants, and turns."""

from __future__ import annotations

import math
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from mcgee.scalar import ENOUGH_DIGITS, Turn, constant_cos_sin, cos_sin, read_angle

PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494")
MULTIPLES = [k for k in range(-48, 49) if k]


def written(k: int, digits: int, rounding: str) -> str:
    """k pi/12 in decimal, with so many significant digits."""
    exact = PI * k / 12
    unit = Decimal(1).scaleb(exact.adjusted() + 1 - digits)
    return str(exact.quantize(unit, rounding=rounding))


# -- reading angles -------------------------------------------------------------------------------


@pytest.mark.parametrize("k", MULTIPLES)
@pytest.mark.parametrize("rounding", [ROUND_HALF_EVEN, ROUND_DOWN])
def test_enough_digits_mean_the_exact_angle(k, rounding):
    """Rounded or cut to eight digits or more."""
    for digits in range(ENOUGH_DIGITS, 22):
        text = written(k, digits, rounding)
        assert read_angle(text) == (k * math.pi / 12, None), text


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ("1.5707963", math.pi / 2),
        ("1.57079632679", math.pi / 2),
        ("1.5707963267948966", math.pi / 2),
        ("-1.5707963", -math.pi / 2),
        ("+1.5707963", math.pi / 2),
        (" 1.5707963\n", math.pi / 2),
        ("3.1415926", math.pi),
        ("3.14159265358979", math.pi),
        ("-3.14159265359", -math.pi),
        ("0.78539816339", math.pi / 4),
        (".78539816339", math.pi / 4),
        ("00.78539816339", math.pi / 4),
        ("1.5707963e0", math.pi / 2),
        ("15.707963E-1", math.pi / 2),
        ("0.15707963e+1", math.pi / 2),
        ("157079632679e-11", math.pi / 2),
        ("4.7123889804", 3 * math.pi / 2),
        ("6.28318530718", 2 * math.pi),
        ("0.261799388", math.pi / 12),
    ],
)
def test_right_angles_as_files_write_them(text, angle):
    assert read_angle(text) == (angle, None)


@pytest.mark.parametrize("k", [1, 2, 3, 4, 6, 8, 9, 12, -6, -12, 24])
def test_few_digits_are_kept_with_a_remark(k):
    for digits in range(4, ENOUGH_DIGITS):
        text = written(k, digits, ROUND_HALF_EVEN)
        value, remark = read_angle(text)
        assert value == float(text)
        assert remark is not None
        assert remark.startswith(f"angle {text} is taken as written; ")
        assert f"needs at least {ENOUGH_DIGITS} digits" in remark


def test_the_remark():
    assert read_angle("1.57") == (
        1.57,
        "angle 1.57 is taken as written; pi/2 needs at least 8 digits (1.5707963268)",
    )
    assert read_angle("-1.5708") == (
        -1.5708,
        "angle -1.5708 is taken as written; -pi/2 needs at least 8 digits (-1.5707963268)",
    )
    for text, name in {
        "3.1416": "pi",
        "-3.14": "-pi",
        "2.356": "3pi/4",
        "0.2618": "pi/12",
        "1.309": "5pi/12",
        "6.283": "2pi",
        "4.189": "4pi/3",
    }.items():
        remark = read_angle(text)[1]
        assert f"; {name} needs" in remark


@pytest.mark.parametrize(
    "text",
    [
        *("0", "0.0", "-0.0", "+0", "0e0", "1e-300", "-1e-9", "0.001", "0.1", "1e-400"),
        *("1", "2", "3", "3.0", "0.26", "0.3", "0.8", "1.6", "-3", "1.0", "0.5", "0.25"),
        *("0.75", "0.79", "0.77", "1.55", "0.273", "1.5718"),
        *("1.570796400", "1.57079700", "1.5700000000000", "3.1415000000", "1.5710000"),
        *("1.5707963267900000", "3.0000000", "0.26000000"),
        *("1e3", "1e9", "-1e300", "1001.5", "1e400"),
    ],
)
def test_other_numbers_are_what_they_are(text):
    assert read_angle(text) == (float(text), None)
    assert math.copysign(1, read_angle(text)[0]) == math.copysign(1, float(text))


@pytest.mark.parametrize(
    "text",
    [
        *("25.0", "1.58", "3.15", "0.786", "100", "180", "12.5", "45.0"),
    ],
)
def test_no_remark_where_no_multiple_was_meant(text):
    """Degrees by mistake, and what is neither k pi/12 rounded to its digits nor cut."""
    assert read_angle(text) == (float(text), None)


@pytest.mark.parametrize("text", ["inf", "-inf", "nan", "infinity"])
def test_no_finite_number(text):
    value, remark = read_angle(text)
    assert np.array_equal(value, float(text), equal_nan=True)
    assert remark is None


@pytest.mark.parametrize("text", ["", " ", "pi", "1.57 rad", "1,57", "0x1p3", "1.5.7", "--1", "1e"])
def test_no_number(text):
    with pytest.raises(ValueError, match="could not convert string to float"):
        read_angle(text)


@given(st.floats(-1e3, 1e3), st.integers(1, 17))
def test_reading_never_moves_an_angle_by_more_than_its_last_digit(value, digits):
    text = f"{value:.{digits}g}"
    got, _ = read_angle(text)
    assert abs(got - float(text)) <= max(10.0 ** (1 - ENOUGH_DIGITS) * abs(value), 0)
    if got != float(text):
        assert len(text.replace(".", "").replace("-", "").lstrip("0")) >= ENOUGH_DIGITS


@given(st.floats(allow_nan=False))
def test_a_float_printed_in_full_is_read_back(value):
    """To its last bits: exact multiples stay, and everything else stays."""
    got, remark = read_angle(repr(value))
    assert remark is None or len(repr(value).strip("-0.").replace(".", "")) < ENOUGH_DIGITS
    assert got == pytest.approx(value, rel=4e-15, abs=0)


# -- cosines of constants -------------------------------------------------------------------------


@pytest.mark.parametrize("k", [*range(-60, 61), 1200, -2400, 3600])
def test_constants_are_exact_at_multiples_of_fifteen_degrees(k):
    """The float nearest to the cosine and sine of k pi/12, zeros, halves and ones exactly."""
    with mpmath.workprec(120):
        exact = mpmath.cos(k * mpmath.pi / 12), mpmath.sin(k * mpmath.pi / 12)
    for angle in (k * math.pi / 12, math.radians(15 * k)):
        for got, want in zip(constant_cos_sin(angle), exact, strict=True):
            assert got == pytest.approx(float(want), rel=2**-52, abs=1e-30)
            if k % 3 == 0 or abs(abs(want) - 0.5) < 1e-9:
                assert abs(got) in (0.0, 0.5, 1.0, math.sqrt(0.5), math.sqrt(0.75))
    c, s = constant_cos_sin(k * math.pi / 12)
    assert c * c + s * s == pytest.approx(1, abs=3e-16)
    quarter = constant_cos_sin((k + 6) * math.pi / 12)
    assert quarter == (-s, c)


def test_right_angles_leave_no_dust():
    assert constant_cos_sin(0.0) == (1.0, 0.0)
    assert constant_cos_sin(0) == (1.0, 0.0)
    assert constant_cos_sin(math.pi / 2) == (0.0, 1.0)
    assert constant_cos_sin(math.pi) == (-1.0, 0.0)
    assert constant_cos_sin(-math.pi / 2) == (0.0, -1.0)
    assert constant_cos_sin(math.pi / 3)[0] == 0.5
    assert constant_cos_sin(math.pi / 6)[1] == 0.5


@pytest.mark.parametrize(
    "angle", [1.0, 1.57, 1.5708, 1e-9, -1e-300, 3.0, 1e4, 1e300, math.pi / 2 + 1e-14]
)
def test_other_constants_are_the_librarys(angle):
    assert constant_cos_sin(angle) == (math.cos(angle), math.sin(angle))


def test_no_cosine_of_infinity():
    with pytest.raises(ValueError, match=r"math domain error|expected a finite input"):
        constant_cos_sin(math.inf)
    assert all(map(math.isnan, constant_cos_sin(math.nan)))


def test_constants_of_other_scalars():
    x = sympy.Symbol("x")
    assert constant_cos_sin(x) == (sympy.cos(x), sympy.sin(x))
    assert constant_cos_sin(Turn(Fraction(3, 5), Fraction(4, 5))) == (
        Fraction(3, 5),
        Fraction(4, 5),
    )


# -- any scalar -----------------------------------------------------------------------------------


def test_cosine_and_sine_by_the_scalars_own_library():
    array = np.array([0.5, 1.0])
    assert np.array_equal(cos_sin(array), [np.cos(array), np.sin(array)])
    assert cos_sin(2) == (math.cos(2), math.sin(2))
    assert cos_sin(np.float64(0.5)) == (math.cos(0.5), math.sin(0.5))
    assert cos_sin(np.float32(0.5)) == (np.cos(np.float32(0.5)), np.sin(np.float32(0.5)))
    assert cos_sin(mpmath.mpf(1)) == (mpmath.cos(1), mpmath.sin(1))
    assert cos_sin(sympy.pi / 3) == (sympy.Rational(1, 2), sympy.sqrt(3) / 2)


def rational_turns():
    """Points of the unit circle with rational coordinates."""

    def turn(t: Fraction) -> Turn:
        return Turn((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t))

    return st.fractions(-20, 20, max_denominator=50).map(turn)


NONE = Turn(Fraction(1), Fraction(0))


@given(rational_turns(), rational_turns(), rational_turns())
def test_turns_are_a_group(a, b, c):
    assert (a + b) + c == a + (b + c)
    assert a + b == b + a
    assert a + NONE == a
    assert a + -a == NONE
    assert -(a + b) == -a + -b
    x, y = (a + b).cos_sin()
    assert x * x + y * y == 1


@given(rational_turns(), st.integers(-7, 7), st.integers(-7, 7))
def test_multiples_of_turns(a, k, m):
    assert a * k + a * m == a * (k + m)
    assert (a * k) * m == a * (k * m)
    assert k * a == a * k
    assert a * 1 == a
    assert a * -1 == -a
    assert a * 0 == NONE
    assert a * 2.0 == a + a
    assert a * Fraction(-3) == -(a + a + a)


@given(st.floats(-3, 3), st.floats(-3, 3), st.integers(-5, 5))
def test_turns_are_angles(x, y, k):
    def turn(angle):
        return Turn(math.cos(angle), math.sin(angle))

    assert (turn(x) + turn(y)).cos_sin() == pytest.approx(turn(x + y).cos_sin(), abs=1e-14)
    assert (-turn(x)).cos_sin() == turn(-x).cos_sin()
    assert (turn(x) * k).cos_sin() == pytest.approx(turn(x * k).cos_sin(), abs=1e-13)


@pytest.mark.parametrize("times", [0.5, -1.5, Fraction(1, 3)])
def test_a_turn_has_no_fractions(times):
    message = f"a Turn can be repeated a whole number of times, not {times}"
    with pytest.raises(ValueError, match=message):
        NONE * times
    with pytest.raises(ValueError, match=message):
        times * NONE


@pytest.mark.parametrize(
    "text", ["1.5707963705062866", "-3.1415927410125732", "1.5707964", "1.57079637"]
)
def test_a_right_angle_in_float32_is_kept_with_a_remark(text):
    value, remark = read_angle(text)
    assert value == float(text)
    assert "is taken as written" in remark
