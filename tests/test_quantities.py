"""The quantities as plain functions of a mechanism, where no law or oracle looks."""

import inspect

import numpy as np
import pytest

from mcgee import build
from mcgee import quantities as on
from mcgee.algorithms.aba import aba
from mcgee.algorithms.linear import solve
from mcgee.kernels import Quantity
from mcgee.parametric import Parametric
from mcgee.robot import Robot
from robots import apart, interpreted, random_state, random_tree

ROUNDING = 1e-13
"""Of the largest element; forward dynamics passes the rounding of tau through M⁻¹."""


@pytest.fixture(params=range(4), ids="tree {}".format)
def tree(request):
    return random_tree(request.param, bodies=6, mimic=[0.0, 0.4][request.param % 2])


def state_of(robot, seed=0):
    return [list(row[0]) for row in random_state(robot, np.random.default_rng(seed), 1)]


def test_every_signature_is_that_of_its_function():
    for name, signature in build.SIGNATURES.items():
        parameters = list(inspect.signature(getattr(on, name)).parameters)
        assert tuple(parameters[1 : 1 + len(signature.inputs)]) == signature.inputs
        method = list(inspect.signature(getattr(Robot, name)).parameters)
        assert tuple(method[1 : 1 + len(signature.inputs)]) == signature.inputs


def test_every_parametric_signature_is_that_of_its_method():
    for name, signature in build.PARAMETRIC.items():
        method = list(inspect.signature(getattr(Parametric, name)).parameters)
        assert tuple(method[1:-1]) == signature.inputs
        assert signature.inputs[-1] == "parameters"
        assert "parameters: (..., 10 bodies)" in getattr(Parametric, name).__doc__


def test_every_quantity_documents_its_shape():
    for name in build.SIGNATURES:
        assert "(..." in getattr(Robot, name).__doc__, name
        assert "Returns: " in getattr(Robot, name).__doc__, name


def test_only_named_quantities_are_compiled():
    bound = {name for name, method in vars(Robot).items() if isinstance(method, Quantity)}
    assert set(build.SIGNATURES) - bound == set(build.OF_A_FRAME)
    assert set(build.OF_A_FRAME) == {"forward_kinematics", "jacobian"}
    parametric = {name for name, method in vars(Parametric).items() if isinstance(method, Quantity)}
    assert set(build.PARAMETRIC) == parametric
    assert set(build.SIGNATURES) - set(build.PARAMETRIC) == {
        *("regressor", "forward_kinematics", "jacobian"),
        *("link_poses", "link_jacobians", "link_accelerations"),
    }


def test_coriolis_does_not_feel_gravity(tree):
    q, qd, _ = state_of(tree)
    heavy = tree.replace(gravity_vector=(0, 0, -1e9))
    assert on.coriolis(tree.mechanism, q, qd) == on.coriolis(heavy.mechanism, q, qd)


def test_articulated_bodies_and_factors_find_the_same_accelerations():
    for seed in range(4):
        robot = random_tree(seed, bodies=6, armature=0.5)
        q, qd, tau = state_of(robot)
        m = robot.mechanism
        bias = on.inverse_dynamics(m, q, qd, [0] * m.n)
        M, rest = on.mass_matrix(m, q), [t - b for t, b in zip(tau, bias, strict=True)]
        size = abs(np.linalg.inv(M)).sum(1).max() * abs(np.array(rest)).max()
        assert apart(aba(m, q, qd, tau), solve(M, rest), size) <= ROUNDING


def test_branches_leave_exact_zeros():
    """Joints on different branches do not feel each other: structurally, not by rounding."""
    robot = random_tree(6, bodies=8, branching=1.0)
    q, qd, _ = state_of(robot)
    m = robot.mechanism
    M, inverse = on.mass_matrix(m, q), on.mass_matrix_inverse(m, q)
    apart_ = [(i, j) for i in range(m.n) for j in range(i) if not on_one_path(m, i, j)]
    assert apart_
    for i, j in apart_:
        assert M[i][j] == M[j][i] == on.coriolis_matrix(m, q, qd)[i][j] == 0
        assert type(M[i][j]) is int
    trees = {i: tree_of(m, i) for i in range(m.n)}
    assert all(inverse[i][j] == 0 for i, j in apart_ if trees[i] != trees[j])


def on_one_path(m, i, j):
    while i > j:
        i = m.bodies[i].parent
    return i == j


def tree_of(m, i):
    while m.bodies[i].parent >= 0:
        i = m.bodies[i].parent
    return i


def test_by_definition_in_floats(tree):
    q, _, _ = state_of(tree)
    M = on.mass_matrix(tree.mechanism, q)
    assert apart(on.mass_matrix_by_definition(tree.mechanism, q), M) <= ROUNDING


def test_links_move_as_their_jacobians_say(tree):
    """Velocity J qd; acceleration its rate, by complex step; M and g from the same Jacobians."""
    m, step = tree.mechanism, 1e-200
    q, qd, qdd = (np.array(x) for x in state_of(tree))
    J = np.array(on.link_jacobians(m, list(q)))
    moved = np.array(on.link_jacobians(m, list(q + 1j * step * qd)))
    rate = np.imag(moved @ (qd + 1j * step * qdd)) / step
    assert apart(on.link_accelerations(m, list(q), list(qd), list(qdd)), rate) <= ROUNDING
    poses = np.array(on.link_poses(m, list(q + 1j * step * qd)), complex)
    assert apart(np.imag(poses[:, :3, 3]) / step, (J @ qd)[:, :3]) <= ROUNDING
    turning = np.imag(poses[:, :3, :3]) / step @ np.real(poses[:, :3, :3]).swapaxes(-1, -2)
    spin = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], -1)
    assert apart(spin, (J @ qd)[:, 3:]) <= ROUNDING
    M, g = np.zeros((m.n, m.n)), np.zeros(m.n)
    for link, Jk, T in zip(m.masses, J, poses.real, strict=True):
        about_com = T[:3, :3] @ np.array(link.inertia.matrix) @ T[:3, :3].T
        M += link.inertia.mass * Jk[:3].T @ Jk[:3] + Jk[3:].T @ about_com @ Jk[3:]
        g -= link.inertia.mass * Jk[:3].T @ np.array(m.gravity)
    for body in m.bodies:
        M[body.coordinate, body.coordinate] += body.armature * body.multiplier**2
    assert apart(on.mass_matrix(m, list(q)), M) <= ROUNDING
    assert apart(on.gravity(m, list(q)), g) <= ROUNDING
    assert tree.moving_links == tuple(link.link for link in m.masses)


def test_gravity_gradient_is_symmetric_and_the_slope_of_gravity(tree):
    m, step = tree.mechanism, 1e-200
    q = np.array(state_of(tree)[0])
    slopes = [np.imag(on.gravity(m, list(q + 1j * step * e))) / step for e in np.eye(m.n)]
    gradient = np.array(on.gravity_gradient(m, list(q)))
    assert apart(gradient, np.stack(slopes, -1), 1.0) <= ROUNDING
    assert apart(gradient, gradient.T) <= ROUNDING


def test_interpreted_equals_compiled(rng):
    """What the tests run hundreds of trees on gives what users get."""
    robot = random_tree(12, bodies=4, mimic=0.3)
    twin = interpreted(robot)
    q, qd, qdd = random_state(robot, rng, 6)
    given = {"q": q, "qd": qd, "qdd": qdd, "tau": qdd, "v": qdd}
    for name, signature in build.SIGNATURES.items():
        arrays = [given[wanted] for wanted in signature.inputs]
        got, want = getattr(robot, name)(*arrays), getattr(twin, name)(*arrays)
        for one, other in zip(_parts(got), _parts(want), strict=True):
            assert apart(one, other, 1.0) <= ROUNDING, name
    assert "_ufuncs" not in twin.__dict__


def _parts(result):
    return result if isinstance(result, tuple) else (result,)
