"""What a user meets: arguments of every kind, sentences on wrong ones, copies, pickles, threads."""

import dataclasses
import pickle
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext

import numpy as np
import pytest
import sympy

from mcgee import ModelError, arms, kernels
from mcgee.model import Frame, Inertia, Joint, Link
from mcgee.robot import Limits, Robot, Terms
from robots import apart, built_in, random_state, random_tree


@pytest.fixture(scope="module")
def arm():
    return arms.planar_2r()


@pytest.fixture(scope="module")
def tree():
    return random_tree(8, bodies=5, prismatic=0.4, mimic=0.0)


Q, QD, QDD = [0.5, 0.3], [0.1, -0.2], [1.0, 2.0]


# -- wrong arguments, each with its sentence ------------------------------------------------------


def refusal(error, call, *args, **kwargs):
    with pytest.raises(error) as caught:
        call(*args, **kwargs)
    assert caught.value.__context__ is None  # one sentence, no second traceback
    return str(caught.value)


def test_wrong_size(arm):
    assert refusal(ValueError, arm.mass_matrix, np.zeros(3)) == (
        "q has shape (3,), expected (..., 2) for robot 'planar_2r'. Joints: joint1, joint2."
    )
    assert refusal(ValueError, arm.inverse_dynamics, Q, np.zeros((4, 3)), QDD).startswith(
        "qd has shape (4, 3), expected (..., 2)"
    )
    assert refusal(ValueError, arm.forward_dynamics, Q, QD, [1.0]).startswith("tau has shape (1,)")


def test_number_where_an_array_belongs(arm):
    assert refusal(ValueError, arm.mass_matrix, 0.5).startswith("q has shape (), expected (..., 2)")


def test_ragged_rows(arm):
    assert refusal(ValueError, arm.mass_matrix, [[1.0, 2.0], [3.0]]) == (
        "q is ragged: its rows differ in length. Each needs 2."
    )


def test_text(arm):
    sentence = refusal(TypeError, arm.mass_matrix, ["a", "b"])
    assert sentence == "q holds <U1, expected real numbers for robot 'planar_2r'."
    assert refusal(TypeError, arm.gravity, [None, 1.0]).startswith("q holds object, expected real")


def test_complex_numbers(arm):
    assert refusal(TypeError, arm.coriolis, Q, [1j, 0]).startswith("qd holds complex128, expected")


def test_too_few_and_too_many_arrays(arm):
    assert refusal(TypeError, arm.inverse_dynamics, Q, QD) == (
        "inverse_dynamics takes 3 arrays (q, qd, qdd), got 2."
    )
    assert refusal(TypeError, arm.mass_matrix) == "mass_matrix takes 1 arrays (q), got 0."
    assert refusal(TypeError, arm.mass_matrix, Q, QD, QDD).startswith("mass_matrix takes 1 arrays")


def test_batches_that_do_not_broadcast(arm):
    sentence = refusal(ValueError, arm.coriolis, np.zeros((3, 2)), np.zeros((4, 2)))
    assert sentence == (
        "coriolis of robot 'planar_2r' got q (3, 2), qd (4, 2): the dimensions before the last do "
        "not broadcast."
    )


def test_missing_and_doubled_names(arm):
    assert refusal(TypeError, arm.coriolis, qd=QD) == "coriolis needs q, qd; q is missing."
    assert refusal(TypeError, arm.coriolis, Q, QD, q=Q) == (
        "coriolis got q twice, by position and by name."
    )
    assert refusal(TypeError, arm.coriolis, Q, q=Q, qd=QD) == (
        "coriolis got q twice, by position and by name."
    )


def test_unknown_keyword(arm):
    assert "speed" in refusal(TypeError, arm.gravity, Q, speed=3)


def test_wrong_out(arm):
    assert refusal(ValueError, arm.gravity, Q, out=np.zeros(3)).startswith("gravity of robot")
    frozen = np.zeros(2)
    frozen.flags.writeable = False
    assert "read-only" in refusal(ValueError, arm.gravity, Q, out=frozen)


def test_unknown_frame(arm):
    sentence = refusal(ValueError, arm.jacobian, Q, "wrist")
    assert sentence.startswith("frame is 'wrist', which robot 'planar_2r' has not. Frames: ")
    assert all(name in sentence for name in arm.frame_names)
    assert refusal(ValueError, arm.forward_kinematics, Q, 3).startswith("frame is 3, which")


def test_replace_names_an_unknown_joint(arm):
    for what in ("armature", "viscous", "coulomb"):
        assert refusal(ValueError, arm.replace, **{what: {"elbow": 0.1}}) == (
            f"{what} names joint 'elbow', which robot 'planar_2r' has not among its moving "
            f"joints: joint1, joint2."
        )


def test_replace_with_what_cannot_be(arm):
    assert "is (0, 1), expected 3 num" in refusal(ValueError, arm.replace, gravity_vector=(0, 1))
    assert "armature -1" in refusal(ModelError, arm.replace, armature={"joint1": -1.0})
    assert "finite" in refusal(ModelError, arm.replace, gravity_vector=(0, 0, np.nan))


def test_unknown_symbol():
    m1 = sympy.Symbol("m1")
    arm = arms.planar_2r(m1=m1)
    assert refusal(ValueError, arm.subs, {"mass": 1.0}) == (
        "robot 'planar_2r' has no symbol 'mass'. Its symbols: m1."
    )
    assert refusal(ValueError, arm.subs({m1: 1.0}).subs, {"m1": 1.0}) == (
        "robot 'planar_2r' has no symbol 'm1'. Its symbols: none; all its parameters are numbers."
    )


def test_symbols_left_over():
    arm = arms.planar_2r(m1=sympy.Symbol("m1"), lc2=sympy.Symbol("lc2"))
    sentence = (
        "robot 'planar_2r' still has the symbols lc2, m1; kernels need numbers. "
        "Give them with arm.subs({'lc2': …, 'm1': …})."
    )
    with pytest.raises(ValueError, match="still has the symbols") as caught:
        arm.mass_matrix(Q)
    assert str(caught.value) == sentence
    assert refusal(ValueError, arm.jacobian, Q) == sentence


# -- right arguments, of every kind ---------------------------------------------------------------


def test_lists_and_tuples(arm):
    assert np.array_equal(arm.gravity([0.5, 0.3]), arm.gravity(np.array([0.5, 0.3])))
    assert np.array_equal(arm.gravity((0.5, 0.3)), arm.gravity([[0.5, 0.3]])[0])


def test_inputs_by_name(arm):
    want = arm.inverse_dynamics(Q, QD, QDD)
    assert np.array_equal(arm.inverse_dynamics(q=Q, qd=QD, qdd=QDD), want)
    assert np.array_equal(arm.inverse_dynamics(Q, qdd=QDD, qd=QD), want)
    assert np.array_equal(arm.jacobian(q=Q, frame="tip"), arm.jacobian(Q, "tip"))
    assert np.array_equal(arm.terms(qd=QD, q=Q).M, arm.mass_matrix(q=Q))


def test_out_is_filled(arm):
    out = np.full((3, 2, 2), np.nan)
    q = np.linspace(0, 1, 6).reshape(3, 2)
    assert arm.mass_matrix(q, out=out) is out
    assert np.array_equal(out, arm.mass_matrix(q))
    strided = np.full((2, 2, 6), np.nan)[..., ::3]
    assert arm.mass_matrix(q[0], out=strided[0]) is not None
    assert np.array_equal(strided[0], out[0])
    assert np.isnan(strided[1]).all()
    assert np.array_equal(arm.gravity(q=Q, out=np.empty(2)), arm.gravity(Q))
    M, Cqd, g = arm.terms(Q, QD, out=(np.empty((2, 2)), np.empty(2), np.empty(2)))
    assert np.array_equal(M, arm.mass_matrix(Q))
    assert np.array_equal(Cqd, arm.coriolis(Q, QD))
    assert np.array_equal(g, arm.gravity(Q))


def test_out_may_be_an_input(arm):
    """NumPy copies where memory overlaps."""
    q = np.linspace(0, 1, 12).reshape(6, 2)
    want = arm.gravity(q)
    assert np.array_equal(arm.gravity(q, out=q), want)


def test_broadcasting(tree):
    rng = np.random.default_rng(0)
    q, qd = rng.normal(size=(5, 1, tree.n)), rng.normal(size=(3, tree.n))
    every_q, every_qd = np.broadcast_arrays(q, qd)
    assert every_q.shape == (5, 3, tree.n)
    for method, shape in (("coriolis", (tree.n,)), ("coriolis_matrix", (tree.n, tree.n))):
        got = getattr(tree, method)(q, qd)
        assert got.shape == (5, 3, *shape)
        assert np.array_equal(got, getattr(tree, method)(every_q.copy(), every_qd.copy()))
        row = getattr(tree, method)(q[4, 0], qd[2])
        assert np.array_equal(got[4, 2], row)  # to the last bit, alone or in a batch
    assert tree.kinetic_energy(q, qd).shape == (5, 3)
    assert tree.mass_matrix(q).shape == (5, 1, tree.n, tree.n)
    assert [part.shape[:2] for part in tree.terms(q, qd)] == [(5, 3)] * 3


@pytest.mark.parametrize("kind", [np.float32, np.int64, np.int8, np.uint16, bool])
def test_other_numbers(arm, kind):
    q = np.array([[1, 0], [0, 1]], kind)
    got = arm.mass_matrix(q)
    assert got.dtype == np.float64
    assert np.array_equal(got, arm.mass_matrix(q.astype(float)))


def test_float16_and_foreign_byte_order(arm):
    q = np.array([[0.5, 0.25], [1.0, -2.0]])
    for kind in (np.float16, ">f8", "<f8"):
        assert np.array_equal(arm.gravity(q.astype(kind)), arm.gravity(q))


def test_views_of_every_stride(tree):
    rng = np.random.default_rng(1)
    wide = rng.normal(size=(9, 2 * tree.n))
    views = (
        wide[:, ::2],
        wide[::-1, : tree.n],
        wide[:, tree.n - 1 :: -1],
        np.asfortranarray(wide[:, : tree.n]),
        np.broadcast_to(wide[0, : tree.n], (9, tree.n)),
        np.frombuffer(b"x" + wide[:, : tree.n].tobytes(), np.uint8)[1:]
        .view(np.float64)
        .reshape(9, tree.n),
    )
    for view in views:
        assert np.array_equal(tree.mass_matrix(view), tree.mass_matrix(view.copy(order="C")))


def test_read_only_inputs_are_left_alone(arm):
    q = np.array(Q)
    q.flags.writeable = False
    arm.gravity(q)
    assert q.tolist() == Q


def test_empty_batches(tree):
    none = np.zeros((0, tree.n))
    assert tree.mass_matrix(none).shape == (0, tree.n, tree.n)
    assert tree.kinetic_energy(none, none).shape == (0,)
    assert tree.inverse_dynamics(none, none, np.zeros(tree.n)).shape == (0, tree.n)
    assert tree.gravity(np.zeros((3, 0, tree.n))).shape == (3, 0, tree.n)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_nan_and_infinity_stay_in_their_row(tree, bad):
    q, qd, qdd = random_state(tree, np.random.default_rng(2), 37)
    want = tree.inverse_dynamics(q, qd, qdd), tree.mass_matrix(q)
    turns = [joint.kind != "prismatic" for joint in tree.independent_joints].index(True)
    q[20, turns] = bad
    # NumPy says of an infinite angle what it says of np.sin(np.inf)
    warns = nullcontext() if np.isnan(bad) else pytest.warns(RuntimeWarning, match="invalid value")
    with warns:
        tau, M = tree.inverse_dynamics(q, qd, qdd), tree.mass_matrix(q)
    others = np.arange(37) != 20
    assert np.array_equal(tau[others], want[0][others])
    assert np.array_equal(M[others], want[1][others])
    assert np.isnan(tau[20]).any()


def test_results_are_new_arrays(arm):
    first = arm.mass_matrix(Q)
    first[:] = 0
    assert arm.mass_matrix(Q).all()


def test_single_states_give_single_results(arm):
    assert arm.mass_matrix(Q).shape == (2, 2)
    assert np.shape(arm.potential_energy(Q)) == ()
    assert float(arm.kinetic_energy(Q, QD)) > 0
    assert arm.forward_kinematics(Q).shape == (4, 4)
    assert arm.jacobian(Q).shape == (6, 2)
    assert arm.christoffel(Q).shape == (2, 2, 2)


def test_terms_has_names(arm):
    terms = arm.terms(Q, QD)
    assert isinstance(terms, Terms)
    assert terms._fields == ("M", "Cqd", "g")
    assert terms[0] is terms.M


def test_methods_can_be_taken_off_and_documented(arm):
    mass_matrix = arm.mass_matrix
    assert np.array_equal(mass_matrix(Q), arm.mass_matrix(Q))
    assert arm.mass_matrix is mass_matrix
    assert mass_matrix.__name__ == "mass_matrix"
    assert mass_matrix.__doc__ == Robot.mass_matrix.__doc__
    assert "(..., n, n)" in Robot.mass_matrix.__doc__
    assert isinstance(mass_matrix.ufunc, np.ufunc)


# -- copies, pickles, identity --------------------------------------------------------------------


def test_immutable(arm):
    for name in ("name", "gravity_vector", "links"):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(arm, name, None)
    with pytest.raises(ValueError, match="read-only"):
        arm.limits.lower[0] = 0.0


def test_equal_descriptions_are_equal_robots(arm):
    twin = arms.planar_2r()
    assert twin == arm
    assert hash(twin) == hash(arm)
    assert twin is not arm
    assert len({arm, twin, arms.planar_2r(m1=2.0)}) == 2
    assert arms.planar_2r(m1=2.0) != arm
    assert arm != "planar_2r"


def test_using_a_robot_does_not_change_what_it_is():
    used, fresh = arms.planar_2r(), arms.planar_2r()
    used.mass_matrix(Q)
    used.jacobian(Q)
    assert used == fresh
    assert hash(used) == hash(fresh)


def test_pickles_without_its_kernels(tree):
    q, qd, _ = random_state(tree, np.random.default_rng(3))
    want = tree.coriolis(q, qd), tree.jacobian(q, "tool")
    copy = pickle.loads(pickle.dumps(tree))
    assert copy == tree
    assert set(copy.__dict__) == {field.name for field in dataclasses.fields(Robot)}
    assert np.array_equal(copy.coriolis(q, qd), want[0])
    assert np.array_equal(copy.jacobian(q, "tool"), want[1])


def test_replace(arm):
    moon = arm.replace(gravity_vector=[0, -1.62, 0], armature={"joint2": 0.25}, name="moon")
    assert (moon.name, moon.gravity_vector) == ("moon", (0.0, -1.62, 0.0))
    assert apart(moon.gravity(Q), arm.gravity(Q) * 1.62 / 9.81) < 1e-15
    extra = moon.mass_matrix(Q) - arm.mass_matrix(Q)
    assert apart(extra, [[0, 0], [0, 0.25]]) < 1e-15
    assert arm.name == "planar_2r"
    assert arm.replace() == arm
    damped = arm.replace(viscous={"joint1": 0.5}, coulomb={"joint1": 0.1})
    assert np.array_equal(damped.inverse_dynamics(Q, QD, QDD), arm.inverse_dynamics(Q, QD, QDD))
    assert (damped.joints[0].viscous, damped.joints[0].coulomb) == (0.5, 0.1)


def test_replaced_robots_do_not_share_kernels(arm):
    arm.gravity(Q)
    weightless = arm.replace(gravity_vector=(0, 0, 0))
    assert not weightless.gravity(Q).any()
    assert arm.gravity(Q).all()


def test_subs():
    m1, lc1 = sympy.symbols("m1 lc1")
    arm = arms.planar_2r(m1=m1, lc1=lc1)
    assert arm.symbols == ("lc1", "m1")
    half = arm.subs({m1: 2 * lc1})
    assert half.symbols == ("lc1",)
    assert half.subs({"lc1": 0.5}) == arm.subs({"m1": 1.0, "lc1": 0.5}) == arms.planar_2r()
    assert arms.planar_2r().symbols == ()
    whole = arm.subs({"m1": np.float64(1), "lc1": sympy.Rational(1, 2)})
    assert np.array_equal(whole.mass_matrix(Q), arms.planar_2r().mass_matrix(Q))


# -- what it says of itself -----------------------------------------------------------------------


def test_repr_is_one_readable_line(tree):
    assert repr(arms.planar_2r()) == (
        "Robot 'planar_2r': 2 revolute joints, 2 kg moving, gravity (0, -9.81, 0) m/s², "
        "end frame 'tip'"
    )
    assert "prismatic" in repr(tree)
    assert "\n" not in repr(tree)
    assert "m1" in repr(arms.planar_2r(m1=sympy.Symbol("m1")))


def test_str_has_a_line_for_each_joint():
    robot = built_in("panda")
    first, *lines = str(robot).splitlines()
    assert first == repr(robot)
    assert [line.split()[0] for line in lines] == list(robot.joint_names)
    assert "rad" in lines[0]
    assert "unlimited" in str(arms.planar_2r())
    assert " m" in str(built_in("scara"))


def test_what_it_consists_of(tree):
    assert tree.n == len(tree.joint_names) == len(tree.independent_joints) == 5
    assert set(tree.frame_names) == {*tree.link_names, "tool", "camera"}
    assert tree.end_frame in tree.frame_names
    assert isinstance(tree.limits, Limits)
    assert [limit.shape for limit in tree.limits] == [(5,)] * 4


def test_the_end_frame_is_the_last_of_the_deepest():
    assert arms.planar_2r().end_frame == "tip"
    panda = built_in("panda")
    assert panda.mechanism.frames[panda.end_frame][0] == panda.n - 1


# -- threads --------------------------------------------------------------------------------------


def test_first_use_from_many_threads(monkeypatch):
    """Eight threads meet at a fresh robot: all get the same, and it is compiled once."""
    robot, compiled = random_tree(17, bodies=6), []
    q, qd, _ = random_state(robot, np.random.default_rng(4), 50)
    start, compile_ = threading.Barrier(8), kernels.gufunc
    monkeypatch.setattr(kernels, "gufunc", lambda p, **o: compiled.append(1) or compile_(p, **o))

    def work(_):
        start.wait()
        return robot.coriolis_matrix(q, qd), robot.jacobian(q)

    with ThreadPoolExecutor(8) as pool:
        results = list(pool.map(work, range(8)))
    for C, J in results:
        assert np.array_equal(C, results[0][0])
        assert np.array_equal(J, results[0][1])
    assert len(compiled) == 2


def test_many_threads_on_one_kernel(tree):
    q, qd, _ = random_state(tree, np.random.default_rng(5), 2000)
    want = tree.coriolis_matrix(q, qd)
    with ThreadPoolExecutor(8) as pool:
        for got in pool.map(lambda _: tree.coriolis_matrix(q, qd), range(24)):
            assert np.array_equal(got, want)


# -- the smallest robots --------------------------------------------------------------------------


def test_one_joint():
    arm = arms.pendulum(m=2.0, lc=0.5, I=0.1)
    assert arm.n == 1
    q = np.linspace(-3, 3, 7)[:, None]
    assert apart(arm.mass_matrix(q), np.full((7, 1, 1), 0.1 + 2 * 0.25)) < 1e-15
    assert apart(arm.gravity(q), 2 * 9.81 * 0.5 * np.sin(q)) < 1e-15
    assert not arm.coriolis(q, q).any()
    assert arm.christoffel(q).shape == (7, 1, 1, 1)
    assert apart(arm.forward_dynamics(q, q, q), (q - arm.gravity(q)) / 0.6) < 1e-15


def test_prismatic_only():
    """A gantry: M is the carried masses, C is zero, g the weight along each axis."""
    links = [Link("base")]
    joints = []
    for i, axis in enumerate([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]):
        links.append(Link(f"l{i}", Inertia(i + 1.0, (0.1, 0.2, 0.3), (0.1, 0, 0, 0.1, 0, 0.1))))
        joints.append(Joint(f"j{i}", "prismatic", links[-2].name, links[-1].name, axis=axis))
    gantry = Robot("gantry", tuple(links), tuple(joints), (Frame("tool", "l2"),))
    q, qd, qdd = random_state(gantry, np.random.default_rng(6))
    assert np.array_equal(gantry.mass_matrix(q), np.broadcast_to(np.diag([6.0, 5, 3]), (4, 3, 3)))
    assert not gantry.coriolis_matrix(q, qd).any()
    assert not gantry.christoffel(q).any()
    assert apart(gantry.gravity(q), np.tile([0, 0, 3 * 9.81], (4, 1))) < 1e-15
    assert np.array_equal(gantry.forward_kinematics(q)[:, :3, 3], q)
    assert np.array_equal(gantry.jacobian(q)[0], np.eye(6, 3))
    tau = gantry.inverse_dynamics(q, qd, qdd)
    assert apart(gantry.forward_dynamics(q, qd, tau), qdd) < 1e-14
