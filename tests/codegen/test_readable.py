"""Formulas of textbook arms, as a person would write them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import sympy
from test_routine import PYTHON, run

import mcgee
from mcgee.codegen import readable, symbols
from mcgee.codegen.expression import text
from mcgee.codegen.routine import Item, Let, Put, Turn, routine
from robots import built_in

NAMED = ["pendulum", "planar_2r", "planar_3r", "acrobot", "cart_pole", "scara"]


def model(name: str) -> symbols.Model:
    return symbols.model(built_in(name), True, {})


def formulas(name: str) -> dict[str, str]:
    """By what is assigned, in the arm's own letters."""
    of = model(name)
    names = list(of.defaults)

    def item(i: Item) -> str:
        return names[i.index] if i.array == "params" else f"{i.array}{i.index + 1}"

    made = readable.dynamics(of)
    assert made is not None
    syntax = type(PYTHON)(item)
    found = {}
    for step in made.parts[0]:
        if isinstance(step, Let):
            found[step.name] = text(step.value, syntax)
        elif isinstance(step, Put):
            found[item(step.place)] = text(step.value, syntax)
    return found


def test_planar_2r_is_the_textbooks():
    found = formulas("planar_2r")
    assert found["M1"] == "I1 + I2 + m1*lc1*lc1 + m2*(l1*l1 + lc2*lc2) + 2.0*m2*l1*lc2*c2"
    assert found["M12"] == "I2 + m2*lc2*lc2 + m2*l1*lc2*c2"
    assert found["M2"] == found["M3"] == "M12"
    assert found["M4"] == "I2 + m2*lc2*lc2"
    assert found["Cqdot1"] == "-(m2*l1*lc2*s2*qdot2*(2.0*qdot1 + qdot2))"
    assert found["Cqdot2"] == "m2*l1*lc2*s2*qdot1*qdot1"
    assert found["g1"] == "g0*(m2*l1 + m1*lc1)*c1 + m2*lc2*g0*c12"
    assert found["g2"] == "m2*lc2*g0*c12"


def test_angles_are_named_by_their_joints():
    made = readable.dynamics(model("planar_3r"))
    assert made is not None
    turns = [step for step in made.parts[0] if isinstance(step, Turn)]
    names = [t.cosine or t.sine for t in turns]
    assert names == ["c1", "c2", "c3", "c12", "c23", "c123"]


def test_pendulum():
    assert formulas("pendulum") == {
        "M1": "I + m*lc*lc",
        "Cqdot1": "0.0",
        "g1": "m*lc*g0*s1",
    }


@pytest.mark.parametrize("name", NAMED)
def test_formulas_give_what_the_kernels_do(name, rng):
    of = model(name)
    made = readable.dynamics(of)
    assert made is not None
    assert made.readable
    for _ in range(4):
        values = {k: v * rng.uniform(0.8, 1.2) for k, v in of.defaults.items()}
        arm = of.robot.subs(values)
        q, qd = rng.normal(size=(2, arm.n))
        got = run(made, q, qd, np.array(list(values.values())))
        for a, b in zip(got, arm.terms(q, qd), strict=True):
            assert abs(a - b).max() <= 1e-13 * max(1, abs(b).max())


def test_symbols_in_angles_and_fractions():
    a, b, beta = sympy.symbols("a b beta")
    row = {"a": a / b, "alpha": 0.0, "m": b, "r": [a, 0, 0], "I": (0.1, 0.1, 0.1)}
    rows = [row, row | {"offset": beta}]
    gravity = (0, -sympy.pi, 0)
    arm = mcgee.from_dh(rows, convention="standard", gravity_vector=gravity)
    values = {"a": 0.4, "b": 1.3, "beta": 0.7}
    made = readable.dynamics(symbols.model(arm, False, values))
    assert made is not None
    numeric = arm.subs(values)
    q, qd = np.array([0.3, -0.8]), np.array([1.1, 0.4])
    got = run(made, q, qd, np.array([values[s] for s in arm.symbols]))
    for x, y in zip(got, numeric.terms(q, qd), strict=True):
        assert abs(x - y).max() <= 1e-13 * max(1, abs(y).max())


def test_long_formulas_are_left_to_the_graph(monkeypatch):
    monkeypatch.setattr(readable, "MOST", 15)
    assert readable.dynamics(model("planar_2r")) is None
    made = model("planar_2r").trace("terms")
    assert [a.name for a in made.inputs] == ["q", "qd", "params"]


def test_symbols_called_like_coordinates_are_left_to_the_graph(rng):
    arm = mcgee.arms.planar_2r(m1=sympy.Symbol("q1"), l1=sympy.Symbol("qd2"))
    of = symbols.model(arm, False, {"q1": 2.0, "qd2": 0.7})
    assert readable.dynamics(of) is None
    made = routine(of.trace("terms"))
    q, qd = rng.normal(size=(2, 2))
    got = run(made, q, qd, np.array([of.defaults[s] for s in arm.symbols]))
    for a, b in zip(got, arm.subs(of.defaults).terms(q, qd), strict=True):
        assert abs(a - b).max() <= 1e-13 * max(1, abs(b).max())


def test_numbers_are_not_formulas():
    assert readable.dynamics(symbols.model(built_in("puma560"), True, {})) is None


# -- what parameters there are --------------------------------------------------------------------


def test_parameters_are_those_of_the_textbook():
    of = model("planar_2r")
    assert list(of.defaults) == ["m1", "m2", "l1", "lc1", "lc2", "I1", "I2", "g0", "l2"]
    arm = mcgee.arms.planar_2r(m1=2.5, angle_from="down")
    assert symbols.model(arm, True, {}).defaults["m1"] == 2.5
    assert symbols.model(arm, True, {"m1": 7}).defaults["m1"] == 7


def test_parameters_keep_how_the_arm_was_made(rng):
    arm = mcgee.arms.planar_2r(plane="horizontal", angle_from="down")
    of = symbols.model(arm, True, {})
    numeric = of.robot.subs({k: v for k, v in of.defaults.items() if k in of.robot.symbols})
    q = rng.normal(size=2)
    assert np.array_equal(arm.gravity(q), numeric.gravity(q))
    assert abs(arm.forward_kinematics(q) - numeric.forward_kinematics(q)).max() < 1e-15


@pytest.mark.parametrize(
    "changed",
    [
        lambda arm: arm.replace(gravity_vector=(0, 0, -1.62)),
        lambda arm: arm.replace(armature={"joint1": 0.1}),
        lambda arm: dataclasses.replace(arm, gravity_vector=(0.0, 0.0, 0.0)),
        lambda arm: dataclasses.replace(arm, frames=()),
    ],
)
def test_a_changed_arm_is_no_longer_the_textbooks(changed):
    of = symbols.model(changed(mcgee.arms.planar_2r(m2=2.0)), True, {})
    assert list(of.defaults)[:4] == ["m1", "hx1", "hy1", "hz1"]
    assert len(of.defaults) == 20


def test_a_new_name_changes_nothing():
    arm = mcgee.arms.planar_2r().replace(name="mine")
    assert list(symbols.model(arm, True, {}).defaults)[:3] == ["m1", "m2", "l1"]


def test_symbols_need_values():
    arm = mcgee.arms.planar_2r(m1=sympy.Symbol("m1"))
    with pytest.raises(ValueError, match="has the symbols m1 without values"):
        symbols.model(arm, False, {})
    assert symbols.model(arm, False, {"m1": 2}).defaults == {"m1": 2.0}


def test_values_of_nothing():
    with pytest.raises(ValueError, match="names 'm7', which is no parameter of 'planar_2r'"):
        symbols.model(built_in("planar_2r"), True, {"m7": 1})
    with pytest.raises(ValueError, match="for all its numbers are folded in"):
        symbols.model(built_in("planar_2r"), False, {"m1": 1})


def test_what_no_language_can_write():
    arm = mcgee.arms.planar_2r(l1=sympy.sqrt(sympy.Symbol("x")))
    with pytest.raises(ValueError, match="expected sums, products, whole powers"):
        symbols.model(arm, False, {"x": 1.0}).trace("inverse_dynamics")
