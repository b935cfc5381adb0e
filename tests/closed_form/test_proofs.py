"""Identities are decided: they hold for every robot, and not for one that is wrong."""

from dataclasses import replace

import pytest
import sympy

import mcgee
from mcgee import arms
from mcgee.closed_form.form import ClosedForm, of_exact
from mcgee.errors import ModelWarning
from mcgee.model import Pose
from robots import built_in, random_tree

NAMES = {"symmetric", "inertia", "gravity", "Newton-Euler", "linear", "skew", "power"}
NAMES |= {"kinetic energy", "definition", "height"}


@pytest.mark.parametrize("symbolic", [False, True])
@pytest.mark.parametrize("name", ["cart_pole", "scara", "stanford", "puma560", "ur5e", "panda"])
def test_every_identity_holds(name, symbolic):
    proof = built_in(name).closed_form(symbolic_inertias=symbolic).prove()
    assert proof
    assert {identity.name for identity in proof} >= NAMES
    for identity in proof:
        assert not any(getattr(identity, "differences", ()))
    assert proof["Newton-Euler"].terms[0] == proof["Newton-Euler"].terms[1] > 0


@pytest.mark.parametrize("seed", range(6))
def test_on_random_trees(seed):
    robot = random_tree(seed, exact=True, bodies=5, mimic=0.3, branching=0.5)
    assert robot.closed_form().prove()
    assert robot.closed_form(symbolic_inertias=True).prove()


@pytest.fixture
def right():
    return arms.planar_2r(*sympy.symbols("m1 m2 l1 lc1 lc2 I1 I2 g0")).closed_form()


def false_names(form, **wrong):
    """What no longer holds when quantities are replaced."""
    fields = {k: v for k, v in wrong.items() if k in ("M", "g", "T", "P")}
    dynamics = replace(form.exact, **fields)
    for name in ("C", "christoffel"):
        if name in wrong:
            dynamics.__dict__[name] = wrong[name]
    proof = ClosedForm(form.name, dynamics, form.robot).prove()
    assert not proof
    return {identity.name for identity in proof if not identity.holds}


def transposed(rows):
    return [list(row) for row in zip(*rows, strict=True)]


def test_a_transposed_coriolis_matrix(right):
    """Its symmetric part is right, so Ṁ − 2C still is skew; the efforts are wrong."""
    assert false_names(right, C=transposed(right.exact.C)) == {"Newton-Euler"}


def test_half_a_coriolis_matrix(right):
    half = [[x / 2 for x in row] for row in right.exact.C]
    assert false_names(right, C=half) == {"skew", "Newton-Euler"}


def test_another_matrix_with_the_right_product(right):
    """C' qd = C qd, and Ṁ − 2C' is not skew."""
    ring, (a, b) = right.exact.ring, right.qd
    C = [list(row) for row in right.exact.C]
    more = ring.symbol(sympy.Symbol("m1"))
    C[0] = [C[0][0] + more * ring.symbol(b), C[0][1] - more * ring.symbol(a)]
    assert false_names(right, C=C) == {"skew"}


def test_a_mass_matrix_without_its_coupling(right):
    M = [list(row) for row in right.exact.M]
    M[0][1] = M[1][0] = right.exact.ring(0)
    assert false_names(right, M=M) == {
        *("definition", "inertia", "kinetic energy", "Newton-Euler"),
    }


def test_a_potential_with_cosines_for_sines(right):
    """The lesson's slip."""
    wrong = right.exact.P.derivative(right.q[0])
    assert false_names(right, P=wrong) == {"gravity", "height", "power"}


def test_gravity_of_the_wrong_sign(right):
    wrong = [-x for x in right.exact.g]
    assert false_names(right, g=wrong) == {"gravity", "Newton-Euler"}


def test_a_kinetic_energy_without_a_half(right):
    wrong = right.exact.T * 2
    assert false_names(right, T=wrong) == {"inertia", "kinetic energy", "power"}


def test_a_recursion_that_forgets_a_term(right, monkeypatch):
    """M by columns, linearity and power do not come from the formulas they are tested against."""
    from mcgee.closed_form import identities

    def wrong(e):
        first, second = newton_euler(e)
        return [first + second.derivative(e.qdd[0]) * e.ring.symbol(e.qdd[1]), second]

    newton_euler = identities.newton_euler
    monkeypatch.setattr(identities, "newton_euler", wrong)
    names = {identity.name for identity in right.prove() if not identity.holds}
    assert names == {"symmetric", "Newton-Euler", "linear", "power"}


def test_axes_that_are_wrong(right):
    """Bodies seen in other axes than they should be."""
    robot = right.robot
    first, second = robot.mechanism.bodies
    turned = replace(second, pose=second.pose @ Pose.about("z", 0.0) @ Pose.at(y=1.0))
    wrong = replace(robot, mechanism=replace(robot.mechanism, bodies=(first, turned)))
    form = of_exact("wrong", wrong, "expanded")
    assert {i.name for i in form.prove() if not i.holds} >= {"definition", "height"}


def test_what_a_proof_says(right):
    proof = right.prove()
    assert str(proof["gravity"]) == "proved    g = ∂P/∂q: 2 differences 0, from 4 and 4 terms."
    assert "proved    ∂M/∂q1 = 0" in str(proof)
    assert proof[0].name == "symmetric"
    wrong = replace(right.exact, P=right.exact.P * 2)
    sentence = str(ClosedForm("wrong", wrong, right.robot).prove()["gravity"])
    assert sentence == (
        "FALSE     g = ∂P/∂q: 2 of 2 differences are not 0, the first is "
        "-g0*l1*m2*cos(q1) - g0*lc1*m1*cos(q1) - g0*lc2*m2*cos(q1 + q2)."
    )
    with pytest.raises(KeyError, match=r"no identity is called 'energy'\. Names: symmetric, "):
        proof["energy"]


@pytest.mark.parametrize(
    ("name", "free"),
    [("planar_3r", {"q1"}), ("scara", {"q1", "q3", "q4"}), ("puma560", {"q1", "q6"})],
)
def test_which_coordinates_the_inertia_matrix_does_not_see(name, free):
    proof = built_in(name).closed_form().prove()
    found = {i.name.split()[-1] for i in proof if i.name.startswith("M without")}
    assert found >= {"q1"}
    assert found == free or name == "puma560"


class TestPositiveDefinite:
    """Proved by the sum of squares where that decides, else sampled, else left open."""

    def of(self, robot, **options):
        return robot.closed_form(**options).prove()["positive definite"]

    def test_numbers(self):
        for name in ("planar_2r", "stanford", "panda", "ur5e"):
            assert self.of(built_in(name)).how == "proved"

    def test_positive_symbols(self):
        symbols = sympy.symbols("m1 m2 l1 lc1 lc2 I1 I2 g0", positive=True)
        assert self.of(arms.planar_2r(*symbols)).how == "proved"

    def test_symbols_that_could_be_negative(self):
        found = self.of(arms.planar_2r(*sympy.symbols("m1 m2 l1 lc1 lc2 I1 I2 g0")))
        assert found.how == "undecided"
        assert str(found) == (
            "undecided M is positive definite: the mass of 'link1' is not known to be zero or "
            "more. Declare symbols positive=True, or .subs."
        )

    def test_symbolic_inertias(self):
        found = self.of(built_in("scara"), symbolic_inertias=True)
        assert found.how == "undecided"

    def test_a_joint_that_moves_nothing_alone_is_sampled(self):
        rows = [{"alpha": 1.5707963267948966}, {"a": 0.4, "m": 1.0, "I": (0.1, 0.2, 0.2)}]
        found = self.of(mcgee.from_dh(rows))
        assert found.how == "sampled"
        assert "'joint1' alone is not known to move any inertia; of 200 random" in found.reason

    def test_a_matrix_that_is_not(self):
        with pytest.warns(ModelWarning, match="moves nothing"):
            found = self.of(arms.acrobot(m2=0.0, I2=0.0))
        assert found.how == "false"
        assert not found.holds
        assert str(found).startswith("FALSE     M is positive definite: 'joint2' alone is not ")


INERTIAL = (
    '<inertial><origin xyz="0.1 0 0.2"/><mass value="1"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
)
GEARED = f"""<robot name="geared"><link name="base"/>
<joint name="j1" type="continuous"><parent link="base"/><child link="l1"/>
<axis xyz="0 1 0"/></joint>
<link name="l1">{INERTIAL}</link>
<joint name="j2" type="continuous"><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
<origin xyz="0 0 0.5"/><mimic joint="j1" multiplier="{{}}"/></joint>
<link name="l2">{INERTIAL}</link></robot>"""


@pytest.mark.parametrize("factor", [4, 5, 10])
def test_gears_of_many_turns_prove_nothing_false(factor, tmp_path):
    """cos 5q is a generator beside cos q: what is not seen to be 0 is not said to be false."""
    path = tmp_path / "geared.urdf"
    path.write_text(GEARED.format(factor))
    arm = mcgee.load(path)
    proof = arm.closed_form().prove()
    assert proof
    assert "FALSE" not in str(proof)


def test_equality_that_is_not_decided_is_not_denied():
    q, v, k = sympy.symbols("q1 qd1 k")
    one = mcgee.lagrange(v**2, k * sympy.cos(5 * q), [q], [v])
    other = mcgee.lagrange(v**2, k * sympy.expand_trig(sympy.cos(5 * q)), [q], [v])
    found = one.compare(other)
    assert not found
    assert str(found["g"]).startswith("undecided the same g")
