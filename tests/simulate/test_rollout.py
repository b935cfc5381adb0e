"""Compiled rollouts: the same steps as NumPy's, whatever the company."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

import mcgee
from mcgee.simulate import rollout, simulate
from robots import built_in, random_tree


def by_numpy(arm, q, qd, tau, dt, substeps=1, viscous=0.0):
    """tau (steps, ..., n)."""
    h, found = np.asarray(dt, float)[..., None], []

    def f(x, v, u):
        return arm.forward_dynamics(x, v, u - viscous * v)

    for u in tau:
        for _ in range(substeps):
            a1 = f(q, qd, u)
            v2 = qd + h / 2 * a1
            a2 = f(q + h / 2 * qd, v2, u)
            v3 = qd + h / 2 * a2
            a3 = f(q + h / 2 * v2, v3, u)
            v4 = qd + h * a3
            a4 = f(q + h * v3, v4, u)
            q, qd = q + h / 6 * (qd + 2 * (v2 + v3) + v4), qd + h / 6 * (a1 + 2 * (a2 + a3) + a4)
        found.append((q, qd))
    return tuple(np.stack(x, axis=-2) for x in zip(*found, strict=True))


@pytest.mark.parametrize("rows", [1, 3, 8, 21])
@pytest.mark.parametrize("name", ["planar_2r", "scara", "puma560", "panda"])
def test_steps_are_runge_kuttas(name, rows, rng):
    arm = built_in(name)
    q, qd = rng.normal(size=(2, rows, arm.n))
    tau = rng.normal(size=(rows, 5, arm.n))
    got = rollout(arm, q, qd, tau, dt=2e-3, substeps=3)
    want = by_numpy(arm, q, qd, np.moveaxis(tau, 1, 0), 2e-3, 3)
    for a, b in zip(got, want, strict=True):
        assert a.shape == (rows, 5, arm.n)
        assert abs(a - b).max() <= 1e-11 * max(1, abs(b).max())


def test_trees_with_followers_and_sliding_joints(rng):
    arm = random_tree(3, bodies=6, prismatic=0.4, mimic=0.3)
    q, qd = rng.normal(size=(2, 4, arm.n))
    got = rollout(arm, q, qd, steps=10, dt=1e-3)
    want = by_numpy(arm, q, qd, np.zeros((10, 4, arm.n)), 1e-3)
    assert abs(got.q - want[0]).max() <= 1e-10 * abs(want[0]).max()


def test_it_is_what_simulate_does(rng):
    arm = built_in("puma560")
    q, qd = rng.uniform(-0.5, 0.5, (2, 6))
    got = rollout(arm, q, qd, steps=50, dt=1e-3, substeps=2)
    want = simulate(arm, q, qd, 0.1, method="rk4", dt=1e-3, step=2e-3)
    assert got.q.shape == (50, 6)
    assert abs(got.q - want.q[1:]).max() < 1e-12
    assert abs(got.qd - want.qd[1:]).max() < 1e-11


def test_viscous_friction(rng):
    arm = built_in("puma560")
    q, qd = rng.normal(size=(2, 3, 6))
    b = np.array([joint.viscous for joint in arm.independent_joints])
    got = rollout(arm, q, qd, steps=4, dt=1e-3, viscous=True)
    want = by_numpy(arm, q, qd, np.zeros((4, 3, 6)), 1e-3, viscous=b)
    assert abs(got.qd - want[1]).max() < 1e-10
    assert abs(got.qd - rollout(arm, q, qd, steps=4, dt=1e-3).qd).max() > 1e-3


def test_bits_do_not_depend_on_the_company(rng):
    arm = built_in("panda")
    q, qd = rng.normal(size=(2, 37, 7))
    tau = rng.normal(size=(37, 6, 7))
    whole = rollout(arm, q, qd, tau)
    for k in (0, 5, 36):
        alone = rollout(arm, q[k], qd[k], tau[k])
        assert np.array_equal(whole.q[k], alone.q)
    turned = rollout(arm, q.T.copy().T, qd[::-1][::-1], tau.transpose(2, 1, 0).copy().T)
    assert np.array_equal(whole.q, turned.q)
    assert np.array_equal(whole.qd, turned.qd)


def test_threads_change_nothing(rng):
    arm = built_in("panda")
    q, qd = rng.normal(size=(2, 3000, 7))
    try:
        mcgee.set_num_threads(1)
        one = rollout(arm, q, qd, steps=20, dt=1e-3)
        mcgee.set_num_threads(3)
        three = rollout(arm, q, qd, steps=20, dt=1e-3)
    finally:
        mcgee.set_num_threads(None)
    assert np.array_equal(one.q, three.q)
    assert np.array_equal(one.qd, three.qd)


def test_nan_is_that_rows_alone(rng):
    arm = built_in("puma560")
    q, qd = rng.normal(size=(2, 9, 6))
    want = rollout(arm, q, qd, steps=3)
    bad = q.copy()
    bad[4, 2] = np.nan
    got = rollout(arm, bad, qd, steps=3)
    assert np.isnan(got.q[4]).any(-1).all()
    rest = np.arange(9) != 4
    assert np.array_equal(got.q[rest], want.q[rest])


def test_leading_dimensions_broadcast(rng):
    arm = built_in("planar_2r")
    q, qd, tau = rng.normal(size=(4, 1, 2)), rng.normal(size=(3, 2)), rng.normal(size=(5, 2))
    dt = np.array([1e-3, 2e-3, 4e-3])
    got = rollout(arm, q, qd, tau, dt=dt)
    assert got.q.shape == (4, 3, 5, 2)
    alone = rollout(arm, q[2, 0], qd[1], tau, dt=2e-3)
    assert np.array_equal(got.q[2, 1], alone.q)


REFUSED = [
    (([0], [0, 0]), {"steps": 1}, r"q0 has shape \(1,\)"),
    (([0, 0], [0, 0]), {}, "steps is None, expected a whole number from 1, or give tau"),
    (([0, 0], [0, 0]), {"steps": 0}, "steps is 0"),
    (([0, 0], [0, 0]), {"steps": 1.5}, "steps is 1.5"),
    (([0, 0], [0, 0], [1, 2]), {}, r"tau has shape \(2,\), expected \(..., steps, 2\)"),
    (([0, 0], [0, 0], np.zeros((3, 2))), {"steps": 4}, "steps is 4, and tau has rows for 3"),
    (([0, 0], [0, 0]), {"steps": 1, "dt": 0}, "dt is 0, expected more than 0 s"),
    (([0, 0], [0, 0]), {"steps": 1, "substeps": 0}, "substeps is 0"),
]


@pytest.mark.parametrize(("given", "more", "says"), REFUSED)
def test_refusals(given, more, says):
    with pytest.raises(ValueError, match=says):
        rollout(built_in("planar_2r"), *given, **more)


def test_symbols_and_singular_arms_are_refused():
    arm = mcgee.arms.planar_2r(m1=sympy.Symbol("m1"))
    with pytest.raises(ValueError, match="still has the symbols m1; rollouts need numbers"):
        rollout(arm, [0, 0], [0, 0], steps=1)
