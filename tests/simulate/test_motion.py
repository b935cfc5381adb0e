"""Motion: exact solutions, conserved quantities, the ledger, and other people's integrators."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import os
import pty
import subprocess
import sys
import warnings
from importlib import resources

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import mcgee
from mcgee.control.controller import Controller
from mcgee.simulate import Friction, SimulationError, Stops, simulate
from mcgee.simulate.flow import Flow
from mcgee.simulate.plant import Plant
from robots import built_in, random_tree

METHODS = ["DOP853", "RK45", "Radau", "rk4", "midpoint"]


def start(name: str):
    arm = built_in(name)
    rng = np.random.default_rng(len(name))
    return arm, rng.uniform(-0.5, 0.5, arm.n), rng.uniform(-0.5, 0.5, arm.n)


# -- exact ----------------------------------------------------------------------------------------


def swing(arm, amplitude: float, t: np.ndarray) -> np.ndarray:
    """A pendulum released at rest, exactly."""
    (M,), (slope,) = arm.mass_matrix([0.0])[0], arm.gravity_gradient([0.0])[0]
    omega, k = np.sqrt(slope / M), np.sin(amplitude / 2)
    sn, *_ = ellipj(ellipk(k * k) - omega * t, k * k)
    return 2 * np.arcsin(k * sn)


@pytest.mark.parametrize("method", METHODS)
def test_a_pendulum_swings_as_elliptic_functions_say(method):
    arm = mcgee.arms.pendulum()
    found = simulate(arm, [2.5], [0], 6.0, method=method, step=0.05)
    error = {"DOP853": 1e-7, "RK45": 1e-6, "Radau": 1e-4, "rk4": 1e-9, "midpoint": 1e-3}[method]
    assert abs(found.q[:, 0] - swing(arm, 2.5, found.t)).max() < error


@pytest.mark.parametrize(("method", "order"), [("rk4", 4), ("midpoint", 2)])
def test_orders_of_fixed_steps(method, order):
    arm = mcgee.arms.pendulum()
    errors = []
    for dt in (0.02, 0.01):
        found = simulate(arm, [2.0], [0], 2.0, method=method, dt=dt, step=2.0)
        errors.append(abs(found.q[-1, 0] - swing(arm, 2.0, np.array(2.0))))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.2)


def test_viscous_decay():
    """A body on a slide without gravity: qd = qd0 exp(−b t/m)."""
    slide = built_in("cart_pole").replace(viscous={"cart": 0.7}, gravity_vector=(0, 0, 0))
    found = simulate(slide, [0, 0], [1.0, 0], 3.0, friction=Friction(coulomb=False), rtol=1e-11)
    M = slide.mass_matrix([0, 0])
    assert found.dissipated[-1, 0] > 0.1
    momentum = (slide.mass_matrix(found.q) @ found.qd[..., None])[:, 0, 0]
    lost = 0.7 * (found.q[:, 0] - found.q[0, 0])
    assert abs(momentum + lost - M[0, 0]).max() < 1e-8


def test_coulomb_friction_stops_a_sliding_cart():
    """v² = 2 a s: the distance that constant friction leaves."""
    cart = built_in("cart_pole").replace(coulomb={"cart": 0.5}, gravity_vector=(0, 0, 0))
    locked = dataclasses.replace(
        cart,
        joints=tuple(
            dataclasses.replace(j, kind="fixed") if j.name == "pole" else j for j in cart.joints
        ),
    )
    friction = Friction(viscous=False, speed=1e-4)
    found = simulate(locked, [0], [1.0], 4.0, friction=friction, method="LSODA", step=0.01)
    mass = float(locked.mass_matrix([0])[0, 0])
    assert found.q[-1, 0] == pytest.approx(mass / (2 * 0.5), rel=2e-3)
    assert abs(found.residual).max() < 1e-6


# -- conserved ------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["planar_2r", "puma560", "panda"])
def test_energy_is_kept(name, method):
    arm, q, qd = start(name)
    found = simulate(arm, q, qd, 2.0, method=method)
    size = found.kinetic.max()
    bound = {"midpoint": 1e-3, "Radau": 1e-5, "DOP853": 1e-7}.get(method, 1e-6)
    assert float(abs(found.residual).max()) < bound * size
    assert not found.work.any()


@pytest.mark.parametrize("name", ["planar_2r", "puma560", "panda"])
def test_kinetic_energy_is_constant_without_gravity(name):
    """dT/dt = ½ qdᵀ(Ṁ − 2C)qd = 0: the Coriolis forces make and destroy none."""
    arm, q, qd = start(name)
    free = arm.replace(gravity_vector=(0, 0, 0))
    found = simulate(free, q, 4 * qd, 3.0, rtol=1e-12, atol=1e-12)
    assert abs(found.q[-1] - found.q[0]).max() > 1
    assert found.kinetic == pytest.approx(found.kinetic[0], rel=1e-9)


@pytest.mark.parametrize("method", ["DOP853", "midpoint"])
def test_momentum_about_a_vertical_axis_is_kept(method):
    arm, q, qd = start("panda")
    found = simulate(arm, q, qd, 2.0, method=method)
    momentum = (arm.mass_matrix(found.q) @ found.qd[..., None])[:, 0, 0]
    size = abs(arm.mass_matrix(q) @ qd).max()
    bound = 1e-12 if method == "midpoint" else 1e-8
    assert abs(momentum - momentum[0]).max() < bound * max(size, 1)


def test_jacobians_of_the_motion(rng):
    """Nothing depends on the books, nor on an angle about the vertical."""
    arm = built_in("puma560")
    flow = Flow(Plant(arm), None, 0)
    q, qd = rng.normal(size=(2, 6))
    got = flow.jacobian(0.0, flow.begin(q, qd, np.zeros(0)))
    by_q, by_qd, _ = arm.forward_dynamics_derivatives(q, qd, np.zeros(6))
    want = np.zeros_like(got)
    want[:6, 6:12] = np.eye(6)
    want[6:12, :6], want[6:12, 6:12] = by_q, by_qd
    assert got == pytest.approx(want, abs=1e-6 * abs(want).max())
    assert not want[:, 12:].any()


@pytest.mark.parametrize("method", ["Radau", "BDF"])
def test_implicit_methods_go_on_where_nothing_depends_on_a_coordinate(method):
    arm, q, qd = start("puma560")
    found = simulate(arm, q, 0 * qd, 20.0, method=method, step=0.5, rtol=1e-7, atol=1e-8)
    assert found.complete
    assert abs(found.residual).max() < 1e-4 * found.kinetic.max()


def test_midpoint_has_a_bounded_error():
    """Over a hundred times as long, energy strays no farther."""
    arm = mcgee.arms.pendulum()
    short, long = (
        simulate(arm, [2.0], [0], duration, method="midpoint", dt=0.01, step=0.1)
        for duration in (4.0, 100.0)
    )
    assert abs(long.residual).max() < 1.1 * abs(short.residual).max()
    drifting = simulate(arm, [2.0], [0], 100.0, method="rk4", dt=0.05, step=0.1)
    assert abs(drifting.residual[-1]) > 5 * abs(drifting.residual[40])


@pytest.mark.parametrize("method", ["DOP853", "rk4", "midpoint"])
def test_the_ledger_closes_with_everything_on(method):
    arm = built_in("puma560")
    found = simulate(
        arm,
        np.full(6, 0.4),
        np.zeros(6),
        1.0,
        lambda t, q, qd: arm.gravity(q) + 30 * np.cos(3 * t),
        method=method,
        friction=Friction(speed=0.2),
        stops=Stops(2e3, 0.3),
        effort_limits=True,
        disturbance=lambda t, q, qd: 5 * np.sin(9 * t) * np.ones_like(q),
    )
    size = abs(found.work).sum(-1).max()
    assert found.dissipated[-1].min() > 0
    assert (
        abs(found.residual).max() < {"midpoint": 1e-3, "rk4": 1e-4, "DOP853": 1e-7}[method] * size
    )
    for what in (found.work, found.disturbed):
        assert abs(what).max() > 0.01


# -- beside others --------------------------------------------------------------------------------


def test_mujoco_goes_the_same_way():
    import mujoco

    arm, q, qd = start("panda")
    text = (resources.files("mcgee") / "robots" / "panda.urdf").read_text()
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep, model.opt.integrator = 1e-3, mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.dof_damping[:] = model.dof_frictionloss[:] = 0
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = q, qd
    for _ in range(1000):
        mujoco.mj_step(model, data)
    ours = simulate(arm, q, qd, 1.0, method="rk4", dt=1e-3)
    assert abs(ours.q[-1] - data.qpos).max() < 1e-9
    assert abs(ours.qd[-1] - data.qvel).max() < 1e-8


def test_pinocchio_goes_the_same_way():
    import pinocchio as pin

    arm, q0, v0 = start("panda")
    text = (resources.files("mcgee") / "robots" / "panda.urdf").read_text()
    model = pin.buildModelFromXML(text)
    data, tau, h = model.createData(), np.zeros(7), 1e-3

    def f(q, v):
        return v, pin.aba(model, data, q, v, tau).copy()

    q, v = q0.copy(), v0.copy()
    for _ in range(1000):
        k1 = f(q, v)
        k2 = f(q + h / 2 * k1[0], v + h / 2 * k1[1])
        k3 = f(q + h / 2 * k2[0], v + h / 2 * k2[1])
        k4 = f(q + h * k3[0], v + h * k3[1])
        q = q + h / 6 * (k1[0] + 2 * (k2[0] + k3[0]) + k4[0])
        v = v + h / 6 * (k1[1] + 2 * (k2[1] + k3[1]) + k4[1])
    ours = simulate(arm, q0, v0, 1.0, method="rk4", dt=1e-3)
    assert abs(ours.q[-1] - q).max() < 1e-10


# -- controllers, batches -------------------------------------------------------------------------


class Counting(Controller):
    """tau = −k q + z, z' = −q; counts how often it is asked."""

    def __init__(self, period=None):
        self.period, self.asked = period, 0

    def start(self, q, qd):
        return np.zeros_like(q)

    def effort(self, t, q, qd, z):
        self.asked += 1
        return -3.0 * q - 2.0 * qd + z

    def slope(self, t, q, qd, z):
        return -q

    def log(self, t, q, qd, z):
        return {"integral": z, "size": (q * q).sum(-1)}


@pytest.mark.parametrize("method", METHODS)
def test_a_controller_may_have_a_state(method):
    arm = mcgee.arms.planar_2r(plane="horizontal")
    found = simulate(arm, [0.5, -0.2], [0, 0], 4.0, Counting(), method=method)
    assert found.log["integral"].shape == (501, 2)
    assert found.log["size"].shape == (501,)
    integral = -np.trapezoid(found.q[:, 0], found.t)
    assert found.log["integral"][-1, 0] == pytest.approx(integral, abs=1e-4)


@pytest.mark.parametrize("method", ["DOP853", "rk4", "midpoint"])
def test_sampled_controllers_hold_their_effort(method):
    arm = mcgee.arms.planar_2r(plane="horizontal")
    law = Counting(period=0.1)
    found = simulate(arm, [0.5, -0.2], [0, 0], 1.0, law, method=method, step=0.02)
    held = found.tau[1:].reshape(10, 5, 2)
    assert (held == held[:, :1]).all()
    assert len(np.unique(found.tau[:, 0])) == law.asked == 10
    assert (found.tau[0] == found.tau[1]).all()


def test_sampling_fast_is_like_never_holding():
    arm = mcgee.arms.planar_2r(plane="horizontal")
    end = simulate(arm, [0.5, -0.2], [0, 0], 1.0, Counting()).q[-1]
    errors = [
        abs(simulate(arm, [0.5, -0.2], [0, 0], 1.0, Counting(p), method="rk4").q[-1] - end).max()
        for p in (0.02, 0.01)
    ]
    assert errors[1] < 0.6 * errors[0] < 0.01


@pytest.mark.parametrize("method", ["DOP853", "rk4", "midpoint"])
def test_members_of_a_batch_move_alone(method, rng):
    arm = built_in("puma560")
    q, qd = rng.uniform(-0.5, 0.5, (2, 2, 3, 6))
    whole = simulate(arm, q, qd, 0.3, method=method, step=0.1)
    assert whole.q.shape == (2, 3, 4, 6)
    assert whole.residual.shape == (2, 3, 4)
    alone = simulate(arm, q[1, 2], qd[1, 2], 0.3, method=method, step=0.1)
    bound = 0 if method == "DOP853" else 1e-13
    assert abs(whole.q[1, 2] - alone.q).max() <= bound
    assert abs(whole.tau[1, 2] - alone.tau).max() == 0


def test_random_trees_with_followers(rng):
    arm = random_tree(5, bodies=5, mimic=0.4)
    q, qd = rng.normal(size=(2, arm.n)) / 2
    found = simulate(arm, q, qd, 0.5)
    assert abs(found.residual).max() < 1e-6 * found.kinetic.max()


def test_limits_saturate():
    arm = dataclasses.replace(built_in("planar_2r"))
    limited = dataclasses.replace(
        arm, joints=tuple(dataclasses.replace(j, effort=2.0) for j in arm.joints)
    )
    found = simulate(limited, [0, 0], [0, 0], 0.2, lambda t, q, qd: [9, -9], effort_limits=True)
    assert (found.tau == [2.0, -2.0]).all()


def test_stops_hold_a_falling_arm():
    arm = built_in("planar_2r")
    arm = dataclasses.replace(
        arm,
        joints=tuple(dataclasses.replace(j, lower=-0.5, upper=0.5) for j in arm.joints),
    )
    found = simulate(arm, [0, 0], [0, 0], 20.0, stops=True, method="LSODA", friction=None)
    assert found.q.min() > -0.65
    assert abs(found.q[-1, 0] + 0.5) < 0.01
    assert found.stopped[-1].sum() < -1


# -- what goes wrong ------------------------------------------------------------------------------

REFUSED = [
    (([0], [0, 0], 1.0), {}, r"q0 has shape \(1,\), expected \(..., 2\) for robot 'planar_2r'"),
    (([0, np.nan], [0, 0], 1.0), {}, "q0 holds nan"),
    (([0, 0], [0, np.inf], 1.0), {}, "qd0 holds inf"),
    ((np.zeros((3, 2)), np.zeros((2, 2)), 1.0), {}, "leading dimensions do not broadcast"),
    (([0, 0], [0, 0], 0.0), {}, "duration is 0.0, expected a number above 0"),
    (([0, 0], [0, 0], -1), {}, "duration is -1"),
    (([0, 0], [0, 0], "1"), {}, "duration is '1'"),
    (([0, 0], [0, 0], 1.0), {"step": 0}, "step is 0"),
    (([0, 0], [0, 0], 1e9), {"step": 1e-3}, "give a longer step"),
    (([0, 0], [0, 0], 1.0), {"method": "euler"}, "method is 'euler', expected one of: DOP853"),
    (([0, 0], [0, 0], 1.0), {"dt": np.nan}, "dt is nan"),
    (([0, 0], [0, 0], 1.0), {"rtol": -1}, "rtol is -1"),
]


@pytest.mark.parametrize(("given", "more", "says"), REFUSED)
def test_refusals(given, more, says):
    with pytest.raises(ValueError, match=says):
        simulate(built_in("planar_2r"), *given, **more)


def test_controllers_of_no_kind():
    arm = built_in("planar_2r")
    with pytest.raises(TypeError, match=r"controller is 3, expected one of mcgee\.control"):
        simulate(arm, [0, 0], [0, 0], 1.0, 3)
    for given in ([1, 2, 3], "abc", None, {}, [[1, 2], [3]], 1j):
        for more in ({"controller": lambda *a, x=given: x}, {"disturbance": lambda *a, x=given: x}):
            with pytest.raises(ValueError, match=r"gives .*, expected numbers of shape \(2,\) for"):
                simulate(arm, [0, 0], [0, 0], 1.0, **more)
    with pytest.raises(ValueError, match="Unready starts with a state of shape"):
        simulate(arm, [0, 0], [0, 0], 1.0, Unready())


class Unready(Controller):
    def start(self, q, qd):
        return 3.0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("bad", "says"),
    [
        ({"controller": lambda t, q, qd: np.nan * q}, "Law gives nan for joint 'joint1' at t = 0"),
        ({"controller": lambda t, q, qd: [0, np.inf]}, "Law gives inf for joint 'joint2' at t = 0"),
        ({"disturbance": lambda t, q, qd: np.nan}, "the disturbance gives nan for joint 'joint1'"),
        ({"qd0": [1e200, 0]}, "'joint1' runs away: its speed is beyond 10000 at t = 0 s"),
        ({"controller": Controller()}, "has no effort"),
    ],
)
def test_there_is_no_motion_from_such_a_start(method, bad, says):
    """And no endless search for a first step."""
    given = {"q0": [0.1, 0.2], "qd0": [0, 0], "duration": 1.0} | bad
    with pytest.raises((ValueError, NotImplementedError), match=says):
        simulate(built_in("planar_2r"), **given, method=method)


@pytest.mark.parametrize("method", ["DOP853", "rk4"])
def test_a_batch_that_fails_says_so(method):
    arm = built_in("planar_2r")

    def law(t, q, qd):
        return np.where((q[..., :1] > 0.5) & (t > 0.05), np.nan, 0.0) + 0 * q

    with pytest.raises(SimulationError, match="Law gives nan for joint 'joint1'") as caught:
        simulate(arm, [[0.1, 0], [0.9, 0], [0, 0.1]], [0, 0], 0.2, law, method=method)
    kept = caught.value.trajectory
    assert not kept.complete
    assert kept.status in str(caught.value)
    assert kept.q.shape[0] == (2 if method == "DOP853" else 3)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("where", ["effort", "log", "names", "shapes"])
def test_what_a_controller_does_later_keeps_what_there_is(method, where):
    """By how often it was asked, not by the time, so that nothing can be asked again."""

    class Tiring(Controller):
        asked = logged = 0

        def effort(self, t, q, qd, z):
            self.asked += 1
            if where == "effort" and self.asked > 400:
                raise OSError("the sensor is gone")
            return 0 * q

        def log(self, t, q, qd, z):
            self.logged += 1
            if self.logged < 5:
                return {"a": t}
            if where == "log":
                raise OSError("the disk is full")
            return {"names": {"b": t}, "shapes": {"a": [t, t]}}.get(where, {"a": t})

    arm, says = built_in("planar_2r"), {"effort": "sensor is gone", "log": "disk is full"}
    with pytest.raises(SimulationError, match=says.get(where, "logs other names or shapes")) as got:
        simulate(arm, [0.1, 0.2], [0, 0], 5.0, Tiring(), method=method, step=0.01, dt=0.01)
    kept = got.value.trajectory
    assert len(kept.log["a"]) == len(kept.t) == len(kept.tau) > 1


@pytest.mark.parametrize("period", [0, -1, "x", math.nan, math.inf, 1e-12])
def test_periods_that_are_none(period):
    class Own(Controller):
        def effort(self, t, q, qd, z):
            return 0 * q

    law = Own()
    law.period = period
    with pytest.raises(ValueError, match="period is"):
        simulate(built_in("planar_2r"), [0, 0], [0, 0], 1.0, law)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"friction": "yes"}, "friction is 'yes', expected True, False or Friction"),
        ({"stops": 5}, "stops is 5, expected True, False or Stops"),
        ({"q0": np.zeros((0, 2))}, "there is no state to start from"),
        ({"q0": ["a", 1]}, "q0 is .*, expected numbers"),
        ({"q0": [1j, 0]}, "q0 is .*, expected numbers"),
        ({"q0": [[0, 0], [0]]}, "q0 is .*, expected numbers"),
    ],
)
def test_arguments_of_no_kind(more, says):
    with pytest.raises(ValueError, match=says):
        simulate(built_in("planar_2r"), **({"q0": [0, 0], "qd0": [0, 0], "duration": 1.0} | more))


def test_settings_of_no_kind():
    for make, says in (
        (lambda: Friction(speed="x"), "speed of friction is 'x', expected numbers"),
        (lambda: Stops(damping=None), "damping of stops is None, expected numbers"),
        (lambda: Stops(stiffness=-1), "stiffness of stops is -1, expected a number, 0 or more"),
    ):
        with pytest.raises(ValueError, match=says):
            make()


def test_times_are_even_and_end_with_the_duration():
    arm = built_in("planar_2r")
    for duration, step, count in ((1.1, 0.1, 12), (1.0, 0.3, 5), (0.3, 0.1, 4)):
        t = simulate(arm, [0, 0], [0, 0], duration, step=step).t
        assert len(t) == count
        assert t == pytest.approx(np.linspace(0, duration, count))


def test_friction_of_followers_reaches_their_leader():
    """A follower at m qd with b and c takes m² b qd² + |m c qd|."""
    arm = random_tree(6, bodies=5, mimic=0.6)
    follower = next(j for j in arm.joints if j.mimic is not None)
    rubbed = arm.replace(viscous={follower.name: 0.5}, coulomb={follower.name: 0.2})
    m, joint = 1.0, follower
    while joint.mimic is not None:
        m *= joint.mimic.multiplier
        joint = next(j for j in arm.joints if j.name == joint.mimic.joint)
    assert abs(m) not in (0, 1)
    k = rubbed.joint_names.index(joint.name)
    q, qd = np.full(arm.n, 0.2), np.full(arm.n, 0.7)
    found = simulate(rubbed, q, qd, 0.01, friction=Friction(speed=1e-3))
    want = np.zeros(arm.n)
    want[k] = m * m * 0.5 * 0.7 + abs(m) * 0.2
    assert found.friction[0] == pytest.approx(want)
    rolled = mcgee.rollout(rubbed, q, qd, steps=10, dt=1e-3, viscous=True)
    viscous = Friction(coulomb=False)
    steps = simulate(rubbed, q, qd, 0.01, method="rk4", dt=1e-3, step=1e-3, friction=viscous)
    assert rolled.q == pytest.approx(steps.q[1:], rel=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_a_singular_pose_is_named(method):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mcgee.ModelWarning)
        arm = mcgee.arms.planar_2r(m1=0, I1=0, I2=0, lc1=0)
    with pytest.raises(ValueError, match=r"M\(q\) is singular there, at q = \(0.3, 0\)"):
        simulate(arm, [0.3, 0.0], [0, 0], 1.0, method=method)
    with pytest.raises(SimulationError) as caught:
        simulate(arm, [0.3, 0.5], [0, 2.0], 4.0, method=method, step=0.01)
    assert caught.value.trajectory.t[-1] > 0.05


@pytest.mark.parametrize("method", ["DOP853", "rk4"])
def test_a_runaway_keeps_what_there_is(method):
    arm = built_in("planar_2r")
    with pytest.raises(SimulationError, match="robot 'planar_2r': ") as caught:
        simulate(arm, [0, 0], [0, 0], 50.0, lambda t, q, qd: 30 * qd + 1, method=method, step=0.01)
    kept = caught.value.trajectory
    assert 2 < len(kept.t) < 5001
    assert np.isfinite(kept.q).all()
    assert not kept.complete
    assert kept.status in str(caught.value)


@pytest.mark.parametrize("method", ["DOP853", "rk4", "midpoint"])
def test_nan_of_a_controller_keeps_what_there_is(method):
    arm = built_in("planar_2r")
    with pytest.raises(SimulationError) as caught:
        simulate(
            arm,
            [0, 0],
            [0, 0],
            1.0,
            lambda t, q, qd: np.where(t > 0.5, np.nan, 0.0) * np.ones(2),
            method=method,
        )
    kept = caught.value.trajectory
    assert 0.3 < kept.t[-1] <= 0.51
    assert np.isfinite(kept.q).all()


def test_what_a_controller_raises_keeps_what_there_is():
    arm = built_in("planar_2r")

    def law(t, q, qd):
        if t > 0.5:
            raise LookupError("no sensor")
        return np.zeros(2)

    with pytest.raises(SimulationError, match=r"LookupError after t = 0.5 s: no sensor") as caught:
        simulate(arm, [0, 0], [0, 0], 1.0, law, method="rk4", step=0.1)
    assert isinstance(caught.value.__cause__, LookupError)
    assert caught.value.trajectory.t[-1] == 0.5
    with pytest.raises(LookupError):
        simulate(arm, [0, 0], [0, 0], 1.0, lambda t, q, qd: {}["tau"])


def test_an_arm_that_nothing_moves_is_refused():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mcgee.ModelWarning)
        arm = mcgee.arms.planar_2r(m2=0, I2=0)
    with pytest.raises(ValueError, match="M is singular in every pose"):
        simulate(arm, [0, 0], [0, 0], 1.0)


@pytest.mark.parametrize("method", ["DOP853", "rk4"])
def test_interruptions_keep_what_there_is(method):
    arm, asked = built_in("planar_2r"), []

    def law(t, q, qd):
        asked.append(t)
        if t > 0.4 and not any(x < 0 for x in asked):
            asked.append(-1.0)
            raise KeyboardInterrupt
        return np.zeros(2)

    found = simulate(arm, [0.1, 0.2], [0, 0], 1.0, law, method=method, step=0.01)
    assert found.status == "interrupted"
    assert 0.05 < found.t[-1] < 0.45
    assert abs(found.residual).max() < 1e-6


def test_progress_is_shown_on_request(capfd):
    simulate(built_in("planar_2r"), [0, 0], [0, 0], 0.1, progress=True)
    assert "simulating" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("more", "patience", "shown"), [("", 0, True), ("progress=False", 0, False), ("", 60, False)]
)
def test_progress_of_long_runs_is_shown_on_terminals(more, patience, shown):
    program = (
        "import mcgee, sys\n"
        f"sys.modules['mcgee.simulate.progress'].PATIENCE = {patience}\n"
        f"mcgee.simulate(mcgee.load('planar_2r'), [0, 0], [0, 0], 0.1, {more})\n"
    )
    ours, its = pty.openpty()
    subprocess.run([sys.executable, "-c", program], stderr=its, env=os.environ | {"TERM": "xterm"})
    os.close(its)
    said = b""
    with contextlib.suppress(OSError):  # the other end is closed
        while more := os.read(ours, 4096):
            said += more
    os.close(ours)
    assert (b"simulating" in said) is shown, said
    assert shown or not said
