"""The last step of every reader: a robot, and a word on what looks wrong in it."""

import dataclasses
import warnings

from mcgee import validate
from mcgee.errors import ModelWarning
from mcgee.model import Frame, Joint, Link, Vec3
from mcgee.robot import EARTH, Robot


def described(
    name: str,
    links: tuple[Link, ...],
    joints: tuple[Joint, ...],
    frames: tuple[Frame, ...] = (),
    gravity_vector: Vec3 = EARTH,
    remarks: tuple[str, ...] = (),
) -> Robot:
    """A robot fresh from a description; what looks wrong in it is said as ModelWarnings.

    remarks: what the reader of the description itself found odd, one sentence each.
    """
    robot = Robot(name, links, joints, frames, gravity_vector)
    sentences = (*remarks, *validate.suspicions(links, joints))
    for sentence in sentences:
        warnings.warn(sentence, ModelWarning, stacklevel=3)
    return dataclasses.replace(robot, warnings=sentences)
