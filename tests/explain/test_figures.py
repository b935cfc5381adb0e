"""Every figure against formulas by hand (the planar 2R arm) and against Pinocchio (the Panda)."""

import numpy as np
import pinocchio as pin
import pytest

import mcgee
from mcgee.explain.gravity import worst_gravity
from mcgee.explain.velocity import energy_flow
from mcgee.explain.workspace import sweep

EXACT = 1e-12
"""Of the largest figure of its kind: sums of parts, and formulas of a few operations."""

M1, M2, L1, LC1, LC2, I1, I2, G0 = 1.3, 0.8, 1.1, 0.6, 0.4, 0.12, 0.07, 9.81
Q, QD, QDD = np.array([0.5, 0.7]), np.array([0.9, -1.7]), np.array([0.4, 2.0])


@pytest.fixture(scope="module")
def two():
    return mcgee.arms.planar_2r(m1=M1, m2=M2, l1=L1, lc1=LC1, lc2=LC2, I1=I1, I2=I2, g0=G0).explain(
        Q, QD, QDD
    )


@pytest.fixture(scope="module")
def panda():
    rng = np.random.default_rng(3)
    q, qd, qdd = rng.uniform(-1, 1, (3, 7))
    return mcgee.load("panda").explain(q, qd, qdd)


@pytest.fixture(scope="module")
def peer(panda):
    """Pinocchio's model of the same URDF, and its data at the state."""
    from importlib.resources import files

    model = pin.buildModelFromUrdf(str(files("mcgee") / "robots" / "panda.urdf"))
    data = model.createData()
    pin.computeAllTerms(model, data, panda.q, panda.qd)
    pin.updateFramePlacements(model, data)
    return model, data


def close(a, b, relative=EXACT):
    np.testing.assert_allclose(a, b, rtol=0, atol=relative * max(abs(np.asarray(b)).max(), 1e-300))


# -- inertia --------------------------------------------------------------------------------------

C2, S2 = np.cos(Q[1]), np.sin(Q[1])
M11 = I1 + I2 + M1 * LC1**2 + M2 * (L1**2 + LC2**2 + 2 * L1 * LC2 * C2)
M12 = I2 + M2 * (LC2**2 + L1 * LC2 * C2)
M22 = I2 + M2 * LC2**2


def test_felt_inertia_of_the_planar_arm(two):
    f = two.inertia
    determinant = M11 * M22 - M12**2
    close(f.locked, [M11, M22])
    close(f.free, [determinant / M22, determinant / M11])
    close(f.ratio, 1 - f.hidden)
    close(f.hidden, [M12**2 / (M11 * M22)] * 2)
    close(f.coupling[0, 1], M12 / np.sqrt(M11 * M22))
    middle, half = (M11 + M22) / 2, np.hypot((M11 - M22) / 2, M12)
    close(f.principal, [middle - half, middle + half], 1e-11)
    close(f.condition, (middle + half) / (middle - half), 1e-11)
    for value, v in zip(f.principal, f.directions.T, strict=True):
        close(f.M @ v, value * v)


def test_torque_columns_are_the_lessons_fifth_exercise(two):
    columns = two.inertia.torque_columns([2.0, 3.0])
    close(columns, [[2 * M11, 3 * M12], [2 * M12, 3 * M22]])
    arm = two.robot
    for j, alpha in enumerate(np.diag([2.0, 3.0])):
        alone = arm.inverse_dynamics(Q, [0, 0], alpha) - arm.gravity(Q)
        close(columns[:, j], alone)


def test_what_each_link_adds_to_the_planar_arm(two):
    f = two.inertia
    assert f.links == ("link1", "link2")
    close(f.translation[0], [[M1 * LC1**2, 0], [0, 0]])
    close(f.rotation[0], [[I1, 0], [0, 0]])
    reach = M2 * (L1**2 + LC2**2 + 2 * L1 * LC2 * C2)
    cross = M2 * (LC2**2 + L1 * LC2 * C2)
    close(f.translation[1], [[reach, cross], [cross, M2 * LC2**2]])
    close(f.rotation[1], np.full((2, 2), I2))


def test_slope_of_the_planar_arm(two):
    slope = -M2 * L1 * LC2 * S2
    expected = np.zeros((2, 2, 2))
    expected[..., 1] = [[2 * slope, slope], [slope, 0]]
    close(two.inertia.slope, expected)
    assert two.inertia.fastest.tolist() == [[1, 1], [1, -1]]


def test_parts_of_inertia_sum_to_it(panda):
    f = panda.inertia
    close(f.translation.sum(0) + f.rotation.sum(0) + f.armature, f.M)


def test_inertia_of_the_panda(panda, peer):
    model, data = peer
    M = np.triu(data.M) + np.triu(data.M, 1).T
    close(panda.inertia.M, M)
    close(panda.inertia.free, 1 / np.diag(np.linalg.inv(M)), 1e-10)
    h, slope = 1e-5, np.empty((7, 7, 7))
    for k, e in enumerate(np.eye(7)):
        up, down = (pin.crba(model, data, panda.q + s * h * e).copy() for s in (1, -1))
        slope[..., k] = (up - down) / (2 * h)
    upper = np.triu_indices(7)
    close(panda.inertia.slope[upper], slope[upper], 1e-8)


def test_armature_is_part_of_the_sum():
    e = mcgee.load("puma560").explain(np.linspace(-1, 1, 6))
    f = e.inertia
    close(f.translation.sum(0) + f.rotation.sum(0) + f.armature, f.M)
    assert (np.diag(f.armature) > 0).all()


def test_a_hand_on_the_panda(panda, peer):
    model, data = peer
    frame = model.getFrameId(panda.task.frame)
    J = pin.computeFrameJacobian(model, data, panda.q, frame, pin.LOCAL_WORLD_ALIGNED)
    M = pin.crba(model, data, panda.q)
    M = np.triu(M) + np.triu(M, 1).T
    mobility = J @ np.linalg.solve(M, J.T)
    close(panda.task.mobility, mobility, 1e-9)
    close(panda.task.operational_inertia, np.linalg.inv(mobility), 1e-8)
    inertia = np.linalg.inv(mobility[:3, :3])
    close(panda.task.inertia, inertia, 1e-9)
    close(np.sort(panda.task.masses), np.linalg.eigvalsh(inertia), 1e-9)
    u = np.array([1.0, 2.0, -0.5])
    u /= np.linalg.norm(u)
    close(panda.task.effective_mass(3 * u), 1 / (u @ mobility[:3, :3] @ u), 1e-9)
    reach = J[:3] @ np.linalg.inv(M)
    close(panda.task.manipulability, np.sqrt(np.linalg.det(reach @ reach.T)), 1e-9)


def test_a_hand_on_the_planar_arm_cannot_push_it_out_of_its_plane(two):
    assert two.task.dimensions == 2
    assert two.task.masses[-1] == np.inf
    assert two.task.effective_mass([0, 0, 1]) == np.inf


# -- velocity -------------------------------------------------------------------------------------


def test_velocity_terms_of_the_planar_arm(two):
    v, h = two.velocity, M2 * L1 * LC2 * S2
    close(v.centrifugal, [[0, -h * QD[1] ** 2], [h * QD[0] ** 2, 0]])
    close(v.coriolis[:, 0, 1], [-2 * h * QD[0] * QD[1], 0])
    assert v.residual < EXACT
    # energy that the elbow takes from the shoulder
    close(v.Cqd, [-h * (2 * QD[0] * QD[1] + QD[1] ** 2), h * QD[0] ** 2])
    close(v.half_Mdot_power, QD @ v.Cqd)


def test_velocity_terms_of_the_panda(panda, peer):
    model, data = peer

    def efforts(qd):
        return pin.nonLinearEffects(model, data, panda.q, qd).copy()

    rest = efforts(np.zeros(7))
    alone = np.array([efforts(e) - rest for e in np.diag(panda.qd)])
    close(panda.velocity.centrifugal, alone.T)
    for j in range(7):
        for k in range(j + 1, 7):
            both = efforts(np.eye(7)[j] * panda.qd[j] + np.eye(7)[k] * panda.qd[k]) - rest
            close(panda.velocity.coriolis[:, j, k] + 1, both - alone[j] - alone[k] + 1, 1e-11)


def test_energy_only_moves(panda, two):
    for v in (panda.velocity, two.velocity):
        scale = abs(v.flow).max()
        assert abs(v.power.sum()) < EXACT * scale
        close(v.flow, -v.flow.T)
        close(v.flow.sum(1), v.power)
        assert abs(v.half_Mdot_power - v.C_power) < EXACT * max(scale, abs(v.C_power))
        assert v.skew_residual < EXACT * scale


def test_kinetic_energy_of_each_link(panda, peer):
    model, data = peer
    v = panda.velocity
    close(v.translation.sum() + v.rotation.sum() + v.rotors, v.kinetic_energy)
    pin.forwardKinematics(model, data, panda.q, panda.qd)
    for k, joint in enumerate(range(1, model.njoints)):
        inertia, motion = model.inertias[joint], data.v[joint]
        com = motion.linear + np.cross(motion.angular, inertia.lever)
        close(v.translation[k], 0.5 * inertia.mass * com @ com)
        close(v.rotation[k], 0.5 * motion.angular @ inertia.inertia @ motion.angular)


def test_energy_flow_against_the_forces_between_bodies(panda, peer):
    model, data = peer
    tau = pin.rnea(model, data, panda.q, panda.qd, panda.qdd)
    e = panda.energy
    into = [data.f[i].dot(data.v[i]) for i in range(1, model.njoints)]
    close(e.through + e.actuator, into, 1e-11)
    close(e.actuator, tau * panda.qd, 1e-11)
    beyond = np.append(into[1:], 0)  # a chain: what one takes in, the one before gave
    handed = np.append(e.through[1:], 0)
    close(e.rate, e.through + e.actuator + e.gravity - handed, 1e-11)
    assert len(beyond) == 7
    assert e.residual < 1e-11


def test_energy_flow_with_followers():
    """A joint that follows another has its share of the leader's power."""
    from robots import random_tree

    robot = random_tree(5, bodies=6, mimic=0.5)
    q, qd, qdd = np.random.default_rng(0).normal(size=(3, robot.n))
    e = energy_flow(robot, q, qd, qdd)
    assert robot.mechanism.coupled
    close(e.actuator.sum(), qd @ robot.inverse_dynamics(q, qd, qdd), 1e-10)
    handed = np.zeros(len(e.joints))
    for i, parent in enumerate(e.parents):
        if parent >= 0:
            handed[parent] += e.through[i]
    close(e.rate, e.through + e.actuator + e.gravity - handed, 1e-10)


# -- gravity --------------------------------------------------------------------------------------

C1, C12 = np.cos(Q[0]), np.cos(Q.sum())


def test_gravity_of_the_planar_arm(two):
    g = two.gravity
    close(g.weight, [M1 * G0, M2 * G0])
    close(g.lever, [[LC1 * C1, 0], [L1 * C1 + LC2 * C12, LC2 * C12]])
    close(
        g.parts, [[M1 * G0 * LC1 * C1, 0], [M2 * G0 * (L1 * C1 + LC2 * C12), M2 * G0 * LC2 * C12]]
    )
    close(g.parts.sum(0), g.g)
    close(g.weight[:, None] * g.level * g.lever, g.parts)
    close(g.level, np.ones((2, 2)))
    close(g.height, [LC1 * np.sin(Q[0]), L1 * np.sin(Q[0]) + LC2 * np.sin(Q.sum())])
    close(g.weight @ g.height, g.potential_energy)
    s1, s12 = np.sin(Q[0]), np.sin(Q.sum())
    second = -M2 * G0 * LC2 * s12
    close(g.slope, [[-(M1 * LC1 + M2 * L1) * G0 * s1 + second, second], [second, second]])


def test_gravity_of_the_panda_link_by_link(panda, peer):
    model, _ = peer
    for k in range(7):
        lonely = model.copy()
        for i in range(1, model.njoints):
            if i != k + 1:
                lonely.inertias[i] = pin.Inertia.Zero()
        alone = pin.computeGeneralizedGravity(lonely, lonely.createData(), panda.q)
        close(panda.gravity.parts[k] + 1, alone + 1)
    close(panda.gravity.parts.sum(0), panda.gravity.g)
    close(panda.gravity.share, abs(panda.gravity.g) / model.effortLimit)
    close(panda.gravity.margin, 100 * (1 - panda.gravity.share))


def test_worst_gravity_of_the_planar_arm_is_stretched_and_level(two):
    shoulder, elbow = worst_gravity(two.robot, Q)
    close(shoulder.effort, (M1 * LC1 + M2 * (L1 + LC2)) * G0, 1e-9)
    close(elbow.effort, M2 * LC2 * G0, 1e-9)
    assert abs(np.cos(shoulder.q[0])) == pytest.approx(1, abs=1e-6)
    assert np.cos(shoulder.q[1]) == pytest.approx(1, abs=1e-6)
    assert shoulder.starts >= shoulder.agreeing >= 2


def test_worst_gravity_of_the_panda_is_inside_the_ranges_and_above_every_sample(panda):
    limits = panda.robot.limits
    rng = np.random.default_rng(9)
    poses = rng.uniform(limits.lower, limits.upper, size=(100_000, 7))
    samples = abs(panda.robot.gravity(poses)).max(0)
    for i, worst in enumerate(panda.worst):
        assert worst.effort >= samples[i] - 1e-9
        assert (limits.lower - 1e-9 <= worst.q).all()
        assert (worst.q <= limits.upper + 1e-9).all()
        close(abs(panda.robot.gravity(worst.q)[i]), worst.effort)
        assert worst.limit == limits.effort[i]


# -- the lesson's claims, as results --------------------------------------------------------------


def test_stretching_raises_the_inertia_like_a_skater(two):
    s = sweep(two.robot, Q, ["joint2"], points=361)
    (least, folded), (most, stretched) = s.extremes(s.M[:, 0, 0])
    assert abs(folded[1]) == pytest.approx(np.pi)
    assert stretched[1] == pytest.approx(0, abs=1e-12)
    close(most - least, 4 * M2 * L1 * LC2)


def test_coriolis_terms_vanish_stretched_and_folded(two):
    for q2 in (0.0, np.pi):
        v = two.robot.explain([0.3, q2], QD).velocity
        assert abs(v.Cqd).max() < 1e-14


def test_gravity_vanishes_upright_and_is_largest_level(two):
    arm = two.robot
    assert abs(arm.explain([np.pi / 2, 0]).gravity.g).max() < 1e-14
    s = sweep(arm, np.zeros(2), ["joint1"], points=361)
    (_, _), (_, where) = s.extremes(abs(s.g[:, 0]))
    assert abs(np.cos(where[0])) == pytest.approx(1)


def test_in_the_horizontal_plane_nothing_weighs():
    arm = mcgee.arms.planar_2r(plane="horizontal")
    assert abs(arm.explain(Q, QD).gravity.g).max() == 0


def test_free_motion_keeps_the_kinetic_energy():
    """Without gravity and without efforts: classic Runge-Kutta, and a step that is halved."""
    arm = mcgee.load("panda").replace(gravity_vector=(0, 0, 0))
    rng = np.random.default_rng(1)
    start = rng.normal(size=(2, 7))

    def rate(state):
        return np.stack([state[1], arm.forward_dynamics(state[0], state[1], np.zeros(7))])

    def drift(steps):
        state, h = start, 0.2 / steps
        for _ in range(steps):
            a = rate(state)
            b = rate(state + h / 2 * a)
            c = rate(state + h / 2 * b)
            d = rate(state + h * c)
            state = state + h / 6 * (a + 2 * b + 2 * c + d)
        energy, before = arm.kinetic_energy(*state), arm.kinetic_energy(*start)
        return abs(energy - before) / before

    assert drift(400) < 1e-9
    assert drift(400) < drift(100) / 30


def test_two_conventions_of_one_arm_are_the_lessons_fourth_exercise():
    level, down = mcgee.arms.planar_2r(), mcgee.arms.planar_2r(angle_from="down")
    q = np.array([0.4, 0.3])
    close(level.gravity(q), down.gravity(q + np.array([np.pi / 2, 0])))
    assert abs(level.gravity(q) - down.gravity(q)).max() > 1
