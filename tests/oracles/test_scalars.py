"""The algorithms, unchanged, on other scalars: exact, long, symbolic, complex, and CasADi's."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from mcgee import arms, build
from mcgee import quantities as on
from mcgee.algorithms.parameters import inertial_parameters, with_parameters
from mcgee.algorithms.regroup import regrouped
from mcgee.model import Pose
from mcgee.scalar import Turn
from robots import apart, interpreted, loaded, random_state, random_tree

# -- exact: Fraction ------------------------------------------------------------------------------


class Dual:
    """x + x' ε with ε² = 0: exact values with exact derivatives along one direction."""

    def __init__(self, x, rate=0):
        self.x, self.rate = x, rate

    def __add__(self, other):
        other = dual(other)
        return Dual(self.x + other.x, self.rate + other.rate)

    def __mul__(self, other):
        other = dual(other)
        return Dual(self.x * other.x, self.x * other.rate + self.rate * other.x)

    def __truediv__(self, other):
        return Dual(self.x / other, self.rate / other)

    def __neg__(self):
        return Dual(-self.x, -self.rate)

    def __sub__(self, other):
        return self + -dual(other)

    def __rsub__(self, other):
        return dual(other) - self

    __radd__, __rmul__ = __add__, __mul__


def dual(x):
    return x if isinstance(x, Dual) else Dual(x)


def along(position, speed):
    """A position that moves at a speed."""
    if isinstance(position, Turn):
        return Turn(Dual(position.c, -position.s * speed), Dual(position.s, position.c * speed))
    return Dual(position, speed)


def rates(array):
    return [rates(x) for x in array] if isinstance(array, list) else dual(array).rate


def fraction(rng):
    """Any but zero."""
    return Fraction(int(rng.integers(-6, 7)), int(rng.integers(1, 6))) + Fraction(1, 7)


def turn(rng):
    """A rational point of the unit circle."""
    t = fraction(rng)
    return Turn((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t))


def rotation(rng):
    """Rational turns about z, x and z."""
    a, b, c = (turn(rng) for _ in range(3))
    about_x = Pose(((1, 0, 0), (0, b.c, -b.s), (0, b.s, b.c)))
    first, last = (Pose(((t.c, -t.s, 0), (t.s, t.c, 0), (0, 0, 1))) for t in (a, c))
    return (first @ about_x @ last).rotation


class Exact:
    """A rational mechanism and a rational state of it."""

    def __init__(self, seed):
        rng = np.random.default_rng([seed, 7])
        self.robot = random_tree(
            seed, exact=True, bodies=5, prismatic=0.3, mimic=[0, 0.4][seed % 2], armature=0.5
        )
        mechanism = self.robot.mechanism.map(Fraction)
        # the description is exact in quarter turns; the joints may stand any way
        bodies = (
            replace(body, pose=Pose(rotation(rng), body.pose.translation))
            for body in mechanism.bodies
        )
        self.m = replace(mechanism, bodies=tuple(bodies))
        slides = [joint.kind == "prismatic" for joint in self.robot.independent_joints]
        self.q = [fraction(rng) if slide else turn(rng) for slide in slides]
        self.n = n = self.m.n
        self.qd, self.qdd, self.v = ([fraction(rng) for _ in range(n)] for _ in range(3))

    def moving(self, velocity):
        return [along(q, qd) for q, qd in zip(self.q, velocity, strict=True)]

    def unit(self, k):
        return [Fraction(int(i == k)) for i in range(self.n)]


def times(M, v):
    return [sum(a * b for a, b in zip(row, v, strict=True)) for row in M]


def plus(*vectors):
    return [sum(column) for column in zip(*vectors, strict=True)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


@pytest.fixture(params=range(8), ids="exact tree {}".format)
def exact(request):
    return Exact(request.param)


def test_the_exact_trees_have_everything():
    trees = [Exact(seed) for seed in range(8)]
    assert any(x.m.coupled for x in trees)
    assert not all(x.m.coupled for x in trees)
    assert {body.prismatic for x in trees for body in x.m.bodies} == {True, False}
    assert any(body.armature for x in trees for body in x.m.bodies)
    (first, second, third) = trees[0].m.bodies[0].pose.rotation
    assert dot(first, first) == dot(second, second) == dot(third, third) == 1
    assert dot(first, second) == dot(second, third) == dot(third, first) == 0


def test_mass_matrix_is_its_definition(exact):
    M = on.mass_matrix(exact.m, exact.q)
    assert on.mass_matrix_by_definition(exact.m, exact.q) == M
    assert [list(row) for row in zip(*M, strict=True)] == M
    assert all(isinstance(x, (Fraction, int)) for row in M for x in row)


def test_regrouping_moves_nothing(exact):
    light = regrouped(exact.m)
    assert light.bodies != exact.m.bodies
    assert on.mass_matrix(light, exact.q) == on.mass_matrix(exact.m, exact.q)
    assert on.gravity(light, exact.q) == on.gravity(exact.m, exact.q)
    state = exact.q, exact.qd, exact.qdd
    assert on.inverse_dynamics(light, *state) == on.inverse_dynamics(exact.m, *state)
    assert on.christoffel(light, exact.q) == on.christoffel(exact.m, exact.q)


def test_christoffel_symbols_are_derivatives_of_mass_matrix(exact):
    c, n = on.christoffel(exact.m, exact.q), exact.n
    D = [rates(on.mass_matrix(exact.m, exact.moving(exact.unit(k)))) for k in range(n)]
    for i in range(n):
        for j in range(n):
            for k in range(n):
                assert 2 * c[i][j][k] == D[k][i][j] + D[j][i][k] - D[i][j][k]


def test_coriolis_matrix_is_christoffel(exact):
    c, C = on.christoffel(exact.m, exact.q), on.coriolis_matrix(exact.m, exact.q, exact.qd)
    assert [times(c_i, exact.qd) for c_i in c] == C
    assert times(C, exact.qd) == on.coriolis(exact.m, exact.q, exact.qd)
    product = on.coriolis_product(exact.m, exact.q, exact.qd, exact.v)
    assert times(C, exact.v) == product
    assert product == on.coriolis_product(exact.m, exact.q, exact.v, exact.qd)


def test_rate_of_inertia_less_twice_coriolis_is_skew(exact):
    rate = rates(on.mass_matrix(exact.m, exact.moving(exact.qd)))
    C = on.coriolis_matrix(exact.m, exact.q, exact.qd)
    N = [[a - 2 * b for a, b in zip(*rows, strict=True)] for rows in zip(rate, C, strict=True)]
    assert all(N[i][j] == -N[j][i] for i in range(exact.n) for j in range(exact.n))


def test_gravity_is_slope_of_potential_energy(exact):
    slopes = [
        rates(on.potential_energy(exact.m, exact.moving(exact.unit(k)))) for k in range(exact.n)
    ]
    assert slopes == on.gravity(exact.m, exact.q)


def test_gravity_gradient_is_slope_of_gravity(exact):
    columns = [rates(on.gravity(exact.m, exact.moving(exact.unit(k)))) for k in range(exact.n)]
    assert [list(row) for row in zip(*columns, strict=True)] == on.gravity_gradient(
        exact.m, exact.q
    )


def test_derivatives_of_inverse_dynamics(exact):
    state = exact.q, exact.qd, exact.qdd
    by_q, by_qd, by_qdd = on.inverse_dynamics_derivatives(exact.m, *state)
    for k in range(exact.n):
        unit = exact.unit(k)
        moved = on.inverse_dynamics(exact.m, exact.moving(unit), *state[1:])
        faster = [Dual(*pair) for pair in zip(exact.qd, unit, strict=True)]
        assert rates(moved) == [row[k] for row in by_q]
        sped = on.inverse_dynamics(exact.m, exact.q, faster, exact.qdd)
        assert rates(sped) == [row[k] for row in by_qd]
    C = on.coriolis_matrix(exact.m, *state[:2])
    assert [[2 * x for x in row] for row in C] == by_qd
    assert by_qdd == on.mass_matrix(exact.m, exact.q)


def test_derivatives_of_forward_dynamics(exact):
    state = exact.q, exact.qd, exact.qdd
    tau = on.inverse_dynamics(exact.m, *state)
    slopes = on.forward_dynamics_derivatives(exact.m, *state[:2], tau)
    M = on.mass_matrix(exact.m, exact.q)
    by_q, by_qd, _ = on.inverse_dynamics_derivatives(exact.m, *state)
    for ours, theirs in zip(slopes, (by_q, by_qd), strict=False):
        back = [times(M, column) for column in zip(*ours, strict=True)]
        assert back == [[-x for x in column] for column in zip(*theirs, strict=True)]
    assert slopes[2] == on.mass_matrix_inverse(exact.m, exact.q)


def test_inverse_dynamics_is_linear_in_the_parameters(exact):
    """In the same way for the parameters of the links, and for any others."""
    state = exact.q, exact.qd, exact.qdd
    Y, p = on.regressor(exact.m, *state), inertial_parameters(exact.m)
    rotors = on.inverse_dynamics(with_parameters(exact.m, [0] * len(p)), *state)
    assert with_parameters(exact.m, p) == exact.m
    assert plus(times(Y, p), rotors) == on.inverse_dynamics(exact.m, *state)
    other = [Fraction(k % 7 - 3, 1 + k % 4) for k in range(len(p))]
    changed = with_parameters(exact.m, other)
    assert inertial_parameters(changed) == other
    assert plus(times(Y, other), rotors) == on.inverse_dynamics(changed, *state)


def test_equation_of_motion(exact):
    M, Cqd, g = on.terms(exact.m, exact.q, exact.qd)
    tau = on.inverse_dynamics(exact.m, exact.q, exact.qd, exact.qdd)
    assert tau == plus(times(M, exact.qdd), Cqd, g)
    assert on.forward_dynamics(exact.m, exact.q, exact.qd, tau) == exact.qdd


def test_inverse_of_mass_matrix(exact):
    M, inverse = on.mass_matrix(exact.m, exact.q), on.mass_matrix_inverse(exact.m, exact.q)
    columns = [times(inverse, column) for column in zip(*M, strict=True)]
    assert columns == [exact.unit(k) for k in range(exact.n)]


def test_kinetic_energy(exact):
    T = on.kinetic_energy(exact.m, exact.q, exact.qd)
    assert dot(exact.qd, times(on.mass_matrix(exact.m, exact.q), exact.qd)) == 2 * T
    assert T > 0


def test_energy_is_what_the_joints_put_in(exact):
    """d(T + P)/dt = qdᵀ tau: along qd for the positions, along qdd for the velocities."""
    q, qd = exact.moving(exact.qd), [Dual(*pair) for pair in zip(exact.qd, exact.qdd, strict=True)]
    power = rates(on.kinetic_energy(exact.m, q, qd)) + rates(on.potential_energy(exact.m, q))
    assert power == dot(exact.qd, on.inverse_dynamics(exact.m, exact.q, exact.qd, exact.qdd))


def test_jacobian_is_rate_of_pose(exact):
    J = on.jacobian(exact.m, exact.q, "tool")
    R = [row[:3] for row in on.forward_kinematics(exact.m, exact.q, "tool")[:3]]
    for k in range(exact.n):
        pose = rates(on.forward_kinematics(exact.m, exact.moving(exact.unit(k)), "tool"))
        assert [row[3] for row in pose[:3]] == [row[k] for row in J[:3]]
        turning = [times(R, row[:3]) for row in pose[:3]]  # Ṙ Rᵀ
        assert [turning[2][1], turning[0][2], turning[1][0]] == [row[k] for row in J[3:]]


# -- float, and graph nodes -----------------------------------------------------------------------

ROUNDING = 1e-14
"""Of the largest element: the same operations, regrouped."""


def test_float_and_nodes_agree(rng):
    robot = random_tree(5, bodies=6, mimic=0.3)
    nodes = interpreted(robot)
    q, qd, qdd = (list(row) for row in rng.normal(size=(3, robot.n)))
    for name, given in (
        ("mass_matrix", (q,)),
        ("coriolis_matrix", (q, qd)),
        ("christoffel", (q,)),
        ("inverse_dynamics", (q, qd, qdd)),
        ("forward_dynamics", (q, qd, qdd)),
        ("potential_energy", (q,)),
    ):
        assert apart(getattr(nodes, name)(*given), getattr(on, name)(robot.mechanism, *given)) <= (
            ROUNDING
        )


# -- complex: derivatives without differences -----------------------------------------------------


@pytest.mark.parametrize("number", [complex, np.complex128])
def test_complex_step(number, rng):
    """∂f/∂q_k = Im f(q + iε)/ε has no cancellation, so ε may be 1e-200."""
    robot, step = random_tree(11, bodies=5, prismatic=0.4, mimic=0.2), 1e-200
    m, n = robot.mechanism, robot.n
    q, qd = rng.normal(size=(2, n))

    def slopes(f):
        moved = ([number(x + 1j * step * (i == k)) for i, x in enumerate(q)] for k in range(n))
        return np.stack([np.imag(np.array(f(m, x), complex)) / step for x in moved], axis=-1)

    D = slopes(on.mass_matrix)
    c = 0.5 * (D + D.swapaxes(1, 2) - np.moveaxis(D, -1, 0))
    size = abs(np.array(on.mass_matrix(m, list(q)))).max()
    assert apart(on.christoffel(m, list(q)), c, size) <= ROUNDING
    C = np.array(on.coriolis_matrix(m, list(q), list(qd)))
    N = D @ qd - 2 * C
    assert apart(N, -N.T, size) <= ROUNDING
    g = slopes(on.potential_energy)
    assert apart(on.gravity(m, list(q)), g, 10.0) <= ROUNDING


# -- fifty digits: mpmath -------------------------------------------------------------------------

UNITS = 6
"""Errors allowed to compiled kernels, in units of eps × scale; 3 were measured. The scale is that
of the terms that are added up; of what is solved for, their image under |M⁻¹|."""


def scales(robot, q, qd, qdd):
    """Of a quantity, the size of what its elements are sums of, where not their own or 1."""
    M = np.array(on.mass_matrix(robot.mechanism, list(q)))
    inverse = np.linalg.inv(M)
    weight = 9.81 * sum(mass.inertia.mass for mass in robot.mechanism.masses)
    speed, m = abs(qd).max(), abs(M).max()
    velocity_terms = m * speed**2
    efforts = m * abs(qdd).max() + velocity_terms + weight
    passed = abs(inverse).sum(1).max()
    worsened = passed * abs(M).sum(1).max()  # the condition of M: what a solution loses
    caused = np.array(on.forward_dynamics(robot.mechanism, list(q), list(qd), list(qdd)))
    slopes = m * abs(caused).max() + velocity_terms + weight
    return {
        "mass_matrix": m,
        "mass_matrix_inverse": worsened * abs(inverse).max(),
        "coriolis": velocity_terms,
        "coriolis_matrix": m * speed,
        "coriolis_product": m * speed * abs(qdd).max(),
        "christoffel": m,
        "gravity": weight,
        "gravity_gradient": weight,
        "inverse_dynamics": efforts,
        "forward_dynamics": passed * efforts,
        "inverse_dynamics_derivatives: dtau_dq": efforts,
        "inverse_dynamics_derivatives: dtau_dqd": m * speed,
        "inverse_dynamics_derivatives: M": m,
        "forward_dynamics_derivatives: dqdd_dq": passed * slopes,
        "forward_dynamics_derivatives: dqdd_dqd": passed * m * speed,
        "forward_dynamics_derivatives: Minv": worsened * abs(inverse).max(),
        "kinetic_energy": velocity_terms,
        "potential_energy": weight,
    }


@pytest.mark.parametrize("name", ["ur5", "random"])
def test_compiled_kernels_against_fifty_digits(name, rng):
    import mpmath

    robot = loaded("ur5") if name == "ur5" else random_tree(21, bodies=6, prismatic=0.4)
    errors = {}
    with mpmath.workdps(50):
        m = robot.mechanism.map(mpmath.mpf)
        for q, qd, qdd in zip(*random_state(robot, rng, 5), strict=True):
            sizes = scales(robot, q, qd, qdd)
            for quantity, signature in build.SIGNATURES.items():
                if quantity == "terms":  # its parts are measured one by one
                    continue
                given = {"q": q, "qd": qd, "qdd": qdd, "tau": qdd, "v": qdd}
                arrays = [given[wanted] for wanted in signature.inputs]
                frame = [robot.end_frame] if quantity in ("forward_kinematics", "jacobian") else []
                long = [[mpmath.mpf(x) for x in array] for array in arrays]
                results = (
                    getattr(on, quantity)(m, *long, *frame),
                    getattr(robot, quantity)(*arrays, *frame),
                )
                if len(signature.outputs) == 1:
                    results = tuple((result,) for result in results)
                for (part, _), want, got in zip(signature.outputs, *results, strict=True):
                    name = quantity if len(signature.outputs) == 1 else f"{quantity}: {part}"
                    want = np.array(want, dtype=object)
                    difference = abs(np.vectorize(mpmath.mpf, otypes=[object])(got) - want)
                    size = sizes.get(name, max(1.0, float(np.max(abs(want)))))
                    error = float(np.max(difference) / size) / np.finfo(float).eps
                    errors[name] = max(errors.get(name, 0.0), error)
    assert max(errors.values()) <= UNITS, errors


# -- CasADi ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["ur5", "random"])
def test_casadi(name, rng):
    """Its functions give our numbers, and its derivatives find M, C qd and g in our tau and P."""
    import casadi as ca

    robot = loaded("ur5") if name == "ur5" else random_tree(31, bodies=5, mimic=0.3, prismatic=0.3)
    m, n = robot.mechanism, robot.n
    q, qd, qdd = (ca.SX.sym(x, n) for x in ("q", "qd", "qdd"))
    Q, V, A = (ca.vertsplit(x) for x in (q, qd, qdd))
    tau = ca.vertcat(*on.inverse_dynamics(m, Q, V, A))
    T, P = on.kinetic_energy(m, Q, V), on.potential_energy(m, Q)
    momentum = ca.jacobian(T, qd).T
    f = ca.Function(
        "f",
        [q, qd, qdd],
        [
            tau,
            ca.jacobian(tau, qdd),
            ca.hessian(T, qd)[0],
            ca.jacobian(P, q).T,
            ca.jacobian(momentum, q) @ qd - ca.jacobian(T, q).T,  # Lagrange's C qd
            ca.jacobian(tau, qd),
            ca.vertcat(*on.forward_dynamics(m, Q, V, A)),
        ],
    )
    own = interpreted(robot)
    for state in zip(*random_state(robot, rng, 5), strict=True):
        tau, M, curvature, slope, Cqd, damping, accelerations = (np.array(x) for x in f(*state))
        size = abs(M).max()
        assert apart(own.inverse_dynamics(*state), tau[:, 0], size) <= ROUNDING
        assert apart(own.mass_matrix(state[0]), M) <= ROUNDING
        assert apart(own.mass_matrix(state[0]), curvature) <= ROUNDING
        assert apart(own.gravity(state[0]), slope[:, 0], 10.0) <= ROUNDING
        assert apart(own.coriolis(*state[:2]), Cqd[:, 0], 4 * size) <= ROUNDING
        # ∂(C qd)/∂qd = 2C for Christoffel's C, whose symbols are symmetric
        assert apart(2 * own.coriolis_matrix(*state[:2]), damping, size) <= ROUNDING
        scale = abs(np.linalg.inv(M)).sum(1).max() * (abs(tau).max() + size)
        assert apart(own.forward_dynamics(*state), accelerations[:, 0], scale) <= ROUNDING


# -- SymPy: the formulas of the textbook ----------------------------------------------------------


def test_planar_2r_in_sympy():
    """Exactly the published M, C qd and g, angles from the horizontal."""
    import sympy as sp

    names = "m1 m2 l1 lc1 lc2 I1 I2 g0"
    m1, m2, l1, lc1, lc2, I1, I2, g0 = p = sp.symbols(names, positive=True)
    q1, q2, qd1, qd2 = sp.symbols("q1 q2 qd1 qd2", real=True)
    arm = arms.planar_2r(**dict(zip(names.split(), p, strict=True)))
    assert set(arm.symbols) == set(names.split())
    s2, c2, c1, c12 = sp.sin(q2), sp.cos(q2), sp.cos(q1), sp.cos(q1 + q2)
    M12 = I2 + m2 * (lc2**2 + l1 * lc2 * c2)
    M11 = I1 + I2 + m1 * lc1**2 + m2 * (l1**2 + lc2**2 + 2 * l1 * lc2 * c2)
    h = m2 * l1 * lc2 * s2
    M = [[M11, M12], [M12, I2 + m2 * lc2**2]]
    Cqd = [-h * (2 * qd1 * qd2 + qd2**2), h * qd1**2]
    C = [[-h * qd2, -h * (qd1 + qd2)], [h * qd1, 0]]
    g = [(m1 * lc1 + m2 * l1) * g0 * c1 + m2 * lc2 * g0 * c12, m2 * lc2 * g0 * c12]
    P = m1 * g0 * lc1 * sp.sin(q1) + m2 * g0 * (l1 * sp.sin(q1) + lc2 * sp.sin(q1 + q2))
    for mechanism in (arm.mechanism, regrouped(arm.mechanism)):
        q, qd = [q1, q2], [qd1, qd2]
        got = on.terms(mechanism, q, qd)
        for ours, published in zip(got, (M, Cqd, g), strict=True):
            assert exactly_zero(sp.Matrix(ours) - sp.Matrix(published))
        assert exactly_zero(sp.Matrix(on.coriolis_matrix(mechanism, q, qd)) - sp.Matrix(C))
    assert exactly_zero(sp.Matrix([on.potential_energy(arm.mechanism, [q1, q2]) - P]))


def exactly_zero(matrix):
    import sympy as sp

    reduced = matrix.applyfunc(lambda x: sp.expand(sp.expand_trig(sp.nsimplify(x))))
    return reduced.applyfunc(lambda x: sp.simplify(x)) == sp.zeros(*matrix.shape)


# -- what a scalar must offer ---------------------------------------------------------------------


def test_turn_adds_and_repeats():
    a, b = Turn(Fraction(3, 5), Fraction(4, 5)), Turn(Fraction(5, 13), Fraction(12, 13))
    angle = math.atan2(4, 3) + math.atan2(12, 5)
    assert (float((a + b).c), float((a + b).s)) == pytest.approx((math.cos(angle), math.sin(angle)))
    assert a * 3 == a + a + a
    assert a * -1 == -a
    assert a + -a == a * 0 == Turn(1, 0)
    with pytest.raises(ValueError, match=r"a whole number of times, not 0\.5"):
        a * 0.5
