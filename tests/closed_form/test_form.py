"""What robots with symbols can and cannot have, and what bad arguments get."""

import copy
import math
import pickle

import numpy as np
import pytest
import sympy

import mcgee
from mcgee import arms
from mcgee.closed_form import ring
from robots import built_in, interpreted, random_tree

m, l, alpha = sympy.symbols("m l alpha")


def dh(**row):
    body = {"m": 1.0, "r": (0.1, 0, 0), "I": (0.1, 0.2, 0.3)}
    return mcgee.from_dh([body | row, body | {"a": 0.3}])


def test_symbolic_angles_stay_angles():
    form = dh(alpha=alpha, theta=sympy.Symbol("beta"), a=l, m=m).closed_form()
    angles = {str(x.args[0]) for e in form.M for x in e.atoms(sympy.cos, sympy.sin)}
    assert {"alpha", "q2"} <= angles
    assert form.prove()
    numbers = {"alpha": 0.4, "beta": -0.3, "l": 0.5, "m": 2.0}
    arm = interpreted(dh(alpha=0.4, theta=-0.3, a=0.5, m=2.0))
    q, qd = [0.3, -0.8], [1.0, 2.0]
    for quantity, method in (("M", "mass_matrix"), ("g", "gravity")):
        got = form.evaluate(quantity, q, values=numbers)
        assert np.allclose(got, getattr(arm, method)(q), rtol=1e-13, atol=1e-14)
    assert np.allclose(form.evaluate("Cqd", q, qd, values=numbers), arm.coriolis(q, qd))


def test_symbolic_and_exact_angles_mix():
    form = mcgee.from_dh(
        [{"alpha": alpha, "theta": math.pi / 6, "m": 1}, {"a": 1, "m": m}], convention="modified"
    ).closed_form()
    assert form.prove()
    assert form.exact.ring.roots == (3,)


def test_parameters_divide_by_symbols_and_hold_products():
    form = arms.pendulum(m / l, 1, l**2, m * l**3 / 12, sympy.sqrt(2)).closed_form()
    assert sympy.expand(form.M[0] - (m * l**3 / 12 + m * l**3)) == 0
    assert form.prove()


def test_symbolic_inertias_are_the_inertial_parameters():
    arm = built_in("ur5e")
    form = arm.closed_form(symbolic_inertias=True)
    names = ("m", "hx", "hy", "hz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
    values = dict(
        zip([f"{x}{k}" for k in range(1, 7) for x in names], arm.inertial_parameters, strict=True)
    )
    q = np.array([0.3, -0.8, 1.2, 0.4, 2.0, -1.0])
    assert np.allclose(
        form.evaluate("M", q, values=values), interpreted(arm).mass_matrix(q), rtol=1e-12
    )


def test_numbers_are_exact():
    form = arms.planar_2r(m1=0.1, l1=0.1).closed_form()
    assert form.M[1, 1] == sympy.Rational(7, 20)
    assert form.P.coeff(sympy.sin(form.q[0])) == sympy.Rational("1.4715")


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"m": sympy.exp(l)}, r"robot 'dh' has the parameter exp\(l\), expected a polynomial in"),
        ({"a": 1 / (l + 1)}, r"has the parameter 1/\(l \+ 1\)"),
        ({"alpha": alpha**2}, r"has the parameter alpha\*\*2"),
        ({"a": sympy.Symbol("q1")}, "has the symbol 'q1', which closed_form.. uses itself. Give"),
    ],
)
def test_parameters_that_are_refused(change, sentence):
    with pytest.raises(ValueError, match=sentence):
        dh(**change).closed_form()


def test_a_rotation_of_free_symbols_is_refused():
    c, s = sympy.symbols("c s")
    base = [[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    arm = mcgee.from_dh([{"m": 1, "a": 1}], base=base)
    with pytest.raises(ValueError, match=r"has the parameter .*expected a polynomial in symbols"):
        arm.closed_form()


def test_mimic_joints_with_symbols_are_refused():
    from dataclasses import replace

    from mcgee.model import Mimic

    arm = dh()
    joints = (arm.joints[0], replace(arm.joints[1], mimic=Mimic("joint1", m)))
    with pytest.raises(ValueError, match="joint 'joint2' of robot 'dh' mimics with the factor or"):
        replace(arm, joints=joints).closed_form()


def test_arguments_that_are_refused():
    form = arms.planar_2r(m1=m).closed_form()
    with pytest.raises(ValueError, match=r"simplify is 'short', expected one of: expanded, collec"):
        form.simplified("short")
    with pytest.raises(ValueError, match=r"no quantity 'N'. Quantities: T, P, M, C, Cqd, g, tau"):
        form.evaluate("N", [0, 0])
    with pytest.raises(ValueError, match=r"q has shape \(3,\), expected \(..., 2\) for 'planar_2r"):
        form.evaluate("M", [0, 0, 0])
    with pytest.raises(ValueError, match=r"qd has shape \(\), expected \(..., 2\)"):
        form.evaluate("C", [0, 0], 1.0)
    with pytest.raises(ValueError, match=r"symbol 'm' has no value. Give one in values=.'m': …}"):
        form.evaluate("M", [0, 0])
    with pytest.raises(ValueError, match=r"'planar_2r' has no symbol 'k'. Its symbols: m, q1, q2"):
        form.evaluate("M", [0, 0], values={"k": 1})


def test_large_formulas_are_not_printed():
    text = str(built_in("panda").closed_form())
    assert "… 3" in text
    assert len(text) < 500_000


def test_what_would_not_fit_is_refused(monkeypatch):
    monkeypatch.setattr(ring, "MOST", 200)
    assert mcgee.load("puma560").closed_form().terms("M") < 200
    with pytest.raises(ValueError, match=r"formula of more than 200 terms, .* Put numbers in"):
        mcgee.load("puma560").closed_form(symbolic_inertias=True)


def test_one_state_and_states_that_broadcast():
    form = arms.planar_2r().closed_form()
    assert form.evaluate("P", [0.1, 0.2]) == pytest.approx(
        arms.planar_2r().potential_energy([0.1, 0.2])
    )
    assert form.evaluate("Cqd", [0.1, 0.2], np.ones((5, 2))).shape == (5, 2)
    assert form.evaluate("T", np.zeros((3, 1, 2)), np.ones((4, 2))).shape == (3, 4)


@pytest.mark.parametrize("simplify", ["expanded", "lumped"])
def test_forms_are_copied_and_pickled(simplify):
    form = arms.planar_2r(m1=m).closed_form(simplify=simplify)
    for other in (pickle.loads(pickle.dumps(form)), copy.deepcopy(form)):
        assert (other.M, other.simplify, other.lumps) == (form.M, simplify, form.lumps)
    own = mcgee.lagrange(sympy.Symbol("v") ** 2, 0, [sympy.Symbol("x")], [sympy.Symbol("v")])
    assert pickle.loads(pickle.dumps(own)).M == own.M


def test_general_rotations_are_shown_in_a_moment():
    """Denominators of hundreds of bits are not factored."""
    form = random_tree(5, bodies=3).closed_form()
    assert "M11 = " in str(form)
