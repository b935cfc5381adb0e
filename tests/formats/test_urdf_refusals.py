"""What the URDF reader refuses, sentence by sentence; hostile files."""

import pytest
from urdf_text import ELBOW, FILE, INERTIAL, arm, line_of, read, refusal, remarks

from mcgee import ModelError
from mcgee.formats import xml
from mcgee.formats.urdf import parse_urdf

# -- what is refused ------------------------------------------------------------------------------

TREE = arm()
NUMBERS = "expected 3 finite numbers with spaces between such as 0 0 0.1."
NUMBER = "expected a finite number such as 0.5."
EXPAND = "Expand it first: xacro FILE.xacro > FILE.urdf"
REPLACED = [  # what, by what, line of what, the rest of the sentence
    ('"0 1 0"', '"0 1"', f"joint 'elbow': <axis> has xyz '0 1', {NUMBERS}"),
    ('"0 1 0"', '"0 1 0 0"', f"joint 'elbow': <axis> has xyz '0 1 0 0', {NUMBERS}"),
    ('"0 1 0"', '""', f"joint 'elbow': <axis> has xyz '', {NUMBERS}"),
    ('"0 1 0"', '"0 1_0 0"', f"joint 'elbow': <axis> has xyz '0 1_0 0', {NUMBERS}"),
    ('"0 1 0"', '"0 nan 0"', f"joint 'elbow': <axis> has xyz '0 nan 0', {NUMBERS}"),
    ('"0 1 0"', '"0 inf 0"', f"joint 'elbow': <axis> has xyz '0 inf 0', {NUMBERS}"),
    ('"0 1 0"', '"0 1e999 0"', f"joint 'elbow': <axis> has xyz '0 1e999 0', {NUMBERS}"),
    ('"0 1 0"', '"0&#160;1 0"', f"joint 'elbow': <axis> has xyz '0\\xa01 0', {NUMBERS}"),
    ('"0 1 0"', '"0 ١ 0"', f"joint 'elbow': <axis> has xyz '0 ١ 0', {NUMBERS}"),
    (
        '"0 1 0"',
        '"0,1,0"',
        f"joint 'elbow': <axis> has xyz '0,1,0', {NUMBERS} Write decimals with a point.",
    ),
    (
        '"0 1 0"',
        '"0 ${x} 0"',
        f"joint 'elbow': <axis> has xyz '0 ${{x}} 0', {NUMBERS} {EXPAND}",
    ),
    (
        '<axis xyz="0 1 0"/>',
        "<axis/>",
        "joint 'elbow': <axis> has no xyz, expected <axis xyz=\"…\">.",
    ),
    ('"0 0 1"', '"0 0 x"', f"joint 'elbow': <origin> has xyz '0 0 x', {NUMBERS}"),
    ('lower="-2"', 'lower="abc"', f"joint 'elbow': <limit> has lower 'abc', {NUMBER}"),
    ('lower="-2"', 'lower="0x10"', f"joint 'elbow': <limit> has lower '0x10', {NUMBER}"),
    ('lower="-2"', 'lower="1_000"', f"joint 'elbow': <limit> has lower '1_000', {NUMBER}"),
    ('lower="-2"', 'lower=""', f"joint 'elbow': <limit> has lower '', {NUMBER}"),
    ('lower="-2"', 'lower="1 2"', f"joint 'elbow': <limit> has lower '1 2', {NUMBER}"),
    ('upper="2"', 'upper="nan"', f"joint 'elbow': <limit> has upper 'nan', {NUMBER}"),
    ('velocity="3"', 'velocity="."', f"joint 'elbow': <limit> has velocity '.', {NUMBER}"),
    ('effort="40"', 'effort="1e"', f"joint 'elbow': <limit> has effort '1e', {NUMBER}"),
    (
        '"0 1 0"/>',
        '"0 1 0"/> <axis xyz="0 0 1"/>',
        "joint 'elbow': <axis> is there twice, first on line {line}. Remove one.",
    ),
    (
        '<origin xyz="0 0 1"',
        '<origin quat_xyzw="0 0 0 1" xyz="0 0 1"',
        "joint 'elbow': <origin> has quat_xyzw, which is not read. Write the rotation as rpy.",
    ),
    (
        'child link="fore"',
        "child",
        "joint 'elbow': <child> has no link, expected <child link=\"…\">.",
    ),
    (
        'child link="fore"',
        'child link=" "',
        "joint 'elbow': <child> has link ' ', expected a name that is not empty.",
    ),
    (
        '<link name="fore">',
        "<link>",
        '<link> has no name, expected <link name="…">.',
    ),
    (
        '<link name="fore">',
        '<link name="">',
        "<link> has name '', expected a name that is not empty.",
    ),
    (
        '<joint name="elbow"',
        "<joint",
        '<joint> has no name, expected <joint name="…">.',
    ),
    (
        '<robot name="arm">',
        "<robot>",
        '<robot> has no name, expected <robot name="…">.',
    ),
    (
        '<joint name="elbow" type="revolute">',
        '<joint name="elbow">',
        "joint 'elbow' has no type, expected <joint type=\"…\">.",
    ),
    (
        'type="revolute"',
        'type="Revolute"',
        "joint 'elbow' has type 'Revolute', expected revolute, continuous, prismatic, fixed.",
    ),
    (
        'type="revolute"',
        'type="floating"',
        "joint 'elbow' has type 'floating', expected revolute, continuous, prismatic, fixed. "
        "Robots stand on a fixed base here: make the joint fixed, or remove it.",
    ),
    (
        'type="revolute"',
        'type="planar"',
        "joint 'elbow' has type 'planar', expected revolute, continuous, prismatic, fixed. "
        "Write two prismatic joints and a continuous one instead.",
    ),
]


@pytest.mark.parametrize(("old", "new", "sentence"), REPLACED)
def test_refuses(old, new, sentence):
    assert TREE.count(old) == 1
    line = line_of(TREE, old)
    sentence = sentence if "${" in sentence else sentence.replace("{line}", str(line))
    assert refusal(TREE.replace(old, new)) == f"{FILE}:{line}: {sentence}"


INERTIALS = [
    ('<mass value="2"/>', "", "<inertial> has no <mass>, expected one."),
    ('<mass value="2"/>', "<mass/>", '<mass> has no value, expected <mass value="…">.'),
    ('"2"', '"nan"', f"<mass> has value 'nan', {NUMBER}"),
    ('"2"', '"inf"', f"<mass> has value 'inf', {NUMBER}"),
    ('ixx="0.3"', "", '<inertia> has no ixx, expected <inertia ixx="…">.'),
    ('ixy="0"', 'ixy="zero"', f"<inertia> has ixy 'zero', {NUMBER}"),
    ('"0 0 0.5"', '"0 0"', f"<origin> has xyz '0 0', {NUMBERS}"),
    ('"0 0 0"', '"0 0 nan"', f"<origin> has rpy '0 0 nan', {NUMBERS}"),
]


@pytest.mark.parametrize(("old", "new", "sentence"), INERTIALS)
def test_refuses_in_an_inertial(old, new, sentence):
    assert INERTIAL.count(old) == 1
    text = arm(fore=INERTIAL.replace(old, new))
    assert refusal(text).endswith(f": link 'fore': {sentence}")


def test_refuses_an_inertial_without_inertia():
    fore = '<inertial><mass value="1"/></inertial>'
    assert refusal(arm(fore=fore)) == (
        f"{FILE}:22: link 'fore': <inertial> has no <inertia>, expected one."
    )


def test_refuses_two_inertials():
    assert refusal(arm(fore=INERTIAL + "\n" + INERTIAL)) == (
        f"{FILE}:27: link 'fore': <inertial> is there twice, first on line 22. Remove one."
    )


def test_refuses_a_joint_without_ends():
    for end, other in (("parent", "upper"), ("child", "fore")):
        elbow = ELBOW.replace(f'<{end} link="{other}"/>', "")
        assert refusal(arm(elbow)) == f"{FILE}:14: joint 'elbow' has no <{end}>, expected one."


def test_refuses_a_wrong_mimic():
    for mimic, problem in (
        ("<mimic/>", '<mimic> has no joint, expected <mimic joint="…">.'),
        ('<mimic joint="shoulder" offset="x"/>', f"<mimic> has offset 'x', {NUMBER}"),
    ):
        assert refusal(arm(ELBOW + mimic)) == f"{FILE}:19: joint 'elbow': {problem}"


def test_refuses_wrong_dynamics():
    for name in ("damping", "friction"):
        sentence = f"{FILE}:19: joint 'elbow': <dynamics> has {name} 'x', {NUMBER}"
        assert refusal(arm(ELBOW + f'<dynamics {name}="x"/>')) == sentence


@pytest.mark.parametrize(
    ("text", "start"),
    [
        (
            arm(ELBOW.replace("0 1 0", "0 0 0")),
            ":14: joint 'elbow' has axis (0, 0, 0), which has no",
        ),
        (arm(ELBOW.replace("0 1 0", "0 1e-9 0")), ":14: joint 'elbow' has axis (0, 1e-09, 0), wh"),
        (
            arm(ELBOW.replace("0 1 0", "0 1.7e308 1e308")),
            ":14: joint 'elbow' has axis (0, 1.7e+308",
        ),
        (arm(fore=INERTIAL.replace('"2"', '"-2"')), ":21: link 'fore' has mass -2 kg, expected a"),
        (arm(fore=""), ":21: link 'fore', moved by joint 'elbow', has no <inertial>."),
        (arm(ELBOW.replace('"upper"', '"no"')), ":14: joint 'elbow' has parent link 'no', which "),
        (arm(ELBOW.replace('"fore"', '"no"')), ":14: joint 'elbow' has child link 'no', which do"),
        (arm(ELBOW.replace('"upper"', '"fore"')), ":14: the joints form a cycle through the lin"),
        (arm(ELBOW.replace('"fore"', '"base"')), ":10: the joints form a cycle through the links"),
        (arm(ELBOW.replace('"fore"', '"upper"')), ":14: link 'upper' is the child of joint 'shou"),
        (arm(more='<link name="alone"/>'), ":28: robot 'arm' falls apart: no joint leads to lin"),
        (arm(more='<link name="base"/>'), f":28: link 'base' is declared twice, first at {FILE}:2"),
        (arm().replace('"shoulder"', '"elbow"'), ":14: joint 'elbow' is declared twice, first at"),
        (arm(ELBOW + '<mimic joint="no"/>'), ":14: joint 'elbow' mimics joint 'no', which does n"),
        (arm(ELBOW + '<mimic joint="elbow"/>'), ":14: joint 'elbow' mimics itself: elbow - elbow"),
    ],
)
def test_what_is_wrong_with_the_tree_is_said_with_its_line(text, start):
    """Sentences of `validate`: here only that each starts with its place in the file."""
    assert refusal(text).startswith(FILE + start)


# -- hostile and broken files ---------------------------------------------------------------------

NO_DOCTYPE = (
    f"{FILE} has a DOCTYPE. A robot description needs none, and entities are not expanded: "
    "remove it."
)


def test_refuses_an_entity_bomb():
    entities = '<!ENTITY a0 "lol">' + "".join(
        f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 30)
    )
    for head in ('<robot name="&a29;">', '<robot name="arm">&a29;'):
        bomb = f"<!DOCTYPE robot [{entities}]>{arm(head=head)}"
        assert refusal(bomb) == NO_DOCTYPE
        assert refusal(bomb.encode("utf-16")) == NO_DOCTYPE


@pytest.mark.parametrize(
    "declaration",
    [
        '<!DOCTYPE robot [<!ENTITY leak SYSTEM "{uri}">]>',
        '<!DOCTYPE robot [<!ENTITY % leak SYSTEM "{uri}"> %leak;]>',
        '<!DOCTYPE robot SYSTEM "{uri}">',
        '<!DOCTYPE robot PUBLIC "-//X//EN" "{uri}">',
        '<?xml version="1.0"?><!-- a comment first --> <!DOCTYPE robot>',
    ],
)
def test_refuses_external_entities_unread(declaration, tmp_path):
    secret = tmp_path / "secret"
    secret.write_text('<!ENTITY leak "hunter2">')
    text = declaration.format(uri=secret.as_uri()) + arm(head='<robot name="arm">&leak;')
    assert refusal(text) == NO_DOCTYPE


def test_a_doctype_in_a_comment_is_none():
    assert read("<!-- <!DOCTYPE robot> -->" + arm()) == read(arm())


def test_xinclude_is_not_followed(tmp_path):
    (tmp_path / "secret").write_text("hunter2")
    uri = (tmp_path / "secret").as_uri()
    more = f'<i:include xmlns:i="http://www.w3.org/2001/XInclude" href="{uri}" parse="text"/>'
    assert remarks(arm(more=more)) == [f"{FILE}:28: <i:include> is not read: skipped."]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (arm()[:-4], ":29: is not well-formed XML: "),
        (arm().replace("</link>", "", 1), ":29: is not well-formed XML: Opening and ending tag"),
        ("hello", ":1: is not well-formed XML: Start tag expected, '<' not found."),
        (b"\x89PNG\r\n\x1a\n\x00\x00", ":1: is not well-formed XML: "),
        (arm().encode()[:300] + b"\xff\xfe" + arm().encode()[300:], ": is not well-formed XML: "),
        ("<robot name='&who;'/>", ":1: is not well-formed XML: Entity 'who' not defined."),
        ("<robot><x:y/></robot>", ":1: is not well-formed XML: Namespace prefix x on y is not def"),
        ("<robot><xacro:y/></robot>", f"is not defined. {EXPAND}"),
        ("<robot a='1' a='2'/>", ":1: is not well-formed XML: Attribute a redefined."),
        ("<r>" * 300 + "</r>" * 300, ":1: is not well-formed XML: Excessive depth in document"),
        (b'<?xml version="1.0" encoding="no-such"?><robot/>', "Unsupported encoding: no-s"),
        ("<robot name='\ud800'/>", ":1: is not well-formed XML: "),
        ("<robot name='\x1b[31m'/>", ":1: is not well-formed XML: "),
    ],
)
def test_refuses_what_is_not_xml(text, sentence):
    assert sentence in refusal(text)


@pytest.mark.parametrize("text", ["", " \n\t", b""])
def test_refuses_empty_texts(text):
    assert refusal(text) == f"{FILE} is empty, expected a robot's file."


def test_refuses_large_texts(monkeypatch):
    monkeypatch.setattr(xml, "SIZE_LIMIT", 1 << 20)
    sentence = f"{FILE} is larger than 1 MiB, expected a robot's file."
    assert refusal(arm(more="<!--" + "x" * (1 << 20) + "-->")) == sentence


@pytest.mark.parametrize(
    ("root", "sentence"),
    [
        (
            "<mujoco/>",
            "<mujoco> is MuJoCo's MJCF, which is not read yet. URDF is: convert it, root <robot>.",
        ),
        ("<sdf/>", "<sdf> is SDF, which is not read yet. URDF is: convert it, root <robot>."),
        ("<html/>", "<html> is the root element, expected <robot>."),
        ('<robot name="a"/>', "<robot> has no <link>. Describe at least a base and a moving link."),
    ],
)
def test_refuses_other_roots(root, sentence):
    assert refusal(root) == f"{FILE}:1: {sentence}"


@pytest.mark.parametrize("uri", ["http://wiki.ros.org/xacro", "http://www.ros.org/wiki/xacro", "u"])
def test_refuses_xacro_content(uri):
    text = arm(more='<xacro:include filename="x"/>', head=f'<robot name="a" xmlns:xacro="{uri}">')
    assert refusal(text) == f"{FILE}:28: <xacro:include> is not expanded. {EXPAND}"


def test_refuses_xacro_content_by_another_prefix():
    text = arm(more='<x:property xmlns:x="http://www.ros.org/wiki/xacro"/>')
    assert refusal(text) == f"{FILE}:28: <x:property> is not expanded. {EXPAND}"


@pytest.mark.parametrize("reference", ["&#10;", "&#x85;", "&#x9b;31m", "&#x202e;", "&#x2028;"])
def test_refuses_names_that_would_break_a_message(reference):
    character = chr(int(reference[2:].split(";")[0].replace("x", "0x"), 0))
    escaped = character.encode("unicode_escape").decode() + reference.split(";")[1]
    expected = f"'fo{escaped}re', expected at most 256 characters, all of them printable."
    assert refusal(arm().replace('"fore"', f'"fo{reference}re"')).endswith(expected)
    assert f"type '{escaped}'" in refusal(arm(kind=reference))
    assert f"xyz '{escaped}'" in refusal(arm(ELBOW.replace("0 1 0", reference)))


def test_refuses_and_cuts_long_names():
    message = refusal(arm().replace('"fore"', f'"{"x" * 100_000}"'))
    assert message.endswith("x…', expected at most 256 characters, all of them printable.")
    assert len(message) < 400


def test_long_numbers_are_refused_at_once():
    message = refusal(arm(ELBOW.replace('"40"', f'"{"1" * 1_000_000}x"')))
    assert message.endswith(f"1…', {NUMBER}")
    assert refusal(arm(ELBOW.replace('"40"', f'"{"0" * 100}4"'))).endswith(f"4', {NUMBER}")


def test_the_name_of_the_file_is_escaped_too():
    with pytest.raises(ModelError, match=r"^a\\x1b\\n\.urdf is empty"):
        parse_urdf("", "a\x1b\n.urdf")
