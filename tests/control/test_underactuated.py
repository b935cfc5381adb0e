"""Regulators about equilibria, swing-ups that end in them, and shaped energies."""

import math

import numpy as np
import pytest
from steering import HOME, derivative, falls_as_told, panda

import mcgee
from mcgee.control import (
    LQR,
    CartPoleIDAPBC,
    EnergySwingUp,
    InertiaWheelIDAPBC,
    swing_up,
    upright_since,
)
from mcgee.simulate import simulate
from robots import apart

UP = [math.pi / 2, 0.0]
ARMS = {
    "acrobot": mcgee.arms.acrobot(),
    "pendubot": mcgee.arms.pendubot(),
    "cart_pole": mcgee.arms.cart_pole(),
    "wheel": mcgee.arms.inertia_wheel_pendulum(),
}
UPRIGHT = {"acrobot": UP, "pendubot": UP, "cart_pole": [0.0, 0.0], "wheel": [0.0, 0.0]}


# -- LQR ------------------------------------------------------------------------------------------


def test_the_cart_poles_regulator_solves_its_riccati_equation():
    law = LQR(ARMS["cart_pole"], [0, 0], Q=[1, 2, 3, 4], R=0.5)
    A, B, P = law.A, law.B, law.P
    residual = A.T @ P + P @ A - P @ B @ B.T @ P / 0.5 + np.diag([1, 2, 3, 4])
    assert abs(residual).max() < 1e-9
    assert (np.linalg.eigvals(A - B @ law.K).real < 0).all()
    # Florian's equations about the upright pole, uniform and half a metre to its centre
    total, lever = 1.1, 0.5 * (4 / 3 - 0.1 / 1.1)
    assert A[3, 1] == pytest.approx(9.8 / lever)
    assert B[3, 0] == pytest.approx(-1 / (total * lever))


@pytest.mark.parametrize("name", ARMS)
def test_regulators_balance(name):
    arm, q0 = ARMS[name], np.array(UPRIGHT[name])
    law = LQR(arm, q0)
    inside = 0.5 * np.sqrt(law.level / law.P[0, 0])
    found = simulate(arm, q0 + np.array([inside, 0]), [0, 0], 10.0, law, step=0.005)
    assert falls_as_told(found, 1e-4)
    assert abs(found.log["error"][-1]).max() < 0.02 * inside
    passive = arm.limits.effort == 0
    assert not found.tau[:, passive].any()


def test_the_panda_is_held_by_its_gravity():
    law = LQR(panda(), HOME, Q=[1000.0] * 7 + [10.0] * 7, R=0.01)
    found = simulate(panda(), HOME + 0.1, np.zeros(7), 3.0, law, rtol=1e-7)
    assert abs(found.q[-1] - HOME).max() < 1e-4
    assert found.tau[-1] == pytest.approx(panda().gravity(HOME), abs=0.01)


def test_within_the_level_V_falls_from_everywhere(rng):
    law = LQR(ARMS["pendubot"], UP, Q=[100, 100, 1, 1], R=0.1)
    x = rng.normal(size=(500, 4))
    x *= np.sqrt(0.98 * law.level / np.einsum("ki,ij,kj->k", x, law.P, x))[:, None]
    q, qd = law.q + x[:, :2], x[:, 2:]
    assert law.inside(q, qd).all()
    assert (law.log(0.0, q, qd, qd[:, :0])["Vdot"] < 0).all()
    assert not law.inside(law.q + 1.2 * x[:, :2], 1.2 * x[:, 2:]).any()


def test_levels_of_arms_whose_joints_do_not_turn(rng):
    """Far below V of a radian, and found from above all the same."""
    law = LQR(panda(), HOME)
    assert 0.01 < law.level < 1.0
    x = rng.normal(size=(20_000, 14))
    x *= np.sqrt(0.999 * law.level / np.einsum("ki,ij,kj->k", x, law.P, x))[:, None]
    assert (law.log(0.0, law.q + x[:, :7], x[:, 7:], x[:, :0])["Vdot"] < 0).all()


@pytest.mark.parametrize("name", ["acrobot", "pendubot", "cart_pole"])
def test_levels_hold_in_many_more_directions_than_they_were_found_in(name, rng):
    law = swing_up(ARMS[name]).catch
    x = rng.normal(size=(200_000, 4))
    x *= np.sqrt(0.995 * law.level / np.einsum("ki,ij,kj->k", x, law.P, x))[:, None]
    assert (law.log(0.0, law.q + x[:, :2], x[:, 2:], x[:, :0])["Vdot"] < 0).all()


def test_angles_count_to_the_nearest_turn():
    law = LQR(ARMS["cart_pole"], [0, 0])
    near = law.value(np.array([0.1, 0.2]), np.zeros(2))
    assert law.value(np.array([0.1, 0.2 - 4 * np.pi]), np.zeros(2)) == pytest.approx(near)
    assert law.value(np.array([0.1 + 2 * np.pi, 0.2]), np.zeros(2)) > 2 * near  # a cart does not
    stops = LQR(panda(), HOME)
    assert not stops.turning.any()


# -- swing-ups ------------------------------------------------------------------------------------

WITHIN = {"acrobot": 40.0, "pendubot": 15.0, "cart_pole": 12.0}
"""Seconds; of 200 random starts all were up before."""


@pytest.mark.parametrize("name", WITHIN)
def test_ten_of_ten_random_starts_end_upright(name):
    arm, rng = ARMS[name], np.random.default_rng(7)
    q, qd = rng.uniform(-np.pi, np.pi, (10, 2)), rng.uniform(-1, 1, (10, 2))
    law = swing_up(arm)
    found = simulate(arm, q, qd, WITHIN[name], law, method="rk4", dt=4e-3, step=0.04)
    since = upright_since(law, found)
    assert np.isfinite(since).sum() == 10
    assert since.max() < WITHIN[name]
    caught = found.log["caught"]
    assert (np.diff(caught, axis=1) >= 0).all()  # once caught, never lost
    assert not found.tau[..., arm.limits.effort == 0].any()


def test_an_acrobot_hanging_at_rest_starts_and_friction_is_made_up_for():
    arm = mcgee.arms.acrobot().replace(viscous={"joint1": 0.05, "joint2": 0.05})
    law = swing_up(arm, "acrobot", extra=0.6)
    q = [[-np.pi / 2, 0.0], [-1.0, 0.5], [0.3, -1.0]]
    found = simulate(arm, q, [0, 0], 25.0, law, method="rk4", dt=4e-3, step=0.04, friction=True)
    assert np.isfinite(upright_since(law, found)).all()


def test_upright_since_knows_who_was_not_caught():
    arm = ARMS["cart_pole"]
    law = swing_up(arm)
    found = simulate(arm, [[0, 0.01], [0, 3.0]], [0, 0], 0.5, law, method="rk4", step=0.1)
    since = upright_since(law, found)
    assert since[0] == 0.0
    assert np.isnan(since[1])
    assert upright_since(law, simulate(arm, [0, 0.01], [0, 0], 0.1, law)).shape == ()


@pytest.mark.parametrize("name", WITHIN)
def test_above_its_energy_an_arm_loses_it_as_told(name):
    """V = ½ E² + ½ kv (qd_aᵀ qd_a + x_aᵀ kp x_a) falls by kv qd_aᵀ kd qd_a."""
    arm = ARMS[name]
    law = swing_up(arm)
    rate, end = {"acrobot": (4, 0.4), "pendubot": (10, 0.1), "cart_pole": (12, 0.4)}[name]
    passive = int(np.flatnonzero(arm.limits.effort == 0)[0])
    qd = np.zeros(2)
    qd[passive] = rate
    found = simulate(arm, np.add(UPRIGHT[name], [0.2, 0.1]), qd, end, law, step=end / 400)
    E, v = found.log["excess"], found.qd[:, 1 - passive]
    assert (E > 0).all()
    assert not found.log["caught"].any()
    assert falls_as_told(found, 1e-4)
    assert found.log["Vdot"] == pytest.approx(-law.kv * law.kd[0] * v**2, abs=1e-8)
    power = (found.qd * found.tau).sum(1)
    assert derivative(found.t, E) == pytest.approx(power[2:-2], abs=1e-4 * abs(power).max())


def test_swing_ups_hand_over_when_sampled():
    arm = ARMS["cart_pole"]
    law = swing_up(arm, period=0.01)
    found = simulate(arm, [0.0, 2.5], [0, 0], 12.0, law, method="rk4", dt=0.005)
    assert np.isfinite(upright_since(law, found))


def test_gains_may_be_changed():
    law = swing_up(ARMS["pendubot"], kp=12.0)
    assert law.kp == 12.0
    assert isinstance(law, EnergySwingUp)
    assert swing_up(mcgee.arms.acrobot(m1=1.1), "acrobot").push < 0


# -- shaped energies ------------------------------------------------------------------------------


def test_the_wheel_swings_its_pendulum_up_and_balances_it():
    """From beside hanging at rest, with one smooth law."""
    arm = ARMS["wheel"]
    law = InertiaWheelIDAPBC(arm)
    start = [np.pi - 0.01, 0.0]
    assert falls_as_told(simulate(arm, start, [0, 0], 2.0, law, step=2e-3))
    found = simulate(arm, start, [0, 0], 25.0, law, rtol=1e-8)
    assert (np.diff(found.log["V"]) <= 1e-9).all()
    assert abs(found.log["error"][-1]).max() < 1e-4
    assert abs(found.qd[-1]).max() < 1e-4
    assert abs(found.tau).max() < 60
    assert not found.tau[:, 0].any()


@pytest.mark.parametrize("seed", range(4))
def test_the_wheel_ends_upright_from_random_starts(seed):
    arm, rng = ARMS["wheel"], np.random.default_rng(seed)
    q, qd = rng.uniform(-3, 3, 2), rng.uniform(-5, 5, 2)
    found = simulate(arm, q, qd, 25.0, InertiaWheelIDAPBC(arm), rtol=1e-7)
    assert abs(found.log["error"][-1]).max() < 1e-2
    assert (np.diff(found.log["V"]) <= 1e-8 * found.log["V"][0]).all()


@pytest.mark.parametrize("lean", [0.3, 1.2, -1.5])
def test_the_cart_balances_its_pole_from_above_the_horizontal(lean):
    arm = ARMS["cart_pole"]
    law = CartPoleIDAPBC(arm)
    assert falls_as_told(simulate(arm, [0.5, lean], [0, 0], 1.0, law, step=5e-4))
    found = simulate(arm, [0.5, lean], [0, 0], 12.0, law, rtol=1e-8)
    assert abs(found.q[:, 1]).max() < np.pi / 2
    assert abs(found.log["error"][-1]).max() < 1e-3
    assert (np.diff(found.log["V"]) <= 1e-9).all()
    assert not found.tau[:, 1].any()


def test_the_wheels_energy_matches_its_arm(rng):
    """G⊥ (∂V − M_d M⁻¹ ∂V_d) = 0 in the paper's coordinates, and M_d > 0."""
    law = InertiaWheelIDAPBC(ARMS["wheel"])
    (a1, a2, a3), I1, I2, m3 = law.a, law.I1, law.I2, law.m3
    assert a1 * a3 > a2 * a2
    M = np.diag([I1, I2])
    turned = np.array([[1.0, 0.0], [1.0, 1.0]])  # x = turned q
    assert apart(turned.T @ M @ turned, ARMS["wheel"].mass_matrix([0, 0])) < 1e-14
    x, h = rng.normal(size=2), 1e-6

    def V_d(x):
        q = np.linalg.solve(turned, x)
        return law.energy(q, 0 * q).Hd

    slope = np.array([V_d(x + h * e) - V_d(x - h * e) for e in np.eye(2)]) / (2 * h)
    Md = np.array([[a1, a2], [a2, a3]])
    off = np.array([1.0, 1.0]) @ (
        np.array([-m3 * np.sin(x[0]), 0.0]) - Md @ np.linalg.solve(M, slope)
    )
    assert abs(off) < 1e-6


def test_where_the_pole_lies_there_is_no_energy():
    with pytest.raises(ValueError, match=r"joint 'pole' starts at 2 rad, below the horizontal"):
        simulate(ARMS["cart_pole"], [0, 2.0], [0, 0], 1.0, CartPoleIDAPBC(ARMS["cart_pole"]))
