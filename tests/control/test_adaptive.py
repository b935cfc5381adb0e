"""Laws that learn: the two-velocity regressor, energies, wrong masses, unknown friction."""

import numpy as np
import pytest
from steering import HOME, falls_as_told, heavier, light, panda, waves

import mcgee
from mcgee.control import (
    AdaptiveComputedTorque,
    AdaptiveSlotineLi,
    ComputedTorque,
    Fourier,
    PDGravity,
    SlotineLi,
    excitation_gains,
    parameter_scales,
)
from mcgee.control.regressor import Unknowns
from mcgee.simulate import Friction, simulate
from robots import random_tree

ROUNDING = 1e-12
KD = [20.0] * 4 + [5.0] * 3
TREE = random_tree(4, bodies=5, prismatic=0.3, armature=0.7, mimic=0.4)
TWO = mcgee.arms.planar_2r(plane="vertical")


def rubbing(arm):
    """With viscous and Coulomb friction, and p with it."""
    viscous, coulomb = 0.5 + 0.1 * np.arange(arm.n), 0.3 + 0.1 * np.arange(arm.n)
    named = {
        what: dict(zip(arm.joint_names, values, strict=True))
        for what, values in (("viscous", viscous), ("coulomb", coulomb))
    }
    return arm.replace(**named), np.concatenate([arm.inertial_parameters, viscous, coulomb])


# -- regressors -----------------------------------------------------------------------------------


@pytest.mark.parametrize("arm", [TREE, panda(), mcgee.arms.cart_pole()], ids=lambda arm: arm.name)
def test_two_velocities_give_the_reference_dynamics(arm, rng):
    """Y_r p + rotors qdd_r = M qdd_r + C(q, qd) qd_r + g + friction(qd), followers and armature
    among it."""
    unknowns = Unknowns(arm, friction=True, speed=0.05)
    p = rubbing(arm)[1]
    q, qd, v, a = rng.normal(size=(4, 3, arm.n))
    got = (unknowns.two_velocities(q, qd, v, a) @ p) + a @ unknowns.rotors
    viscous, coulomb = p[-2 * arm.n : -arm.n], p[-arm.n :]
    friction = viscous * qd + coulomb * np.tanh(qd / 0.05)
    rigid = (arm.mass_matrix(q) @ a[..., None])[..., 0] + arm.gravity(q)
    want = rigid + arm.coriolis_product(q, qd, v) + friction
    assert got == pytest.approx(want, abs=ROUNDING * abs(want).max())
    same = unknowns.regressor(q, qd, a) - unknowns.two_velocities(q, qd, qd, a)
    assert abs(same).max() < ROUNDING * 100


def test_rotors_are_what_armature_adds():
    bare = TREE.replace(armature={j.name: 0.0 for j in TREE.joints if j.moves})
    q = np.full(TREE.n, 0.3)
    want = TREE.mass_matrix(q) - bare.mass_matrix(q)
    assert Unknowns(TREE, False, 1.0).rotors == pytest.approx(want, abs=1e-12)
    assert want.any()


def test_parameters_have_names():
    names = Unknowns(TWO, True, 1.0).names
    assert names[:2] == ("m of link1", "m cx of link1")
    assert names[-4:] == (
        *("viscous of joint1", "viscous of joint2"),
        *("coulomb of joint1", "coulomb of joint2"),
    )
    assert len(parameter_scales(TWO)) == len(names) == len(parameter_scales(TWO, False)) + 4
    assert (parameter_scales(mcgee.arms.cart_pole()) > 0).all()


# -- energies -------------------------------------------------------------------------------------


def accelerometer(arm, friction=None):
    def acceleration(t, q, qd, tau):
        return arm.forward_dynamics(q, qd, tau)

    return acceleration


@pytest.mark.parametrize("name", ["panda", "tree"])
def test_V_of_passivity_falls_whatever_the_estimates(name):
    arm = {"panda": panda(), "tree": TREE}[name]
    rubbed, p = rubbing(arm)
    law = AdaptiveSlotineLi(
        heavier(arm, 0.8),
        waves(arm),
        8.0,
        10 * np.diag(arm.mass_matrix(waves(arm).mean)),
        3 * parameter_scales(arm) ** 2,
        friction_speed=0.1,
        true_parameters=p,
    )
    q = waves(arm).mean + 0.1
    friction = Friction(speed=0.1)
    found = simulate(rubbed, q, 0 * q, 0.1, law, friction=friction, step=1e-4)
    assert falls_as_told(found)
    estimates = found.log["estimates"]
    assert estimates[0, : len(arm.inertial_parameters)] == pytest.approx(
        0.8 * arm.inertial_parameters
    )
    assert not estimates[0, -2 * arm.n :].any()
    assert (estimates[-1] != estimates[0]).any()


@pytest.mark.parametrize("name", ["panda", "2R"])
def test_V_of_computed_torque_falls_with_measured_accelerations(name):
    arm = {"panda": panda(), "2R": TWO}[name]
    law = AdaptiveComputedTorque(
        heavier(arm, 0.8),
        waves(arm),
        100.0,
        20.0,
        parameter_scales(arm, False) ** 2,
        friction=False,
        acceleration=accelerometer(arm),
        true_parameters=arm.inertial_parameters,
        bounds=(-np.inf, np.inf),
    )
    q = waves(arm).mean + 0.05
    found = simulate(arm, q, 0 * q, 0.1, law, step=1e-4)
    assert falls_as_told(found)
    assert found.log["least_inertia"].min() > 0


def test_an_inertia_that_is_none_does_not_run_away():
    """Estimates that make M̂ singular move no faster than the floor of its eigenvalues allows."""
    motion = waves(TWO)
    law = AdaptiveComputedTorque(
        TWO, motion, 50, 14, 1.0, False, acceleration=accelerometer(TWO), bounds=(-np.inf, np.inf)
    )
    q, qd = motion.mean + 0.1, np.zeros(2)
    thin = 1e-9 * TWO.inertial_parameters
    M = TWO.with_parameters().mass_matrix(motion(0.0).q, TWO.inertial_parameters)
    floor = 0.01 * np.linalg.eigvalsh(M).min()
    d = motion(0.0)
    filtered = d.qd - qd + law.psi * (d.q - q)
    qdd = TWO.forward_dynamics(q, qd, law.effort(0.0, q, qd, thin))
    change = TWO.regressor(q, qd, qdd).T @ filtered / floor
    assert law.slope(0.0, q, qd, thin) == pytest.approx(change, rel=1e-6)


def test_a_bound_stops_an_estimate():
    """And the rest learns on: dV/dt is no more than the theory's."""
    p = TWO.inertial_parameters
    wrong = heavier(TWO, 0.8)
    first = wrong.inertial_parameters
    bounds = first - 0.3 * abs(first), first + 0.05 * abs(first)
    law = AdaptiveComputedTorque(
        wrong, waves(TWO), 50, 14, 1.0, False, bounds=bounds, acceleration=accelerometer(TWO)
    )
    found = simulate(TWO, [0.0, 0.0], [0, 0], 5.0, law, rtol=1e-7)
    estimates = found.log["estimates"]
    assert (estimates < bounds[1] + 1e-3).all()
    assert (estimates > bounds[0] - 1e-3).all()
    assert (abs(estimates[-1] - bounds[1]) < 1e-3).sum() > np.count_nonzero(first == 0) > 0
    assert p.shape == estimates[-1].shape


# -- wrong masses ---------------------------------------------------------------------------------


def residual(law, duration: float = 8.0) -> float:
    """The largest error of the last second, the controller's Panda being 20 % too light."""
    found = simulate(panda(), HOME, np.zeros(7), duration, law, rtol=1e-6, atol=1e-8)
    return abs(found.log["error"][found.t > duration - 1]).max()


def test_masses_wrong_by_a_fifth_leave_an_error_unless_they_are_learnt():
    arm, motion = light(), waves(panda())
    scales = parameter_scales(arm, False) ** 2
    left = {
        "PD": residual(PDGravity(arm, HOME, 300.0, 40.0), 3.0),
        "computed torque": residual(ComputedTorque(arm, motion, 100.0, 20.0)),
        "passivity": residual(SlotineLi(arm, motion, 10.0, KD)),
        "adaptive": residual(AdaptiveSlotineLi(arm, motion, 10.0, KD, 10 * scales, False)),
        "adaptive computed torque": residual(
            AdaptiveComputedTorque(arm, motion, 100.0, 20.0, scales, False)
        ),
    }
    assert left["PD"] > 0.005
    assert left["computed torque"] > 0.05
    assert left["passivity"] > 0.005
    assert left["adaptive"] < 5e-4
    assert left["adaptive computed torque"] < 2e-3


def test_a_constant_target_is_reached_in_spite_of_wrong_masses():
    law = AdaptiveSlotineLi(light(), HOME, 5.0, KD, 3 * parameter_scales(light()) ** 2)
    found = simulate(panda(), HOME + 0.1, np.zeros(7), 12.0, law, rtol=1e-6, atol=1e-8)
    assert abs(found.log["error"][-1]).max() < 1e-4


RICH = Fourier([0.3, 0.5], [[0.6, -0.4], [0.3, 0.5]], [[0.2, 0.4], [-0.3, 0.2]], 0.25, ramp=1.0)


def test_estimates_converge_where_the_motion_tells_them_apart(rng):
    """dp ends where no motion of this arm shows it: Y dp dies out in states never visited too."""
    p = TWO.inertial_parameters
    law = AdaptiveSlotineLi(heavier(TWO, 0.8), RICH, 5.0, 3.0, 1.0, False, true_parameters=p)
    found = simulate(TWO, RICH.mean, [0, 0], 20.0, law, rtol=1e-6)
    dp = found.log["estimates"] - p
    Y = TWO.regressor(*rng.normal(size=(3, 50, 2))).reshape(-1, len(p))
    assert np.linalg.norm(Y @ dp[-1]) < 0.05 * np.linalg.norm(Y @ dp[0])
    assert np.linalg.norm(dp[-1]) > 0.4 * np.linalg.norm(dp[0])
    prediction = abs(found.log["prediction"])
    assert prediction[-50:].max() < 0.01 * prediction[:50].max()
    assert abs(found.log["error"][-50:]).max() < 5e-4


@pytest.mark.parametrize(("friction", "left"), [(False, 5e-4), (True, 5e-3)])
def test_excitation_gains_learn_all_that_a_motion_shows(friction, left, rng):
    """And the error dies out with it."""
    arm, p = rubbing(TWO) if friction else (TWO, TWO.inertial_parameters)
    learnt = {"friction": friction, "friction_speed": 0.1}
    light, times = heavier(TWO, 0.8), np.linspace(1, 5, 200, endpoint=False)
    gains = excitation_gains(light, RICH, times, 20.0, 1.0, **learnt)
    law = AdaptiveSlotineLi(light, RICH, 5.0, 20.0, gains, **learnt, true_parameters=p)
    rubs = Friction(speed=0.1) if friction else None
    found = simulate(arm, RICH.mean, [0, 0], 20.0, law, friction=rubs, rtol=1e-8, atol=1e-11)
    assert (np.diff(found.log["V"]) < 1e-9 * found.log["V"][0]).all()
    early, late = (found.t > 1) & (found.t < 3), found.t > 18
    for name in ("error", "prediction"):
        size = abs(found.log[name])
        assert size[late].max() < left * size[early].max(), name
    seen = law.unknowns.regressor(*rng.normal(size=(3, 50, 2))).reshape(-1, len(p))
    dp = found.log["estimates"] - p
    assert np.linalg.norm(seen @ dp[-1]) < 4 * left * np.linalg.norm(seen @ dp[0])


def test_excitation_gains_are_what_they_say():
    gains = excitation_gains(TWO, RICH, np.linspace(1, 5, 50), 3.0, 0.5, False, least=1e-6)
    Y, scales = TWO.regressor(*RICH(np.linspace(1, 5, 50))), parameter_scales(TWO, False)
    mean = sum(y.T @ y for y in Y) / 50 / 3
    scaled = mean * scales * scales[:, None]
    rest = 1e-6 * np.linalg.eigvalsh(scaled)[-1] * np.diag(1 / scales**2)
    assert gains @ (mean + rest) == pytest.approx(0.5 * np.eye(len(mean)), abs=1e-6)
    law = AdaptiveSlotineLi(TWO, RICH, 5.0, 3.0, gains, False)
    diagonal = AdaptiveSlotineLi(TWO, RICH, 5.0, 3.0, np.diag(gains), False)
    assert law.gains == pytest.approx(gains)
    assert diagonal.gains == pytest.approx(np.diag(np.diag(gains)))


def test_friction_is_learnt_with_the_masses():
    rubbed, p = rubbing(TWO)
    law = AdaptiveSlotineLi(
        heavier(TWO, 0.8), RICH, 5.0, 10.0, 20.0, friction_speed=0.1, true_parameters=p
    )
    friction = Friction(speed=0.1)
    found = simulate(rubbed, RICH.mean, [0, 0], 20.0, law, friction=friction, rtol=1e-6)
    prediction = np.linalg.norm(found.log["prediction"], axis=1)
    assert np.mean(prediction[-100:]) < 0.1 * np.mean(prediction[:25])
    assert abs(found.log["error"][-100:]).max() < 2e-3
    assert (found.log["estimates"][-1, -4:] > 0.1).all()
    assert (np.diff(found.log["V"]) < 1e-6).all()


def test_estimated_accelerations_do_nearly_as_well_as_measured_ones():
    arm, motion = heavier(TWO, 0.8), waves(TWO)
    ends = []
    for acceleration in (accelerometer(TWO), None):
        law = AdaptiveComputedTorque(
            arm, motion, 50, 14, 0.3, False, acceleration=acceleration, bandwidth=300.0
        )
        found = simulate(TWO, motion.mean, [0, 0], 6.0, law, rtol=1e-7)
        ends.append(found.q[-1])
        assert abs(found.log["error"][-50:]).max() < 5e-3
    assert ends[0] == pytest.approx(ends[1], abs=1e-3)


def test_a_sampled_adaptive_law_learns_too():
    motion = waves(TWO)
    law = AdaptiveSlotineLi(heavier(TWO, 0.8), motion, 5.0, 5.0, 1.0, False, period=0.005)
    found = simulate(TWO, motion.mean, [0, 0], 8.0, law, method="rk4", dt=0.005)
    early, late = (abs(found.log["error"][s]).max() for s in (slice(0, 100), slice(-100, None)))
    assert late < 0.2 * early


@pytest.mark.parametrize("law_of", [AdaptiveSlotineLi, AdaptiveComputedTorque])
def test_a_batch_is_its_members(law_of, rng):
    law = law_of(TREE, waves(TREE), 9.0, 6.0, 1.0, true_parameters=rubbing(TREE)[1])
    q, qd = rng.normal(size=(2, 2, TREE.n))
    z = law.start(q, qd) + rng.normal(size=law.start(q, qd).shape) * 1e-3
    results = law.effort(0.7, q, qd, z), law.slope(0.7, q, qd, z)
    log = law.log(0.7, q, qd, z)
    for k in range(2):
        one = q[k], qd[k], z[k]
        assert results[0][k] == pytest.approx(law.effort(0.7, *one), rel=1e-10)
        assert results[1][k] == pytest.approx(law.slope(0.7, *one), rel=1e-10, abs=1e-10)
        for key, value in law.log(0.7, *one).items():
            assert log[key][k] == pytest.approx(value, rel=1e-10)
