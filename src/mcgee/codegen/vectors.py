"""States, and what a function gives there to the last bit: what generated code is held against.

The numbers come from the same recursions at 60 digits, rounded once. Each result has a scale, the
size that rounding errors are measured against: its largest element, what that usually is where it
happens to be small, or what the result moves by, in units of float's last place, when all inputs
and constants move by one: far angles and nearly singular inertias say no more than that.
"""

from __future__ import annotations

import math
import random
import statistics
import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import mpmath

from mcgee import quantities
from mcgee.codegen.routine import Routine

if TYPE_CHECKING:
    from mcgee.codegen.symbols import Model

DIGITS = 60
STATES = 20
DEFAULT = 12

UNIT = 2.0**-30
"""The relative change that moves results; small, and far above float's last place."""

LARGE, FAST, TINY = 100.0, 50.0, 1e-9


@dataclass(frozen=True)
class Vectors:
    """A row holds the inputs, the outputs, and a scale for each output, element by element."""

    rows: tuple[tuple[float, ...], ...]

    def text(self) -> str:
        return "".join(" ".join(map(repr, row)) + "\n" for row in self.rows)


def vectors(
    model: Model,
    quantity: str,
    options: tuple,
    routine: Routine,
    single: bool,
    seed: int = 20,
    default: int = DEFAULT,
) -> Vectors:
    """
    Args:
        default: states at which parameters have their default values; then they are others
    Raises: ZeroDivisionError: the result exists in no state
    """
    states, results, moved = [], [], []
    for state in _states(model, routine, single, seed, default):
        try:
            result = _result(model, quantity, options, routine, state)
            other = _moved(model, quantity, options, routine, state)
        except ZeroDivisionError:  # M is singular there
            continue
        states.append(state)
        results.append(result)
        moved.append(other)
    if not states:
        raise ZeroDivisionError
    usual = [statistics.median(map(_size, column)) for column in zip(*results, strict=True)]
    rows = []
    for state, result, other in zip(states, results, moved, strict=True):
        scales = [
            max(_size(x), middle, *(abs(a - b) / UNIT for a, b in zip(x, y, strict=True))) or 1.0
            for x, y, middle in zip(result, other, usual, strict=True)
        ]
        given = [x for array in routine.inputs for x in state[array.name]]
        rows.append((*given, *(x for array in result for x in array), *scales))
    return Vectors(tuple(rows))


def _size(elements: Sequence[float]) -> float:
    return max(map(abs, elements))


def _states(
    model: Model, routine: Routine, single: bool, seed: int, default: int
) -> Iterator[dict[str, list[float]]]:
    """Random ones, and those where code goes wrong: at rest, stretched, folded, far, fast."""
    draw = random.Random(seed)
    n, defaults = model.robot.n, list(model.defaults.values())
    slides = [joint.kind == "prismatic" for joint in model.robot.independent_joints]
    for k in range(STATES):
        q = [draw.uniform(-0.5, 0.5) if slide else draw.uniform(-3.2, 3.2) for slide in slides]
        rates = {name: [draw.uniform(-2, 2) for _ in range(n)] for name in ("qdot", "qddot", "v")}
        tau = [draw.uniform(-20, 20) for _ in range(n)]
        factor = [draw.uniform(0.9, 1.1) for _ in defaults]
        if k in _SPECIAL:
            q = [_SPECIAL[k](x) for x in q]
        if k in (0, 1, 3):
            rates = {name: [0.0] * n for name in rates}
        if k == 6:
            rates = {name: [FAST * x for x in values] for name, values in rates.items()}
        if k < default:
            factor = [1.0] * len(defaults)
        params = [f * x for f, x in zip(_alike(model, factor), defaults, strict=True)]
        state = {"q": q, **rates, "tau": tau, "params": params}
        kept = {array.name: state[array.name] for array in routine.inputs}
        yield {name: [_float32(x) if single else x for x in v] for name, v in kept.items()}


_SPECIAL = {
    0: lambda x: 0.0,
    1: lambda x: math.pi / 2,
    2: lambda x: 0.0,
    3: lambda x: -math.pi,
    4: lambda x: TINY * x,
    5: lambda x: LARGE * x,
}


def _alike(model: Model, factor: list[float]) -> list[float]:
    """One factor for the ten parameters of a body, which another body can have."""
    if model.symbolic:
        return factor
    return [factor[k - k % 10] for k in range(len(factor))]


def _float32(x: float) -> float:
    return float(struct.unpack("f", struct.pack("f", x))[0])


def _result(
    model: Model,
    quantity: str,
    options: tuple,
    routine: Routine,
    state: dict[str, list[float]],
    number: Callable[[float], Any] = mpmath.mpf,
) -> list[list[float]]:
    """The outputs' elements, correctly rounded."""
    with mpmath.workdps(DIGITS):
        exact = {name: [number(x) for x in values] for name, values in state.items()}
        mechanism = model.put(model.robot.mechanism, exact.pop("params", None), number)
        result = getattr(quantities, quantity)(mechanism, *exact.values(), *options)
        whole = result if isinstance(result, tuple) else (result,)
        return [[float(x) for x in _flat(array)] for array in whole]


def _moved(
    model: Model, quantity: str, options: tuple, routine: Routine, state: dict[str, list[float]]
) -> list[list[float]]:
    """The outputs when every number that goes in is a little larger or smaller."""
    draw = random.Random(7)

    def near(x: Any) -> Any:
        return mpmath.mpf(x) * (1 + draw.choice((-UNIT, UNIT)))

    return _result(model, quantity, options, routine, state, near)


def _flat(x: Any) -> Iterator[Any]:
    if isinstance(x, (list, tuple)):
        for part in x:
            yield from _flat(part)
    else:
        yield x
