"""Five old formulations as oracles of inverse dynamics, and what they cost."""

from __future__ import annotations

import itertools
from fractions import Fraction

import mpmath
import numpy as np
import pytest

import mcgee
from mcgee import quantities
from mcgee.algorithms.classic import FORMULATIONS, PUBLISHED, Chain, counted
from mcgee.scalar import Turn
from robots import random_tree

CHAINS = {"bodies": 5, "branching": 0.0, "prismatic": 0.0, "armature": 0.0, "fixed": 0.0}


def chain(seed: int, **details):
    return random_tree(seed, **{**CHAINS, **details}).mechanism


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", FORMULATIONS)
def test_they_agree_with_our_recursion(name, seed):
    m = chain(seed)
    q, qd, qdd = np.random.default_rng(seed).normal(size=(3, m.n)).tolist()
    got = np.array(FORMULATIONS[name](Chain.at(m, q), qd, qdd))
    want = np.array(quantities.inverse_dynamics(m, q, qd, qdd))
    assert np.abs(got - want).max() <= 1e-12 * np.abs(want).max()


@pytest.mark.parametrize("name", FORMULATIONS)
def test_on_textbook_arms(name):
    for arm in (mcgee.arms.planar_2r(), mcgee.load("ur5e")):
        m = arm.mechanism
        q, qd, qdd = np.random.default_rng(0).normal(size=(3, m.n))
        got = np.array(FORMULATIONS[name](Chain.at(m, q), qd, qdd), float)
        want = arm.inverse_dynamics(q, qd, qdd)
        assert np.abs(got - want).max() <= 1e-12 * np.abs(want).max()


@pytest.mark.parametrize("name", FORMULATIONS)
def test_exactly(name):
    """On fractions, with angles as points of the unit circle: the same numbers, not nearly."""
    m = chain(1, bodies=3, exact=True).map(Fraction)
    q = [Turn(Fraction(3, 5), Fraction(4, 5)), Turn(Fraction(-5, 13), Fraction(12, 13))]
    q.append(Turn(Fraction(8, 17), Fraction(-15, 17)))
    qd, qdd = [Fraction(k, 7) for k in (1, -2, 3)], [Fraction(k, 3) for k in (2, 5, -1)]
    assert FORMULATIONS[name](Chain.at(m, q), qd, qdd) == quantities.inverse_dynamics(m, q, qd, qdd)


@pytest.mark.parametrize("name", FORMULATIONS)
def test_at_fifty_digits(name):
    with mpmath.workdps(50):
        m = chain(2, bodies=4, exact=True).map(mpmath.mpf)  # rotations exactly orthogonal
        q, qd, qdd = ([mpmath.mpf(k + j) / 7 for k in range(4)] for j in range(3))
        got = FORMULATIONS[name](Chain.at(m, q), qd, qdd)
        want = quantities.inverse_dynamics(m, q, qd, qdd)
        assert max(abs(g - w) for g, w in zip(got, want, strict=True)) < mpmath.mpf(10) ** -46


def test_counts_are_near_the_published_ones():
    """Within a quarter, but for Uicker & Kahn's, who computed derivatives again and again."""
    m = chain(4, bodies=6)
    for name, both in PUBLISHED.items():
        for ours, theirs in zip(counted(name, m), both, strict=True):
            assert ours < theirs
            assert ours > 0.75 * theirs or name == "Uicker & Kahn"


def test_orders_of_growth():
    """By differences of counts: n⁴, n², n, n, n."""
    orders = dict(zip(FORMULATIONS, (4, 2, 1, 1, 1), strict=True))
    for name, order in orders.items():
        series = [counted(name, chain(3, bodies=n))[0] for n in range(2, 9)]
        for _ in range(order):
            series = [b - a for a, b in itertools.pairwise(series)]
        assert len(set(series)) == 1, name
        assert series[0] > 0


def test_ours_takes_a_fraction_of_them_all():
    m = chain(4, bodies=6)
    ours = mcgee.build.trace(m, "inverse_dynamics").arithmetic()
    assert all(ours < sum(counted(name, m)) for name in FORMULATIONS)


@pytest.mark.parametrize("details", [{"prismatic": 1.0}, {"branching": 1.0}, {"mimic": 1.0}])
def test_what_they_are_not_for_is_refused(details):
    m = chain(5, **details)
    with pytest.raises(ValueError, match="chains of revolute joints"):
        Chain.at(m, [0.0] * len(m.bodies))


@pytest.mark.parametrize("name", FORMULATIONS)
def test_rotors_are_the_callers(name):
    arm = mcgee.load("puma560")
    m = arm.mechanism
    q, qd, qdd = np.random.default_rng(0).normal(size=(3, m.n))
    links = np.array(FORMULATIONS[name](Chain.at(m, q), qd, qdd), float)
    rotors = np.array([body.armature for body in m.bodies]) * qdd
    want = arm.inverse_dynamics(q, qd, qdd)
    assert np.abs(rotors).max() > 0.1
    assert np.abs(links + rotors - want).max() <= 1e-12 * np.abs(want).max()
