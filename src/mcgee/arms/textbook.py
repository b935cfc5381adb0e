"""What a textbook arm's parameters are called, kept with the robot that they made."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, ParamSpec

import numpy as np

import mcgee
from mcgee.model import is_number, map_numbers
from mcgee.robot import Robot

P = ParamSpec("P")

PER_LINK = ("m", "l", "lc", "I")
"""What planar_nr takes for each link."""


def textbook(make: Callable[P, Robot]) -> Callable[P, Robot]:
    """The function, whose robots remember it and its arguments."""
    signature = inspect.signature(make)

    @wraps(make)
    def made(*args: P.args, **kwargs: P.kwargs) -> Robot:
        robot = make(*args, **kwargs)
        given = signature.bind(*args, **kwargs)
        given.apply_defaults()
        return dataclasses.replace(
            robot, made_by=(make.__name__, tuple((k, _kept(v)) for k, v in given.arguments.items()))
        )

    return made


def _kept(value: Any) -> Any:
    is_sequence = isinstance(value, Iterable) and not isinstance(value, str)
    return tuple(value) if is_sequence else value


def symbolic(robot: Robot) -> tuple[Robot, dict[str, float]] | None:
    """The same arm with symbols for the numbers that its textbook function was given.

    Returns: the arm and the numbers by the symbols' names; None where no such function made it, or
        where it was changed since
    """
    if robot.made_by is None or robot.symbols:
        return None
    import sympy

    function, arguments = robot.made_by
    n = dict(arguments).get("n", 0)  # of planar_nr, whose numbers are one for all links or n
    defaults: dict[str, float] = {}

    def symbol(name: str, value: Any) -> Any:
        if name == "n" or not is_number(value):
            return value
        defaults[name] = float(value)
        return sympy.Symbol(name, positive=True)

    given: dict[str, Any] = {}
    for name, value in arguments:
        if n and name in PER_LINK:
            each = value if isinstance(value, tuple) else (value,) * n
            given[name] = tuple(symbol(f"{name}{k}", v) for k, v in enumerate(each, 1))
        else:
            given[name] = symbol(name, value)
    made = getattr(mcgee.arms, function)(**given).replace(name=robot.name)
    used = {name: value for name, value in defaults.items() if name in made.symbols}
    return (made, defaults) if _alike(made.subs(used), robot) else None


def _alike(a: Robot, b: Robot) -> bool:
    """Whether two robots are the same but for rounding."""
    numbers: tuple[list[float], list[float]] = ([], [])
    frames = []
    for robot, found in zip((a, b), numbers, strict=True):
        described = (robot.links, robot.joints, robot.frames, robot.gravity_vector)

        def note(x: Any, found: list[float] = found) -> float:
            found.append(float(x))
            return 0.0

        frames.append(map_numbers(described, note))
    first, second = (np.array(found) for found in numbers)
    same = first.shape == second.shape and np.allclose(first, second, rtol=1e-12, atol=1e-15)
    return bool(same and frames[0] == frames[1])
