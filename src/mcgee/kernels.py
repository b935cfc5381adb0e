"""Binds a robot's quantities to compiled gufuncs, on first use."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from mcgee import build
from mcgee.jit.ufunc import gufunc

if TYPE_CHECKING:
    from mcgee.robot import Robot

F = TypeVar("F", bound=Callable)
_lock = threading.RLock()


class Quantity:
    """A method whose body is a compiled kernel; the function it is made from documents it.

    The kernel is compiled when the attribute is first looked up, and from then on stands in the
    instance itself: later calls pass through no Python code but their own error handling.
    """

    def __init__(self, stub: Callable):
        self.stub = stub
        self.__doc__ = stub.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, robot: Robot | None, owner: type) -> Callable:
        if robot is None:
            return self.stub
        call = callable_for(robot, self.name)
        call.__doc__, call.__name__ = self.__doc__, self.name
        robot.__dict__[self.name] = call
        return call


def quantity(stub: F) -> F:
    return cast(F, Quantity(stub))


def callable_for(robot: Robot, name: str, *options: str) -> Callable:
    """The quantity as a function of arrays that answers bad arguments with one clear sentence.

    Its attribute `ufunc` is the NumPy gufunc behind it.
    """
    ufunc = compiled(robot, name, *options)
    names = build.SIGNATURES[name].inputs

    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            return ufunc(*args, **kwargs)
        except (TypeError, ValueError) as error:
            refusal = error
        if kwargs.keys() & set(names):
            return call(*_positional(name, names, args, kwargs), **kwargs)
        raise _explained(robot, name, names, args, refusal)

    call.ufunc = ufunc  # type: ignore[attr-defined]
    return call


def compiled(robot: Robot, name: str, *options: str) -> np.ufunc:
    """The gufunc of a quantity of this robot, compiled at most once."""
    with _lock:
        known = robot.__dict__.setdefault("_ufuncs", {})
        if (name, options) not in known:
            if robot.symbols:
                raise ValueError(
                    f"robot '{robot.name}' still has the symbols {', '.join(robot.symbols)}; "
                    f"kernels need numbers. Give them with "
                    f"arm.subs({{{', '.join(f'{s!r}: …' for s in robot.symbols[:3])}}})."
                )
            known[name, options] = gufunc(build.trace(robot.mechanism, name, *options))
        return known[name, options]


def _positional(
    name: str, names: tuple[str, ...], args: tuple, kwargs: dict[str, Any]
) -> list[Any]:
    """Inputs given by name put in their places; they are taken out of kwargs."""
    places = list(args)
    for wanted in names[len(args) :]:
        if wanted not in kwargs:
            raise TypeError(f"{name} needs {', '.join(names)}; {wanted} is missing.")
        places.append(kwargs.pop(wanted))
    for twice in kwargs.keys() & set(names):
        raise TypeError(f"{name} got {twice} twice, by position and by name.")
    return places


def _explained(
    robot: Robot, name: str, names: tuple[str, ...], args: tuple, error: Exception
) -> Exception:
    """The clearest sentence for what NumPy refused."""
    if not len(names) <= len(args) <= len(names) + len(build.SIGNATURES[name].outputs):
        return TypeError(f"{name} takes {len(names)} arrays ({', '.join(names)}), got {len(args)}.")
    for wanted, given in zip(names, args, strict=False):
        try:
            array = np.asarray(given)
        except ValueError:
            return ValueError(
                f"{wanted} is ragged: its rows differ in length. Each needs {robot.n}."
            )
        if array.dtype.kind not in "fiub":
            return TypeError(
                f"{wanted} holds {array.dtype}, expected real numbers for robot '{robot.name}'."
            )
        if array.shape[-1:] != (robot.n,):
            return ValueError(
                f"{wanted} has shape {array.shape}, expected (..., {robot.n}) for robot "
                f"'{robot.name}'. Joints: {', '.join(robot.joint_names)}."
            )
    return type(error)(f"{name} of robot '{robot.name}': {error}")
