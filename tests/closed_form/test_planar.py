"""The planar arms of the lesson, literally, and against SymPy's own mechanics."""

import numpy as np
import pytest
import sympy
from sympy import Matrix, cos, sin
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

import mcgee
from mcgee import arms

m1, m2, l1, l2, lc1, lc2, I1, I2, g0 = sympy.symbols("m1 m2 l1 l2 lc1 lc2 I1 I2 g0")
q1, q2, qd1, qd2 = sympy.symbols("q1 q2 qd1 qd2")

# the lesson's section 3, angles from the horizontal
M = Matrix(
    [
        [
            I1 + I2 + m1 * lc1**2 + m2 * (l1**2 + lc2**2 + 2 * l1 * lc2 * cos(q2)),
            I2 + m2 * (lc2**2 + l1 * lc2 * cos(q2)),
        ],
        [I2 + m2 * (lc2**2 + l1 * lc2 * cos(q2)), I2 + m2 * lc2**2],
    ]
)
CQD = Matrix(
    [
        -m2 * l1 * lc2 * sin(q2) * (2 * qd1 * qd2 + qd2**2),
        m2 * l1 * lc2 * sin(q2) * qd1**2,
    ]
)
G = Matrix(
    [
        (m1 * lc1 + m2 * l1) * g0 * cos(q1) + m2 * lc2 * g0 * cos(q1 + q2),
        m2 * lc2 * g0 * cos(q1 + q2),
    ]
)
P = m1 * g0 * lc1 * sin(q1) + m2 * g0 * (l1 * sin(q1) + lc2 * sin(q1 + q2))


@pytest.fixture(scope="module")
def two():
    return arms.planar_2r(m1, m2, l1, lc1, lc2, I1, I2, g0, l2=l2).closed_form()


def test_the_lesson_literally(two):
    """As printed: no identity of cosines is needed, only the products multiplied out."""
    assert M.expand() == two.M
    assert two.Cqd == CQD.expand()
    assert two.g == G.expand()
    assert sympy.expand(two.P - P) == 0
    assert sympy.expand(two.tau[1] - (two.M * Matrix(two.qdd) + CQD + G)[1]) == 0


def test_shapes_and_symbols(two):
    assert (two.M.shape, two.C.shape, two.Cqd.shape, two.g.shape, two.tau.shape) == (
        *((2, 2),) * 2,
        *((2, 1),) * 3,
    )
    assert two.q == (q1, q2)
    assert two.christoffel.shape == (2, 2, 2)
    assert two.christoffel[0, 1, 1] == two.christoffel[0][1][1] == -m2 * l1 * lc2 * sin(q2)
    assert [c[0, 0] for c in two.christoffel] == [0, m2 * l1 * lc2 * sin(q2)]
    assert sympy.expand(two.C * Matrix([qd1, qd2]) - two.Cqd) == Matrix([0, 0])


def test_the_lesson_at_its_reference_point(two):
    values = dict.fromkeys(("m1", "m2", "l1"), 1.0)
    values |= {"lc1": 0.5, "lc2": 0.5, "I1": 0.1, "I2": 0.1, "g0": 9.81}
    state = ([0.5, 0.3], [0.1, -0.2])
    want = arms.planar_2r().terms(*state)
    for quantity in ("M", "Cqd", "g"):
        got = two.evaluate(quantity, *state, values=values)
        assert np.allclose(got, getattr(want, quantity), rtol=1e-14, atol=1e-16)


def test_the_pendulum():
    m, lc, I = sympy.symbols("m lc I")
    form = arms.pendulum(m, 1, lc, I, g0).closed_form()
    assert Matrix([[I + m * lc**2]]) == form.M
    assert form.g == Matrix([m * g0 * lc * sin(q1)])
    assert sympy.expand(form.P - m * g0 * lc * (1 - cos(q1))) == 0


def test_parallel_axes_print_as_sums_of_angles():
    l, lc, m, I = (sympy.symbols([f"{x}{k}" for k in (1, 2, 3, 4)]) for x in ("l", "lc", "m", "I"))
    form = arms.planar_nr(4, m, l, lc, I, g0).closed_form()
    angles = {str(a.args[0]) for e in (*form.M, *form.g) for a in e.atoms(cos, sin)}
    assert angles == {
        *("q2", "q3", "q4", "q2 + q3", "q3 + q4", "q2 + q3 + q4"),
        *("q1", "q1 + q2", "q1 + q2 + q3", "q1 + q2 + q3 + q4"),
    }
    assert all(len(term.atoms(cos, sin)) <= 1 for e in form.M for term in e.as_ordered_terms())
    assert form.prove()


def test_a_base_angle_is_part_of_the_angle():
    phi = sympy.Symbol("phi")
    pose = [[cos(phi), -sin(phi), 0, 0], [sin(phi), cos(phi), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    rows = [{"a": l1, "m": m1, "r": (-l1 / 2, 0, 0), "I": (0, 0, I1)}, {"a": l2, "m": m2}]
    arm = mcgee.from_dh(rows, base=pose, gravity_vector=(0, -g0, 0))
    form = arm.closed_form()
    assert form.g[1] == g0 * l2 * m2 * cos(phi + q1 + q2)
    assert form.prove()


def test_the_horizontal_plane_has_no_gravity():
    form = arms.planar_2r(m1, m2, l1, lc1, lc2, I1, I2, g0, l2=l2, plane="horizontal").closed_form()
    assert form.g == Matrix([0, 0])
    assert form.prove()["M without q1"].note.endswith("Nor does P: ∂T/∂qd1 stays as it is.")


def test_sympy_mechanics(two):
    """Lagrange's equations by SymPy, from the same energies."""
    t = dynamicsymbols._t
    a, b = dynamicsymbols("q1 q2")
    moving = {qd1: a.diff(t), qd2: b.diff(t), q1: a, q2: b}
    energies = [e.subs(moving, simultaneous=True) for e in (two.T, two.P)]
    method = LagrangesMethod(energies[0] - energies[1], [a, b])
    method.form_lagranges_equations()
    still = {v: k for k, v in moving.items()}
    got = method.mass_matrix.xreplace(still)
    assert sympy.simplify(got - two.M) == sympy.zeros(2)
    bias = (-method.forcing).xreplace({a.diff(t): qd1, b.diff(t): qd2}).xreplace(still)
    assert sympy.simplify(bias - two.Cqd - two.g) == sympy.zeros(2, 1)


def test_collected_has_one_term_a_configuration(two):
    form = two.simplified("collected")
    assert form.g[0] == g0 * lc2 * m2 * cos(q1 + q2) + g0 * (l1 * m2 + lc1 * m1) * cos(q1)
    assert sympy.expand(form.M) == two.M


def test_lumped_names_each_constant_once(two):
    form = two.simplified("lumped")
    a = {str(s): s for s in form.lumps}
    assert (
        Matrix(
            [
                [2 * a["a1"] * cos(q2) + a["a2"] + a["a3"], a["a1"] * cos(q2) + a["a2"]],
                [a["a1"] * cos(q2) + a["a2"], a["a2"]],
            ]
        )
        == form.M
    )
    assert form.lumps == {
        a["a1"]: l1 * lc2 * m2,
        a["a2"]: I2 + m2 * lc2**2,
        a["a3"]: I1 + m1 * lc1**2 + m2 * l1**2,
        a["a4"]: g0 * lc2 * m2,
        a["a5"]: g0 * l1 * m2 + g0 * lc1 * m1,
    }
    for quantity in ("T", "P", "M", "C", "Cqd", "g", "tau"):
        named = getattr(form, quantity).subs(form.lumps)
        difference = named - getattr(two, quantity)
        assert sympy.expand(difference) in (0, sympy.zeros(*getattr(difference, "shape", (0, 0))))


def test_lumps_do_not_take_the_names_of_parameters():
    a1 = sympy.Symbol("a1")
    form = arms.pendulum(a1, 1, lc1, I1, g0).closed_form(simplify="lumped")
    assert [str(s) for s in form.lumps] == ["a_1", "a_2"]


def test_text_and_latex(two):
    text = str(two)
    assert "M12 = I2 + l1*lc2*m2*cos(q2) + lc2**2*m2" in text
    assert "g2 = g0*lc2*m2*cos(q1 + q2)" in text
    latex = two.latex()
    assert r"\dot{q}_{1}" in latex
    assert r"\cos{\left(q_{1} + q_{2} \right)}" in latex
    assert repr(two) == "ClosedForm of 'planar_2r': 2 joints, M has 17 terms"
    assert "a3 = " in str(two.simplified("lumped"))


def test_long_fractions_are_shown_as_decimals():
    form = arms.planar_2r(m1=1.2345678, m2=0.1).closed_form()
    assert form.P.coeff(sin(q1)) == sympy.Rational("7.036555059")
    assert "M22 = 1/8" in str(form)
    assert "7.03656*cos(q1)" in str(form)
