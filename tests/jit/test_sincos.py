"""Cosine and sine of compiled kernels against mpmath, and against the C library far out."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from programs import compiled_for, program, same_bits, targets

from mcgee.trigonometry import PIO2, REACH

QUADRANTS = 63_661  # floor(REACH / (pi / 2))
BITS = 200
ULP = 1.0
"""A unit in the last place; the polynomials and the reduction promise less than one."""


def kernel(target):
    return compiled_for(target, program(lambda x: x[0].cos_sin(), (1,)))


def caller(name: str):
    function = kernel(targets()[name])

    def call(x):
        x = np.asarray(x, float)
        return np.moveaxis(function(x[..., None]), -1, 0)

    call.name = name
    return call


@pytest.fixture(scope="module", params=targets())
def cos_sin(request):
    return caller(request.param)


@pytest.fixture(scope="module", params=["host", "2 lanes"])
def accurate(request):
    """With multiply-add where the host has it, and without; the number of lanes changes no bit."""
    return caller(request.param)


def samples() -> np.ndarray:
    rng = np.random.default_rng(7)
    near_right_angles = np.arange(1, 4001) * (math.pi / 2) * (1 + rng.normal(size=4000) * 1e-9)
    return np.concatenate(
        [
            rng.uniform(-math.pi, math.pi, 6000),
            rng.uniform(-100, 100, 3000),
            rng.uniform(-REACH, REACH, 5000),
            near_right_angles,
            (np.arange(2000) * 31 + 0.5) * (math.pi / 2),  # where the quadrant is a close call
            np.geomspace(1e-320, 1, 1500) * np.where(rng.random(1500) < 0.5, 1, -1),
            [0.0, -0.0, 5e-324, -5e-324, 2.2250738585072014e-308, 1e-8, 2**-26, 2**-27],
            [REACH, -REACH, np.nextafter(REACH, 0), -np.nextafter(REACH, 0)],
        ]
    )


def in_ulp(got: float, exact: mpmath.mpf) -> float:
    return float(abs(mpmath.mpf(got) - exact) / math.ulp(float(exact)))


@pytest.fixture(scope="module")
def exact():
    with mpmath.workprec(BITS):
        return [mpmath.cos_sin(mpmath.mpf(x)) for x in samples()]


@pytest.fixture(scope="module")
def remainders():
    """The double closest to k pi/2 for each k in the fast range, and by how much it misses."""
    with mpmath.workprec(BITS):
        half = mpmath.pi / 2
        x = [float(k * half) for k in range(1, QUADRANTS + 1)]
        return np.array(x), [mpmath.mpf(v) - k * half for k, v in enumerate(x, 1)]


def test_the_reduction_constants_are_pi_over_two():
    with mpmath.workprec(BITS):
        assert abs(sum(map(mpmath.mpf, PIO2)) - mpmath.pi / 2) < mpmath.mpf(2) ** -129
    for part in PIO2[:2]:  # 36 bits, so that 17 more multiply exactly
        assert math.ldexp(math.frexp(part)[0], 36).is_integer()
    assert REACH / (math.pi / 2) < 2**16
    assert int(REACH / (math.pi / 2)) == QUADRANTS


def test_within_one_ulp_of_mpmath(accurate, exact):
    x = samples()
    got = accurate(x)
    errors = [
        [in_ulp(value, want) for value, want in zip(row, wanted, strict=True)]
        for row, wanted in zip(got.T.tolist(), exact, strict=True)
    ]
    worst_cos, worst_sin = np.max(errors, axis=0)
    at = x[np.argmax(errors, axis=0)]
    print(
        f"\n{accurate.name}: cos {worst_cos:.4f} ulp at {at[0]!r}, sin {worst_sin:.4f} at {at[1]!r}"
    )
    assert worst_cos <= ULP
    assert worst_sin <= ULP


def test_within_one_ulp_where_cancellation_is_worst(accurate, remainders):
    """At the double next to k pi/2 one of the two is the remainder r itself, the other is ±1."""
    x, r = remainders
    c, s = accurate(x)
    k = np.arange(1, QUADRANTS + 1)
    small, large = np.where(k % 2, c, s), np.where(k % 2, s, c)
    small = small * np.select([k % 4 == 0, k % 4 == 1, k % 4 == 2], [1, -1, -1], 1)
    assert np.array_equal(large, np.where((k % 4) < 2, 1.0, -1.0))
    with mpmath.workprec(BITS):
        errors = [in_ulp(a, b - b**3 / 6) for a, b in zip(small.tolist(), r, strict=True)]
    print(f"\n{accurate.name}: next to k pi/2 {max(errors):.4f} ulp at k = {np.argmax(errors) + 1}")
    assert max(errors) <= ULP
    assert same_bits(accurate(-x), np.stack([c, -s]))


def test_beyond_reach_it_is_the_c_library(cos_sin):
    rng = np.random.default_rng(3)
    beyond = np.nextafter(REACH, np.inf)
    x = np.concatenate(
        [10.0 ** rng.uniform(5.01, 308, 500) * rng.choice([-1, 1], 500), [beyond, -beyond, 1e308]]
    )
    c, s = cos_sin(x)
    assert c.tolist() == [math.cos(v) for v in x]
    assert s.tolist() == [math.sin(v) for v in x]


def test_zeros_keep_their_sign(cos_sin):
    c, s = cos_sin([0.0, -0.0])
    assert same_bits(c, [1.0, 1.0])
    assert same_bits(s, [0.0, -0.0])


def test_symmetry_and_unit_length(cos_sin):
    x = samples()
    (c, s), (c_minus, s_minus) = cos_sin(x), cos_sin(-x)
    assert same_bits(c, c_minus)
    assert same_bits(s, -s_minus)
    assert np.abs(c * c + s * s - 1).max() < 1e-15
    assert max(np.abs(c).max(), np.abs(s).max()) <= 1


def test_infinity_gives_nan(cos_sin):
    with np.errstate(invalid="ignore"):
        assert np.isnan(cos_sin([np.inf, -np.inf])).all()


def test_nan_gives_nan_without_a_warning(cos_sin):
    for rows in range(1, 12):
        x = np.full(rows, 0.5)
        x[-1] = np.nan
        assert np.isnan(cos_sin(x)[:, -1]).all()


def test_no_floating_point_error_is_raised_by_legal_angles(cos_sin):
    with np.errstate(all="raise", under="ignore"):
        for x in (1e6, 1e155, 1e300, -1.7976931348623157e308, 5e-324, REACH):
            cos_sin([x])
            cos_sin([x, 0.5] * 8)


def test_neighbours_do_not_matter(cos_sin):
    """Near, far, infinite and NaN lanes side by side, in every order of places."""
    rng = np.random.default_rng(11)
    x = np.concatenate([rng.uniform(-9, 9, 40), 10.0 ** rng.uniform(5, 300, 20), [np.inf, np.nan]])
    with np.errstate(invalid="ignore"):
        alone = np.stack([cos_sin([v])[:, 0] for v in x], axis=-1)
        for _ in range(50):
            order = rng.permutation(len(x))
            assert np.array_equal(cos_sin(x[order]), alone[:, order], equal_nan=True)


def test_the_number_of_lanes_changes_no_bit():
    x = samples()[:, None]
    for fma in (True, False):
        results = [kernel(t)(x) for t in targets().values() if t.fma is fma]
        assert all(same_bits(results[0], other) for other in results[1:])
