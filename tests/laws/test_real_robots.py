"""Every law on compiled kernels: the bundled arms, and robots as their makers describe them."""

import numpy as np
import pytest

from mcgee import arms
from mcgee.audit.laws import LAWS, check
from robots import built_in, interpreted, loaded, random_state, random_tree

SIZES = {"random": 3.0, "near zero": 1e-8, "large": 1e4}
"""Of the positions [rad | m]."""

RIGHT_ANGLES = np.pi / 2 * np.arange(-2, 3)
"""Stretched, folded, upright: where much of M, C and g vanishes."""


def states(robot, rng):
    """Rows of every size, of poses at right angles without acceleration, and one at rest."""
    rows = [random_state(robot, rng, 3, size) for size in SIZES.values()]
    _, qd, qdd = random_state(robot, rng, 4)
    rows.append((rng.choice(RIGHT_ANGLES, qd.shape), qd, 0 * qdd))
    rows.append(tuple(np.zeros((3, 1, robot.n))))
    return tuple(np.concatenate(columns) for columns in zip(*rows, strict=True))


def assert_lawful(robot, rng):
    verdicts = check(robot, *states(robot, rng))
    broken = {v.law.name: (v.residual, v.worst) for v in verdicts if not v.holds}
    assert not broken, repr(robot)
    assert len(verdicts) == len(LAWS)


@pytest.mark.parametrize("name", sorted(arms.BUILTIN))
def test_built_in_arms(name, rng):
    assert_lawful(built_in(name), rng)


@pytest.mark.parametrize("name", sorted(arms.BUILTIN))
def test_where_every_term_vanishes(name, rng):
    """Weightless, at right angles, unaccelerated: rounding alone is left, and breaks no law."""
    arm = interpreted(built_in(name).replace(gravity_vector=(0, 0, 0)))
    q = rng.choice(RIGHT_ANGLES, (40, arm.n))
    qd = rng.choice([-1.0, -0.7, 0.0, 1.0], q.shape)
    assert not [v.law.name for v in check(arm, q, qd, 0 * q) if not v.holds]


@pytest.mark.parametrize("name", ["ur5", "panda", "talos"])
def test_urdfs(name, rng):
    assert_lawful(loaded(name), rng)


@pytest.mark.parametrize("seed", range(2))
def test_random_trees_with_followers(seed, rng):
    assert_lawful(random_tree(seed, bodies=6, mimic=0.4), rng)
