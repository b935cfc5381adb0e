"""The closed forms are what the compiled algorithms compute."""

import math

import numpy as np
import pytest

import mcgee
from mcgee.model import Inertia, Joint, Link, Mimic, Pose
from mcgee.robot import Robot
from robots import apart, built_in, interpreted, loaded, random_state, random_tree

EXACT = 1e-12  # rounding of up to thousands of terms, beside the largest element
QUANTITIES = {
    "M": ("mass_matrix", 1),
    "g": ("gravity", 1),
    "P": ("potential_energy", 1),
    "christoffel": ("christoffel", 1),
    "C": ("coriolis_matrix", 2),
    "Cqd": ("coriolis", 2),
    "T": ("kinetic_energy", 2),
    "tau": ("inverse_dynamics", 3),
}


def check(robot, rng, rows=2):
    form, reference = robot.closed_form(), interpreted(robot)
    state = random_state(robot, rng, rows=rows)
    for quantity, (method, arguments) in QUANTITIES.items():
        if quantity == "christoffel" and form.terms("M") > 1000:
            continue  # tens of thousands of terms: C has them all
        got = form.evaluate(quantity, *state[:arguments])
        want = getattr(reference, method)(*state[:arguments])
        assert apart(got, want, 1e-3) < EXACT, quantity
    return form


@pytest.mark.parametrize("name", mcgee.arms.BUILTIN)
def test_built_in_arms(name, rng):
    check(built_in(name), rng)


@pytest.mark.parametrize("name", ["ur5", "kinova", "double_pendulum"])
def test_urdfs(name, rng):
    check(loaded(name), rng)


@pytest.mark.parametrize("seed", range(4))
def test_random_trees_with_any_rotations(seed, rng):
    check(random_tree(seed, bodies=4), rng)


@pytest.mark.parametrize("seed", range(4))
def test_random_trees_that_mimic(seed, rng):
    check(random_tree(seed, bodies=4, mimic=0.5), rng)


@pytest.mark.parametrize("seed", range(12))
def test_exact_trees(seed, rng):
    shares = {"mimic": 0.3 * (seed % 2), "branching": 0.4, "prismatic": 0.4}
    check(random_tree(seed, exact=True, bodies=6, **shares), rng)


def inertia(k):
    return Inertia(1.0 + k, (0.1, 0.02 * k, -0.03), (0.05, 0.001, 0.002, 0.06, -0.003, 0.04 + k))


def chain(poses, axes, kinds=None, mimics=None, gravity=(1.0, -2.0, 9.0)):
    n = len(poses)
    kinds, mimics = kinds or ["revolute"] * n, mimics or [None] * n
    links = [Link("base"), *(Link(f"l{k}", inertia(k)) for k in range(n))]
    joints = [
        Joint(
            f"j{k}", kinds[k], links[k].name, links[k + 1].name, poses[k], axes[k], mimic=mimics[k]
        )
        for k in range(n)
    ]
    return Robot("chain", tuple(links), tuple(joints), (), gravity)


def tilted(*angles):
    return Pose.from_rpy(angles, (0.3, 0.1, -0.2))


@pytest.mark.parametrize("degrees", [15, 30, 45, 60, 75, 105, 150, 210, -45])
def test_multiples_of_fifteen_degrees_are_algebraic(degrees, rng):
    a = math.radians(degrees)
    robot = chain([tilted(a, 0, 0), tilted(0, a, 0), tilted(0, 0, a)], [(0.0, 0.0, 1.0)] * 3)
    form = check(robot, rng)
    assert not form.constants
    assert form.exact.ring.roots
    assert form.prove()


def test_several_turns_by_multiples_of_fifteen_degrees_are_algebraic(rng):
    a, b, c = (math.radians(d) for d in (30, 45, 75))
    form = check(chain([tilted(a, b, c), tilted(c, a, b)], [(0.0, 0.0, 1.0)] * 2), rng)
    assert not form.constants
    assert form.exact.ring.roots == (2, 3)
    assert form.prove()


def test_another_angle_gets_a_name_and_is_one_constant(rng):
    z = (0.0, 0.0, 1.0)
    poses = [tilted(0.3, 0, 0), tilted(0, -0.3, 0), tilted(0, 0, math.pi / 2 - 0.3)]
    form = check(chain(poses, [z, z, z]), rng)
    assert list(form.constants.values()) == [pytest.approx(0.3, abs=1e-15)]
    assert form.prove()


def test_a_general_rotation_is_exactly_orthogonal(rng):
    form = check(chain([tilted(0.3, 0.4, 0.5)] * 2, [(0.6, 0.8, 0.0), (0.48, 0.6, 0.64)]), rng)
    assert not form.constants
    assert form.prove()


def test_a_run_goes_on_in_a_slide_behind_a_slide_across(rng):
    """Turn about z, slide along x, slide along z, turn about z: all poses upright."""
    kinds = ["revolute", "prismatic", "prismatic", "revolute", "prismatic", "prismatic"]
    z, x, down = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0)
    form = check(chain([Pose.at(x=0.3, y=0.2)] * 6, [z, x, down, z, x, z], kinds), rng)
    assert len(form.exact.ring.angles.forms) == 2
    assert form.prove()


def test_runs_of_parallel_axes_go_on_through_slides_and_flips(rng):
    kinds = ["revolute", "prismatic", "revolute", "prismatic", "revolute", "revolute"]
    z, x, down = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0)
    poses = [Pose.at(x=0.3 + k / 10, z=0.1) for k in range(6)]
    form = check(chain(poses, [z, x, down, z, down, x], kinds), rng)
    assert [str(dict(f)) for f in form.exact.ring.angles.forms] == [
        "{q1: Fraction(1, 1)}",
        "{q1: Fraction(1, 1), q3: Fraction(-1, 1)}",
        "{q1: Fraction(1, 1), q3: Fraction(-1, 1), q5: Fraction(-1, 1)}",
        "{q6: Fraction(1, 1)}",
    ]
    assert form.prove()


@pytest.mark.parametrize("factor", [2.0, -1.0, 0.5, 1.5, -0.7, 0.123456789])
def test_mimic_joints(factor, rng):
    z, y = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)
    mimics = [None, Mimic("j0", factor, 0.25), None, Mimic("j1", 2.0, -0.5)]
    form = check(chain([Pose.at(x=0.4)] * 4, [z, z, y, y], mimics=mimics), rng)
    assert form.prove()


def test_a_slide_may_mimic_a_turn(rng):
    kinds = ["revolute", "prismatic", "revolute"]
    z, mimics = (0.0, 0.0, 1.0), [None, Mimic("j0", 0.05, 0.1), None]
    form = check(chain([Pose.at(x=0.4)] * 3, [z, z, z], kinds, mimics), rng)
    assert form.prove()


def test_batches_and_shapes(rng):
    form = built_in("scara").closed_form()
    q, qd, qdd = (rng.normal(size=(2, 3, 4)) for _ in range(3))
    for quantity, shape in (("P", ()), ("g", (4,)), ("M", (4, 4)), ("christoffel", (4, 4, 4))):
        assert form.evaluate(quantity, q, qd, qdd).shape == (2, 3, *shape)
    assert np.array_equal(form.evaluate("tau", q[0, 0]), form.evaluate("g", q[0, 0]))
