"""A motion from the terminal: what it was, its ledger, files of it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from mcgee.cli.state import State, as_shown
from mcgee.control.gains import positive
from mcgee.robot import Robot
from mcgee.typeset import aligned, number
from mcgee.writing import check_place

if TYPE_CHECKING:
    from mcgee.control.controller import Controller
    from mcgee.simulate import Trajectory


DurationOption = Annotated[float, typer.Option("--duration", help="Seconds.")]
ControllerOption = Annotated[
    str,
    typer.Option(
        "--controller",
        metavar="LAW",
        help="none, pd-gravity, computed-torque, slotine-li, adaptive, lqr, or swing-up.",
    ),
]
TargetOption = Annotated[str, typer.Option("--target", help="Where to, in the form of --q.")]
RiseOption = Annotated[
    float | None,
    typer.Option("--rise", help="Seconds of the way to the target; half of the duration."),
]
BandwidthOption = Annotated[
    float | None,
    typer.Option("--bandwidth", help="Of the controller's errors [rad/s]; 10 by default."),
]
MethodOption = Annotated[
    str,
    typer.Option("--method", help="DOP853, RK45, RK23, Radau, BDF, LSODA, rk4 or midpoint."),
]
StepOption = Annotated[
    float | None, typer.Option("--step", help="Seconds between the times that are kept.")
]
DtOption = Annotated[float, typer.Option("--dt", help="Longest step of rk4 and midpoint [s].")]
FrictionOption = Annotated[
    bool, typer.Option("--friction", help="With the description's friction.")
]
StopsOption = Annotated[bool, typer.Option("--stops", help="With stops at the joints' limits.")]
LimitsOption = Annotated[
    bool, typer.Option("--limits", help="Actuators give no more than their effort.")
]
HtmlOption = Annotated[
    Path | None, typer.Option("--html", metavar="FILE", help="Write a page of the motion.")
]
OutputOption = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="FILE", help="Write .npz, .csv or .parquet."),
]

WRONG, REFUSED, INTERRUPTED = 1, 2, 130
"""Exit codes of motions that could not go on, of files that could not be written, and of Ctrl-C."""


@dataclass(frozen=True)
class Wanted:
    duration: float
    controller: str
    target: np.ndarray | None
    rise: float | None
    bandwidth: float | None
    settings: dict[str, Any]
    """Of `mcgee.simulate`."""


def _pd(robot: Robot, goal: np.ndarray, reference: Any, w: float) -> Controller:
    from mcgee.control import PDGravity

    felt = np.diag(robot.mass_matrix(goal))
    return PDGravity(robot, goal, w * w * felt, 2 * w * felt)


def _computed(robot: Robot, goal: np.ndarray, reference: Any, w: float) -> Controller:
    from mcgee.control import ComputedTorque

    return ComputedTorque(robot, reference, w * w, 2 * w)


def _slotine(robot: Robot, goal: np.ndarray, reference: Any, w: float) -> Controller:
    from mcgee.control import SlotineLi

    return SlotineLi(robot, reference, w, w * np.diag(robot.mass_matrix(goal)))


def _adaptive(robot: Robot, goal: np.ndarray, reference: Any, w: float) -> Controller:
    from mcgee.control import AdaptiveSlotineLi, parameter_scales

    felt = np.diag(robot.mass_matrix(goal))
    return AdaptiveSlotineLi(robot, reference, w, w * felt, 10 * parameter_scales(robot) ** 2)


def _lqr(robot: Robot, goal: np.ndarray, reference: Any, w: float) -> Controller:
    """Of a single joint: kp = w² M, kd = √3 w M."""
    from mcgee.control import LQR

    felt = np.diag(robot.mass_matrix(goal))
    weights = np.concatenate([w * w * felt, felt])
    return LQR(robot, goal, Q=weights, R=1 / (w * w * felt[robot.limits.effort > 0]))


CONTROLLERS: dict[str, Callable[[Robot, np.ndarray, Any, float], Controller]] = {
    "pd-gravity": _pd,
    "computed-torque": _computed,
    "slotine-li": _slotine,
    "adaptive": _adaptive,
    "lqr": _lqr,
}
BANDWIDTH = 10.0
SWING_UP = "swing-up"
"""The one that knows where to."""


def run(
    robot: Robot,
    start: State,
    wanted: Wanted,
    paths: tuple[Path | None, Path | None],
    as_json: bool,
) -> int:
    """Simulate, write and tell; the exit code.

    Raises: ValueError: an unknown controller, one without a target, a target beyond the limits
    """
    from mcgee.simulate import SimulationError, simulate

    _check_places(*paths)
    law, code = _law(robot, start.q, wanted), 0
    try:
        motion = simulate(robot, start.q, start.qd, wanted.duration, law, **wanted.settings)
    except SimulationError as error:
        typer.echo(f"mcgee: error: {error}", err=True)
        motion, code = error.trajectory, WRONG
    if motion.status == "interrupted":
        code = INTERRUPTED
    for path, save in zip(paths, (motion.to_html, motion.save), strict=True):
        if path is not None:
            try:
                save(path)
            except ValueError as error:  # the other file and the report are still to come
                typer.echo(f"mcgee: error: {error}", err=True)
                code = REFUSED
            else:
                typer.echo(f"mcgee: wrote {path}", err=True)
    if as_json:
        print(json.dumps(motion.to_dict(), indent=1))
    else:
        print_report(motion, wanted, start.degrees)
    return code


def _check_places(html: Path | None, table: Path | None) -> None:
    """What can be known before a long motion.

    Raises:
        ValueError: a file cannot be there, or has no known ending, or both are one
        ModuleNotFoundError: what would write it is not installed
    """
    from mcgee.explain.look import plotly
    from mcgee.simulate.files import maker, pyarrow

    for path in (html, table):
        if path is not None:
            check_place(path, "the motion")
    if table is not None:
        maker(table)
        if table.suffix == ".parquet":
            pyarrow()
    if html is not None:
        plotly()
        if table is not None and html.resolve() == table.resolve():
            raise ValueError(f"--html and -o both name '{html}'; give each a file of its own.")


def _law(robot: Robot, q: np.ndarray, wanted: Wanted) -> Controller | None:
    if wanted.controller == "none":
        for option, value in (
            ("--target", wanted.target),
            ("--rise", wanted.rise),
            ("--bandwidth", wanted.bandwidth),
        ):
            if value is not None:
                raise ValueError(f"{option} needs a --controller: {', '.join(CONTROLLERS)}.")
        return None
    if wanted.controller == SWING_UP:
        if wanted.target is not None:
            raise ValueError(f"--controller {SWING_UP} takes no --target: it goes upright.")
        from mcgee.control import swing_up

        return swing_up(robot)
    make = CONTROLLERS.get(wanted.controller)
    if make is None:
        known = ", ".join(("none", *CONTROLLERS, SWING_UP))
        raise ValueError(f"--controller is '{wanted.controller}', expected one of: {known}.")
    if wanted.target is None:
        raise ValueError(f"--controller {wanted.controller} needs a --target: joint positions.")
    from mcgee.control import Quintic

    rise = wanted.duration / 2 if wanted.rise is None else positive("--rise", wanted.rise, "s")
    w = BANDWIDTH if wanted.bandwidth is None else positive("--bandwidth", wanted.bandwidth, "1/s")
    for option, place in (("--q", q), ("--target", wanted.target)):
        _check_limits(robot, option, place)
    reference = Quintic(q, wanted.target, rise)
    reference.check(robot.limits, robot.joint_names)
    return make(robot, wanted.target, reference, w)


def _check_limits(robot: Robot, option: str, q: np.ndarray) -> None:
    """Raises: ValueError: a joint is beyond its limits"""
    for name, x, lower, upper in zip(
        robot.joint_names, q, robot.limits.lower, robot.limits.upper, strict=True
    ):
        if not lower <= x <= upper:
            raise ValueError(
                f"{option} puts joint '{name}' at {x:.6g}, expected {lower:.6g} to {upper:.6g}, "
                f"its limits; other joints of {option} are zero where they are not named."
            )


def print_report(motion: Trajectory, wanted: Wanted, degrees: bool = False) -> None:
    console = Console(highlight=False)
    steps = f"{motion.t[-1]:g} s in {len(motion.t)} times, {motion.status}"
    console.print(f"{motion.robot.name}: {steps}", markup=False)
    console.print(_joints(motion, wanted, degrees))
    console.print(_ledger(motion))
    lost = float(abs(motion.residual).max())
    console.print(
        f"Energy that the ledger misses, the integrator's error: {number(lost)} J at most.",
        markup=False,
    )


def _joints(motion: Trajectory, wanted: Wanted, degrees: bool) -> Table:
    shown, units = as_shown(motion.robot, degrees)
    columns = {"q": motion.q[-1] * shown, "qd /s": motion.qd[-1] * shown}
    columns["max |tau|"] = abs(motion.tau).max(0)
    if wanted.target is not None:
        columns["off target"] = (motion.q[-1] - wanted.target) * shown
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("at the end")
    for name in columns:
        table.add_column(name, justify="right")
    table.add_column("unit")
    cells = [aligned(column) for column in columns.values()]
    for name, *row in zip(motion.robot.joint_names, *cells, map(", ".join, units), strict=True):
        table.add_row(Text(name), *row)
    return table


def _ledger(motion: Trajectory) -> Table:
    start, end = ((motion.kinetic[k], motion.potential[k]) for k in (0, -1))
    rows = {
        "kinetic energy T": end[0] - start[0],
        "potential energy P": end[1] - start[1],
        "work of the actuators": motion.work[-1].sum(),
        "work of the stops": motion.stopped[-1].sum(),
        "work of the disturbance": motion.disturbed[-1].sum(),
        "lost to friction": -motion.dissipated[-1].sum(),
    }
    kept = {name: value for name, value in rows.items() if value or name[:1] in "kp"}
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("since the start")
    table.add_column("[J]", justify="right")
    for name, value in zip(kept, aligned(kept.values()), strict=True):
        table.add_row(name, value)
    return table
