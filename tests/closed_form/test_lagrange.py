"""A user's own energies."""

import math

import pytest
import sympy
from sympy import Matrix, cos, sin
from sympy.physics.mechanics import dynamicsymbols

import mcgee
from mcgee import arms

m1, m2, l1, l2, lc1, lc2, I1, I2, g0 = sympy.symbols("m1 m2 l1 l2 lc1 lc2 I1 I2 g0")
q1, q2, qd1, qd2 = sympy.symbols("q1 q2 qd1 qd2")
Q, QD = (q1, q2), (qd1, qd2)

T = (
    (I1 + m1 * lc1**2) * qd1**2 / 2
    + I2 * (qd1 + qd2) ** 2 / 2
    + m2 * (l1**2 * qd1**2 + lc2**2 * (qd1 + qd2) ** 2) / 2
    + m2 * l1 * lc2 * cos(q2) * qd1 * (qd1 + qd2)
)
P = m1 * g0 * lc1 * sin(q1) + m2 * g0 * (l1 * sin(q1) + lc2 * sin(q1 + q2))


@pytest.fixture(scope="module")
def arm():
    return arms.planar_2r(m1, m2, l1, lc1, lc2, I1, I2, g0, l2=l2).closed_form()


def test_the_lessons_energies_give_the_arm(arm):
    own = mcgee.lagrange(T, P, Q, QD)
    assert own.compare(arm)
    assert own.M == arm.M
    assert own.g == arm.g
    proof = own.prove()
    assert proof
    assert [i.name for i in proof] == [
        *("skew", "kinetic energy", "power", "M without q1", "positive definite"),
    ]
    assert proof["positive definite"].how == "undecided"


def test_the_lessons_slip_is_found(arm):
    """Its listing takes P with cos; the gradient of that is not section 3's g."""
    slip = m1 * g0 * lc1 * cos(q1) + m2 * g0 * (l1 * cos(q1) + lc2 * cos(q1 + q2))
    found = mcgee.lagrange(T, slip, Q, QD).compare(arm)
    assert not found
    assert [i.name for i in found if not i.holds] == ["g"]
    assert str(found["g"]).startswith("FALSE     the same g: 2 of 2 differences are not 0, the fi")


def test_functions_of_time(arm):
    t = dynamicsymbols._t
    a, b = dynamicsymbols("q1 q2")
    moving = {qd1: a.diff(t), qd2: b.diff(t), q1: a, q2: b}
    energies = [e.subs(moving, simultaneous=True) for e in (T, P)]
    own = mcgee.lagrange(*energies, [a, b], [a.diff(t), b.diff(t)])
    assert own.q == Q
    assert own.qd == QD
    assert own.compare(arm)


def test_a_cart_and_a_pole():
    """A coordinate that slides; Florian 2007."""
    x, v, mc, mp, lc = sympy.symbols("x v mc mp lc")
    T = mc * v**2 / 2 + mp * (v**2 + 2 * lc * cos(q1) * v * qd1 + lc**2 * qd1**2) / 2
    own = mcgee.lagrange(T, mp * g0 * lc * cos(q1) + x**2 / lc, [x, q1], [v, qd1])
    assert Matrix([[mc + mp, mp * lc * cos(q1)], [mp * lc * cos(q1), mp * lc**2]]) == own.M
    assert own.Cqd == Matrix([-mp * lc * sin(q1) * qd1**2, 0])
    assert own.g == Matrix([2 * x / lc, -mp * g0 * lc * sin(q1)])
    assert [str(s) for s in own.qdd] == ["xdd", "qdd1"]


def test_multiple_angles_and_constants():
    own = mcgee.lagrange(qd1**2 * cos(2 * q1 + sympy.pi / 6), sin(q1 + 0.3), [q1], [qd1])
    assert list(own.constants.values()) == [0.3]
    value = own.evaluate("Cqd", [0.7], [1.1])[0]
    assert value == pytest.approx(-2 * math.sin(1.4 + math.pi / 6) * 1.21, rel=1e-13)
    assert own.evaluate("g", [0.7])[0] == pytest.approx(float(cos(1.0)), rel=1e-13)
    assert own.prove()


def test_numbers_and_roots():
    own = mcgee.lagrange(sympy.sqrt(5) * qd1**2 / sympy.sqrt(2) ** 3, sympy.pi * q1, [q1], [qd1])
    assert sympy.simplify(own.M[0] - sympy.sqrt(10) / 2) == 0
    assert own.g[0] == sympy.pi
    assert own.evaluate("g", [0.0])[0] == math.pi


def test_a_users_e_is_not_eulers():
    E = sympy.Symbol("E", positive=True)
    own = mcgee.lagrange(qd1**2, E * q1 + sympy.E * q1, [q1], [qd1])
    assert own.g[0] == E + sympy.E
    assert own.evaluate("g", [0.0], values={"E": 2.0})[0] == pytest.approx(2 + math.e)


TIME = dynamicsymbols._t
(X,) = dynamicsymbols("q1:2")


def test_a_users_angle_is_not_a_named_one():
    k, phi1 = sympy.symbols("k phi1")
    own = mcgee.lagrange(qd1**2, k * cos(q1 + 0.3) + k * cos(q1 + phi1), [q1], [qd1])
    values = {"k": 2.0, "phi1": 1.1}
    assert own.evaluate("g", [0.2], values=values)[0] == pytest.approx(
        -2 * (math.sin(0.5) + math.sin(1.3))
    )


@pytest.mark.parametrize(
    ("T", "P", "q", "qd", "sentence"),
    [
        (T, P, Q, [qd1], "q has 2 coordinates and qd 1 velocities, expected as many of both"),
        (T, P, [], [], "q has 0 coordinates and qd 0 velocities"),
        (T, P, ["q1"], [qd1], "coordinate q1 is no SymPy symbol. Write q = sympy.symbols"),
        (T, P, [q1], [2 * qd1], r"velocity 2\*qd1 is no SymPy symbol"),
        (T, P, [q1, q1], QD, "coordinates and velocities are q1, q1, qd1, qd2, expected each once"),
        (qd1**2 + 1, q1, [q1], [qd1], "T has a term of degree 0 in the velocities, expected 2"),
        (qd1**2 + qd1, q1, [q1], [qd1], "T has a term of degree 1 in the velocities, expected 2"),
        (qd1**2, q1 * qd1, [q1], [qd1], "P has a term of degree 1 in the velocities, expected 0"),
        (qd1**2, 1 / q1, [q1], [qd1], "the energies divide by q1, which moves"),
        (qd1**2, sin(qd1), [q1], [qd1], "the energies have velocity qd1 in an angle"),
        (
            qd1**2,
            sympy.exp(q1),
            [q1],
            [qd1],
            r"P has the part exp\(q1\), which is no",
        ),
        (qd1**2, sin(q1**2), [q1], [qd1], r"P has the part q1\*\*2, which is no trigonometric"),
        (sympy.sqrt(l1) * qd1**2, q1, [q1], [qd1], r"T has the part sqrt\(l1\), which is no"),
        (None, q1, [q1], [qd1], "T is None, expected a SymPy expression"),
        ("m*qd1**", q1, [q1], [qd1], r"T is 'm\*qd1\*\*', expected a SymPy expression"),
        (qd1**2, cos(q1 + sympy.I), [q1], [qd1], "P has the imaginary unit in it"),
        (qd1**2, sympy.Symbol("A", commutative=False), [q1], [qd1], "P has A in it"),
        (qd1**2, q1, q1, qd1, "q is q1, expected a list"),
        (
            *(qd1**2, cos(sympy.Symbol("q1", real=True)), [q1], [qd1]),
            "P has a symbol 'q1' that is not the coordinate or velocity of that name",
        ),
        (TIME * X.diff() ** 2, X, [X], [X.diff()], "T depends on time by itself"),
        (X.diff() ** 2, TIME * X, [X], [X.diff()], "P depends on time by itself"),
        (X.diff() ** 2, X, [X], [X.diff(TIME, 2)], r"velocity .* is not .*, that of q1\(t\)"),
        (X.diff() ** 2, (X - q1) ** 2, [X], [X.diff()], "P has a symbol 'q1' that is not the coo"),
    ],
)
def test_what_is_refused(T, P, q, qd, sentence):
    with pytest.raises(ValueError, match=sentence):
        mcgee.lagrange(T, P, q, qd)


def test_compared_forms_have_as_many_coordinates(arm):
    with pytest.raises(ValueError, match="'pendulum' has 1 coordinates and 'planar_2r' 2"):
        arms.pendulum().closed_form().compare(arm)


def test_forms_with_named_angles_compare_by_their_values():
    rows = [{"alpha": 0.3, "a": 1, "m": 1, "r": (0, 0, 0.1)}, {"alpha": 0.2, "a": 1, "m": 2}]
    one = mcgee.from_dh(rows).closed_form()
    other = mcgee.from_dh([rows[0], {**rows[1], "theta": 0.2}]).closed_form()
    assert one.compare(mcgee.from_dh(rows).closed_form())
    assert not one.compare(other)
