"""Inertial parameters as data and as an argument; operation counts."""

import pickle
import re

import numpy as np
import pytest

from mcgee import arms, build
from mcgee.errors import ModelWarning
from robots import apart, loaded, random_state, random_tree

ROUNDING = 1e-13
"""Of the largest element; forward dynamics passes the rounding of tau through M⁻¹."""


@pytest.fixture(scope="module")
def arm():
    return random_tree(3, bodies=4, prismatic=0.3, armature=0.5, mimic=0.3)


def test_parameters_are_about_the_frame_of_the_link():
    """A link's own numbers, wherever its joint's axis points, with what is fixed to it."""
    robot = loaded("ur5")
    p = robot.inertial_parameters.reshape(-1, 10)
    forearm = next(link for link in robot.links if link.name == "forearm_link").inertia
    m, c = forearm.mass, np.array(forearm.com)
    about = np.array(forearm.matrix) + m * (c @ c * np.eye(3) - np.outer(c, c))
    k = [body.link for body in robot.mechanism.bodies].index("forearm_link")
    xx, xy, yy, xz, yz, zz = p[k, 4:]
    assert apart(p[k, :4], [m, *(m * c)]) <= ROUNDING
    assert apart([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], about) <= ROUNDING
    assert p[:, 0].sum() == pytest.approx(sum(m.inertia.mass for m in robot.mechanism.masses))


def test_parameters_are_read_only(arm):
    assert arm.inertial_parameters is arm.inertial_parameters
    with pytest.raises(ValueError, match="read-only"):
        arm.inertial_parameters[0] = 1.0


def test_symbols_stay_symbols():
    import sympy as sp

    arm = arms.planar_2r(m1=sp.Symbol("m1"))
    assert str(arm.inertial_parameters[0]) == "m1"
    assert arm.inertial_parameters[10] == 1
    for ask in (arm.operation_counts, arm.with_parameters().operation_counts):
        with pytest.raises(ValueError, match=r"still has the symbols m1; .* need numbers\. Give"):
            ask()


# -- the parameters as an argument ----------------------------------------------------------------


def test_own_parameters_give_the_robots_own_dynamics(arm, rng):
    q, qd, x = random_state(arm, rng, 3)
    given = {"q": q, "qd": qd, "qdd": x, "tau": x, "v": x}
    parametric, p = arm.with_parameters(), arm.inertial_parameters
    for name, signature in build.PARAMETRIC.items():
        arrays = [given[wanted] for wanted in signature.inputs[:-1]]
        got, want = getattr(parametric, name)(*arrays, p), getattr(arm, name)(*arrays)
        assert getattr(got, "_fields", None) == getattr(want, "_fields", None)
        for one, other in zip(_parts(got), _parts(want), strict=True):
            assert apart(one, other, 1.0) <= ROUNDING, name


def _parts(result):
    return result if isinstance(result, tuple) else (result,)


def test_parameters_broadcast_and_fill_out(arm, rng):
    parametric, p = arm.with_parameters(), arm.inertial_parameters
    many = p * rng.uniform(0.5, 2.0, (3, 1, p.size))
    q = rng.normal(size=(2, arm.n))
    M = parametric.mass_matrix(q, many)
    assert M.shape == (3, 2, arm.n, arm.n)
    assert (M[1, 1] == parametric.mass_matrix(q[1], many[1, 0])).all()
    out = np.empty_like(M)
    assert parametric.mass_matrix(q, parameters=many, out=out) is out
    assert (out == M).all()
    many[0, 0, 0] = np.nan
    assert np.isnan(parametric.mass_matrix(q, many)[0]).all()
    assert not np.isnan(parametric.mass_matrix(q, many)[1:]).any()


def test_wrong_widths(arm):
    parametric, p, q = arm.with_parameters(), arm.inertial_parameters, np.zeros(arm.n)
    width = p.size
    joints = ", ".join(body.name for body in arm.mechanism.bodies)
    sentence = (
        f"parameters has shape ({width - 1},), expected (..., {width}) for robot 'random'. "
        f"Ten for the link of each joint, as in arm.inertial_parameters: {joints}."
    )
    with pytest.raises(ValueError, match=re.escape(sentence)):
        parametric.gravity(q, p[1:])
    with pytest.raises(ValueError, match=rf"q has shape \({width},\), expected \(..., {arm.n}\)"):
        parametric.gravity(p, p)
    with pytest.raises(TypeError, match=r"gravity takes 2 arrays \(q, parameters\), got 1"):
        parametric.gravity(q)


def test_pickles_and_prints(arm):
    parametric, q, p = arm.with_parameters(), np.full(arm.n, 0.3), arm.inertial_parameters
    again = pickle.loads(pickle.dumps(parametric))
    assert again == parametric
    g = parametric.gravity(q, p)
    assert (pickle.loads(pickle.dumps(parametric.gravity))(q, p) == g).all()
    assert repr(again) == f"Robot 'random' with parameters (..., {p.size})"
    assert repr(again.gravity) == "<gravity(q, parameters) of robot 'random'>"
    assert (again.inertial_parameters == p).all()
    assert (again.n, again.name, again.joint_names) == (arm.n, arm.name, arm.joint_names)


def test_regrouping_at_run_time_only_where_it_pays():
    m = loaded("ur5").mechanism
    taken = set()
    for name in ("mass_matrix", "inverse_dynamics"):
        counts = [
            build._traced(m, name, name, (), True, regroup).arithmetic()
            for regroup in (False, True)
        ]
        assert build.trace(m, name, parametric=True).arithmetic() == min(counts)
        taken.add(counts.index(min(counts)))
    assert taken == {0, 1}  # both happen


# -- operation counts -----------------------------------------------------------------------------


def test_counts_are_those_of_the_traces():
    arm = loaded("ur5")
    counts = arm.operation_counts()
    assert set(counts) == set(build.SIGNATURES)
    program = build.trace(arm.mechanism, "inverse_dynamics")
    assert counts["inverse_dynamics"] == program.operation_counts()
    at_the_end = build.trace(arm.mechanism, "jacobian", arm.end_frame)
    assert counts["jacobian"] == at_the_end.operation_counts()
    c = counts["regressor"]
    assert set(c) == {"add", "mul", "div", "neg", "sincos", "fma", "instructions"}
    assert 0 < c["fma"] <= c["add"]
    assert c["add"] <= c["instructions"] < c["add"] + c["mul"] + c["div"] + c["neg"]
    with_parameters = arm.with_parameters().operation_counts()
    assert set(with_parameters) == set(build.PARAMETRIC)
    assert with_parameters["gravity"]["mul"] > counts["gravity"]["mul"]


def test_no_counts_where_M_is_singular():
    with pytest.warns(ModelWarning, match="M is singular"):
        arm = arms.pendulum(m=0.0, I=0.0)
    missing = set(build.SIGNATURES) - set(arm.operation_counts())
    assert "mass_matrix_inverse" in missing
    assert "mass_matrix" not in missing
