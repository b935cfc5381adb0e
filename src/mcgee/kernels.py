"""Binds a robot's quantities to compiled gufuncs, on first use."""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Callable
from functools import update_wrapper
from types import MethodType
from typing import Any, ClassVar, Protocol, TypeVar, cast

import numpy as np

from mcgee import build, threads
from mcgee.graph.program import Program
from mcgee.jit.compile import compiled_row
from mcgee.jit.door import door_type, hang, is_open, open_
from mcgee.jit.ufunc import gufunc
from mcgee.jit.ufunc import rollout as rollout_ufunc
from mcgee.mechanism import Mechanism, friction


class Robot(Protocol):
    """Whose kernels these are: a `mcgee.robot.Robot`, or its `with_parameters()`."""

    parametric: ClassVar[bool]
    __dict__: dict[str, Any]

    @property
    def name(self) -> str: ...
    @property
    def joint_names(self) -> tuple[str, ...]: ...
    @property
    def symbols(self) -> tuple[str, ...]: ...
    @property
    def mechanism(self) -> Mechanism: ...


F = TypeVar("F", bound=Callable)
_lock = threading.RLock()
if hasattr(os, "register_at_fork"):  # a child must not inherit a lock that nobody will release
    os.register_at_fork(
        before=_lock.acquire, after_in_parent=_lock.release, after_in_child=_lock.release
    )


class Quantity:
    """A method whose body is a compiled kernel; the function it is made from documents it.

    Looking it up puts a `Bound` into the robot itself, which compiles at its first call.
    """

    def __init__(self, stub: Callable, gives: type[tuple]):
        self.stub, self.gives = stub, gives
        update_wrapper(self, stub)

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, robot: Robot | None, owner: type) -> Callable:
        if robot is None:
            return self
        # what a subclass puts over it must not be hidden by an entry of that name
        is_seen = getattr(type(robot), self.name, None) is self
        place = self.name if is_seen else f"{self.name}, overridden"
        made = robot.__dict__.get(place)
        if made is None:
            made = _made(robot, self.name, stub=self.stub, gives=self.gives)
            robot.__dict__[place] = made
        return made

    def __call__(self, robot: Robot, *args: Any, **kwargs: Any) -> Any:
        return self.__get__(robot, type(robot))(*args, **kwargs)


def quantity(stub: F) -> F:
    return cast(F, Quantity(stub, tuple))


class quantities:  # noqa: N801
    """As `quantity`, for several results in a named tuple."""

    def __init__(self, gives: type[tuple]):
        self.gives = gives

    def __call__(self, stub: F) -> F:
        return cast(F, Quantity(stub, self.gives))


class Bound:
    # A quantity of a robot as a function of arrays, with one clear sentence for bad ones.
    #
    # Instances that `bound` makes are of a compiled subtype where this Python has one, and answer a
    # plain single call without coming here. The rest is `general`. Their docstring is their stub's.

    __slots__ = (
        *("__name__", "__weakref__", "__wrapped__", "_description", "_plan"),
        *("gives", "inputs", "options", "robot"),
    )

    def __init__(
        self,
        robot: Robot,
        name: str,
        *options: str,
        stub: Callable | None = None,
        gives: type[tuple] = tuple,
    ):
        self.robot, self.options, self.gives = robot, options, gives
        self.inputs = build.signature(name, robot.parametric).inputs
        self.__name__ = name
        self._description = None if stub is None else stub.__doc__
        if stub is not None:
            self.__wrapped__ = MethodType(stub, robot)

    @property
    def __doc__(self) -> str | None:  # type: ignore[override]
        return self._description

    @property
    def ufunc(self) -> np.ufunc:
        """The NumPy gufunc behind it."""
        return compiled(self.robot, self.__name__, *self.options)[0]

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return self.general(*args, **kwargs)

    def general(self, *args: Any, **kwargs: Any) -> Any:
        """What any arguments give, by way of NumPy."""
        if not kwargs and self._opens_for(args):
            return self(*args)
        if isinstance(kwargs.get("out"), tuple):
            kwargs["out"] = tuple(kwargs["out"])  # a named one, from an earlier call
        kernel = compiled(self.robot, self.__name__, *self.options, single=_asks_single(kwargs))
        try:
            result = threads.run(*kernel, args, kwargs)
            return self.gives(*result) if self.gives is not tuple else result
        except (TypeError, ValueError) as error:
            refusal = error
        if kwargs.keys() & set(self.inputs):
            return self(*_positional(self.__name__, self.inputs, args, kwargs), **kwargs)
        raise _explained(self.robot, self.__name__, self.inputs, args, refusal)

    def _opens_for(self, args: tuple) -> bool:
        """Compile for single rows if these are the first."""
        if type(self) is Bound or is_open(self) or len(args) != len(self.inputs):
            return False
        if not all(type(a) is np.ndarray and a.ndim == 1 and a.dtype == float for a in args):
            return False
        with _lock, build.collection_paused():
            open_(self, compiled_row(_traced(self.robot, self.__name__, *self.options)))
        return True

    def __repr__(self) -> str:
        takes = ", ".join(self.inputs)
        return f"<{self.__name__}({takes}) of robot '{self.robot.name}'>"

    def __reduce__(self) -> tuple:
        if self.options:
            return bound, (self.robot, self.__name__, *self.options)
        return getattr, (self.robot, self.__name__)


def _made(robot: Robot, name: str, *options: str, **details: Any) -> Bound:
    made = door_type(Bound)(robot, name, *options, **details)
    if type(made) is not Bound:
        inputs, outputs = build.arrays(robot.mechanism, name, robot.parametric)
        made._plan = hang(made, [array.size for array in inputs], outputs, made.gives)
    return made


def bound(robot: Robot, name: str, *options: str) -> Bound:
    """A quantity that is no `Quantity` of the robot's class, made once."""
    known = robot.__dict__.setdefault("_calls", {})
    call = known.get((name, options))
    if call is None:
        call = known[name, options] = _made(robot, name, *options)
    return call


def compiled(robot: Robot, name: str, *options: str, single: bool = False) -> tuple[np.ufunc, int]:
    """The gufunc of a robot's quantity, compiled at most once, and the operations of a row."""
    key = (name, options, single)
    known = robot.__dict__.setdefault("_ufuncs", {})
    if key in known:  # not to wait while another is compiled
        return known[key]
    with _lock:
        if key not in known:
            with build.collection_paused():
                program = _traced(robot, name, *options)
                known[key] = gufunc(program, single=single), len(program.nodes)
        return known[key]


def rollout(
    robot: Any,
    state: tuple[np.ndarray, np.ndarray],
    tau: np.ndarray,
    dt: np.ndarray,
    substeps: int,
    viscous: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """Many steps of motion, see `mcgee.simulate.rollout`; the loop is compiled at most once."""
    ufunc, cost = _rollout(robot, viscous)
    lead = np.broadcast_shapes(*(x.shape[:-1] for x in state), tau.shape[:-2], dt.shape)
    times, n = tau.shape[-2:]
    rows = lead or (1,)
    given = [
        *(np.broadcast_to(x, (*rows, n)) for x in state),
        *(np.broadcast_to(tau, (*rows, times, n)), np.broadcast_to(dt, rows)),
        np.broadcast_to(float(substeps), rows),
    ]
    outputs = np.empty((*rows, times, n)), np.empty((*rows, times, n))
    operations = cost * times * substeps * math.prod(rows[1:])
    threads.run_rows(ufunc, operations, given, outputs)
    return outputs[0].reshape(*lead, times, n), outputs[1].reshape(*lead, times, n)


def _rollout(robot: Any, viscous: bool) -> tuple[np.ufunc, int]:
    refuse_symbols(robot, "rollouts")
    known = robot.__dict__.setdefault("_ufuncs", {})
    key = ("rollout", (), viscous)
    with _lock:
        if key not in known:
            rubs = [b * viscous for b, _ in friction(robot.joints, robot.joint_names)]
            try:
                program = build.trace_step(robot.mechanism, rubs)
            except ZeroDivisionError:
                raise ValueError(singular(robot, "forward_dynamics")) from None
            known[key] = rollout_ufunc(program), len(program.nodes)
        return known[key]


def _traced(robot: Robot, name: str, *options: str) -> Program:
    refuse_symbols(robot, "kernels")
    try:
        return build.trace(robot.mechanism, name, *options, parametric=robot.parametric)
    except ZeroDivisionError:
        raise ValueError(singular(robot, name)) from None


def _asks_single(kwargs: dict[str, Any]) -> bool:
    """Whether results of float32 are wanted."""
    wanted = kwargs.get("dtype")
    try:
        return wanted is not None and np.dtype(wanted) == np.float32
    except TypeError:
        return False


def refuse_symbols(robot: Robot, what: str) -> None:
    """Raises: ValueError: the robot has symbols, and what is asked for needs numbers"""
    if robot.symbols:
        raise ValueError(
            f"robot '{robot.name}' still has the symbols {', '.join(robot.symbols)}; "
            f"{what} need numbers. Give them with "
            f"arm.subs({{{', '.join(f'{s!r}: …' for s in robot.symbols[:3])}}})."
        )


def singular(robot: Robot, name: str) -> str:
    """Why M has no inverse, whatever the pose."""
    below = [
        np.array([b.mass, *b.inertia, b.armature * b.multiplier**2], float)
        for b in robot.mechanism.bodies
    ]
    for i, body in reversed(list(enumerate(robot.mechanism.bodies))):
        if body.parent >= 0:
            below[body.parent] = below[body.parent] + below[i]
    idle = [b.name for b, held in zip(robot.mechanism.bodies, below, strict=True) if not held.any()]
    joint = f"joint '{idle[0]}' moves nothing that has inertia" if idle else "some joint is free"
    return (
        f"{name} of robot '{robot.name}' does not exist: M is singular in every pose, {joint}. "
        f"Give the links beyond it mass and inertia, or the joint an armature."
    )


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


def _elements(robot: Robot, wanted: str) -> str:
    """What the last dimension of an input counts."""
    if wanted == "parameters":
        joints = ", ".join(body.name for body in robot.mechanism.bodies)
        return f"Ten for the link of each joint, as in arm.inertial_parameters: {joints}"
    return f"Joints: {', '.join(robot.joint_names)}"


def _explained(
    robot: Robot, name: str, names: tuple[str, ...], args: tuple, error: Exception
) -> Exception:
    """The clearest sentence for what NumPy refused."""
    if (
        not len(names)
        <= len(args)
        <= len(names) + len(build.signature(name, robot.parametric).outputs)
    ):
        return TypeError(f"{name} takes {len(names)} arrays ({', '.join(names)}), got {len(args)}.")
    for wanted, given in zip(names, args, strict=False):
        width = build.width(robot.mechanism, wanted)
        try:
            array = np.asarray(given)
        except ValueError:
            return ValueError(f"{wanted} is ragged: its rows differ in length. Each needs {width}.")
        if array.dtype.kind not in "fiub":
            return TypeError(
                f"{wanted} holds {array.dtype}, expected real numbers for robot '{robot.name}'."
            )
        if array.shape[-1:] != (width,):
            return ValueError(
                f"{wanted} has shape {array.shape}, expected (..., {width}) for robot "
                f"'{robot.name}'. {_elements(robot, wanted)}."
            )
    leads = [np.shape(given)[:-1] for given in args[: len(names)]]
    try:
        np.broadcast_shapes(*leads)
    except ValueError:
        shapes = ", ".join(
            f"{wanted} {np.shape(given)}" for wanted, given in zip(names, args, strict=False)
        )
        return ValueError(
            f"{name} of robot '{robot.name}' got {shapes}: the dimensions before the last do not "
            f"broadcast."
        )
    kind = TypeError if isinstance(error, TypeError) else ValueError  # NumPy's own take more
    return kind(f"{name} of robot '{robot.name}': {error}")
