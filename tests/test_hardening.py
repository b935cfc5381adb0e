"""Strange uses of a robot that must end in one clear sentence, or simply work."""

import copy
import inspect
import multiprocessing
import pickle
import re

import numpy as np
import pytest
import sympy

import mcgee
from mcgee import quantities
from mcgee.formats.urdf import parse_urdf
from mcgee.model import Inertia, Joint, Link, Mimic


def says(sentence, kind=ValueError):
    return pytest.raises(kind, match=re.escape(sentence))


@pytest.fixture(scope="module")
def two():
    return mcgee.load("planar_2r")


def test_a_singular_M_has_no_inverse_and_says_which_joint():
    with pytest.warns(mcgee.ModelWarning, match="joint2"):
        arm = mcgee.arms.planar_2r(m2=0, I2=0)
    assert hasattr(arm, "forward_dynamics")
    for name, arguments in (("mass_matrix_inverse", 1), ("forward_dynamics", 3)):
        with says(
            f"{name} of robot 'planar_2r' does not exist: M is singular in every pose, joint"
        ):
            getattr(arm, name)(*[[0.0, 0.0]] * arguments)
    np.testing.assert_allclose(arm.mass_matrix([0, 0]), [[0.35, 0], [0, 0]])


def test_methods_are_picklable_and_documented(two):
    for method in (two.gravity, two.mass_matrix):
        again = pickle.loads(pickle.dumps(method))
        np.testing.assert_array_equal(again([0.1, 0.2]), method([0.1, 0.2]))
        assert "(q" in str(inspect.signature(method))
        assert "joint positions" in inspect.getdoc(method)
        assert isinstance(method.ufunc, np.ufunc)
    assert repr(two.coriolis) == "<coriolis(q, qd) of robot 'planar_2r'>"
    assert copy.deepcopy(two) == two


def test_methods_map_over_processes(two):
    rows = list(np.random.default_rng(0).normal(size=(4, 2)))
    with multiprocessing.get_context("fork").Pool(2) as pool:
        np.testing.assert_array_equal(pool.map(two.gravity, rows), two.gravity(rows))


def test_looking_at_a_symbolic_arm_compiles_nothing():
    arm = mcgee.arms.planar_2r(m1=sympy.Symbol("m1"))
    assert hasattr(arm, "mass_matrix")
    assert dict(inspect.getmembers(arm))["gravity"] is arm.gravity
    with says("still has the symbols m1; kernels need numbers"):
        arm.mass_matrix([0, 0])


def test_symbols_are_found_wherever_they_stand():
    b = sympy.Symbol("b")
    arm = mcgee.from_dh([{"m": 1, "I": [1, 1, 1], "viscous": b}])
    assert arm.symbols == ("b",)
    assert arm.subs({b: 2}).joints[0].viscous == 2.0


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"m1": '__import__("os")'}, "symbol 'm1' is '__import__(\"os\")', expected a number."),
        ({"m1": None}, "symbol 'm1' is None, expected a number."),
        ({"m1": [1]}, "symbol 'm1' is [1], expected a number."),
        ({"m1": 1j}, "symbol 'm1' is 1j, expected a number."),
        ([("m1", 1)], "subs takes a mapping from symbols to numbers"),
        (None, "subs takes a mapping from symbols to numbers, got None."),
    ],
)
def test_subs_takes_numbers_and_runs_nothing(values, sentence):
    with says(sentence):
        mcgee.arms.planar_2r(m1=sympy.Symbol("m1")).subs(values)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"gravity_vector": 9.81}, "gravity_vector is 9.81, expected 3 numbers [m/s²]."),
        ({"gravity_vector": "abc"}, "gravity_vector is 'abc', expected 3 numbers"),
        ({"gravity_vector": (0, 0, "x")}, "gravity_vector is 'x', expected a number."),
        ({"armature": {"joint1": "a"}}, "armature of joint 'joint1' is 'a', expected a number."),
        ({"armature": [1]}, "armature is [1], expected a mapping from joint names."),
        ({"armature": {"joint1": -1}}, "joint 'joint1' has armature -1, expected a finite number"),
        ({"viscous": {"tip": 1}}, "viscous names joint 'tip', which robot 'planar_2r' has not"),
        ({"name": 3}, "a robot is named 3, expected a printable text."),
    ],
)
def test_replace_says_what_is_wrong(two, changes, sentence):
    with says(sentence):
        two.replace(**changes)


def test_a_fixed_joint_has_no_armature():
    with says("which robot 'panda' has not among its moving joints: panda_joint1"):
        mcgee.load("panda").replace(armature={"panda_joint8": 1})


def test_out_of_the_wrong_type_and_batches_that_do_not_fit(two):
    with says("gravity of robot 'planar_2r': Cannot cast", TypeError):
        two.gravity([0, 0], out=np.zeros(2, int))
    with says("coriolis of robot 'planar_2r' got q (2, 2), qd (3, 2): the dimensions before"):
        two.coriolis(np.zeros((2, 2)), np.zeros((3, 2)))


@pytest.mark.parametrize("frame", [["tip"], np.zeros(2), 3])
def test_a_frame_is_a_name(two, frame):
    with says("which robot 'planar_2r' has not. Frames: base"):
        two.jacobian([0, 0], frame)


def test_quantities_count_their_coordinates(two):
    with says("got 3 joint coordinates, expected 2."):
        quantities.gravity(two.mechanism, [1.0, 2.0, 3.0])


def test_robots_are_equal_whatever_lines_say_so():
    text = "<robot name='r'>{}<link name='a'/>{}</robot>"
    body = (
        "<link name='b'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' "
        "iyz='0' izz='1'/></inertial></link><joint name='j' type='continuous'>"
        "<parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint>"
    )
    assert parse_urdf(text.format("", body)) == parse_urdf(text.format("\n\n", body))


def test_frames_cannot_be_changed(two):
    with pytest.raises(TypeError):
        two.mechanism.frames["tip"] = two.mechanism.frames["base"]


@pytest.mark.parametrize("name", ["a\nb", "", 3, "\x1b[31m"])
def test_names_are_printable(name):
    links = (Link("base"), Link(name, Inertia(1.0)))
    joints = (Joint("j", "revolute", "base", name),)
    with says(f"a link is named {name!r}, expected a printable text.", mcgee.ModelError):
        mcgee.Robot("r", links, joints)


def test_long_chains_are_checked_in_a_moment():
    """Every joint hangs on the one before, and mimics it."""
    n = 3000
    links = [Link(f"l{i}", Inertia(1.0)) for i in range(n + 1)]
    joints = [Joint("j0", "revolute", "l0", "l1")]
    for i in range(1, n):
        mimic = Mimic(f"j{i - 1}")
        joints.append(Joint(f"j{i}", "revolute", f"l{i}", f"l{i + 1}", mimic=mimic))
    chain = mcgee.Robot("chain", tuple(links), tuple(reversed(joints)))
    assert chain.n == 1


def test_too_many_links_are_refused():
    links = "".join(f"<link name='l{i}'/>" for i in range(5001))
    with says("has 5001 <link>; at most 5000 are read.", mcgee.ModelError):
        parse_urdf(f"<robot name='r'>{links}</robot>")


def test_the_same_arm_again_costs_no_new_code():
    from mcgee.jit import compile

    mcgee.load("pendulum").mass_matrix([0.0])
    known = len(compile._kept)
    mcgee.load("pendulum").mass_matrix([0.0])
    assert len(compile._kept) == known


def test_methods_can_be_called_through_the_class(two):
    state = [0.1, 0.2]
    np.testing.assert_array_equal(mcgee.Robot.gravity(two, state), two.gravity(state))
    assert "the efforts that hold the arm still" in inspect.getdoc(mcgee.Robot.gravity)
    assert str(inspect.signature(mcgee.Robot.coriolis)).startswith("(self, q")
