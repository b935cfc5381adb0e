"""PD with gravity, computed torque, passivity-based tracking: energies, exact errors, samples."""

import numpy as np
import pytest
from steering import HOME, falls_as_told, panda, waves

import mcgee
from mcgee.control import ComputedTorque, Constant, Controller, PDGravity, SlotineLi
from mcgee.simulate import simulate
from robots import random_tree

TREE = random_tree(5, bodies=5, prismatic=0.4, mimic=0.4)
ARMS = {
    "panda": panda(),
    "ur5e": mcgee.arms.ur5e(),
    "cart_pole": mcgee.arms.cart_pole(),
    "tree with followers": TREE,
}


def start(arm):
    q, qd = np.random.default_rng(1).uniform(-0.3, 0.3, (2, arm.n))
    return q + waves(arm).mean, qd


def stiffness(arm):
    """Of PD, for joints of very unlike inertias: (10 rad/s)² and 20 1/s."""
    inertia = np.diag(arm.mass_matrix(waves(arm).mean))
    return 100 * inertia, 20 * inertia


LAWS = {
    "PD": lambda arm: PDGravity(arm, waves(arm).mean, *stiffness(arm)),
    "computed torque": lambda arm: ComputedTorque(arm, waves(arm), 100.0, 20.0),
    "passivity": lambda arm: SlotineLi(arm, waves(arm), 10.0, stiffness(arm)[1]),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("arm", ARMS)
def test_V_falls_as_the_theory_says(law, arm):
    robot = ARMS[arm]
    found = simulate(robot, *start(robot), 0.15, LAWS[law](robot), step=1e-4)
    assert falls_as_told(found)
    assert found.log["V"][-1] < 0.7 * found.log["V"][0]


@pytest.mark.parametrize("arm", ["panda", "tree with followers"])
def test_errors_under_computed_torque_are_linear(arm):
    """Critically damped: e = (e0 + (ed0 + 10 e0) t) exp(−10 t)."""
    robot = ARMS[arm]
    found = simulate(robot, *start(robot), 1.0, ComputedTorque(robot, waves(robot), 100, 20))
    e, t = found.log["error"], found.t[:, None]
    e0, ed0 = e[0], found.log["error_rate"][0]
    assert abs(e - (e0 + (ed0 + 10 * e0) * t) * np.exp(-10 * t)).max() < 1e-8


def test_gains_of_each_joint():
    """kp = 25 … 400 and no damping: each error swings at its own √kp."""
    arm, kp = panda(), np.linspace(5, 20, 7) ** 2
    q0 = HOME + 0.1
    found = simulate(arm, q0, np.zeros(7), 1.0, ComputedTorque(arm, HOME, kp, 0.0))
    assert abs(found.log["error"] + 0.1 * np.cos(np.sqrt(kp) * found.t[:, None])).max() < 1e-7


@pytest.mark.parametrize("name", LAWS)
def test_the_arm_ends_where_it_shall(name):
    arm = panda()
    target = HOME + 0.2
    law = {
        "PD": PDGravity(arm, target, 200.0, [60, 60, 40, 40, 12, 12, 12]),
        "computed torque": ComputedTorque(arm, target, 100.0, 20.0),
        "passivity": SlotineLi(arm, Constant(target), 10.0, 20.0),
    }[name]
    found = simulate(arm, HOME, np.zeros(7), 6.0, law, rtol=1e-7)
    assert abs(found.q[-1] - target).max() < 1e-4
    assert abs(found.tau[-1] - arm.gravity(target)).max() < 1e-2


def test_the_passivity_based_law_is_its_equation(rng):
    arm, law = panda(), SlotineLi(panda(), waves(panda()), 3.0, 7.0)
    t, (q, qd) = 1.3, rng.normal(size=(2, 7))
    d = law.reference(t)
    e, ed = d.q - q, d.qd - qd
    s, v, a = ed + 3 * e, d.qd + 3 * e, d.qdd + 3 * ed
    M, g = arm.mass_matrix(q), arm.gravity(q)
    tau = M @ a + arm.coriolis_matrix(q, qd) @ v + g + 7 * s
    assert law.effort(t, q, qd, np.zeros(0)) == pytest.approx(tau, rel=1e-12)
    assert law.log(t, q, qd, np.zeros(0))["V"] == pytest.approx(s @ M @ s / 2)


@pytest.mark.parametrize("name", LAWS)
def test_a_batch_is_its_members(name, rng):
    law = LAWS[name](TREE)
    q, qd = rng.normal(size=(2, 2, 3, TREE.n))
    z = law.start(q, qd)
    tau, log = law.effort(0.7, q, qd, z), law.log(0.7, q, qd, z)
    for k in np.ndindex(2, 3):
        assert tau[k] == pytest.approx(law.effort(0.7, q[k], qd[k], z[k]), rel=1e-12)
        for key, value in law.log(0.7, q[k], qd[k], z[k]).items():
            assert log[key][k] == pytest.approx(value, rel=1e-12)


def test_a_batch_moves_together():
    arm, law = TREE, LAWS["computed torque"](TREE)
    q, qd = np.random.default_rng(2).uniform(-0.3, 0.3, (2, 3, arm.n))
    together = simulate(arm, q, qd, 0.3, law, method="rk4", step=0.1)
    alone = simulate(arm, q[1], qd[1], 0.3, law, method="rk4", step=0.1)
    assert together.q[1] == pytest.approx(alone.q, rel=1e-12)
    assert together.log["error"].shape == (3, 4, arm.n)


@pytest.mark.parametrize("law", [PDGravity, ComputedTorque, SlotineLi])
def test_samples_come_near_the_continuous_law(law):
    """The distance is proportional to the period."""
    arm = mcgee.arms.planar_2r()
    law_of = {
        PDGravity: lambda period: PDGravity(arm, [0.5, 0.3], 50, 10, period=period),
        ComputedTorque: lambda period: ComputedTorque(arm, waves(arm), 50, 10, period=period),
        SlotineLi: lambda period: SlotineLi(arm, waves(arm), 5, 10, period=period),
    }[law]
    exact = simulate(arm, [0.1, -0.4], [0, 0], 1.0, law_of(None), step=0.02).q
    far = [
        abs(simulate(arm, [0.1, -0.4], [0, 0], 1.0, law_of(h), step=0.02).q - exact).max()
        for h in (0.01, 0.005, 0.0025)
    ]
    assert far[0] < 0.05
    assert np.log2(far[0] / far[1]) == pytest.approx(1, abs=0.2)
    assert np.log2(far[1] / far[2]) == pytest.approx(1, abs=0.1)


def test_laws_are_controllers():
    for law in LAWS.values():
        assert isinstance(law(TREE), Controller)
        assert law(TREE).period is None
