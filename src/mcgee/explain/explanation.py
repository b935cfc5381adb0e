"""All figures of one state, and the doors to their renderings."""

from __future__ import annotations

import dataclasses
import math
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.explain import sentences
from mcgee.explain.conventions import Conventions, conventions
from mcgee.explain.gravity import GravityFigures, WorstGravity, gravity_figures, worst_gravity
from mcgee.explain.inertia import (
    Array,
    InertiaFigures,
    TaskFigures,
    inertia_figures,
    task_figures,
)
from mcgee.explain.velocity import EnergyFlow, VelocityFigures, energy_flow, velocity_figures
from mcgee.explain.workspace import Extremes, Sweep, felt_extremes, sweep

if TYPE_CHECKING:
    from mcgee.robot import Robot


@dataclass(frozen=True, eq=False, repr=False)
class Explanation:
    """What M, C and g mean in one state.

    Everything is a figure with its unit in its docstring; `sentences` say the most telling ones.
    `worst` and `sweeps` look beyond the state and are computed when asked for.
    """

    robot: Robot
    q: Array
    qd: Array
    qdd: Array
    conventions: Conventions
    inertia: InertiaFigures
    task: TaskFigures
    velocity: VelocityFigures
    energy: EnergyFlow
    gravity: GravityFigures

    @cached_property
    def worst(self) -> tuple[WorstGravity, ...]:
        """The largest holding effort of each joint over the joint ranges.

        Raises: ModuleNotFoundError: SciPy is not installed (mcgee[plot])
        """
        return worst_gravity(self.robot, self.q)

    @property
    def _worst(self) -> tuple[WorstGravity, ...] | None:
        """`worst`, or None without SciPy."""
        try:
            return self.worst
        except ModuleNotFoundError:
            return None

    @cached_property
    def sweeps(self) -> tuple[Sweep, ...]:
        """M and g while each joint alone moves over its range."""
        return tuple(sweep(self.robot, self.q, [name]) for name in self.robot.joint_names)

    @cached_property
    def skater(self) -> Sweep:
        """The sweep that changes most what the first joint feels."""

        def ratio(s: Sweep) -> float:
            (least, _), (most, _) = s.extremes(s.M[..., 0, 0])
            return most / least

        return max(self.sweeps, key=ratio)

    @cached_property
    def felt(self) -> Extremes:
        """The least and most that the first joint feels along that sweep."""
        return felt_extremes(self.robot, self.skater)

    @property
    def is_skater(self) -> bool:
        """Whether any joint changes what the first one feels."""
        return self.felt.most - self.felt.least > sentences.NEGLIGIBLE * self.felt.most

    @cached_property
    def sentences(self) -> tuple[str, ...]:
        """The state in words."""
        c = self.conventions
        return (
            *sentences.inertia_sentences(c, self.inertia),
            *([sentences.skater_sentence(c, self.felt)] if self.is_skater else []),
            *sentences.task_sentences(self.task),
            *sentences.velocity_sentences(c, self.velocity),
            *sentences.gravity_sentences(c, self.gravity),
        )

    def __str__(self) -> str:
        from mcgee.explain.terminal import text

        return text(self)

    __repr__ = __str__

    def to_dict(self) -> dict[str, Any]:
        """Every figure but the sweeps as plain numbers, lists and texts; infinite ones as None,
        and so is `worst` without SciPy."""
        parts = ("conventions", "inertia", "task", "velocity", "energy", "gravity")
        return {
            "robot": self.robot.name,
            "q": self.q.tolist(),
            "qd": self.qd.tolist(),
            "qdd": self.qdd.tolist(),
            **{part: _plain(getattr(self, part)) for part in parts},
            "felt_by_first_joint": _plain(self.felt),
            "worst": None if self._worst is None else _plain(self._worst),
            "sentences": list(self.sentences),
        }

    def to_html(self, path: str | os.PathLike[str]) -> Path:
        """Write one page that needs nothing else: no network, no other file.

        Returns: the path, written whole or not at all
        Raises: ModuleNotFoundError: Plotly or SciPy is not installed (mcgee[plot])
        """
        from mcgee.explain.page import write_page

        return write_page(self, Path(path))


def explain(robot: Robot, q: Any, qd: Any, qdd: Any, frame: str) -> Explanation:
    """See `Robot.explain`."""
    at, speed, acceleration = (
        _state(robot, name, values) for name, values in (("q", q), ("qd", qd), ("qdd", qdd))
    )
    with np.errstate(over="ignore", invalid="ignore"):
        e = _figures(robot, at, speed, acceleration, frame)
    if not np.isfinite([*e.velocity.Cqd, e.velocity.kinetic_energy, *e.energy.through]).all():
        raise ValueError("the figures of this state are beyond float64: take smaller numbers.")
    return e


def _figures(robot: Robot, at: Array, speed: Array, acceleration: Array, frame: str) -> Explanation:
    return Explanation(
        robot=robot,
        q=at,
        qd=speed,
        qdd=acceleration,
        conventions=conventions(robot, frame),
        inertia=inertia_figures(robot, at),
        task=task_figures(robot, at, frame),
        velocity=velocity_figures(robot, at, speed),
        energy=energy_flow(robot, at, speed, acceleration),
        gravity=gravity_figures(robot, at),
    )


def _state(robot: Robot, name: str, values: Any) -> Array:
    """(n,) finite numbers; zeros for None."""
    if values is None:
        return np.zeros(robot.n)
    try:
        array = np.array(values, float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {values!r}, expected {robot.n} numbers.") from None
    if array.shape != (robot.n,):
        raise ValueError(
            f"{name} has shape {array.shape}, expected ({robot.n},) for robot '{robot.name}': one "
            f"state is explained at a time. Joints: {', '.join(robot.joint_names)}."
        )
    if not np.isfinite(array).all():
        raise ValueError(f"{name} holds {array.tolist()}, expected finite numbers.")
    return array


def _plain(x: Any) -> Any:
    if dataclasses.is_dataclass(x):
        return {f.name: _plain(getattr(x, f.name)) for f in dataclasses.fields(x)}
    if isinstance(x, np.ndarray):
        return _plain(x.tolist())
    if isinstance(x, (list, tuple)):
        return [_plain(v) for v in x]
    if isinstance(x, float):
        return x if math.isfinite(x) else None
    return x
