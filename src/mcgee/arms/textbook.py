"""What a textbook arm's parameters are called, kept with the robot that they made."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, ParamSpec

import mcgee
from mcgee.model import is_number
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

    Returns: the arm and the numbers by the symbols' names; None where no such function made it
    """
    if robot.made_by is None:
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
    return getattr(mcgee.arms, function)(**given), defaults
