"""The built-in arms against their published equations and figures."""

import math
import re
import sysconfig
from dataclasses import replace
from importlib import resources
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import sympy
from sympy import cos, sin

from mcgee import ModelError, ModelWarning, arms, quantities
from mcgee.formats.dh import from_dh

PI = math.pi


def mechanism(robot):
    return robot.mechanism


def mass_matrix(robot, q):
    return np.array(quantities.mass_matrix(mechanism(robot), list(q)), dtype=float)


def coriolis(robot, q, qd):
    return np.array(quantities.coriolis(mechanism(robot), list(q), list(qd)), dtype=float)


def coriolis_matrix(robot, q, qd):
    return np.array(quantities.coriolis_matrix(mechanism(robot), list(q), list(qd)), dtype=float)


def gravity(robot, q):
    return np.array(quantities.gravity(mechanism(robot), list(q)), dtype=float)


def potential_energy(robot, q):
    return quantities.potential_energy(mechanism(robot), list(q))


def position(robot, q, frame="tip"):
    pose = quantities.forward_kinematics(mechanism(robot), list(q), frame)
    return np.array([row[3] for row in pose[:3]], dtype=float)


# -- every arm ------------------------------------------------------------------------------------

JOINTS = {
    "pendulum": 1,
    "planar_2r": 2,
    "planar_3r": 3,
    "acrobot": 2,
    "pendubot": 2,
    "cart_pole": 2,
    "inertia_wheel_pendulum": 2,
    "scara": 4,
    "stanford": 6,
    "puma560": 6,
    "panda": 7,
    "ur5e": 6,
}


@pytest.mark.parametrize("name", arms.BUILTIN)
def test_an_arm_by_name(name):
    robot = arms.BUILTIN[name]()  # a warning would be an error here
    assert robot.name == name
    assert mechanism(robot).n == JOINTS[name]
    rng = np.random.default_rng(1)
    for q in (np.zeros(JOINTS[name]), rng.uniform(-3, 3, JOINTS[name])):
        M = mass_matrix(robot, q)
        assert pytest.approx(M.T) == M
        assert np.linalg.eigvalsh(M).min() > 0
    assert arms.BUILTIN[name].__doc__


def test_what_is_odd_is_kept_with_the_arm():
    odd = {name: robot.warnings for name, f in arms.BUILTIN.items() if (robot := f()).warnings}
    assert list(odd) == ["puma560"]
    mass, tensor = odd["puma560"]
    assert "link 'link1' has mass 0 but a rotational inertia" in mass
    assert "link 'link3' has an inertia that no body can have" in tensor


# -- the lesson's planar 2R arm -------------------------------------------------------------------


PARAMETERS = ("m1", "m2", "l1", "lc1", "lc2", "I1", "I2", "g0")
REFERENCE = dict(zip(PARAMETERS, (1, 1, 1, 0.5, 0.5, 0.1, 0.1, 9.81), strict=True))


def lesson_2r(p, q, qd, c=np.cos, s=np.sin):
    """M, C qd, g of the lesson, section 3: angles from the horizontal."""
    (q1, q2), (qd1, qd2) = q, qd
    m1, m2, l1, lc1, lc2, I1, I2, g0 = (p[k] for k in PARAMETERS)
    M12 = I2 + m2 * (lc2**2 + l1 * lc2 * c(q2))
    M11 = I1 + I2 + m1 * lc1**2 + m2 * (l1**2 + lc2**2 + 2 * l1 * lc2 * c(q2))
    h = m2 * l1 * lc2 * s(q2)
    last = m2 * lc2 * g0 * c(q1 + q2)
    return (
        [[M11, M12], [M12, I2 + m2 * lc2**2]],
        [-h * (2 * qd1 * qd2 + qd2**2), h * qd1**2],
        [(m1 * lc1 + m2 * l1) * g0 * c(q1) + last, last],
    )


def random_2r(rng):
    return {k: rng.uniform(0.2, 3) for k in REFERENCE}


def test_planar_2r_defaults_are_the_lessons_reference_point():
    q, qd = (0.5, 0.3), (0.1, -0.2)
    robot = arms.planar_2r()
    M, Cqd, g = lesson_2r(REFERENCE, q, qd)
    assert mass_matrix(robot, q) == pytest.approx(np.array(M), rel=1e-14)
    assert coriolis(robot, q, qd) == pytest.approx(np.array(Cqd), rel=1e-13, abs=1e-16)
    assert gravity(robot, q) == pytest.approx(np.array(g), rel=1e-14)
    # and in figures, worked out by hand
    assert M[0][0] == pytest.approx(1.7 + math.cos(0.3))
    assert Cqd == pytest.approx([0.0, 0.005 * math.sin(0.3)])
    assert g[1] == pytest.approx(4.905 * math.cos(0.8))


@pytest.mark.parametrize("plane", ["vertical", "horizontal"])
@pytest.mark.parametrize("angle_from", ["horizontal", "down"])
def test_planar_2r_is_the_lessons_arm_everywhere(plane, angle_from):
    rng = np.random.default_rng(3)
    for _ in range(20):
        p, q, qd = random_2r(rng), rng.uniform(-4, 4, 2), rng.uniform(-3, 3, 2)
        robot = arms.planar_2r(**p, l2=0.7, plane=plane, angle_from=angle_from)
        # from the downward vertical, the angle from the horizontal is q1 - pi/2
        turn = -PI / 2 if angle_from == "down" else 0.0
        M, Cqd, g = lesson_2r(p, (q[0] + turn, q[1]), qd)
        if plane == "horizontal":
            g = [0.0, 0.0]
        assert mass_matrix(robot, q) == pytest.approx(np.array(M), rel=1e-12)
        assert coriolis(robot, q, qd) == pytest.approx(np.array(Cqd), rel=1e-11, abs=1e-13)
        assert gravity(robot, q) == pytest.approx(np.array(g), rel=1e-11, abs=1e-12)
        a, b = q[0] + turn, q[0] + q[1] + turn
        tip = [
            p["l1"] * math.cos(a) + 0.7 * math.cos(b),
            p["l1"] * math.sin(a) + 0.7 * math.sin(b),
            0,
        ]
        assert position(robot, q) == pytest.approx(tip, abs=1e-13)


def test_the_two_angle_conventions_differ_by_a_quarter_turn_and_so_does_gravity():
    """The lesson's slip: q1 = pi/2 is upright in one convention, horizontal in the other."""
    upright, level = arms.planar_2r(), arms.planar_2r(angle_from="down")
    assert gravity(upright, [PI / 2, 0]) == pytest.approx([0, 0], abs=1e-14)
    assert gravity(level, [PI / 2, 0]) == pytest.approx([9.81 * 2.0, 9.81 * 0.5])
    assert gravity(level, [0, 0]) == pytest.approx([0, 0], abs=1e-14)


def test_planar_2r_exactly_in_symbols():
    symbols = {k: sympy.Symbol(k, positive=True) for k in REFERENCE}
    q1, q2, qd1, qd2 = sympy.symbols("q1 q2 qd1 qd2")
    for angle_from, start in (("horizontal", q1), ("down", q1 - sympy.pi / 2)):
        m = mechanism(arms.planar_2r(**symbols, angle_from=angle_from))
        M, Cqd, g = lesson_2r(symbols, (start, q2), (qd1, qd2), cos, sin)
        ours = (
            quantities.mass_matrix(m, [q1, q2]),
            quantities.coriolis(m, [q1, q2], [qd1, qd2]),
            quantities.gravity(m, [q1, q2]),
        )
        for mine, theirs in zip(ours, (M, Cqd, g), strict=True):
            difference = sympy.Matrix(mine) - sympy.Matrix(theirs)
            exact = difference.applyfunc(lambda e: sympy.expand(sympy.nsimplify(e), trig=True))
            assert exact.applyfunc(sympy.simplify) == sympy.zeros(*difference.shape)


# -- pendulum -------------------------------------------------------------------------------------


def test_pendulum_of_the_lesson():
    m, l, lc, I, g0 = 1.3, 0.9, 0.4, 0.07, 9.7
    robot = arms.pendulum(m, l, lc, I, g0)
    for q in (-2.0, 0.0, 0.4, 7.0):
        assert mass_matrix(robot, [q]) == pytest.approx(np.array([[I + m * lc**2]]))
        assert potential_energy(robot, [q]) == pytest.approx(m * g0 * lc * (1 - math.cos(q)))
        assert gravity(robot, [q]) == pytest.approx([m * g0 * lc * math.sin(q)], abs=1e-15)
        assert coriolis(robot, [q], [3.0]) == pytest.approx([0.0], abs=1e-15)
    assert position(robot, [0.0]) == pytest.approx([0, lc - l, 0])


def test_pendulum_from_the_horizontal():
    robot = arms.pendulum(m=2, lc=0.3, g0=10, angle_from="horizontal")
    assert gravity(robot, [0.6]) == pytest.approx([6 * math.cos(0.6)])
    assert potential_energy(robot, [0.6]) == pytest.approx(6 * math.sin(0.6))
    assert position(robot, [0.0]) == pytest.approx([1, 0, 0])


def test_pendulum_in_the_horizontal_plane_has_no_gravity():
    for angle_from in ("down", "horizontal"):
        robot = arms.pendulum(plane="horizontal", angle_from=angle_from)
        assert gravity(robot, [0.6]) == pytest.approx([0.0])
        tip = [1, 0, 0] if angle_from == "horizontal" else [0, -1, 0]
        assert position(robot, [0.0]) == pytest.approx(tip)
        assert potential_energy(robot, [0.6]) == 0


def test_pendulum_in_symbols():
    m, _, lc, I, g0 = symbols = sympy.symbols("m l lc I g0", positive=True)
    q = sympy.Symbol("q")
    mechanics = mechanism(arms.pendulum(*symbols))
    P = quantities.potential_energy(mechanics, [q])
    (g,) = quantities.gravity(mechanics, [q])
    assert sympy.simplify(P - m * g0 * lc * (1 - cos(q))) == 0
    assert sympy.simplify(sympy.diff(P, q) - g) == 0
    assert sympy.simplify(quantities.mass_matrix(mechanics, [q])[0][0] - (I + m * lc**2)) == 0


# -- longer chains --------------------------------------------------------------------------------


def test_planar_nr_of_two_is_planar_2r():
    rng = np.random.default_rng(8)
    p, q = random_2r(rng), rng.uniform(-3, 3, 2)
    both = {k: [p[k + "1"], p.get(k + "2", 1.0)] for k in ("m", "l", "lc", "I")}
    robot = arms.planar_nr(2, **both, g0=p["g0"])
    assert mass_matrix(robot, q) == pytest.approx(mass_matrix(arms.planar_2r(**p), q))
    assert gravity(robot, q) == pytest.approx(gravity(arms.planar_2r(**p), q))


def test_planar_nr_against_its_energy():
    """T = ½ Σ m |v|² + I ω² with v from the rods' absolute angles, by numeric differentiation."""
    n, h, rng = 5, 1e-6, np.random.default_rng(2)
    m, l, lc, I = rng.uniform(0.2, 2, (4, n))
    robot = arms.planar_nr(n, m, list(l), tuple(lc), I)
    q, qd = rng.uniform(-3, 3, n), rng.uniform(-1, 1, n)

    def centres(q):
        angles = np.cumsum(q)
        along = np.exp(1j * angles)
        return np.concatenate([[0], np.cumsum(l * along)[:-1]]) + lc * along

    v = (centres(q + h * qd) - centres(q - h * qd)) / (2 * h)
    T = 0.5 * np.sum(m * abs(v) ** 2 + I * np.cumsum(qd) ** 2)
    assert 0.5 * qd @ mass_matrix(robot, q) @ qd == pytest.approx(T, rel=1e-8)
    assert potential_energy(robot, q) == pytest.approx(9.81 * np.sum(m * centres(q).imag))
    assert robot.name == "planar_5r"


# -- acrobot --------------------------------------------------------------------------------------


def spong_acrobot(q, qd, m1, m2, l1, lc1, lc2, I1, I2, g):
    """d11 … phi2 of Spong 1995, eqs. (1)-(10)."""
    (q1, q2), (w1, w2) = q, qd
    d11 = m1 * lc1**2 + m2 * (l1**2 + lc2**2 + 2 * l1 * lc2 * math.cos(q2)) + I1 + I2
    d22 = m2 * lc2**2 + I2
    d12 = m2 * (lc2**2 + l1 * lc2 * math.cos(q2)) + I2
    h1 = -m2 * l1 * lc2 * math.sin(q2) * w2**2 - 2 * m2 * l1 * lc2 * math.sin(q2) * w2 * w1
    h2 = m2 * l1 * lc2 * math.sin(q2) * w1**2
    phi2 = m2 * lc2 * g * math.cos(q1 + q2)
    phi1 = (m1 * lc1 + m2 * l1) * g * math.cos(q1) + phi2
    return [[d11, d12], [d12, d22]], [h1, h2], [phi1, phi2]


def test_acrobot_of_spong():
    rng = np.random.default_rng(4)
    for _ in range(5):
        q, qd = rng.uniform(-3, 3, 2), rng.uniform(-3, 3, 2)
        M, h, phi = spong_acrobot(q, qd, 1, 1, 1, 0.5, 1, 0.083, 0.33, 9.8)
        robot = arms.acrobot()
        assert mass_matrix(robot, q) == pytest.approx(np.array(M))
        assert coriolis(robot, q, qd) == pytest.approx(np.array(h))
        assert gravity(robot, q) == pytest.approx(np.array(phi))
    assert [joint.effort for joint in robot.joints] == [0, math.inf]
    assert position(robot, [-PI / 2, 0]) == pytest.approx([0, -3, 0])


def test_acrobot_of_gymnasium():
    """d1, d2, phi1, phi2 of the environment's source (the 'book' variant), angles from below."""
    robot = arms.acrobot(l2=1, lc2=0.5, I1=1, I2=1, angle_from="down")
    q, qd = np.array([0.7, -1.1]), np.array([0.4, 2.0])
    c2, s2, g = math.cos(q[1]), math.sin(q[1]), 9.8
    d1 = 0.5**2 + (1 + 0.5**2 + 2 * 0.5 * c2) + 1 + 1
    d2 = (0.5**2 + 0.5 * c2) + 1
    phi2 = 0.5 * g * math.cos(q[0] + q[1] - PI / 2)
    phi1 = -0.5 * qd[1] ** 2 * s2 - 2 * 0.5 * qd[1] * qd[0] * s2
    phi1 += 1.5 * g * math.cos(q[0] - PI / 2) + phi2
    M, bias = mass_matrix(robot, q), coriolis(robot, q, qd) + gravity(robot, q)
    assert M[0] == pytest.approx([d1, d2])
    assert bias == pytest.approx([phi1, 0.5 * qd[0] ** 2 * s2 + phi2])


# -- pendubot and inertia-wheel pendulum ---------------------------------------------------------


def test_the_pendubot_is_an_acrobot_with_its_motor_at_the_shoulder():
    rng = np.random.default_rng(1)
    q = rng.normal(size=(4, 2))
    alike = arms.planar_2r()
    assert arms.pendubot().mass_matrix(q) == pytest.approx(alike.mass_matrix(q))
    assert arms.pendubot().gravity(q) == pytest.approx(alike.gravity(q))
    assert list(arms.pendubot().limits.effort) == [math.inf, 0.0]
    assert arms.pendubot(m2=3.0).links[2].inertia.mass == 3.0


def test_the_wheel_pendulum_has_the_equations_of_its_docstring():
    rng = np.random.default_rng(1)
    arm = arms.inertia_wheel_pendulum(m1=1.5, m2=0.7, l1=0.8, lc1=0.3, I1=0.2, I2=0.05, g0=9.0)
    q, qd = rng.normal(size=(2, 4, 2))
    M = [[1.5 * 0.09 + 0.7 * 0.64 + 0.25, 0.05], [0.05, 0.05]]
    m3 = (1.5 * 0.3 + 0.7 * 0.8) * 9.0
    assert arm.mass_matrix(q) == pytest.approx(np.broadcast_to(M, (4, 2, 2)))
    assert abs(arm.coriolis(q, qd)).max() < 1e-14
    assert arm.gravity(q) == pytest.approx(np.stack([-m3 * np.sin(q[:, 0]), 0 * q[:, 0]], 1))
    assert arm.potential_energy(q) == pytest.approx(m3 * np.cos(q[:, 0]))
    hangs = arms.inertia_wheel_pendulum(angle_from="down")
    assert hangs.gravity([0.1, 0.0])[0] == pytest.approx(14.715 * np.sin(0.1))


# -- cart-pole ------------------------------------------------------------------------------------


def test_cart_pole_of_barto_sutton_and_anderson():
    """Their accelerations (frictionless), as corrected by Florian 2007 where they agree."""
    mc, mp, half, g = 1.0, 0.1, 0.5, 9.8
    robot = arms.cart_pole()
    for theta, w, F in ((0.1, 0.5, 10.0), (-0.7, 2.0, -10.0), (2.0, -1.0, 3.0)):
        total = mc + mp
        pull = (-F - mp * half * w**2 * math.sin(theta)) / total
        top = g * math.sin(theta) + math.cos(theta) * pull
        alpha = top / (half * (4 / 3 - mp * math.cos(theta) ** 2 / total))
        a = (F + mp * half * (w**2 * math.sin(theta) - alpha * math.cos(theta))) / total
        m = mechanism(robot)
        qdd = quantities.forward_dynamics(m, [0.3, theta], [1.5, w], [F, 0.0])
        assert qdd == pytest.approx([a, alpha])
    assert position(robot, [0.3, 0.1]) == pytest.approx([0.3 + math.sin(0.1), math.cos(0.1), 0])


def test_cart_pole_of_tedrake():
    mc, mp, l, g = 2.0, 0.6, 0.8, 9.81
    robot = arms.cart_pole(mc, mp, l, 0.0, g, angle_from="down")
    theta, w = 0.9, -1.7
    M = [[mc + mp, mp * l * math.cos(theta)], [mp * l * math.cos(theta), mp * l**2]]
    assert mass_matrix(robot, [0.2, theta]) == pytest.approx(np.array(M))
    assert coriolis(robot, [0.2, theta], [1.0, w]) == pytest.approx(
        [-mp * l * w**2 * math.sin(theta), 0], abs=1e-14
    )
    assert gravity(robot, [0.2, theta]) == pytest.approx([0, mp * g * l * math.sin(theta)])
    assert [joint.effort for joint in robot.joints] == [math.inf, 0]


# -- SCARA ----------------------------------------------------------------------------------------


def test_scara_against_its_equations():
    rng = np.random.default_rng(6)
    m1, m2, m3, m4, l1, l2, I4 = rng.uniform(0.2, 2, 7)
    robot = arms.scara(m1, m2, m3, m4, l1, l2, 0.4, I4, 9.8)
    q1, q2, q3, _ = q = rng.uniform(-2, 2, 4)
    m, c = m3 + m4, math.cos(q2)
    b = (m2 / 2 + m) * l1 * l2 * c
    M22 = (m2 / 3 + m) * l2**2 + I4
    M11 = (m1 / 3 + m2 + m) * l1**2 + 2 * b + M22
    M = [[M11, M22 + b, 0, -I4], [M22 + b, M22, 0, -I4], [0, 0, m, 0], [-I4, -I4, 0, I4]]
    assert mass_matrix(robot, q) == pytest.approx(np.array(M), abs=1e-14)
    assert gravity(robot, q) == pytest.approx([0, 0, -m * 9.8, 0], abs=1e-13)
    x = l1 * math.cos(q1) + l2 * math.cos(q1 + q2)
    y = l1 * math.sin(q1) + l2 * math.sin(q1 + q2)
    assert position(robot, q) == pytest.approx([x, y, 0.4 - q3])


def test_scara_in_symbols():
    m1, l1 = sympy.symbols("m1 l1", positive=True)
    (row, *_) = quantities.mass_matrix(mechanism(arms.scara(m1=m1, l1=l1)), [0.0] * 4)
    assert sympy.nsimplify(sympy.expand(sympy.diff(row[0], m1)), rational=True) == l1**2 / 3


# -- Stanford arm ---------------------------------------------------------------------------------

# the range of M_ii without load, joints 1 to 5: Bejczy 1974, as in Paul 1981, chapter 6
BEJCZY = [(1.417, 6.176), (3.590, 6.950), (7.257, 7.257), (0.108, 0.123), (0.114, 0.114)]


def test_stanford_inertias_range_as_bejczy_found():
    """The reading of the table (centimetres, tensors about the frames' origins) is the right one.

    The drives and figures are rounded, and the stroke of the table is not stated: 1.11 m of
    extension gives its largest values, and 4 % covers the difference.
    """
    robot, quarter = arms.stanford(), PI / 2
    poses = [
        [0, q2, q3, q4, q5, 0]
        for q2 in (0, quarter, -quarter)
        for q3 in np.linspace(0.15, 1.11, 30)
        for q4 in (0, quarter)
        for q5 in (0, quarter, -quarter)
    ]
    diagonals = np.array([np.diag(mass_matrix(robot, q)) for q in poses])
    for i, (low, high) in enumerate(BEJCZY):
        assert diagonals[:, i].min() == pytest.approx(low, rel=0.04)
        assert diagonals[:, i].max() == pytest.approx(high, rel=0.04)


def test_stanford_geometry():
    robot = arms.stanford()
    # at q = (0, 0, d, …) the boom points up from the shoulder, 0.154 m beside the column
    assert position(robot, [0, 0, 0.5, 0, 0, 0]) == pytest.approx([0, 0.154, 0.412 + 0.5 + 0.263])
    q = [0.3, 1.0, 0.5, 0, 0, 0]
    boom = 0.5 + 0.263
    x, y = boom * math.sin(1.0), 0.154
    c, s = math.cos(0.3), math.sin(0.3)
    assert position(robot, q) == pytest.approx(
        [c * x - s * y, s * x + c * y, 0.412 + boom * math.cos(1.0)]
    )


# -- PUMA 560: figures of the Robotics Toolbox's documentation and tests, four decimals -----------

QN = [0, PI / 4, PI, 0, PI / 4, 0]
FOUR_DECIMALS = 5.1e-5


def test_puma560_gravity():
    expected = [0, 31.6399, 6.0351, 0, 0.0283, 0]
    assert gravity(arms.puma560(), QN) == pytest.approx(expected, abs=FOUR_DECIMALS)


def test_puma560_inertia():
    expected = [
        [3.6594, -0.4044, 0.1006, -0.0025, 0, 0],
        [-0.4044, 4.4137, 0.3509, 0, 0.0024, 0],
        [0.1006, 0.3509, 0.9378, 0, 0.0015, 0],
        [-0.0025, 0, 0, 0.1925, 0, 0],
        [0, 0.0024, 0.0015, 0, 0.1713, 0],
        [0, 0, 0, 0, 0, 0.1941],
    ]
    assert mass_matrix(arms.puma560(), QN) == pytest.approx(np.array(expected), abs=FOUR_DECIMALS)


def test_puma560_coriolis_matrix():
    """Theirs splits each velocity product evenly, which is Christoffel's choice."""
    expected = [
        [-0.1735, -2.0494, -0.1178, -0.0002, -0.0045, 0.0001],
        [0.6274, 1.1572, 1.9287, -0.0015, -0.0003, 0],
        [-0.3608, -0.7734, -0.0018, -0.0009, -0.0064, 0],
        [0.0011, 0.0005, -0.0001, 0.0002, 0.0002, -0.0001],
        [-0.0002, 0.0028, 0.0046, -0.0002, 0, 0],
        [0.0001, 0, 0, 0, 0, 0],
    ]
    C = coriolis_matrix(arms.puma560(), QN, [1, 2, 3, 1, 2, 3])
    assert pytest.approx(np.array(expected), abs=FOUR_DECIMALS) == C


def test_puma560_inertial_torque():
    expected = [3.1500, 9.4805, 3.6189, 0.1901, 0.3519, 0.5823]
    torque = mass_matrix(arms.puma560(), QN) @ [1, 2, 3, 1, 2, 3]
    assert torque == pytest.approx(expected, abs=FOUR_DECIMALS)


GEARS = np.array([62.6111, 107.815, 53.7063, 76.0364, 71.923, 76.686])
TC_PLUS = np.array([0.395, 0.126, 0.132, 11.2e-3, 9.26e-3, 3.96e-3])


def test_puma560_friction():
    """Their inverse dynamics at qd = qdd = 1 holds friction, with Tc of the direction qd > 0."""
    robot, one = arms.puma560(), [1.0] * 6
    theirs = np.array([32.4952, 60.8670, 17.7436, 1.4545, 1.2991, 0.7138])
    rigid = mass_matrix(robot, QN) @ one + coriolis(robot, QN, one) + gravity(robot, QN)
    viscous = [joint.viscous for joint in robot.joints]
    assert theirs - rigid - GEARS * TC_PLUS == pytest.approx(viscous, abs=2 * FOUR_DECIMALS)
    means = GEARS * [0.415, 0.0985, 0.1185, 14.05e-3, 11.88e-3, 7.23e-3]
    assert [joint.coulomb for joint in robot.joints] == pytest.approx(means)


def test_puma560_forward_dynamics():
    """Their `accel`, with all friction, so with the same forces applied from outside."""
    qd, torque = np.array([0.1, 0.2, 0.8, 0.2, 0.5, 1.0]), [1.0, 3.2, 1.8, 0.1, 0.7, 4.6]
    robot = arms.puma560()
    applied = torque - qd * [joint.viscous for joint in robot.joints] - GEARS * TC_PLUS
    qdd = quantities.forward_dynamics(mechanism(robot), QN, list(qd), list(applied))
    expected = [-7.4102, -9.8432, -10.9694, -4.4314, -0.9881, 21.0228]
    assert qdd == pytest.approx(expected, abs=FOUR_DECIMALS)


def test_puma560_zero_pose():
    """Corke's book: T at qz is (0.4521, -0.15, 0.4318)."""
    assert position(arms.puma560(), [0] * 6) == pytest.approx([0.4521, -0.15005, 0.4318])


def test_puma560_gravity_constants_of_the_explicit_model():
    """Armstrong, Khatib & Burdick 1986: g2 = -37.2 c2 - 8.44 s23 + 1.02 s2 + 0.249 c23 - 0.0282 ….

    Their joint 2 counts from pi, which turns the signs of c2 and s2. The last constant, the
    hand's, joins s23 while the wrist is straight. Link 4's centre of mass lies 19 mm beyond the
    wrist in Corke's frames and 19 mm before it in theirs: twice its moment is the difference.
    """
    robot, rng = arms.puma560(), np.random.default_rng(0)
    poses = [[0, *rng.uniform(-3, 3, 2), 0, 0, 0] for _ in range(12)]
    terms = [[math.cos(a), math.sin(a + b), math.sin(a), math.cos(a + b)] for _, a, b, *_ in poses]
    constants, *_ = np.linalg.lstsq(terms, [gravity(robot, q)[1] for q in poses])
    link4 = 2 * 0.82 * 0.019 * 9.81
    expected = [37.2, -8.44 - 0.0282 - link4, -1.02, 0.249]
    assert constants == pytest.approx(expected, rel=5e-3)


def test_puma560_in_the_frames_of_armstrong_khatib_and_burdick():
    """Their modified table, with Corke's sign for link 4, moves as Corke's standard one.

    Their d4 is 433.1 mm to his 431.8 and their d3 0.1 mm off: half a percent.
    """
    table = [
        {"m": 0.0, "I": (0.175, 0.175, 0.35)},
        {"d": 0.2435, "alpha": -PI / 2, "m": 17.4, "r": (0.068, 0.006, -0.016)},
        {"d": -0.0934, "a": 0.4318, "m": 4.8, "r": (0, -0.070, 0.014), "I": (0.066, 0.0125, 0.086)},
        {"d": 0.4331, "a": -0.0203, "alpha": PI / 2, "m": 0.82, "r": (0, 0, 0.019)},
        {"alpha": -PI / 2, "m": 0.34, "I": (0.3e-3, 0.3e-3, 0.4e-3)},
        {"alpha": PI / 2, "m": 0.09, "r": (0, 0, 0.032), "I": (0.15e-3, 0.15e-3, 0.04e-3)},
    ]
    table[1]["I"], table[3]["I"] = (0.13, 0.524, 0.539), (1.8e-3, 1.8e-3, 1.3e-3)
    with pytest.warns(ModelWarning):
        theirs = from_dh(table, "modified")
    ours = arms.puma560()
    drives = np.diag([joint.armature for joint in ours.joints])
    for q2, q3 in ((0.3, 0.8), (-0.6, 2.0), (1.4, -0.5)):
        mine, other = [0, q2, q3, 0, 0, 0], [0, q2 - PI, q3 + PI, 0, 0, 0]
        assert gravity(ours, mine)[:3] == pytest.approx(gravity(theirs, other)[:3], abs=0.02)
        M, other_M = (mass_matrix(ours, mine) - drives)[:3, :3], mass_matrix(theirs, other)[:3, :3]
        assert pytest.approx(other_M, abs=3e-3) == M


# -- the shipped files ----------------------------------------------------------------------------

ROBOTS = Path(sysconfig.get_path("purelib"), "cmeel.prefix/share/example-robot-data/robots")


def panda_figures(path):
    """The text of every number of links 1 to 7 and joints 1 to 8, as floats."""
    root, figures = ElementTree.parse(path).getroot(), {}
    for node in root:
        name = node.get("name", "")
        if not re.fullmatch("panda_(link[1-7]|joint[1-8])", name):
            continue
        for tag in ("origin", "mass", "inertia", "axis", "limit"):
            for element in node.iterfind(f".//inertial/{tag}" if node.tag == "link" else tag):
                for key, value in element.items():
                    figures[name, tag, key] = [float(v) for v in value.split()]
    return figures


@pytest.mark.skipif(not ROBOTS.exists(), reason="example-robot-data is not there")
def test_panda_figures_are_those_of_franka_ros():
    """example-robot-data's file is generated from franka_ros; its joint 8 has no more than ours."""
    ours = panda_figures(resources.files("mcgee") / "robots/panda.urdf")
    theirs = panda_figures(ROBOTS / "panda_description/urdf/panda.urdf")
    assert len(ours) == 7 * 8 + 7 * 7 + 2
    assert {key: theirs[key] for key in ours} == ours


def test_panda_gravity_of_gaz_et_al():
    """Their own function, generated from the base parameters; joints 3 and 5 not worked out.

    The feasible parameters that are published reproduce those within 0.05 N·m.
    """
    robot = replace(arms.panda(), gravity_vector=(0.0, 0.0, -9.80665))
    some = [0, 1, 3, 5, 6]
    for q, expected in (
        ([0, -0.785, 0, -2.356, 0, 1.571, 0.785], [0, -1.7502, 18.525, 1.6714, 0]),
        ([0.3, 0.9, -0.4, -1.2, 0.7, 2.0, -1.1], [0, -45.9163, 18.1017, 1.527, -0.0105]),
    ):
        assert gravity(robot, q)[some] == pytest.approx(expected, abs=0.05)


def test_panda_kinematics_are_frankas_table():
    """The modified table a, d, alpha of the FCI documentation, with the flange at 0.107 m."""
    h = PI / 2
    a, alpha = (0, 0, 0, 0.0825, -0.0825, 0, 0.088), (0, -h, h, h, -h, h, h)
    d = (0.333, 0, 0.316, 0, 0.384, 0, 0)
    table = [
        {"a": ak, "d": dk, "alpha": bk, "m": 1} for ak, dk, bk in zip(a, d, alpha, strict=True)
    ]
    flange = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.107], [0, 0, 0, 1]]
    theirs, ours = from_dh(table, "modified", tool=flange), arms.panda()
    for q in np.random.default_rng(1).uniform(-3, 3, (5, 7)):
        expected = quantities.forward_kinematics(mechanism(theirs), list(q), "tip")
        pose = quantities.forward_kinematics(mechanism(ours), list(q), "panda_link8")
        assert np.array(pose, float) == pytest.approx(np.array(expected, float), abs=1e-14)


def test_ur5e_is_the_makers_table():
    """Universal Robots' article: theta = q, a, d, alpha, mass and centre of mass in DH frames."""
    h = PI / 2
    tensors = [
        [0.00700210, 0.00000073, -0.00001053, 0.00648091, 0.00049994, 0.00657286],
        [0.01505885, -0.00005400, 0.00000563, 0.33388086, -0.00000181, 0.33247207],
        [0.00399632, -0.00001365, 0.00137272, 0.07879254, -0.00000660, 0.07848510],
        [0.00165491, -0.00000282, -0.00000438, 0.00135962, 0.00010157, 0.00126279],
        [0.00135617, -0.00000274, 0.00000444, 0.00127827, -0.00005048, 0.00096614],
        [0.00018694, 0.00000006, -0.00000017, 0.00018908, -0.00000092, 0.00025756],
    ]
    table = [
        {"d": 0.1625, "alpha": h, "m": 3.761, "r": (0, -0.02561, 0.00193)},
        {"a": -0.425, "m": 8.058, "r": (0.2125, 0, 0.11336)},
        {"a": -0.3922, "m": 2.846, "r": (0.15, 0, 0.0265)},
        {"d": 0.1333, "alpha": h, "m": 1.37, "r": (0, -0.0018, 0.01634)},
        {"d": 0.0997, "alpha": -h, "m": 1.3, "r": (0, 0.0018, 0.01634)},
        {"d": 0.0996, "m": 0.365, "r": (0, 0, -0.001159)},
    ]
    for row, (xx, xy, xz, yy, yz, zz) in zip(table, tensors, strict=True):
        row["I"] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    file = ElementTree.parse(resources.files("mcgee") / "robots/ur5e.urdf")
    assert [[float(v) for v in e.attrib.values()] for e in file.iter("inertia")] == tensors
    theirs, ours = from_dh(table), arms.ur5e()
    for q in np.random.default_rng(1).uniform(-3, 3, (5, 6)):
        poses = [
            np.array(quantities.forward_kinematics(mechanism(r), list(q), end), float)
            for r, end in ((theirs, "tip"), (ours, "tool0"))
        ]
        assert poses[0] == pytest.approx(poses[1], abs=1e-14)
        assert mass_matrix(ours, q) == pytest.approx(mass_matrix(theirs, q), abs=1e-13)
        assert gravity(ours, q) == pytest.approx(gravity(theirs, q), abs=1e-12)


def test_shipped_limits():
    panda, ur5e = ([j for j in r.joints if j.moves] for r in (arms.panda(), arms.ur5e()))
    assert [(j.velocity, j.effort) for j in panda] == [(2.175, 87)] * 4 + [(2.61, 12)] * 3
    assert [j.effort for j in ur5e] == [150] * 3 + [28] * 3
    assert all(j.upper == -j.lower == 2 * PI and j.velocity == PI for j in ur5e)


# -- every mistake has its sentence ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: arms.planar_2r(plane="x"), "plane is 'x', expected 'vertical' or 'horizontal'."),
        (
            lambda: arms.pendulum(angle_from="up"),
            "angle_from is 'up', expected 'horizontal' or 'down'.",
        ),
        (lambda: arms.inertia_wheel_pendulum(I2=-1), "I2 is -1, expected zero or more [kg·m²]."),
        (
            lambda: arms.inertia_wheel_pendulum(angle_from="left"),
            "angle_from is 'left', expected 'up' or 'down'.",
        ),
        (lambda: arms.cart_pole(angle_from="x"), "angle_from is 'x', expected 'up' or 'down'."),
        (lambda: arms.planar_2r(m2=-1), "link 2: m is -1, expected zero or more [kg]."),
        (lambda: arms.planar_2r(I1=-1), "link 1: I is -1, expected zero or more [kg·m²]."),
        (lambda: arms.planar_2r(l1="1"), "link 1: l is '1', expected a finite number [m]."),
        (lambda: arms.acrobot(g0=math.nan), "g0 is nan, expected a finite number [m/s²]."),
        (lambda: arms.cart_pole(mp=-2), "mp is -2, expected zero or more [kg]."),
        (lambda: arms.scara(I4=-1), "I4 is -1, expected zero or more [kg·m²]."),
        (lambda: arms.planar_nr(0), "n is 0, expected a whole number of joints, one or more."),
        (lambda: arms.planar_nr(2.0), "n is 2.0, expected a whole number of joints, one or more."),
        (lambda: arms.planar_nr(3, m=[1, 2]), "m has 2 values, expected one or n = 3."),
    ],
)
def test_a_mistake_is_named(build, sentence):
    with pytest.raises(ModelError, match=re.escape(sentence)):
        build()
