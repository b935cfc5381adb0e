"""Spatial vectors against 6 by 6 matrices written out from the book."""

import numpy as np
import pytest

from mcgee.algorithms.coriolis import VelocityMatrix
from mcgee.algorithms.spatial import (
    NO_INERTIA,
    ArticulatedInertia,
    Force,
    Inertia,
    JointTransform,
    Matrix,
    Motion,
    Symmetric,
    Vector,
    skew,
)
from mcgee.model import Pose
from robots import apart

ROUNDING = 1e-14


@pytest.fixture
def draw(rng):
    class Draw:
        def vector(self):
            return Vector(*rng.normal(size=3).tolist())

        def motion(self):
            return Motion(self.vector(), self.vector())

        def force(self):
            return Force(self.vector(), self.vector())

        def inertia(self):
            return Inertia(float(rng.uniform(1, 2)), self.vector(), Symmetric(*rng.normal(size=6)))

        def transform(self, prismatic):
            pose = Pose.from_rpy(rng.normal(size=3).tolist(), rng.normal(size=3).tolist())
            return JointTransform(pose, prismatic, float(rng.normal()))

    return Draw()


def flat(x):
    """w over u of a motion, n over f of a force."""
    first, last = (x.w, x.u) if isinstance(x, Motion) else (x.n, x.f)
    return np.array([*first, *last])


def cross(v):
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def crossing(v):
    """v× on motions, equation 2.31."""
    w, u = cross(flat(v)[:3]), cross(flat(v)[3:])
    return np.block([[w, np.zeros((3, 3))], [u, w]])


def matrix_of(body):
    """Equation 2.63."""
    I, h = np.array([list(r) for r in rows(body.I.matrix())]), cross(body.h)
    return np.block([[I, h], [h.T, body.m * np.eye(3)]])


def rows(a):
    return a.x, a.y, a.z


def transform_matrix(X):
    """From motions of the parent to motions of the child."""
    R = np.array([list(r) for r in rows(X.R)])
    turn = np.array([[X.c, -X.s, 0], [X.s, X.c, 0], [0, 0, 1]])
    E, r = (R @ turn).T, np.array([*X.r]) + R @ [0, 0, X.d]
    return np.block([[E, np.zeros((3, 3))], [-E @ cross(r), E]])


def test_crosses(draw):
    v, m, f = draw.motion(), draw.motion(), draw.force()
    assert apart(flat(v.cross(m)), crossing(v) @ flat(m)) <= ROUNDING
    assert apart(flat(v.cross_force(f)), -crossing(v).T @ flat(f)) <= ROUNDING
    assert apart(v.dot(f), flat(v) @ flat(f)) <= ROUNDING


def test_inertia_times_motion(draw):
    body, v = draw.inertia(), draw.motion()
    assert apart(flat(body @ v), matrix_of(body) @ flat(v)) <= ROUNDING
    assert apart(flat(ArticulatedInertia.of(body) @ v), matrix_of(body) @ flat(v)) <= ROUNDING


@pytest.mark.parametrize("prismatic", [False, True], ids=["turned", "slid"])
class TestTransform:
    def test_motion_and_force(self, draw, prismatic):
        X, v, f = draw.transform(prismatic), draw.motion(), draw.force()
        assert apart(flat(X.motion(v)), transform_matrix(X) @ flat(v)) <= ROUNDING
        assert apart(flat(X.force(f)), transform_matrix(X).T @ flat(f)) <= ROUNDING
        # power is the same on both sides
        assert apart(X.motion(v).dot(f), v.dot(X.force(f)), 1.0) <= ROUNDING

    def test_inertia(self, draw, prismatic):
        X, body, A = draw.transform(prismatic), draw.inertia(), draw.inertia()
        six = transform_matrix(X)
        assert apart(matrix_of(X.inertia(body)), six.T @ matrix_of(body) @ six) <= ROUNDING
        U = draw.force()
        general = ArticulatedInertia.of(A).without(U, 0.3)
        want = six.T @ (matrix_of(A) - 0.3 * np.outer(flat(U), flat(U))) @ six
        columns = [flat(X.articulated(general) @ unit(k)) for k in range(6)]
        assert apart(np.stack(columns, -1), want) <= ROUNDING

    def test_point_and_first_moment(self, draw, prismatic):
        X, p = draw.transform(prismatic), draw.vector()
        R = transform_matrix(X)[:3, :3].T
        at = np.array([*X.r]) + np.array([list(r) for r in rows(X.R)]) @ [0, 0, X.d]
        assert apart(np.array([*(X.up(p + Vector(0, 0, X.d)) + X.r)]), R @ [*p] + at) <= ROUNDING
        moment = X.first_moment(2.0, p)
        assert apart(np.array([*moment]), R @ [*p] + 2 * at) <= ROUNDING
        assert apart(np.array([*X.down(X.up(p))]), np.array([*p])) <= ROUNDING

    def test_velocity_matrix(self, draw, prismatic):
        """B of the source, seen through a joint, is XᵀBX."""
        X, body, v = draw.transform(prismatic), draw.inertia(), draw.motion()
        six, B = transform_matrix(X), six_by_six(VelocityMatrix.of(body, v))
        seen = six_by_six(VelocityMatrix.of(body, v).seen_through(X))
        assert apart(seen, six.T @ B @ six) <= ROUNDING


def unit(k):
    e = [float(i == k) for i in range(6)]
    return Motion(Vector(*e[:3]), Vector(*e[3:]))


def six_by_six(B):
    return np.stack([flat(B @ unit(k)) for k in range(6)], -1)


def test_velocity_matrix_is_the_source_s(draw):
    """B = ½[(v×*) I + (I v)×̄* − I (v×)], Echeandia & Wensing 2021, equation 8."""
    body, v, m = draw.inertia(), draw.motion(), draw.motion()
    B, I = VelocityMatrix.of(body, v), matrix_of(body)
    n, f = np.split(I @ flat(v), 2)
    bar = np.block([[-cross(n), -cross(f)], [-cross(f), np.zeros((3, 3))]])
    want = 0.5 * (-crossing(v).T @ I + bar - I @ crossing(v))
    assert apart(six_by_six(B), want) <= ROUNDING
    assert apart(flat(B.transposed(m)), want.T @ flat(m)) <= ROUNDING


def test_matrices(draw):
    a, b, v = draw.vector(), draw.vector(), draw.vector()
    ab = Matrix.outer(a, b)
    assert apart(np.array([*(ab @ v)]), np.outer([*a], [*b]) @ [*v]) <= ROUNDING
    assert apart(np.array([*(skew(a) @ v)]), np.cross([*a], [*v])) <= ROUNDING
    assert Matrix.outer(b, a) == ab.T
    assert apart(ab.trace(), np.dot([*a], [*b])) <= ROUNDING
    square = np.array([list(r) for r in rows(ab * skew(v))])
    assert apart(square, np.outer([*a], [*b]) @ cross(v)) <= ROUNDING


def test_second_moment_of_nothing_stays_exact():
    """0 / 2 would be 0.0, and make floats of the fractions it meets."""
    nothing = Inertia(0, Vector(0, 0, 0), NO_INERTIA).second_moment()
    assert {type(x) for row in rows(nothing) for x in row} == {int}
