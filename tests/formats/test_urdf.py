"""What the URDF reader reads, and what it warns of; see test_urdf_refusals.py for the rest."""

import math
import re
import sysconfig
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from urdf_text import ELBOW, FILE, INERTIAL, arm, joint, line_of, read, remarks

from mcgee import ModelError, ModelWarning, Robot
from mcgee.formats.load import load
from mcgee.formats.urdf import parse_urdf, read_urdf
from mcgee.mechanism import depth_first
from mcgee.model import Mimic


def rpy_matrix(r, p, y):
    """Rz Ry Rx, written out independently of mcgee."""
    cr, sr, cp, sp, cy, sy = *_cs(r), *_cs(p), *_cs(y)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _cs(x):
    return math.cos(x), math.sin(x)


# -- what is read ---------------------------------------------------------------------------------


def test_reads_every_part_of_a_joint():
    elbow = ELBOW.replace('0 0 0"', '0.1 -0.2 0.3"') + '<dynamics damping="0.7" friction="0.2"/>'
    j = joint(arm(elbow))
    assert (j.name, j.kind, j.parent, j.child) == ("elbow", "revolute", "upper", "fore")
    assert j.pose.translation == (0, 0, 1)
    assert np.allclose(j.pose.rotation, rpy_matrix(0.1, -0.2, 0.3), rtol=0, atol=1e-15)
    assert j.axis == (0, 1, 0)
    assert (j.lower, j.upper, j.velocity, j.effort) == (-2, 2, 3, 40)
    assert (j.viscous, j.coulomb, j.armature, j.mimic) == (0.7, 0.2, 0, None)
    assert j.place == f"{FILE}:14: "


def test_defaults():
    j = joint(arm(), "shoulder")
    assert j.axis == (1, 0, 0)
    assert (j.pose.translation, j.pose.rotation) == ((0, 0, 0), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    assert (j.lower, j.upper, j.velocity, j.effort) == (-math.inf, *(math.inf,) * 3)
    assert (j.viscous, j.coulomb, j.mimic) == (0, 0, None)
    robot = read(arm())
    assert robot.name == "arm"
    assert robot.links[0].inertia is None
    assert robot.links[1].place == f"{FILE}:3: "


def test_continuous_ignores_its_bounds():
    elbow = ELBOW.replace('lower="-2" upper="2"', 'lower="x" upper="-1"')
    j = joint(arm(elbow, kind="continuous"))
    assert (j.lower, j.upper, j.velocity, j.effort) == (-math.inf, math.inf, 3, 40)


def test_one_absent_bound_is_zero():
    assert joint(arm(ELBOW.replace('lower="-2"', ""))).lower == 0
    assert joint(arm(ELBOW.replace('upper="2"', ""))).upper == 0


def test_infinite_limits():
    elbow = ELBOW.replace('"-2"', '"-inf"').replace('"2"', '"Infinity"').replace('"40"', '"+INF"')
    j = joint(arm(elbow))
    assert (j.lower, j.upper, j.effort) == (-math.inf, math.inf, math.inf)


def test_prismatic():
    assert joint(arm(kind="prismatic")).kind == "prismatic"


def test_fixed_joint_ignores_what_only_moving_ones_need():
    elbow = ELBOW.replace("0 1 0", "0 0 0").replace("-2", "") + "<mimic/><dynamics damping='x'/>"
    j = joint(arm(elbow, kind="fixed"))
    assert j.mimic is None
    assert j.pose.translation == (0, 0, 1)


@pytest.mark.parametrize(
    "written", ["1.5", "+1.5", "1.5e0", "1.5E+0", "15e-1", " 1.5\t", "1.50", "0.15e1", "&#49;.5"]
)
def test_numbers_as_c_writes_them(written):
    assert joint(arm(ELBOW.replace('"3"', f'"{written}"'))).velocity == 1.5


def test_numbers_without_a_leading_or_trailing_digit():
    assert joint(arm(ELBOW.replace("0 0 1", ".5 2. -.25"))).pose.translation == (0.5, 2, -0.25)


@pytest.mark.parametrize(
    ("written", "k"),
    [
        ("1.57079632679", 6),
        ("-1.5707963267948966", -6),
        ("3.14159265", 12),
        ("0.52359877", 2),
        ("4.71238898038", 18),
    ],
)
@pytest.mark.parametrize("place", [0, 1, 2])
def test_rounded_right_angle_is_exact(written, k, place):
    rpy = ["0", "0", "0"]
    rpy[place] = written
    rotation = np.array(joint(arm(ELBOW.replace("0 0 0", " ".join(rpy)))).pose.rotation)
    angles = [0.0, 0.0, 0.0]
    angles[place] = k * math.pi / 12
    expected = rpy_matrix(*angles)
    expected[abs(expected) < 1e-12] = 0
    assert np.allclose(rotation, expected, rtol=0, atol=4e-16)
    assert (rotation == 0).sum() == (expected == 0).sum()


def test_dust_is_zero():
    elbow = ELBOW.replace("0 1 0", "0 1 6.12323e-17").replace("0 0 1", "1e-17 0 1")
    elbow = elbow.replace("0 0 0", "-1.1e-16 0 0")
    j = joint(arm(elbow))
    assert j.axis == (0, 1, 0)
    assert j.pose.translation == (0, 0, 1)
    assert j.pose.rotation == ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def test_what_is_not_dust_stays():
    j = joint(arm(ELBOW.replace("0 1 0", "0 -1 -4.37114e-08").replace("0 0 1", "1e-13 0 1")))
    assert j.axis[2] == pytest.approx(-4.37114e-08)
    assert j.pose.translation[0] == 1e-13


@pytest.mark.parametrize("written", ["0.7071 0 -0.7071", "0.577 0.577 0.577", "0 1.0005 0"])
def test_axis_is_normalised(written):
    axis = np.array(joint(arm(ELBOW.replace("0 1 0", written))).axis)
    given_axis = np.array([float(v) for v in written.split()])
    assert np.linalg.norm(axis) == pytest.approx(1, abs=1e-15)
    assert np.allclose(np.cross(axis, given_axis), 0, atol=1e-15)
    assert axis @ given_axis > 0


@pytest.mark.parametrize("rpy", ["0.3 -0.7 1.9", "0 0 1.57079632679", "-2 0.1 0"])
def test_inertia_is_turned_into_the_axes_of_the_link(rpy):
    fore = f"""<inertial><origin xyz="0.1 -0.2 0.3" rpy="{rpy}"/><mass value="3"/>
      <inertia ixx="0.2" ixy="0.01" ixz="-0.02" iyy="0.3" iyz="0.03" izz="0.4"/></inertial>"""
    inertia = read(arm(fore=fore)).links[2].inertia
    turn = rpy_matrix(*(float(v) for v in rpy.split()))
    written = np.array([[0.2, 0.01, -0.02], [0.01, 0.3, 0.03], [-0.02, 0.03, 0.4]])
    assert inertia.mass == 3
    assert inertia.com == (0.1, -0.2, 0.3)
    assert np.allclose(inertia.matrix, turn @ written @ turn.T, rtol=0, atol=1e-11)


def test_inertia_without_an_origin_is_at_the_link():
    fore = """<inertial><mass value="1"/>
      <inertia ixx="3" ixy=".1" ixz=".2" iyy="4" iyz=".3" izz="5"/></inertial>"""
    inertia = read(arm(fore=fore)).links[2].inertia
    assert inertia.com == (0, 0, 0)
    assert inertia.about_com == (3, 0.1, 0.2, 4, 0.3, 5)


def test_mimic():
    with_all = ELBOW + '<mimic joint="shoulder" multiplier="-2" offset="0.5"/>'
    assert joint(arm(with_all)).mimic == Mimic("shoulder", -2, 0.5)
    bare = arm(ELBOW + '<mimic joint="shoulder"/>')
    assert joint(bare).mimic == Mimic("shoulder", 1, 0)
    assert all(j.mimic is None for j in parse_urdf(bare, mimic=False).joints)


def test_irrelevant_parts_are_passed_over_in_silence():
    fore = INERTIAL + '<visual><geometry><mesh filename="package://no/such.stl"/></geometry>'
    fore += "</visual><collision/><contact/><gravity>1</gravity><kinematic> 0 </kinematic>"
    elbow = ELBOW + "<safety_controller/><calibration/><limits_are_in_a_comment/>"
    elbow = elbow.replace("<limits_are_in_a_comment/>", "<!-- <axis/> --><?pi axis?>")
    elbow = elbow.replace("effort=", 'current="x" effort=')
    more = "<material/><gazebo/><transmission/><sensor/><ros2_control/><!-- ${x} -->"
    assert remarks(arm(elbow, fore, more=more)) == []


def test_default_namespace_and_unused_xacro_namespace():
    head = '<robot name="arm" xmlns="http://drake.mit.edu" xmlns:xacro="http://wiki.ros.org/xacro">'
    assert read(arm(head=head)) == read(arm(head="<robot name='arm'>"))


def test_text_bytes_and_encodings_say_the_same():
    text = arm(head='<robot name="ärm">')
    expected = read(text)
    assert expected.name == "ärm"
    declared = '<?xml version="1.0" encoding="{}"?>' + text
    for encoding in ("utf-8", "utf-16", "iso-8859-1"):
        assert read(declared.format(encoding).encode(encoding)) == expected
    assert read(declared.format("iso-8859-1")) == expected, "a str is already decoded"
    assert read(text.encode("utf-8-sig")) == expected
    assert read("\ufeff" + text) == expected


# -- what is warned of ----------------------------------------------------------------------------


def test_warns_of_a_poorly_rounded_angle():
    elbow = ELBOW.replace('"0 0 0"', '"1.57 0 -1.571"')
    fore = INERTIAL.replace('rpy="0 0 0"', 'rpy="3.1416 0 0"')
    text = arm(elbow, fore)
    inertial = line_of(text, "3.1416")
    assert remarks(text) == [
        f"{FILE}:{inertial}: link 'fore': <origin> rpy: angle 3.1416 is taken as written; "
        f"pi needs at least 8 digits (3.1415926536). Likewise on line 15."
    ]
    with pytest.warns(
        ModelWarning, match=r"arm\.urdf:15: joint 'elbow': <origin> rpy: angle 1.57 "
    ):
        pose = joint(arm(elbow)).pose
    assert np.allclose(pose.rotation, rpy_matrix(1.57, 0, -1.571), rtol=0, atol=1e-15)


def test_a_kind_of_remark_is_made_once():
    more = "".join(f'<spring n="{i}"/>\n' for i in range(8))
    assert remarks(arm(more=more)) == [
        f"{FILE}:28: <spring> is not read: skipped. "
        "Likewise on lines 29, 30, 31, 32, 33 and 2 more."
    ]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            arm(ELBOW.replace("0 1 0", "0 2 0")),
            "18: joint 'elbow': <axis> has xyz '0 2 0' of length 2",
        ),
        (arm(ELBOW + "<spring/>"), "19: joint 'elbow': <spring> is not read: skipped."),
        (arm(fore=INERTIAL + "<origin/>"), "26: link 'fore': <origin> is not read: skipped."),
        (arm(fore=INERTIAL + "<gravity>0</gravity>"), "26: link 'fore': <gravity> is not read: sk"),
        (
            arm(fore=INERTIAL.replace("<mass", "<density/><mass")),
            "24: link 'fore': <density> is not read: skipped.",
        ),
        (
            arm(fore=INERTIAL.replace("<mass", '<mass unit="g"')),
            "24: link 'fore': <mass> has 'unit', which is not read: skipped.",
        ),
        (
            arm(ELBOW.replace("<parent", '<parent frame="tip"')),
            "16: joint 'elbow': <parent> has 'frame', which is not read: skipped.",
        ),
        (
            arm(ELBOW.replace("rpy=", "rpv=")),
            "15: joint 'elbow': <origin> has 'rpv', which is not read: skipped.",
        ),
        (
            arm(ELBOW + '<mimic joint="shoulder" factor="2"/>'),
            "19: joint 'elbow': <mimic> has 'factor', which is not read: skipped.",
        ),
        (
            arm(ELBOW + '<dynamics armature="2"/>'),
            "19: joint 'elbow': <dynamics> has 'armature', which is not read: skipped.",
        ),
        (
            arm(ELBOW.replace('lower="-2" upper="2"', "")),
            "19: joint 'elbow': <limit> does not set lower, upper: taken as unlimited.",
        ),
        (
            arm(ELBOW.replace('velocity="3" effort="40"', "")),
            "19: joint 'elbow': <limit> does not set velocity, effort: taken as unlimited.",
        ),
        (
            arm(ELBOW[: ELBOW.index("<limit")]),
            "14: joint 'elbow' has no <limit>: taken as unlimited.",
        ),
    ],
)
def test_warns(text, sentence):
    (only,) = remarks(text)
    assert only.startswith(f"{FILE}:{sentence}")


def test_warned_limits_are_infinite():
    with pytest.warns(ModelWarning):
        j = joint(arm(ELBOW.replace('lower="-2" upper="2"', "")))
    assert (j.lower, j.upper, j.velocity) == (-math.inf, math.inf, 3)


def test_warned_axis_is_a_unit_vector():
    with pytest.warns(ModelWarning):
        assert joint(arm(ELBOW.replace("0 1 0", "0 -3 4"))).axis == (0, -0.6, 0.8)


def test_a_hostile_element_stays_on_one_line():
    (only,) = remarks(arm(more="<" + "x" * 5000 + "/>"))
    assert len(only) < 400
    assert only.isprintable()


def test_suspicions_carry_their_line():
    (only,) = remarks(arm(fore=INERTIAL.replace('izz="0.1"', 'izz="9"')))
    assert only.startswith(f"{FILE}:21: link 'fore' has an inertia that no body can have")


def test_warnings_point_at_the_caller(tmp_path):
    text = arm(more="<spring/>")
    path = tmp_path / FILE
    path.write_text(text)
    for reader, source in ((parse_urdf, text), (read_urdf, path), (load, path)):
        with pytest.warns(ModelWarning) as caught:
            reader(source)
        assert caught[0].filename == __file__


# -- real robots ----------------------------------------------------------------------------------

ROBOTS = Path(sysconfig.get_path("purelib"), "cmeel.prefix/share/example-robot-data/robots")
needs_robots = pytest.mark.skipif(not ROBOTS.exists(), reason="example-robot-data is not there")
REFUSED = {
    "alex_psyonic_hands.urdf": "joint 'Left_index_q2' mimics joint 'index_q1', which",
    "human.urdf": "link 'left_upperleg_virtual', moved by joint 'left_hip_Z', has no <inertial>",
    "romeo_laas_small.urdf": "link 'l_gripper', moved by joint 'l_gripper_joint', has no",
    "quadrotor_base.urdf": "robot 'hector' has no moving joint",
    "iris_simple.urdf": "robot 'iris' has no moving joint",
    "ur3.urdf": "<robot> has no <link>",
}
TALOS = [
    *("torso_1_joint", "torso_2_joint", "head_1_joint", "head_2_joint"),
    *(f"arm_left_{i}_joint" for i in range(1, 8)),
    "gripper_left_joint",
    *(f"arm_right_{i}_joint" for i in range(1, 8)),
    "gripper_right_joint",
    *(f"leg_{side}_{i}_joint" for side in ("left", "right") for i in range(1, 7)),
]
UR5 = [
    f"{part}_joint"
    for part in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
]
PANDA = [*(f"panda_joint{i}" for i in range(1, 8)), "panda_finger_joint1"]


def coordinates(robot: Robot) -> list[str]:
    return [j.name for j in depth_first(robot.links, robot.joints) if j.moves and j.mimic is None]


@needs_robots
@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("ur_description/urdf/ur5_robot.urdf", UR5),
        ("panda_description/urdf/panda.urdf", PANDA),
        ("talos_data/robots/talos_reduced.urdf", TALOS),
    ],
)
def test_coordinates_of_real_robots(file, names):
    assert coordinates(read_urdf(ROBOTS / file)) == names


@needs_robots
def test_panda_with_independent_fingers():
    robot = read_urdf(ROBOTS / "panda_description/urdf/panda.urdf", mimic=False)
    assert coordinates(robot) == [*PANDA, "panda_finger_joint2"]


@needs_robots
@pytest.mark.parametrize("path", sorted(ROBOTS.rglob("*.urdf")), ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore::mcgee.ModelWarning")
def test_real_files_load_or_are_refused_for_a_reason(path):
    if path.name in REFUSED:
        with pytest.raises(ModelError, match=re.escape(REFUSED[path.name])):
            read_urdf(path)
        return
    robot = read_urdf(path)
    ours = [s for s in robot.warnings if "taken as written" in s or "taken as unlimited" in s]
    assert len(ours) <= 2, "one line for each kind of remark"
    tree = etree.parse(path).getroot()
    assert len(robot.links) == len(tree.findall("link"))
    assert len(robot.joints) == len(tree.findall("joint"))
