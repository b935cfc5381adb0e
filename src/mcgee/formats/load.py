"""One door for every description: a file, or the name of a built-in arm."""

from __future__ import annotations

import os
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

from mcgee.errors import ModelError
from mcgee.formats.described import described
from mcgee.robot import Robot

SUFFIXES = (".urdf", ".xml", ".xacro")


def load(source: str | os.PathLike[str], mimic: bool = True) -> Robot:
    """The robot that a file describes, or a built-in arm.

    Args:
        source: a path (a pathlib.Path, or a text with a separator or one of the suffixes .urdf,
            .xml, .xacro), else the name of a built-in arm, such as 'puma560'
        mimic: False leaves joints that mimic another independent
    Raises: ModelError: no such arm or file, or it does not describe a usable robot
    Warns: ModelWarning: what loads but is probably not meant
    """
    if not isinstance(source, (str, os.PathLike)):
        raise ModelError(
            f"source is of type {type(source).__name__}, expected a path or the name of an arm."
        )
    if _is_path(source):
        from mcgee.formats.urdf import describe_file  # XML is read by those who have a file

        name, links, joints, remarks = describe_file(source, mimic)
        return described(name, links, joints, remarks=remarks)
    robot = _built_in(str(source))
    if mimic:
        return robot
    return replace(robot, joints=tuple(replace(joint, mimic=None) for joint in robot.joints))


def _is_path(source: str | os.PathLike[str]) -> bool:
    if not isinstance(source, str):
        return True
    separators = [os.sep, os.altsep or os.sep]
    return any(s in source for s in separators) or source.lower().endswith(SUFFIXES)


def _built_in(name: str) -> Robot:
    from mcgee import arms  # some of them are read by this module's neighbours

    if name in arms.BUILTIN:
        return arms.BUILTIN[name]()
    close = get_close_matches(name, arms.BUILTIN, n=1)
    hint = f" Did you mean '{close[0]}'?" if close else ""
    if Path(name).is_file():
        hint = f" To read the file of that name, write {'./' + name!r}."
    raise ModelError(
        f"{name!r} is not the name of a built-in arm.{hint} "
        f"Built in: {', '.join(sorted(arms.BUILTIN))}. A file ends in {', '.join(SUFFIXES)}."
    )
