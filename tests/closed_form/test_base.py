"""Base parameters: as many as the regressor's rank, and the efforts come from them alone."""

import numpy as np
import pytest
import sympy

import mcgee
from mcgee import arms
from robots import built_in, interpreted, loaded, random_state, random_tree

HALF = np.pi / 2


def rank(robot, rng):
    """Of the regressor in many random states."""
    states = random_state(robot, rng, rows=80)
    Y = interpreted(robot).regressor(*states).reshape(-1, 10 * len(robot.mechanism.bodies))
    size = abs(Y).max(axis=0)
    seen = size > 1e-12 * size.max()  # the others hold rounding alone
    values = np.linalg.svd(Y[:, seen] / size[seen], compute_uv=False)
    kept = values > 1e-11 * values[0]
    assert kept.all() or values[kept][-1] > 1e3 * values[~kept][0]  # the rank is clear
    return int(kept.sum())


def check(robot, rng):
    base = robot.closed_form().base_parameters()
    assert len(base) == rank(robot, rng)
    assert base.identity is None or base.identity.holds
    return base


@pytest.mark.parametrize(
    ("name", "count"),
    [
        *(("pendulum", 3), ("planar_2r", 6), ("planar_3r", 9), ("cart_pole", 4), ("scara", 8)),
        *(("stanford", 33), ("puma560", 36), ("ur5e", 36), ("panda", 43)),
    ],
)
def test_built_in_arms(name, count, rng):
    base = check(built_in(name), rng)
    assert len(base) == count
    assert base.identity.holds


@pytest.mark.parametrize("name", ["ur5", "kinova"])
def test_urdfs(name, rng):
    check(loaded(name), rng)


@pytest.mark.parametrize("seed", range(8))
def test_exact_trees(seed, rng):
    check(random_tree(seed, exact=True, bodies=5, mimic=0.2, branching=0.4, prismatic=0.4), rng)


@pytest.mark.parametrize("seed", range(3))
def test_trees_with_any_rotations(seed, rng):
    check(random_tree(seed, bodies=3), rng)


@pytest.mark.parametrize("field", [(0, 0, -9.81), (0, -9.81, 0), (0, 0, 0), (1, 2, 3)])
def test_gravity_along_axis_1_or_across(field, rng):
    check(built_in("puma560").replace(gravity_vector=field), rng)


@pytest.mark.parametrize("alpha", [0.0, np.pi / 6, np.pi / 4, HALF, 0.3])
def test_slides_between_turns(alpha, rng):
    body = {"m": 2.0, "r": (0.1, -0.2, 0.3), "I": (0.5, 0.6, 0.7)}
    rows = [{"a": 0.3, "alpha": alpha}, {"sigma": 1, "a": 0.2, "alpha": alpha}, {"a": 0.1}]
    base = check(mcgee.from_dh([row | body for row in rows]), rng)
    # tan(0.3) is no polynomial: nothing is claimed
    assert (base.identity is None) == (alpha == 0.3)


def test_the_planar_arm_by_hand():
    symbols = m1, m2, l1, lc1, lc2, I1, I2, _ = sympy.symbols("m1 m2 l1 lc1 lc2 I1 I2 g0")
    base = arms.planar_2r(*symbols).closed_form().base_parameters()
    assert {b.name: b.formula for b in base if b.formula} == {
        "hxR1": m1 * lc1 + m2 * l1,
        "IzzR1": I1 + m1 * lc1**2 + m2 * l1**2,
        "hxR2": m2 * lc2,
        "IzzR2": I2 + m2 * lc2**2,
    }
    assert [b.joint for b in base] == ["joint1"] * 3 + ["joint2"] * 3
    assert set(base.unseen) == {f"{x}{k}" for x in ("Ixx", "Ixy", "Ixz", "Iyz") for k in (1, 2)}
    assert "IzzR2 = I2 + lc2**2*m2" in str(base)


def test_relations_with_symbolic_geometry():
    """The slide is parallel to the turn before it: its first moments act as that body's."""
    a, b, alpha = sympy.symbols("a b alpha")
    rows = [{"a": a}, {"a": b}, {"sigma": 1, "alpha": alpha}, {}]
    form = mcgee.from_dh([row | {"m": 1} for row in rows]).closed_form(symbolic_inertias=True)
    base = form.base_parameters()
    formulas = {x.name: x.formula for x in base}
    m2, hx2, hx3 = sympy.symbols("m2 hx2 hx3")
    assert {m2, hx2, hx3} <= formulas["hxR2"].free_symbols
    assert base.identity.holds


def test_without_links():
    q, qd = sympy.symbols("q1 qd1")
    form = mcgee.lagrange(qd**2 / 2, sympy.sin(q), [q], [qd])
    with pytest.raises(ValueError, match="made from energies and has no links, so no inertial"):
        form.base_parameters()


def test_several_bodies_on_one_coordinate():
    """Whose parameters are felt through one row alone: it takes as many states as they are."""
    robot = random_tree(89, bodies=5, mimic=0.5, prismatic=0, exact=True, aligned=0.4)
    base = robot.closed_form().base_parameters()
    assert base.identity.holds
    assert len(base) == 25
