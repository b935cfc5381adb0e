"""Frames that follow positions and poses, and press against walls."""

import numpy as np
import pytest
from steering import HOME, falls_as_told, panda

import mcgee
from mcgee.control import HybridForcePosition, OperationalSpace, Quintic, Wall
from mcgee.control.rotation import rotation_vector
from mcgee.control.task import Frame, task_inertia
from mcgee.simulate import simulate
from robots import loaded, random_tree

AT_HOME = panda().forward_kinematics(HOME)
UR5_HOME = np.array([0.2, -1.2, 1.5, -1.0, -1.3, 0.4])


def turn(v) -> np.ndarray:
    """The rotation by a rotation vector (Rodrigues)."""
    angle = np.linalg.norm(v)
    x, y, z = np.asarray(v) / (angle or 1.0)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * (K @ K)


def moved(T, way, v) -> np.ndarray:
    goal = T.copy()
    goal[:3, 3] += way
    goal[:3, :3] = turn(v) @ goal[:3, :3]
    return goal


# -- kinematics -----------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-5, 0.3, 2.0, 3.1, np.pi - 1e-5, np.pi - 1e-9])
def test_rotation_vectors(angle, rng):
    axes = rng.normal(size=(20, 3))
    v = angle * axes / np.linalg.norm(axes, axis=1, keepdims=True)
    found = rotation_vector(np.array([turn(row) for row in v]))
    tolerance = 1e-7 if angle > 3 else 1e-12
    assert np.linalg.norm(found, axis=1) == pytest.approx(np.full(20, angle), abs=1e-9)
    either = np.minimum(abs(found - v).max(1), abs(found + v).max(1) + (angle < np.pi - 1e-7))
    assert either.max() < tolerance


def test_half_turns_have_an_axis():
    for axis in np.eye(3):
        assert abs(rotation_vector(2 * np.outer(axis, axis) - np.eye(3))) == pytest.approx(
            np.pi * axis
        )


ROBOTS = {
    "panda": (panda(), None),
    "a link of the ur5e": (mcgee.arms.ur5e(), "forearm_link"),
    "a tool, with followers": (random_tree(3, bodies=6, mimic=0.4), "tool"),
    "a frame on a massless link": (loaded("ur5"), "ee_link"),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_drift_is_the_derivative_of_the_jacobian(name, rng):
    arm, frame = ROBOTS[name]
    seen, h = Frame(arm, frame), 1e-6
    q, qd = rng.normal(size=(2, 2, arm.n))
    dJ = (seen.jacobian(q + h * qd) - seen.jacobian(q - h * qd)) / (2 * h)
    want = (dJ @ qd[..., None])[..., 0]
    assert seen.drift(q, qd) == pytest.approx(want, abs=1e-8 * (1 + abs(want).max()))


def test_a_damped_inverse_is_an_inverse_away_from_singularities(rng):
    B = rng.normal(size=(3, 3))
    A = B @ B.T + np.eye(3)
    assert task_inertia(A, 1e-3) == pytest.approx(np.linalg.inv(A))
    thin = np.diag([1.0, 1e-6, 0.0])
    assert task_inertia(thin, 1e-3) == pytest.approx(np.diag([1, 1e-6 / 2.5e-7, 0]), rel=1e-5)
    edge = [task_inertia(np.diag([s]), 1e-3)[0, 0] for s in (0.999999e-3, 1.000001e-3)]
    assert edge[0] == pytest.approx(edge[1], rel=1e-5)


# -- motion ---------------------------------------------------------------------------------------


def test_a_pose_is_reached_as_the_theory_says():
    goal = moved(AT_HOME, [0.1, -0.2, -0.1], [0.3, -0.5, 0.6])
    law = OperationalSpace(panda(), goal, 100.0, 20.0)
    found = simulate(panda(), HOME, np.zeros(7), 0.5, law, step=5e-4)
    assert falls_as_told(found, 3e-5)
    t, e0 = found.t[:, None], found.log["error"][0]
    exact = e0 * (1 + 10 * t) * np.exp(-10 * t)  # a turn about one axis is linear as well
    assert abs(found.log["error"] - exact).max() < 1e-7
    assert found.log["least"].min() > 1e-3
    end = simulate(panda(), HOME, np.zeros(7), 2.0, law, rtol=1e-7).q[-1]
    assert abs(panda().forward_kinematics(end) - goal).max() < 1e-5


def test_a_link_of_a_ur5e_follows_a_line():
    arm = mcgee.arms.ur5e()
    x0 = arm.forward_kinematics(UR5_HOME, "wrist_1_link")[:3, 3]
    line = Quintic(x0, np.add(x0, [0.1, 0.1, -0.15]), 1.5)
    law = OperationalSpace(arm, line, 50.0, 14.0, "wrist_1_link", damping=5.0)
    found = simulate(arm, UR5_HOME, np.zeros(6), 2.0, law)
    assert abs(found.log["error"]).max() < 1e-7
    x = arm.forward_kinematics(found.q, "wrist_1_link")[..., :3, 3]
    assert abs(x - line(found.t).q).max() < 1e-7
    assert abs(found.qd[-1]).max() < 0.1  # what does not move the frame is damped


def test_a_pose_that_moves_is_followed():
    """A tool that turns about the vertical while it goes round."""
    rate = 0.5

    def goal(t):
        c, s = np.cos(rate * t), np.sin(rate * t)
        way = 0.1 * np.array([c - 1, s, 0.0])
        velocity = 0.1 * rate * np.array([-s, c, 0.0])
        acceleration = 0.1 * rate**2 * np.array([-c, -s, 0.0])
        still = np.zeros(3)
        T = moved(AT_HOME, way, [0, 0, rate * t])
        twist = np.concatenate([velocity, [0, 0, rate]])
        return T, twist, np.concatenate([acceleration, still])

    law = OperationalSpace(panda(), goal, 100.0, 20.0)
    qd0 = np.linalg.pinv(panda().jacobian(HOME)) @ goal(0.0)[1]
    found = simulate(panda(), HOME, qd0, 2.0, law)
    assert abs(found.log["error"]).max() < 1e-7


def test_a_posture_moves_what_the_frame_leaves_free():
    posture = np.add(HOME, [0.5, 0, -0.5, 0, 0, 0, 0])
    x = AT_HOME[:3, 3]
    law = OperationalSpace(panda(), x, 100.0, 20.0, posture=posture, posture_gain=9.0, damping=6.0)
    found = simulate(panda(), HOME, np.zeros(7), 4.0, law, rtol=1e-7)
    assert abs(found.log["error"]).max() < 1e-6
    assert np.linalg.norm(found.q[-1] - posture) < 0.6 * np.linalg.norm(HOME - posture)


def test_singular_arms_stay_calm():
    """A stretched planar arm is asked for what it cannot do, out of its plane among it."""
    arm = mcgee.arms.planar_2r()
    law = OperationalSpace(arm, [3.0, 0.0, 1.0], 25.0, 10.0, singular=0.1)
    found = simulate(arm, [0.4, 0.6], [0, 0], 6.0, law, rtol=1e-6)
    tip = arm.forward_kinematics(found.q[-1])[:3, 3]
    assert tip == pytest.approx([2, 0, 0], abs=0.05)
    assert found.log["least"] == pytest.approx(np.zeros(501), abs=1e-12)
    assert abs(found.tau).max() < 1e3


# -- force ----------------------------------------------------------------------------------------

TABLE = Wall(panda(), AT_HOME[:3, 3] - [0, 0, 0.02], [0, 0, 2.0], stiffness=2e4)


def circle(t):
    c, s = np.cos(t), np.sin(t)
    way = 0.05 * np.array([1 - c, s, 0])
    return AT_HOME[:3, 3] + way, 0.05 * np.array([s, c, 0]), 0.05 * np.array([c, -s, 0])


@pytest.mark.parametrize("reference", [circle, AT_HOME], ids=["a circle", "a pose"])
def test_a_force_is_held_while_the_frame_moves(reference):
    law = HybridForcePosition(panda(), reference, [0, 0, 1], 20.0, TABLE.force, 100.0, 20.0)
    found = simulate(panda(), HOME, np.zeros(7), 5.0, law, disturbance=TABLE, rtol=1e-7)
    late = found.t > 4
    assert abs(found.log["force_error"][late]).max() < 0.05
    assert abs(found.log["error"][late]).max() < 1e-5
    assert (found.log["force"] > 0)[found.t > 1].all()
    tip = panda().forward_kinematics(found.q[-1])[2, 3]
    assert TABLE.point[2] - tip == pytest.approx(20.0 / 2e4, rel=0.01)


def test_a_force_may_change():
    law = HybridForcePosition(
        panda(), AT_HOME, [0, 0, 1], lambda t: 10.0 + 5 * (t > 3), TABLE.force, 100, 20, kf=1.0
    )
    found = simulate(panda(), HOME, np.zeros(7), 6.0, law, disturbance=TABLE, rtol=1e-6, step=0.02)
    assert found.log["force"][found.t < 2.99][-1] == pytest.approx(10, abs=0.1)
    assert found.log["force"][-1] == pytest.approx(15, abs=0.1)


def test_a_slanted_wall_of_a_ur5e():
    arm, normal = mcgee.arms.ur5e(), np.array([1.0, 0.4, 0.5])
    x = arm.forward_kinematics(UR5_HOME)[:3, 3]
    wall = Wall(arm, x, normal, stiffness=5e3)
    law = HybridForcePosition(arm, x, normal, 15.0, wall.force, 64.0, 16.0)
    found = simulate(arm, UR5_HOME, np.zeros(6), 4.0, law, disturbance=wall, rtol=1e-7)
    assert found.log["force"][-1] == pytest.approx(15.0, abs=0.02)
    assert abs(found.log["error"][-1]).max() < 1e-4


def test_force_acts_as_the_law_says(rng):
    """f_c = f_d + ki z + kf (f_d − f), and z waits away from the surface."""
    held = {"f": [0.0, 0.0, 3.0]}
    law = HybridForcePosition(
        panda(), AT_HOME[:3, 3], [0, 0, 1], 5.0, lambda q, qd: held["f"], 9.0, 6.0, 4.0, kf=0.5
    )
    none = HybridForcePosition(
        panda(), AT_HOME[:3, 3], [0, 0, 1], 5.0, lambda q, qd: held["f"], 9.0, 6.0, 4.0
    )
    q, qd, z = HOME + 0.1 * rng.normal(size=7), rng.normal(size=7), np.array([0.3])
    J = panda().jacobian(q)[2]
    zero = np.zeros(1)
    integral = none.effort(0.0, q, qd, z) - none.effort(0.0, q, qd, zero)
    assert integral == pytest.approx(-J * 4.0 * 0.3)
    proportional = law.effort(0.0, q, qd, z) - none.effort(0.0, q, qd, z)
    assert proportional == pytest.approx(-J * 0.5 * (5.0 - 3.0))
    assert law.slope(0.0, q, qd, z) == pytest.approx([2.0])
    for away in ([0.0, 0.0, 0.0], [0.0, 0.0, -1.0]):
        held["f"] = away
        assert law.slope(0.0, q, qd, z) == pytest.approx([0.0])


def test_walls_push_and_never_pull(rng):
    arm = mcgee.arms.planar_2r()
    wall = Wall(arm, [1.0, 0, 0], [-1, 0, 0], stiffness=100.0, damping=0.5)
    q, qd = np.array([0.1, 0.0]), np.array([0.0, 0.3])
    depth = arm.forward_kinematics(q)[0, 3] - 1
    rate = (arm.jacobian(q) @ qd)[0]
    size = 100 * depth * (1 + 0.5 * rate)
    assert wall.force(q, qd) == pytest.approx([-size, 0, 0])
    assert wall(0.0, q, qd) == pytest.approx(arm.jacobian(q)[:3].T @ [-size, 0, 0])
    assert not wall.force(q, -1e3 * arm.jacobian(q)[0]).any()  # drawn away faster than it follows
    assert not wall.force([2.0, 0.0], qd).any()
    assert wall.force(rng.normal(size=(4, 3, 2)), rng.normal(size=(4, 3, 2))).shape == (4, 3, 3)
    assert (wall.force(rng.normal(size=(99, 2)), 9 * rng.normal(size=(99, 2)))[:, 0] <= 0).all()


@pytest.mark.parametrize("kind", ["operational", "hybrid"])
def test_a_batch_is_its_members(kind, rng):
    law = {
        "operational": OperationalSpace(panda(), AT_HOME, 9.0, 6.0, posture=HOME),
        "hybrid": HybridForcePosition(panda(), circle, [0, 1, 1], 5.0, TABLE.force, 9.0, 6.0),
    }[kind]
    q, qd = HOME + 0.2 * rng.normal(size=(2, 3, 7)), rng.normal(size=(2, 3, 7))
    z = law.start(q, qd) + 0.1
    tau, slope, log = law.effort(0.7, q, qd, z), law.slope(0.7, q, qd, z), law.log(0.7, q, qd, z)
    for k in np.ndindex(2, 3):
        one = q[k], qd[k], z[k]
        assert tau[k] == pytest.approx(law.effort(0.7, *one), rel=1e-9, abs=1e-9)
        assert slope[k] == pytest.approx(law.slope(0.7, *one), rel=1e-9)
        for key, value in law.log(0.7, *one).items():
            assert log[key][k] == pytest.approx(value, rel=1e-9, abs=1e-12)
