"""The reduction of a description: fixed joints, joint frames, followers, regrouped inertias."""

from dataclasses import replace

import numpy as np
import pytest

from mcgee import quantities as on
from mcgee.algorithms.regroup import regrouped
from mcgee.mechanism import GROUND, Mechanism, depth_first
from mcgee.model import Frame, Inertia, Joint, Link, Mimic, Pose, frame_on_axis
from mcgee.robot import Robot
from robots import AXES, apart, interpreted, random_state, random_tree

ROUNDING = 1e-14
"""Of the largest element: the same sums in another order."""

BOX = Inertia(2.0, (0.1, -0.2, 0.05), (0.3, 0.01, -0.02, 0.25, 0.03, 0.2))
ROD = Inertia(0.7, (0.0, 0.3, 0.1), (0.05, 0.0, 0.01, 0.02, 0.0, 0.06))


def dynamics(robot, q, qd, qdd):
    return robot.inverse_dynamics(q, qd, qdd), robot.mass_matrix(q), robot.gravity(q)


# -- fixed joints ---------------------------------------------------------------------------------


def two_links(first, last, *more, second="prismatic"):
    """A joint, a link, another joint and link; more: what is welded on."""
    links = (Link("base"), Link("a", first), Link("b", last))
    joints = (
        Joint("j0", "revolute", "base", "a", Pose.about("x", 0.4), (0.0, 1.0, 0.0)),
        Joint("j1", second, "a", "b", Pose.at(0.3, 0.1, 0.2), (0.6, 0.0, 0.8)),
    )
    extra_links = tuple(part for part in more if isinstance(part, Link))
    extra_joints = tuple(part for part in more if isinstance(part, Joint))
    return interpreted(Robot("two", links + extra_links, joints + extra_joints))


def test_fixed_joints_merged_equal_bodies_added_by_hand():
    pose = Pose.from_rpy((0.3, -0.2, 1.0), (0.1, 0.2, -0.3))
    # the last of two revolute joints feels all of its link's inertia but one moment
    weld = Link("load", ROD), Joint("weld", "fixed", "b", "load", pose)
    welded = two_links(ROD, BOX, *weld, second="revolute")
    # by hand: total mass, joint centre, parallel axes
    parts = [(BOX, np.eye(3), np.zeros(3)), (ROD, np.array(pose.rotation), pose.translation)]
    m = sum(part.mass for part, _, _ in parts)
    centres = [R @ part.com + p for part, R, p in parts]
    com = sum(part.mass * c for (part, _, _), c in zip(parts, centres, strict=True)) / m
    about = np.zeros((3, 3))
    for (part, R, _), c in zip(parts, centres, strict=True):
        d = c - com
        about += R @ np.array(part.matrix) @ R.T + part.mass * (d @ d * np.eye(3) - np.outer(d, d))
    upper = tuple(about[np.triu_indices(3)].tolist())
    by_hand = two_links(ROD, Inertia(m, tuple(com.tolist()), upper), second="revolute")
    state = random_state(welded, np.random.default_rng(0))
    for got, want in zip(dynamics(welded, *state), dynamics(by_hand, *state), strict=True):
        assert apart(got, want) < ROUNDING
    assert len(welded.mechanism.bodies) == 2


def test_a_fixed_joint_in_the_middle_of_a_chain():
    """Splitting a link into two halves, welded, changes nothing, whatever side carries the mass."""
    cut = Pose.from_rpy((0.3, 0.5, -0.4), (0.05, 0.0, 0.1))
    whole = two_links(BOX, ROD)
    for inertias in ((BOX, None), (None, BOX.seen_from(cut.inverse()))):
        links = (Link("base"), Link("a", inertias[0]), Link("half", inertias[1]), Link("b", ROD))
        j0, j1 = whole.joints
        weld = Joint("weld", "fixed", "a", "half", cut)
        j1 = replace(j1, parent="half", pose=cut.inverse() @ j1.pose)
        split = interpreted(Robot("two", links, (j0, weld, j1)))
        state = random_state(whole, np.random.default_rng(1))
        for got, want in zip(dynamics(split, *state), dynamics(whole, *state), strict=True):
            assert apart(got, want) < ROUNDING
        pose = split.forward_kinematics(state[0], "b")
        assert apart(pose, whole.forward_kinematics(state[0], "b")) < ROUNDING


def test_what_stands_on_the_ground_has_no_part_in_the_dynamics():
    plain = two_links(BOX, ROD)
    pillar = Link("pillar", BOX), Joint("bolts", "fixed", "base", "pillar", Pose.at(z=1.0))
    standing = two_links(BOX, ROD, *pillar)
    assert standing.mechanism.bodies == plain.mechanism.bodies
    assert standing.mechanism.frames["pillar"] == (GROUND, Pose.at(z=1.0))
    assert np.array_equal(standing.forward_kinematics([0.1, 0.2], "pillar")[:3, 3], [0, 0, 1])
    assert not standing.jacobian([0.1, 0.2], "pillar").any()
    assert [mass.link for mass in standing.mechanism.masses] == ["a", "b"]


# -- joint frames ---------------------------------------------------------------------------------


@pytest.mark.parametrize("axis", AXES)
def test_frames_on_coordinate_axes_are_exact(axis):
    R = np.array(frame_on_axis(axis).rotation)
    assert set(abs(R).ravel()) == {0.0, 1.0}
    assert np.array_equal(R[:, 2], axis)
    assert np.linalg.det(R) == 1


def test_frames_on_any_axis_are_rotations():
    rng = np.random.default_rng(2)
    for axis in rng.normal(size=(50, 3)) * [1, 1, 1e-9]:
        axis = axis / np.linalg.norm(axis)
        R = np.array(frame_on_axis(tuple(axis)).rotation)
        assert np.array_equal(R[:, 2], axis)
        assert apart(R @ R.T, np.eye(3)) < 1e-15
        assert np.linalg.det(R) == pytest.approx(1, abs=1e-15)


def test_links_keep_their_own_frames():
    """The canonical joint frame is inside; the poses asked for are the description's."""
    robot = two_links(BOX, ROD)
    at_zero = Pose.about("x", 0.4) @ Pose.at(0.3, 0.1, 0.2)
    T = robot.forward_kinematics([0.0, 0.0], "b")
    assert apart(T[:3, :3], np.array(at_zero.rotation)) < 1e-15
    assert apart(T[:3, 3], np.array(at_zero.translation)) < 1e-15
    slid = robot.forward_kinematics([0.0, 0.5], "b")
    assert apart(slid[:3, 3] - T[:3, 3], T[:3, :3] @ [0.3, 0.0, 0.4]) < 1e-15


def test_child_poses_come_behind_the_joint():
    """A joint, then a displacement, is a joint and a fixed joint."""
    behind = Pose.from_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    joint = Joint("j", "revolute", "base", "a", Pose.at(x=1.0), (0.0, 0.6, 0.8))
    one = Robot("one", (Link("base"), Link("a", BOX)), (replace(joint, child_pose=behind),))
    links = (Link("base"), Link("hub"), Link("a", BOX))
    joints = (replace(joint, child="hub"), Joint("weld", "fixed", "hub", "a", behind))
    other = Robot("other", links, joints)
    one, other = interpreted(one), interpreted(other)
    q = np.linspace(-3, 3, 5)[:, None]
    assert apart(one.forward_kinematics(q, "a"), other.forward_kinematics(q, "a")) < ROUNDING
    for got, want in zip(dynamics(one, q, q, q), dynamics(other, q, q, q), strict=True):
        assert apart(got, want) < ROUNDING


def test_coordinates_go_depth_first_whatever_the_order_of_the_file():
    robot = random_tree(4, bodies=9, branching=0.6)
    order = [joint.name for joint in depth_first(robot.links, robot.joints) if joint.moves]
    assert list(robot.joint_names) == order
    parents = [body.parent for body in robot.mechanism.bodies]
    assert all(parent < i for i, parent in enumerate(parents))
    for i, parent in enumerate(parents):  # a subtree's bodies are consecutive
        while parent >= 0:
            assert all(under(parents, j, parent) for j in range(parent + 1, i))
            parent = parents[parent]


def under(parents, body, ancestor):
    while body > ancestor:
        body = parents[body]
    return body == ancestor


# -- followers ------------------------------------------------------------------------------------


def followers(chain):
    """A chain of three joints, the later ones following as told, and the same set free."""
    links = (Link("base"), Link("a", BOX), Link("b", ROD), Link("c", BOX))
    kinds, mimics = ("revolute", "revolute", "prismatic"), (None, *chain)
    joints = tuple(
        Joint(f"j{i}", kind, links[i].name, links[i + 1].name, Pose.at(0.2, 0.1 * i, 0.3), axis,
              armature=0.1 * (i + 1), mimic=mimic)
        for i, (kind, axis, mimic) in enumerate(zip(kinds, AXES[1:6:2], mimics, strict=True))
    )  # fmt: skip
    free = tuple(replace(joint, mimic=None) for joint in joints)
    return interpreted(Robot("led", links, joints)), interpreted(Robot("free", links, free))


@pytest.mark.parametrize(
    ("chain", "A", "b"),
    [
        ((Mimic("j0", 2.0, 0.3), None), [[1, 0], [2, 0], [0, 1]], [0, 0.3, 0]),
        ((Mimic("j0", -1.0), None), [[1, 0], [-1, 0], [0, 1]], [0, 0, 0]),
        ((Mimic("j0", -0.5, 1.0), Mimic("j0", 0.1)), [[1], [-0.5], [0.1]], [0, 1, 0]),
        ((Mimic("j0", 2.0, 0.3), Mimic("j1", -0.5, 0.1)), [[1], [2], [-1]], [0, 0.3, -0.05]),
        ((Mimic("j2", 3.0), Mimic("j0", 0.1, 0.2)), [[1], [0.3], [0.1]], [0, 0.6, 0.2]),
    ],
    ids=["factor and offset", "opposed", "two of one", "chain", "leader behind its follower"],
)
def test_followers_project(chain, A, b):
    """q_joints = A q + b: M = Aᵀ M A, C = Aᵀ C A, g = Aᵀ g, and the Jacobian J A."""
    led, free = followers(chain)
    A, b = np.array(A, float), np.array(b)
    assert led.n == A.shape[1]
    q, qd, qdd = random_state(led, np.random.default_rng(3))
    joints = q @ A.T + b, qd @ A.T, qdd @ A.T
    assert apart(led.mass_matrix(q), A.T @ free.mass_matrix(joints[0]) @ A) < ROUNDING
    C = A.T @ free.coriolis_matrix(*joints[:2]) @ A
    assert apart(led.coriolis_matrix(q, qd), C, 1.0) < ROUNDING
    assert apart(led.gravity(q), free.gravity(joints[0]) @ A) < ROUNDING
    assert apart(led.inverse_dynamics(q, qd, qdd), free.inverse_dynamics(*joints) @ A) < ROUNDING
    c = np.einsum("...abc,ai,bj,ck->...ijk", free.christoffel(joints[0]), A, A, A)
    assert apart(led.christoffel(q), c, 1.0) < ROUNDING
    assert apart(led.jacobian(q, "c"), free.jacobian(joints[0], "c") @ A) < ROUNDING
    pose = free.forward_kinematics(joints[0], "c")
    assert apart(led.forward_kinematics(q, "c"), pose) < ROUNDING
    assert apart(led.kinetic_energy(q, qd), free.kinetic_energy(*joints[:2])) < ROUNDING
    assert apart(led.potential_energy(q), free.potential_energy(joints[0])) < ROUNDING


def test_symmetric_to_the_last_bit_with_followers():
    for seed in range(10):
        robot = interpreted(random_tree(seed, bodies=7, mimic=0.5))
        q, _, _ = random_state(robot, np.random.default_rng(seed))
        M, inverse, c = robot.mass_matrix(q), robot.mass_matrix_inverse(q), robot.christoffel(q)
        for array in (M, inverse, c):
            assert np.array_equal(array, array.swapaxes(-1, -2))


# -- regrouped inertias ---------------------------------------------------------------------------


@pytest.mark.parametrize("prismatic", [0.0, 0.4, 1.0])
def test_regrouped_inertias_move_alike(prismatic):
    for seed in range(6):
        robot = random_tree(seed, bodies=6, prismatic=prismatic, mimic=0.3, armature=0.5)
        full = robot.mechanism
        light = regrouped(full)
        for state in zip(*random_state(robot, np.random.default_rng(seed), 2), strict=True):
            q, qd, qdd = (list(x) for x in state)
            M, C = on.mass_matrix(full, q), on.coriolis_matrix(full, q, qd)
            size = abs(np.array(M)).max()
            assert apart(on.mass_matrix(light, q), M) < ROUNDING
            assert apart(on.coriolis_matrix(light, q, qd), C, size) < ROUNDING
            assert apart(on.gravity(light, q), on.gravity(full, q), 9.81) < ROUNDING
            tau = on.inverse_dynamics(full, q, qd, qdd)
            assert apart(on.inverse_dynamics(light, q, qd, qdd), tau, size) < ROUNDING
            T = on.kinetic_energy(full, q, qd)
            assert on.kinetic_energy(light, q, qd) == pytest.approx(T, rel=1e-13)


def test_regrouping_empties_what_the_joint_cannot_tell():
    robot = random_tree(1, bodies=6, prismatic=0.5, branching=0.0)
    light = regrouped(robot.mechanism)
    kinds = {body.prismatic for body in light.bodies}
    assert kinds == {True, False}
    for body in light.bodies:
        if body.prismatic:
            assert body.inertia == (0,) * 6
        else:
            assert body.mass == body.first_moment[2] == body.inertia[3] == 0


# -- other numbers --------------------------------------------------------------------------------


def test_map_converts_every_number():
    robot = random_tree(2, bodies=4, mimic=0.3)
    doubled = robot.mechanism.map(lambda x: 2 * x)
    assert isinstance(doubled, Mechanism)
    for body, other in zip(robot.mechanism.bodies, doubled.bodies, strict=True):
        assert other.mass == 2 * body.mass
        assert other.multiplier == 2 * body.multiplier
        assert other.inertia == tuple(2 * v for v in body.inertia)
        assert other.pose.translation == tuple(2 * v for v in body.pose.translation)
        assert (other.name, other.parent, other.prismatic) == (
            body.name, body.parent, body.prismatic
        )  # fmt: skip
    assert doubled.gravity == tuple(2 * v for v in robot.mechanism.gravity)
    assert doubled.masses[0].inertia.mass == 2 * robot.mechanism.masses[0].inertia.mass
    assert robot.mechanism.map(lambda x: x) == robot.mechanism


def test_named_frames_ride_on_their_links():
    robot = two_links(BOX, ROD)
    tool = Frame("tool", "b", Pose.about("y", 0.3) @ Pose.at(z=0.2))
    robot = interpreted(replace(robot, frames=(tool,)))
    q = [0.4, -0.1]
    T = robot.forward_kinematics(q, "b")
    offset = np.eye(4)
    offset[:3, :3], offset[:3, 3] = tool.pose.rotation, tool.pose.translation
    assert apart(robot.forward_kinematics(q, "tool"), T @ offset) < 1e-15
