"""Wolfram packages in Mathics: what they derive in symbols, their numbers, their names."""

from __future__ import annotations

import dataclasses
import math
import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy
from units import made

import mcgee
from mcgee.codegen import VerificationError, wolfram_symbolic
from mcgee.codegen.common import layout
from mcgee.codegen.names import camel
from mcgee.codegen.unit import Function, Unit, unit
from mcgee.codegen.verify import Verification, verify
from mcgee.codegen.wolfram import WOLFRAM, context, files
from mcgee.codegen.wolfram_symbolic import Symbols, number, numeric
from robots import random_tree

ULP = 4.0
"""Units in the last place of a result's scale, against 60 digits."""

Evaluate = Callable[[str], Any]


@pytest.fixture(scope="module")
def kernel() -> Evaluate:
    """Evaluates an expression to numbers and lists, to a string where it holds symbols."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        loading = pytest.importorskip("mathics.core.load_builtin")
        loading.import_and_load_builtins()
        from mathics.session import MathicsSession

        session = MathicsSession(add_builtin=True, catch_interrupt=False)

    def evaluate(expression: str) -> Any:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = session.evaluate(expression)
        said = [str(getattr(out, "text", out)) for out in session.evaluation.out]
        session.evaluation.out.clear()
        assert not said, said
        return result.to_python()

    return evaluate


@pytest.fixture
def load(kernel, tmp_path) -> Callable[[Unit], None]:
    """Makes the names of a package known, and of no other."""

    def loaded(robot: Unit) -> None:
        path = tmp_path / f"{context(robot)}.wl"
        path.write_text(str(files(robot)[path.name]), encoding="ascii")
        kernel('$ContextPath = {"System`", "Global`"}')
        kernel(f'Get["{path}"]')

    return loaded


def of(robot, *functions: str, params: bool = False, values=None) -> Unit:
    return unit(robot, functions or ("terms",), params, values or {}, robot.end_frame, False)


def worst(kernel: Evaluate, robot: Unit, f: Function) -> float:
    """The largest error in the vectors' states, in units in the last place of the scale."""
    row, name = layout(f), Symbols(robot).own(numeric(f))
    errors = []
    for values in f.vectors.rows:
        given = (values[at : at + array.size] for array, at in row.inputs)
        arguments = ", ".join(f"{{{', '.join(map(number, x))}}}" for x in given)
        got = kernel(f"Flatten[{{{name}[{arguments}]}}]")
        for array, at, scale in row.outputs:
            own, got = got[: array.size], got[array.size :]
            want = values[at : at + array.size]
            errors += [
                abs(a - b) / (values[scale] * 2**-52) for a, b in zip(own, want, strict=True)
            ]
        assert not got
    return max(errors)


# -- in symbols -----------------------------------------------------------------------------------

M = """{
  {I1 + I2 + m1 lc1^2 + m2 (l1^2 + lc2^2 + 2 l1 lc2 Cos[q2]), I2 + m2 (lc2^2 + l1 lc2 Cos[q2])},
  {I2 + m2 (lc2^2 + l1 lc2 Cos[q2]), I2 + m2 lc2^2}}"""
CQDOT = "{-m2 l1 lc2 Sin[q2] (2 v1 v2 + v2^2), m2 l1 lc2 Sin[q2] v1^2}"
G = "{(m1 lc1 + m2 l1) g0 Cos[q1] + m2 lc2 g0 Cos[q1 + q2], m2 lc2 g0 Cos[q1 + q2]}"


def is_zero(kernel: Evaluate, expression: str) -> bool:
    return kernel(f"Union[Map[Simplify, Flatten[{{{expression}}}]]] === {{0}}")


def test_planar_2r_derives_the_textbook_s_terms(kernel, load):
    load(of(mcgee.arms.planar_2r(), params=True))
    assert is_zero(kernel, f"planar2rMassMatrix[{{q1, q2}}] - {M}")
    assert is_zero(kernel, f"planar2rGravityVector[{{q1, q2}}] - {G}")
    assert is_zero(kernel, f"planar2rCoriolisForces[{{q1, q2}}, {{v1, v2}}] - {CQDOT}")
    assert not is_zero(kernel, f"planar2rMassMatrix[{{q1, q2}}] - 2 {M}")


def test_the_package_may_be_loaded_again(kernel, load):
    load(of(mcgee.arms.pendulum(), params=True))
    kernel("m = 3; pendulumDynamics[_, _] := 0")
    load(of(mcgee.arms.pendulum(), params=True))
    got = kernel("pendulumGravityVector[{Pi/6}] /. pendulumParameters")
    assert got == pytest.approx([9.81 / 4])
    assert kernel("Length[pendulumDynamics[{0.1}, {0.2}]]") == 3


def test_mdot_minus_2c_is_skew_symmetric(kernel, load):
    load(of(mcgee.arms.planar_2r(), params=True))
    slopes = "Table[D[planar2rMassMatrix[{q1, q2}], x], {x, {q1, q2}}]"
    kernel(f"S = {{v1, v2}} . {slopes} - 2 planar2rCoriolisMatrix[{{q1, q2}}, {{v1, v2}}]")
    assert is_zero(kernel, "S + Transpose[S]")
    assert not is_zero(kernel, "S")


def test_christoffel_symbols_stay_symbols(kernel, load):
    load(of(mcgee.arms.planar_2r(), params=True))
    c = "planar2rChristoffel[{q1, q2}]"
    h = "-m2 l1 lc2 Sin[q2]"
    assert is_zero(kernel, f"{c} - {{{{{{0, {h}}}, {{{h}, {h}}}}}, {{{{-({h}), 0}}, {{0, 0}}}}}}")
    at = "{q1, q2} -> {x, x}"
    assert is_zero(kernel, f"planar2rChristoffel[{{x, x}}] - ({c} /. Thread[{at}])")


def test_pendulum(kernel, load):
    load(of(mcgee.arms.pendulum(), params=True))
    assert is_zero(kernel, "pendulumMassMatrix[{q1}] - {{i + m lc^2}} ")
    assert is_zero(kernel, "pendulumPotentialEnergy[{q1}] - m g0 lc (1 - Cos[q1])")
    assert is_zero(kernel, "pendulumGravityVector[{q1}] - {m g0 lc Sin[q1]}")
    assert is_zero(kernel, "pendulumCoriolisForces[{q1}, {v1}]")


def test_numbers_of_the_lesson(kernel, load):
    load(of(mcgee.arms.planar_2r(), params=True))
    state = "{0.5, 0.3}, {0.1, -0.2}"
    arm = mcgee.arms.planar_2r()
    want = np.hstack([x.ravel() for x in arm.terms([0.5, 0.3], [0.1, -0.2])])
    for given in (state, f"{state}, planar2rParameters", f"{state}, {{}}"):
        assert kernel(f"Flatten[planar2rDynamics[{given}]]") == pytest.approx(want, rel=1e-14)
    heavy = mcgee.arms.planar_2r(m2=2.5).gravity([0.5, 0.3])
    got = kernel(f"Last[planar2rDynamics[{state}, {{m2 -> 2.5}}]]")
    assert got == pytest.approx(heavy, rel=1e-14)


@pytest.mark.parametrize(
    ("name", "params"), [("planar_2r", True), ("scara", False), ("puma560", False)]
)
def test_both_forms_of_t_and_p_agree(kernel, load, monkeypatch, name, params):
    robot = of(mcgee.load(name), params=params)
    own, n = Symbols(robot).own, robot.n
    q, v = (", ".join(f"{x + 0.37 * k}" for k in range(n)) for x in (0.3, -0.9))
    both = f"{{{own('kinetic_energy')}[{{{q}}}, {{{v}}}], {own('potential_energy')}[{{{q}}}]}}"
    both = f"{both} /. {own('parameters')}"
    load(robot)
    written = kernel(both)
    assert all(isinstance(x, float) for x in written)
    monkeypatch.setattr(wolfram_symbolic, "TERMS", 0)
    load(robot)
    assert "bodies =" in str(files(robot)[f"{context(robot)}.wl"])
    assert kernel(both) == pytest.approx(written, rel=1e-13)


def test_large_arms_derive_from_their_bodies(kernel, load):
    """With symbols for the inertial parameters, and numbers put in for these."""
    robot = of(mcgee.load("panda"), params=True)
    load(robot)
    arm, q = robot.robot, [0.1 + 0.3 * k for k in range(7)]
    at = f"{{{', '.join(map(repr, q))}}}"
    assert {"m7", "Izz7"} <= set(Symbols(robot).parameters)
    assert kernel(f"FreeQ[pandaPotentialEnergy[{at}], m7]") is False
    got = kernel(f"pandaPotentialEnergy[{at}] /. pandaParameters")
    assert got == pytest.approx(float(arm.potential_energy(q)), rel=1e-13)
    names = ", ".join(Symbols(robot).parameters)
    values = "{" + names + "} = pandaParameters[[All, 2]]"
    inertia = kernel(f"Block[{{{names}}}, {values}; Flatten[pandaMassMatrix[{at}]]]")
    want = arm.mass_matrix(q)
    assert inertia == pytest.approx(want.ravel(), abs=1e-13)


@pytest.mark.parametrize("seed", [1, 6])
def test_coupled_and_sliding_joints_derive_from_their_bodies(kernel, load, monkeypatch, seed):
    monkeypatch.setattr(wolfram_symbolic, "TERMS", 0)
    arm = random_tree(seed, bodies=3, prismatic=0.5, mimic=0.5, armature=0.5)
    assert arm.mechanism.coupled
    assert arm.n == 2
    robot = of(arm)
    load(robot)
    for name, want in (
        ("mass_matrix[{0.2, 0.7}]", arm.mass_matrix([0.2, 0.7])),
        ("gravity_vector[{0.2, 0.7}]", arm.gravity([0.2, 0.7])),
        ("coriolis_forces[{0.2, 0.7}, {1.5, -2.0}]", arm.coriolis([0.2, 0.7], [1.5, -2])),
    ):
        function, bracket, given = name.partition("[")
        got = kernel(f"Flatten[{Symbols(robot).own(function)}{bracket}{given}]")
        assert got == pytest.approx(want.ravel(), rel=1e-12, abs=1e-13)


# -- numbers --------------------------------------------------------------------------------------


def test_numbers_are_read_to_the_last_bit(kernel, rng):
    sizes = 10.0 ** rng.integers(-12, 12, 200)
    values = [*(rng.normal(size=200) * sizes).tolist(), 0.1, 1e22, 5e-10, math.pi, 0.1 + 0.2, -2.0]
    assert kernel(f"{{{', '.join(map(number, values))}}}") == tuple(values)


@pytest.mark.parametrize("params", [False, True], ids=["compiled", "parametric"])
@pytest.mark.parametrize("name", ["pendulum", "cart_pole", "scara", "stanford"])
def test_terms_are_right(kernel, load, name, params):
    robot = of(mcgee.load(name), "terms", "inverse_dynamics", params=params)
    load(robot)
    for f in robot.functions:
        assert worst(kernel, robot, f) <= ULP


def test_every_shape_of_result(kernel, load):
    functions = ("terms", "kinetic_energy", "christoffel", "mass_matrix", "regressor", "jacobian")
    robot = of(mcgee.load("puma560"), *functions, "inverse_dynamics_derivatives")
    assert any(len(f.routine.parts) > 1 for f in robot.functions)
    load(robot)
    for f in robot.functions:
        assert worst(kernel, robot, f) <= ULP


# -- names ----------------------------------------------------------------------------------------

HOSTILE = ['a"]; Exit[7]; (* ', "*) Quit[] (*", "`Private`", "Sin", "\\[Alpha]", "N", "q1"]


def test_hostile_names_do_no_harm(kernel, load):
    arm = random_tree(12, bodies=6, prismatic=0.4, mimic=0.3)
    names = {j.name: f"{HOSTILE[k % len(HOSTILE)]} {k}" for k, j in enumerate(arm.joints)}
    joints = tuple(
        dataclasses.replace(
            j,
            name=names[j.name],
            mimic=j.mimic and dataclasses.replace(j.mimic, joint=names[j.mimic.joint]),
        )
        for j in arm.joints
    )
    arm = dataclasses.replace(arm, name='C*) "] Exit[3] ` ä', joints=joints)
    robot = of(arm, "terms", "jacobian")
    for path, text in files(robot).items():
        assert str(text).isascii(), path
        code = re.sub(r'\(\*.*?\*\)|"[^"]*"', "", str(text), flags=re.DOTALL)
        assert path == "README.md" or not re.search(r"Quit|Exit\[[37]", code)
    load(robot)
    for f in robot.functions:
        assert worst(kernel, robot, f) <= ULP


@pytest.mark.parametrize("name", ["C", "N", "D", "System", "Global", "q", "2r", "Plus"])
def test_robots_may_have_the_names_of_wolfram_s_symbols(kernel, load, name):
    robot = of(dataclasses.replace(mcgee.arms.pendulum(), name=name))
    load(robot)
    assert Symbols(robot).own("dynamics")[0].islower()
    assert worst(kernel, robot, robot.functions[0]) <= ULP
    assert kernel("{Plus[1, 2], Sin[0], N[1]}") == (3, 0, 1)


PARAMETERS = [
    *("C", "N", "E", "I", "Sin", "Module", "q", "qdot2", "c1", "s12", "t1", "w1", "M12", "tau"),
    *("values", "rates", "step", "a", "i", "joint", "passed", "params", "_", "planar2rDynamics"),
    *("planar_2r_mass_matrix", "l_1", "$x", 'x"', "ß", "α", "Table"),
]


@pytest.mark.parametrize("first", range(0, len(PARAMETERS), 4))
def test_parameters_may_have_any_names(kernel, load, first):
    names = [*PARAMETERS[first : first + 4], "m1", "m2", "l1", "lc1"][:4]
    m2, l1, lc2, g0 = (sympy.Symbol(name, positive=True) for name in names)
    arm = mcgee.arms.planar_2r(m2=m2, l1=l1, lc2=lc2, g0=g0)
    values = dict(zip(names, (1.5, 0.8, 0.4, 9.5), strict=True))
    robot = of(arm, "terms", "inverse_dynamics", values=values)
    own = Symbols(robot)
    assert len(set(own.parameters)) == 4
    load(robot)
    for f in robot.functions:
        assert worst(kernel, robot, f) <= ULP
    plain = mcgee.arms.planar_2r(m2=1.5, l1=0.8, lc2=0.4, g0=9.5)
    for name, want in (
        ("mass_matrix[{0.5, 0.3}]", plain.mass_matrix([0.5, 0.3])),
        ("gravity_vector[{0.5, 0.3}]", plain.gravity([0.5, 0.3])),
        ("coriolis_forces[{0.5, 0.3}, {1.0, 2.0}]", plain.coriolis([0.5, 0.3], [1, 2])),
    ):
        function, bracket, given = name.partition("[")
        got = kernel(f"Flatten[{own.own(function)}{bracket}{given} /. {own.own('parameters')}]")
        assert got == pytest.approx(want.ravel(), rel=1e-12)


def test_a_parameter_may_be_called_like_a_coordinate(kernel, load):
    """Closed forms refuse that, so T and P come from the bodies."""
    arm = mcgee.arms.planar_2r(m2=sympy.Symbol("q1", positive=True))
    robot = of(arm, "inverse_dynamics", values={"q1": 1.5})
    load(robot)
    assert worst(kernel, robot, robot.functions[0]) <= ULP
    got = kernel("planar2rGravityVector[{0.5, 0.3}] /. q1 -> 1.5")
    assert got == pytest.approx(mcgee.arms.planar_2r(m2=1.5).gravity([0.5, 0.3]), rel=1e-13)


def test_no_symbol_has_a_capital_but_wolfram_s_own():
    """And no other than templates have, by which parameters get out of the way."""
    robot = of(mcgee.load("panda"), "terms", "christoffel")
    text = re.sub(r'\(\*.*?\*\)|"[^"]*"', "", "".join(map(str, files(robot).values())), flags=re.S)
    code = re.sub(r"\d\.\d+`?|\*\^-?\d+", "", text.partition("BeginPackage")[2])
    symbols = set(re.findall(r"[A-Za-z$][A-Za-z0-9]*", code.partition("#")[0]))
    small = {s for s in symbols if s[0].islower() and not re.fullmatch(r"[a-z]+\d+", s)}
    own = {s for s in small if s.startswith(camel(robot.name))}
    assert small - own - {"usage"} <= wolfram_symbolic.words_of_templates()


# -- self-tests -----------------------------------------------------------------------------------


def tried(robot: Unit) -> Verification:
    done = verify(WOLFRAM, robot, WOLFRAM.files(robot))
    if done.missing:
        pytest.skip(f"no {done.missing}")
    return done


@pytest.mark.parametrize(
    ("name", "params"), [("planar_2r", True), ("puma560", False), ("panda", False)]
)
def test_self_tests_hold(name, params):
    for a in tried(made(name, params=params)).agreements:
        assert a.states == a.kernel_states == 20
        assert a.exact <= ULP
        assert a.kernel <= 2 * ULP


WRONG = {
    "a number": ("2.0*qdot1", "2.0000001*qdot1"),
    "the kinetic energy": ("I1 + I2 + l1^2*m2", "I1 + I2 + l2^2*m2"),
    "the potential energy": ("g0*lc2*m2*Sin[q1 + q2]", "g0*lc2*m2*Cos[q1 + q2]"),
    "a default": ("g0 -> 9.81", "g0 -> 9.82"),
    "no number": ("M12 = ", "M12 = Indeterminate + "),
    "syntax": ("Begin[", "Begin[["),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_found(what):
    robot = made("planar_2r", params=True)
    found = dict(files(robot))
    before, after = WRONG[what]
    text = str(found["Planar2rDynamics.wl"])
    found["Planar2rDynamics.wl"] = text.replace(before, after, 1)
    assert found["Planar2rDynamics.wl"] != text
    with pytest.raises(VerificationError):
        verify(WOLFRAM, robot, found)


@pytest.mark.parametrize("text", ["", "1.0 2.0\n"])
def test_vectors_that_are_not_there_are_missed(text):
    robot = made("planar_2r", params=True)
    with pytest.raises(VerificationError):
        verify(WOLFRAM, robot, files(robot) | {"vectors/dynamics.txt": text})
