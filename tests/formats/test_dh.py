"""Denavit-Hartenberg tables: kinematics of both conventions, and a sentence for every mistake."""

import math
import warnings

import numpy as np
import pytest
import sympy

from mcgee import ModelError, ModelWarning, quantities
from mcgee.formats.dh import from_dh

PI = math.pi
BODY = {"m": 1.0, "I": (0.1, 0.1, 0.1)}


def mechanism(robot):
    return robot.mechanism


def fk(robot, q, frame="tip"):
    return np.array(quantities.forward_kinematics(mechanism(robot), q, frame), dtype=float)


def mass_matrix(robot, q):
    return np.array(quantities.mass_matrix(mechanism(robot), q), dtype=float)


# -- the transforms, written independently --------------------------------------------------------


def rotation(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    T = np.eye(4)
    i, j = {"x": (1, 2), "z": (0, 1)}[axis]
    T[i, i] = T[j, j] = c
    T[i, j], T[j, i] = -s, s
    return T


def shift(axis, length):
    T = np.eye(4)
    T["xyz".index(axis), 3] = length
    return T


def expected(rows, q, convention):
    frames, T = [], np.eye(4)
    for row, qk in zip(rows, q, strict=True):
        row = {"theta": 0, "d": 0, "a": 0, "alpha": 0, "offset": 0, "sigma": 0, **row}
        moved = row["offset"] + qk
        theta = row["theta"] + (0 if row["sigma"] else moved)
        d = row["d"] + (moved if row["sigma"] else 0)
        z = rotation("z", theta), shift("z", d)
        x = shift("x", row["a"]), rotation("x", row["alpha"])
        steps = (*z, *x) if convention == "standard" else (*x[::-1], *z)
        for step in steps:
            T = T @ step
        frames.append(T)
    return frames


def random_rows(rng, n):
    return [
        {
            "theta": rng.uniform(-3, 3),
            "d": rng.uniform(-1, 1),
            "a": rng.uniform(-1, 1),
            "alpha": rng.choice([0.0, PI / 2, -PI / 2, rng.uniform(-3, 3)]),
            "offset": rng.uniform(-1, 1),
            "sigma": int(rng.random() < 0.3),
            "m": rng.uniform(0.5, 2),
            "r": rng.uniform(-0.3, 0.3, 3),
            "I": np.diag(rng.uniform(0.1, 0.15, 3)),
        }
        for _ in range(n)
    ]


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("seed", range(5))
def test_every_link_frame_is_the_product_of_the_transforms(convention, seed):
    rng = np.random.default_rng(seed)
    rows = random_rows(rng, 5)
    robot = from_dh(rows, convention)
    for _ in range(3):
        q = rng.uniform(-3, 3, 5)
        for k, T in enumerate(expected(rows, q, convention), 1):
            assert fk(robot, list(q), f"link{k}") == pytest.approx(T, abs=1e-13)
        assert fk(robot, list(q)) == pytest.approx(T, abs=1e-13)


def test_base_and_tool_stand_before_and_after_the_table():
    rng = np.random.default_rng(7)
    rows = random_rows(rng, 3)
    base = rotation("x", 0.4) @ shift("z", 0.3)
    tool = rotation("z", -0.9) @ shift("x", 0.2)
    for convention in ("standard", "modified"):
        robot = from_dh(rows, convention, base, tool.tolist())
        q = [0.3, -0.8, 1.2]
        T = expected(rows, q, convention)[-1]
        assert fk(robot, q) == pytest.approx(base @ T @ tool, abs=1e-13)
        assert fk(robot, q, "link3") == pytest.approx(base @ T, abs=1e-13)
        assert fk(robot, q, "base") == pytest.approx(np.eye(4))


def test_a_base_computed_with_rounded_cosines_leaves_exact_zeros():
    robot = from_dh([BODY], base=rotation("x", PI / 2))
    assert robot.joints[0].pose.rotation == ((1, 0, 0), (0, 0, -1), (0, 1, 0))


def test_one_arm_in_both_conventions_moves_alike():
    """A standard table's row (d, a, alpha)_i is a modified one's with a, alpha of row i-1."""
    rng = np.random.default_rng(11)
    rows = random_rows(rng, 4)
    shifted = []
    for k, row in enumerate(rows):
        before = rows[k - 1] if k else {"a": 0.0, "alpha": 0.0}
        # r and I move from frame i (standard) to the frame before a_i and alpha_i (modified)
        R = rotation("x", row["alpha"])[:3, :3]
        shifted.append(
            row
            | {"a": before["a"], "alpha": before["alpha"]}
            | {"r": R @ row["r"] + [row["a"], 0, 0], "I": R @ row["I"] @ R.T}
        )
    tool = shift("x", rows[-1]["a"]) @ rotation("x", rows[-1]["alpha"])
    one, other = from_dh(rows), from_dh(shifted, "modified", tool=tool)
    for _ in range(5):
        q = list(rng.uniform(-3, 3, 4))
        assert fk(one, q) == pytest.approx(fk(other, q), abs=1e-13)
        assert mass_matrix(one, q) == pytest.approx(mass_matrix(other, q), abs=1e-12)
        gravity = [quantities.gravity(mechanism(r), q) for r in (one, other)]
        assert gravity[0] == pytest.approx(gravity[1], abs=1e-12)


def test_mass_data_are_those_of_frame_i():
    """By the definition of M, from the frames of the independent product."""
    rng = np.random.default_rng(5)
    rows, h = random_rows(rng, 3), 1e-6
    for convention in ("standard", "modified"):
        robot = from_dh(rows, convention)
        q, qd = rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3)
        after, before = (expected(rows, q + s * h * qd, convention) for s in (1, -1))
        T = 0.0
        for row, a, b in zip(rows, after, before, strict=True):
            rate, middle = (a - b) / (2 * h), (a + b) / 2
            v = rate @ [*row["r"], 1]
            W = middle[:3, :3].T @ rate[:3, :3]
            w = np.array([W[2, 1], W[0, 2], W[1, 0]])
            T += 0.5 * (row["m"] * v @ v + w @ row["I"] @ w)
        assert 0.5 * qd @ mass_matrix(robot, list(q)) @ qd == pytest.approx(T, rel=1e-8)


# -- what a row may say ---------------------------------------------------------------------------


def test_names_and_limits_and_drives():
    rows = [
        {**BODY, "name": "hip", "lower": -1, "upper": 2, "velocity": 3, "effort": 4},
        {**BODY, "sigma": 1, "armature": 0.5, "viscous": 0.6, "coulomb": np.float64(0.7)},
    ]
    hip, slide = from_dh(rows, name="arm").joints
    assert (hip.name, slide.name) == ("hip", "joint2")
    assert (hip.kind, slide.kind) == ("revolute", "prismatic")
    assert (hip.lower, hip.upper, hip.velocity, hip.effort) == (-1, 2, 3, 4)
    assert (slide.lower, slide.upper) == (-math.inf, math.inf)
    assert (slide.armature, slide.viscous, slide.coulomb) == (0.5, 0.6, 0.7)
    assert type(slide.coulomb) is float


def test_link_and_frame_names():
    robot = from_dh([BODY, BODY], name="arm", gravity_vector=np.array([0, -9.8, 0]))
    assert [link.name for link in robot.links] == ["base", "link1", "link2"]
    assert [frame.name for frame in robot.frames] == ["tip"]
    assert (robot.name, robot.gravity_vector) == ("arm", (0, -9.8, 0))


def test_four_numbers_are_a_row():
    numbers = [(0.1, 0.2, 0.3, 0.4), np.array([0.5, 0.6, 0.7, 0.8])]
    with pytest.warns(ModelWarning, match="moves nothing that has mass"):
        robot = from_dh(numbers)
    rows = [dict(zip(("theta", "d", "a", "alpha"), row, strict=True)) for row in numbers]
    assert fk(robot, [0.0, 0.0]) == pytest.approx(expected(rows, [0, 0], "standard")[-1])


def test_a_whole_numpy_table():
    with pytest.warns(ModelWarning):
        assert len(from_dh(np.zeros((3, 4))).joints) == 3


def test_inertia_as_matrix_and_as_diagonal():
    matrix = [[0.3, 0.01, 0.02], [0.01, 0.3, 0.03], [0.02, 0.03, 0.3]]
    full, diagonal, symbolic = from_dh(
        [{"m": 1, "I": matrix}, {"m": 1, "I": [1, 2, 2]}, {"m": 1, "I": sympy.Matrix(matrix)}]
    ).links[1:]
    assert full.inertia.about_com == (0.3, 0.01, 0.02, 0.3, 0.03, 0.3)
    assert diagonal.inertia.about_com == (1, 0, 0, 2, 0, 2)
    assert symbolic.inertia.about_com == full.inertia.about_com


def test_angles_that_round_multiples_of_pi_12_are_exact():
    for alpha in (PI / 2, 1.57079632679, np.float64(PI / 2), sympy.pi / 2):
        link = from_dh([{**BODY, "alpha": alpha}]).joints[0].child_pose
        assert link.rotation == ((1, 0, 0), (0, 0, -1), (0, 1, 0)), alpha


def test_a_poor_rounding_is_kept_and_said():
    with pytest.warns(ModelWarning, match=r"row 2: alpha: angle 1\.57 is taken as written; pi/2"):
        robot = from_dh([BODY, {**BODY, "alpha": 1.57}])
    assert robot.joints[1].child_pose.rotation[1][1] == math.cos(1.57)
    assert "row 2: alpha" in robot.warnings[0]


def test_an_offset_of_length_is_no_angle():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot = from_dh([{**BODY, "sigma": 1, "d": 0.1, "offset": 1.57}])
    assert fk(robot, [0.0])[2, 3] == pytest.approx(1.67)


def test_symbols_stay_symbols():
    m, a, alpha, Iyy, q = sympy.symbols("m a alpha Iyy q", positive=True)
    row = {"m": m, "a": a, "r": (-a / 2, 0, 0), "I": (0, Iyy, 0), "alpha": alpha, "armature": 2 * m}
    robot = from_dh([row], gravity_vector=(0, sympy.Symbol("g0"), 0))
    (M,) = quantities.mass_matrix(mechanism(robot), [q])
    assert sympy.simplify(M[0] - (m * a**2 / 4 + 2 * m + Iyy * sympy.sin(alpha) ** 2)) == 0


def test_numbers_of_sympy_become_floats():
    robot = from_dh([{**BODY, "a": sympy.Rational(1, 4), "m": sympy.Integer(2)}])
    assert type(robot.links[1].inertia.mass) is float
    assert robot.joints[0].child_pose.translation == (0.25, 0, 0)


def test_a_table_without_masses_says_so():
    with pytest.warns(ModelWarning, match=r"row 1: joint 'joint1' moves nothing that has mass"):
        robot = from_dh([{"a": 1.0}])
    assert robot.links[1].inertia.mass == 0


def test_a_centre_of_mass_without_mass_says_so():
    message = r"row 1: r is given without m, so the link weighs nothing\."
    with pytest.warns(ModelWarning, match=message):
        from_dh([{"r": (0, 0, 1)}, BODY])


# -- every mistake has its sentence ---------------------------------------------------------------

MISTAKES = [
    ({"alhpa": 1}, r"row 2: unknown key 'alhpa'\. Keys: theta, d, a, alpha, offset, sigma, m, r,"),
    ("theta", r"row 2: is 'theta', expected a mapping such as .* or the four numbers theta, d"),
    (3.0, r"row 2: is 3\.0, expected a mapping such as"),
    ((0, 1, 2), r"row 2: has 3 values, expected the four numbers theta, d, a, alpha\. Write a"),
    ({"d": "0.3"}, r"row 2: d is '0\.3', expected a finite number \[m\]\."),
    ({"d": None}, r"row 2: d is None, expected a finite number \[m\]\."),
    ({"a": math.nan}, r"row 2: a is nan, expected a finite number \[m\]\."),
    ({"a": sympy.I}, r"row 2: a is I, expected a finite number \[m\]\."),
    ({"theta": math.inf}, r"row 2: theta is inf, expected a finite number \[rad\]\."),
    ({"alpha": [1.0]}, r"row 2: alpha is \[1\.0\], expected a finite number \[rad\]\."),
    ({"m": True}, r"row 2: m is True, expected a finite number \[kg\]\."),
    ({"m": -1}, r"row 2: m is -1, expected zero or more \[kg\]\."),
    ({"armature": -0.5}, r"row 2: armature is -0\.5, expected zero or more \[kg·m² \| kg\]\."),
    ({"sigma": 2}, r"row 2: sigma is 2, expected 0 \(revolute\) or 1 \(prismatic\)\."),
    ({"sigma": "P"}, r"row 2: sigma is 'P', expected 0 \(revolute\) or 1 \(prismatic\)\."),
    ({"r": (1, 2)}, r"row 2: r has shape \(2,\), expected \(3,\) \[m\]\."),
    ({"r": (1, 2, "x")}, r"row 2: r is 'x', expected a finite number \[m\]\."),
    ({"I": np.zeros(6)}, r"row 2: I has shape \(6,\), expected \(3, 3\) or the diagonal \(3,\) "),
    ({"I": [[1, 2, 0], [3, 1, 0], [0, 0, 1]]}, r"row 2: I is not symmetric: Ixy is 2 and Iyx is 3"),
    (
        {"I": [[1, 0, 0], [0, 1, sympy.Symbol("s")], [0, 0, 1]]},
        r"row 2: I is not symmetric: Iyz is s and Izy is 0, expected the same \[kg·m²\]\.",
    ),
    ({"I": [[1, 0, 0], [0, math.nan, 0], [0, 0, 1]]}, r"row 2: I is nan, expected a finite number"),
    ({"I": [np.ones((2, 2)), np.ones((2, 3))]}, r"row 2: I is no array of numbers: "),
    ({"name": ""}, r"row 2: name is '', expected a text that is not empty\."),
    ({"name": 7}, r"row 2: name is 7, expected a text that is not empty\."),
    ({"name": "joint1"}, r"row 2: joint 'joint1' is declared twice, first at row 1\."),
    ({"lower": "low"}, r"row 2: lower is 'low', expected a number \[rad \| m\]\."),
    ({"effort": math.nan}, r"row 2: effort is nan, expected a number \[N·m \| N\]\."),
]


@pytest.mark.parametrize(("row", "sentence"), MISTAKES)
def test_a_mistake_in_a_row_is_named(row, sentence):
    with pytest.raises(ModelError, match=sentence):
        from_dh([BODY, row])


TWISTED = np.diag([1.0, 1.0, -1.0, 1.0])
STRETCHED = np.diag([2.0, 1.0, 1.0, 1.0])
SHEARED = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1.0]])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"rows": []}, r"rows is \[\], expected at least one row, one a joint\."),
        ({"rows": None}, r"rows is None, expected at least one row, one a joint\."),
        ({"convention": "craig"}, r"convention is 'craig', expected 'standard' or 'modified'\."),
        ({"base": np.eye(3)}, r"base has shape \(3, 3\), expected \(4, 4\)\."),
        ({"tool": TWISTED}, r"tool has a left upper block that is no rotation: its rows must be"),
        ({"tool": STRETCHED}, r"tool has a left upper block that is no rotation"),
        ({"base": SHEARED}, r"base has the last row \[0\.0, 0\.0, 1\.0, 1\.0\], expected \[0, 0,"),
        ({"base": [["a"] * 4] * 4}, r"base is 'a', expected a finite number\."),
        (
            {"gravity_vector": (0, 0)},
            r"gravity_vector has shape \(2,\), expected \(3,\) \[m/s²\]\.",
        ),
        ({"gravity_vector": (0, 0, "g")}, r"gravity_vector is 'g', expected a finite number \[m/"),
    ],
)
def test_a_mistake_beside_the_rows_is_named(arguments, sentence):
    with pytest.raises(ModelError, match=sentence):
        from_dh(**{"rows": [BODY], **arguments})


def test_a_symbolic_base_is_not_measured():
    x = sympy.Symbol("x")
    base = [[sympy.cos(x), -sympy.sin(x), 0, 0], [sympy.sin(x), sympy.cos(x), 0, 0]]
    robot = from_dh([BODY], base=[*base, [0, 0, 1, x], [0, 0, 0, 1]])
    assert robot.joints[0].pose.translation[2] == x
