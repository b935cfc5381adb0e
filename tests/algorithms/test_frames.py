"""Slid frames: the same arm, fewer lengths."""

from __future__ import annotations

import numpy as np
import pytest

import mcgee
from mcgee import quantities
from mcgee.algorithms.frames import canonical
from mcgee.mechanism import GROUND, Mechanism
from robots import loaded, random_tree


def lengths(m: Mechanism) -> list[tuple[float, ...]]:
    return [b.pose.translation for b in m.bodies if b.parent != GROUND]


def zeros(m: Mechanism) -> int:
    return sum(x == 0 for offset in lengths(m) for x in offset)


@pytest.mark.parametrize("seed", range(30))
def test_nothing_a_user_sees_changes(seed):
    robot = random_tree(seed, bodies=7, aligned=0.8, mimic=0.2 * (seed % 3))
    m = robot.mechanism
    slid = canonical(m)
    q, qd, qdd = np.random.default_rng(seed).normal(size=(3, m.n)).tolist()
    for name, arguments in {
        "mass_matrix": (q,),
        "inverse_dynamics": (q, qd, qdd),
        "coriolis_matrix": (q, qd),
        "potential_energy": (q,),
        "kinetic_energy": (q, qd),
        "forward_kinematics": (q, "tool"),
        "jacobian": (q, "camera"),
        "link_jacobians": (q,),
    }.items():
        function = getattr(quantities, name)
        mine, own = (np.array(function(x, *arguments), float) for x in (slid, m))
        assert np.abs(mine - own).max() <= 1e-13 * max(np.abs(own).max(), 1.0), name


@pytest.mark.parametrize("seed", range(30))
def test_never_more_lengths(seed):
    m = random_tree(seed, bodies=8, aligned=0.9).mechanism
    assert zeros(canonical(m)) >= zeros(m)


def test_parallel_axes_lose_their_displacement_and_crossing_axes_meet():
    """Of the UR5's joints 2, 3 and 4 are parallel, 1 and 2 meet; d4, d5 and d6 are left."""
    slid = canonical(loaded("ur5").mechanism)
    sizes = [tuple(round(abs(x), 5) for x in offset) for offset in lengths(slid)]
    assert sizes == [
        (0, 0, 0),
        (0, 0.425, 0),
        (0, 0.39225, 0),
        (0, 0, 0.10915),
        (0, 0, 0.09465),
    ]


def test_origins_stay_within_the_arms_own_size():
    """Nearly parallel axes cross far away: no origin goes there."""
    for seed in range(20):
        m = random_tree(seed, bodies=8, aligned=0.0).mechanism
        size = max(abs(x) for offset in lengths(m) for x in offset)
        own = [np.array(b.pose.translation) for b in m.bodies]
        moved = [np.array(b.pose.translation) for b in canonical(m).bodies]
        assert max(np.abs(a - b).max() for a, b in zip(own, moved, strict=True)) <= 2 * size


def test_prismatic_joints_stay():
    m = mcgee.load("cart_pole").mechanism
    assert lengths(canonical(m)) == lengths(m)
