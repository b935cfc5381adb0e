"""Against Pinocchio: real robots through its own URDF reader, and random trees joint by joint."""

import re
from math import pi

import numpy as np
import pinocchio as pin
import pytest
from pinocchio_model import from_description, from_urdf

from robots import apart, interpreted, loaded, random_state, random_tree, urdf

ROUNDING = 2e-14
"""Of the largest element: two algorithms, a few hundred roundings of 1e-16 each."""

ROUNDED_ANGLES = 5e-11
"""Where the URDF says 1.57079632679, Pinocchio turns by that and mcgee by pi/2, which is 5e-12
more; along an arm such differences add up. Kinova says 1.570796327, which is 2e-10 off."""


def worst(robot, oracle, states, frames=None):
    """{quantity: largest relative difference}; C and C qd relative to M's size as well."""
    errors = {}

    def note(name, got, want, size=0.0):
        errors[name] = max(errors.get(name, 0.0), apart(got, want, size))

    weight = sum(m.inertia.mass for m in robot.mechanism.masses) * 9.81
    for q, qd, qdd in zip(*states, strict=True):
        M = oracle.mass_matrix(q)
        size, speed = abs(M).max(), abs(qd).max()
        tau = oracle.inverse_dynamics(q, qd, qdd)
        inverse = np.linalg.inv(M)
        note("mass_matrix", robot.mass_matrix(q), M)
        note("mass_matrix_inverse", robot.mass_matrix_inverse(q), inverse, np.linalg.cond(M))
        note("coriolis", robot.coriolis(q, qd), oracle.coriolis(q, qd), size * speed**2)
        C = oracle.coriolis_matrix(q, qd)
        note("coriolis_matrix", robot.coriolis_matrix(q, qd), C, size * speed)
        product = robot.coriolis_product(q, qd, qdd)
        note("coriolis_product", product, C @ qdd, size * speed * abs(qdd).max())
        note("gravity", robot.gravity(q), oracle.gravity(q), weight)
        note("inverse_dynamics", robot.inverse_dynamics(q, qd, qdd), tau, size)
        # the rounding of tau, as M⁻¹ passes it on
        passed = abs(inverse).sum(1).max() * (abs(tau).max() + size * speed**2)
        note("forward_dynamics", robot.forward_dynamics(q, qd, tau), qdd, passed)
        other = oracle.forward_dynamics(q, qd, qdd)
        note("forward_dynamics", robot.forward_dynamics(q, qd, qdd), other, passed)
        slopes = oracle.inverse_dynamics_derivatives(q, qd, qdd)
        efforts = size * (speed**2 + abs(qdd).max()) + weight
        ours = robot.inverse_dynamics_derivatives(q, qd, qdd)
        for name, got, want, own in zip(
            ("dtau_dq", "dtau_dqd", "M"), ours, slopes, (efforts, size * speed, 0.0), strict=True
        ):
            note(name, got, want, own)
        note_forward(note, robot, oracle, (q, qd, qdd), M, inverse, weight)
        poses = {joint.name: joint.child_pose for joint in robot.joints}
        order = [body.name for body in robot.mechanism.bodies]
        Y = oracle.regressor(q, qd, qdd, poses, order)
        note("regressor", robot.regressor(q, qd, qdd), Y)
        T = oracle.kinetic_energy(q, qd)
        note("kinetic_energy", robot.kinetic_energy(q, qd), T, size * speed**2)
        note("potential_energy", robot.potential_energy(q), oracle.potential_energy(q), weight)
        for frame in robot.frame_names if frames is None else frames:
            pose, J = oracle.forward_kinematics(q, frame), oracle.jacobian(q, frame)
            note("forward_kinematics", robot.forward_kinematics(q, frame), pose)
            note("jacobian", robot.jacobian(q, frame), J, 1.0)
    return errors


def note_forward(note, robot, oracle, state, M, inverse, weight):
    """The derivatives of forward dynamics, against Pinocchio's or, with followers, −M⁻¹ times."""
    q, qd, tau = state
    ours = robot.forward_dynamics_derivatives(q, qd, tau)
    caused = oracle.forward_dynamics(q, qd, tau)
    if oracle.A.shape[0] == oracle.A.shape[1]:
        theirs = oracle.forward_dynamics_derivatives(q, qd, tau)
    else:
        by_q, by_qd, _ = oracle.inverse_dynamics_derivatives(q, qd, caused)
        theirs = -inverse @ by_q, -inverse @ by_qd, inverse
    size, speed = abs(M).max(), abs(qd).max()
    passed, worsened = abs(inverse).sum(1).max(), np.linalg.cond(M)
    slopes = size * (abs(caused).max() + speed**2) + weight
    sizes = worsened * passed * slopes, worsened * passed * size * speed, worsened * passed
    for name, got, want, own in zip(
        ("dqdd_dq", "dqdd_dqd", "Minv"), ours, theirs, sizes, strict=True
    ):
        note(name, got, want, own)


def assert_agrees(robot, oracle, states, tolerance, frames=None):
    errors = worst(robot, oracle, states, frames)
    assert max(errors.values()) <= tolerance, errors


# -- real robots ----------------------------------------------------------------------------------

REAL = ["ur5", "panda", "talos", "double_pendulum", "double_pendulum_continuous", "kinova"]


def written_out(text):
    """The text with its rounded right angles to the last digit, so that both read the same."""
    for angle in (pi / 2, pi):
        text = re.sub(rf"\b{str(angle)[:9]}\d*\b", repr(angle), text)
    return text


@pytest.mark.parametrize("angles", ["as written", "written out"])
@pytest.mark.parametrize("name", REAL)
def test_urdf(name, angles, rng):
    robot, text = loaded(name), urdf(name).read_text()
    if angles == "written out":
        oracle, tolerance = from_urdf(written_out(text), robot), ROUNDING
    else:
        oracle = from_urdf(text, robot)
        tolerance = 5e-10 if name == "kinova" else ROUNDED_ANGLES
    assert set(oracle.model.names) - {"universe"} == {j.name for j in robot.joints if j.moves}
    # a kernel a frame: some of Talos's will do
    some = robot.frame_names[::8] if name == "talos" else None
    assert_agrees(robot, oracle, random_state(robot, rng, 5), tolerance, some)


def test_angles_that_were_written_out():
    """The pattern above finds what it should, or the test would compare the same text twice."""
    assert written_out('"-1.57079632679 3.14159265359 1.5708"') == (f'"-{pi / 2!r} {pi!r} 1.5708"')
    assert written_out(urdf("ur5").read_text()) != urdf("ur5").read_text()


def test_gripper_that_mimics(rng):
    """Panda's second finger follows the first; Pinocchio's own mimic joints against ours."""
    robot, path = loaded("panda"), str(urdf("panda"))
    model = pin.buildModelFromUrdf(path, mimic=True)
    data = model.createData()
    assert robot.n == model.nv == 8
    for q, qd, qdd in zip(*random_state(robot, rng, 5), strict=True):
        tau = pin.rnea(model, data, q, qd, qdd)
        assert apart(robot.inverse_dynamics(q, qd, qdd), tau) <= ROUNDED_ANGLES
        M = np.triu(pin.crba(model, data, q))
        assert apart(robot.mass_matrix(q), M + np.triu(M, 1).T) <= ROUNDED_ANGLES


def test_gripper_whose_fingers_are_independent(rng):
    robot = loaded("panda", mimic=False)
    assert robot.n == 9
    oracle = from_urdf(written_out(urdf("panda").read_text()), robot)
    assert_agrees(robot, oracle, random_state(robot, rng), ROUNDING, ["panda_leftfinger"])


# -- random trees ---------------------------------------------------------------------------------


def knobs(seed):
    rng = np.random.default_rng([seed, 1])
    return {
        "bodies": 12 if seed % 20 == 19 else int(rng.integers(1, 8)),
        "branching": rng.choice([0.0, 0.3, 1.0]),
        "prismatic": rng.choice([0.0, 0.3, 0.3, 1.0]),
        "armature": rng.choice([0.0, 0.5, 1.0]),
        "mimic": rng.choice([0.0, 0.0, 0.3, 0.7]),
        "fixed": rng.choice([0.0, 0.4, 0.6]),
        "aligned": rng.choice([0.0, 0.5, 1.0]),
    }


@pytest.mark.parametrize("tens", range(20))
def test_random_trees_interpreted(tens, rng):
    for seed in range(10 * tens, 10 * tens + 10):
        robot = interpreted(random_tree(seed, **knobs(seed)))
        states = random_state(robot, rng, 1)
        assert_agrees(robot, from_description(robot), states, ROUNDING, ["camera"])


@pytest.mark.parametrize("seed", range(200, 208))
def test_random_trees_compiled(seed, rng):
    robot = random_tree(seed, **knobs(seed))
    states = random_state(robot, rng, 3)
    assert_agrees(robot, from_description(robot), states, ROUNDING, ["tool", "camera"])


def test_random_trees_are_what_they_should_be():
    """Among the trees above are all the things that tests on them claim to cover."""
    robots = [random_tree(seed, **knobs(seed)) for seed in range(200)]
    joints = [joint for robot in robots for joint in robot.joints]
    by_name = [{joint.name: joint for joint in robot.joints} for robot in robots]
    followers = [joint for joint in joints if joint.mimic]
    assert {joint.kind for joint in joints} == {"revolute", "continuous", "prismatic", "fixed"}
    assert any(
        table[joint.mimic.joint].mimic
        for table in by_name
        for joint in table.values()
        if joint.mimic
    )
    assert any(joint.mimic.multiplier < 0 for joint in followers)
    assert any(joint.mimic.multiplier not in (1, -1) and joint.mimic.offset for joint in followers)
    assert {joint.kind == "prismatic" for joint in followers} == {True, False}
    assert any(joint.armature > 0 for joint in joints if not joint.mimic)
    assert any(joint.armature > 0 for joint in followers)
    assert {robot.n for robot in robots} >= set(range(1, 8)) | {12}
    assert sum(len(set(joint.axis)) == 3 for joint in joints) > 100
    assert any(len({body.parent for body in robot.mechanism.bodies}) == 1 for robot in robots)
    for robot in robots:
        inertias = {link.name: link.inertia for link in robot.links}
        sides = {
            (inertias[joint.parent] is not None, inertias[joint.child] is not None)
            for joint in robot.joints
            if not joint.moves
        }
        if len(sides) == 4:
            break
    else:
        raise AssertionError("no tree has fixed joints with and without inertia on either side")
