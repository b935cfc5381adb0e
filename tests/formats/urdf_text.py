"""A small valid URDF text with replaceable parts, and what the reader says about one."""

import warnings

import pytest

from mcgee import ModelError, ModelWarning, Robot
from mcgee.formats.urdf import parse_urdf

FILE = "arm.urdf"
INERTIAL = """<inertial>
      <origin xyz="0 0 0.5" rpy="0 0 0"/>
      <mass value="2"/>
      <inertia ixx="0.3" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.1"/>
    </inertial>"""
ELBOW = """<origin xyz="0 0 1" rpy="0 0 0"/>
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="40"/>"""


def arm(elbow=ELBOW, fore=INERTIAL, kind="revolute", more="", head='<robot name="arm">'):
    """Base - shoulder - upper - elbow - fore; joint elbow starts on line 14, link fore on 21."""
    return f"""{head}
  <link name="base"/>
  <link name="upper">
    {INERTIAL}
  </link>
  <joint name="shoulder" type="continuous">
    <parent link="base"/>
    <child link="upper"/>
  </joint>
  <joint name="elbow" type="{kind}">
    {elbow}
  </joint>
  <link name="fore">
    {fore}
  </link>
  {more}
</robot>"""


def line_of(text: str, part: str) -> int:
    return text[: text.index(part)].count("\n") + 1


def read(text) -> Robot:
    return parse_urdf(text, FILE)


def joint(text, name="elbow"):
    return next(j for j in read(text).joints if j.name == name)


def refusal(text) -> str:
    with pytest.raises(ModelError) as caught:
        read(text)
    message = str(caught.value)
    assert message.isprintable(), "one line, no control characters"
    return message


def remarks(text) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        robot = read(text)
    assert all(w.category is ModelWarning for w in caught)
    sentences = [str(w.message) for w in caught]
    assert tuple(sentences) == robot.warnings
    return sentences
