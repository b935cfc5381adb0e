"""What each quantity of a robot costs: operations, and time on this machine."""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from mcgee import build
from mcgee.kernels import refuse_symbols
from mcgee.robot import Robot

BATCH, ROUNDS = 4096, 7
LARGEST = 40_000
"""Numbers in a result up to which a quantity is looked at unless it is named."""

MEMORY = 1 << 23
"""Numbers in the results of a batch that is timed."""

MANY_JOINTS = 16
"""Beyond which Uicker & Kahn's formulation, O(n⁴), is left out."""

MOMENT = 1e-3
"""Seconds of calls that are timed together."""


def wanted(robot: Robot, named: Sequence[str]) -> tuple[list[str], dict[str, int]]:
    """The quantities to look at; those left out, with the numbers in their results."""
    refuse_symbols(robot, "figures")
    sizes = {
        name: sum(array.size for array in build.arrays(robot.mechanism, name)[1])
        for name in build.SIGNATURES
    }
    large = {name: size for name, size in sizes.items() if size > LARGEST and not named}
    return list(named) or [name for name in sizes if name not in large], large


def times(robot: Robot, names: Sequence[str]) -> dict[str, dict[str, float]]:
    """By quantity, nanoseconds an evaluation: of a batch, of a batch in float32, of one call."""
    random, found = np.random.default_rng(0), {}
    for name in robot.operation_counts(*names):
        method = getattr(robot, name)
        takes = len(_inputs(robot, name))
        size = sum(array.size for array in build.arrays(robot.mechanism, name)[1])
        rows_each = min(BATCH, max(64, MEMORY // size))
        arrays = [random.normal(size=(rows_each, robot.n)) for _ in range(takes)]
        rows = [array[0].copy() for array in arrays]
        single = [array.astype(np.float32) for array in arrays]
        found[name] = {
            "batch": _seconds(partial(method, *arrays)) / rows_each * 1e9,
            "batch float32": _seconds(partial(method, *single, dtype=np.float32)) / rows_each * 1e9,
            "one call": _seconds(partial(method, *rows)) * 1e9,
        }
    return found


def _inputs(robot: Robot, name: str) -> tuple[str, ...]:
    """Frame quantities are methods that take q."""
    return getattr(getattr(robot, name), "inputs", ("q",))


def _seconds(call: Callable[[], Any]) -> float:
    """The median of several rounds, each of calls that take a moment together."""
    call()
    start = time.perf_counter()
    call()
    turns = max(1, int(MOMENT / max(time.perf_counter() - start, 1e-9)))
    rounds = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for _ in range(turns):
            call()
        rounds.append((time.perf_counter() - start) / turns)
    return statistics.median(rounds)


def formulations(robot: Robot) -> dict[str, dict[str, Any]]:
    """Inverse dynamics by the formulations of old, where the robot is a chain they know.

    Of the links alone: they knew no rotors.
    """
    from mcgee.algorithms.classic import FORMULATIONS, PUBLISHED, counted

    found: dict[str, dict[str, Any]] = {}
    for name in FORMULATIONS:
        if name == "Uicker & Kahn" and robot.n > MANY_JOINTS:
            continue
        try:
            mul, add = counted(name, robot.mechanism)
        except ValueError:
            return {}
        found[name] = {"mul": mul, "add": add}
        if robot.n == 6:
            found[name]["published"] = dict(zip(("mul", "add"), PUBLISHED[name], strict=True))
    links = robot.replace(armature=dict.fromkeys(robot.joint_names, 0.0))
    ours = links.operation_counts("inverse_dynamics")["inverse_dynamics"]
    return found | {"mcgee": {"mul": ours["mul"], "add": ours["add"]}}


def print_json(robot: Robot, operations: bool, named: Sequence[str]) -> None:
    names, large = wanted(robot, named)
    report: dict[str, Any] = {"robot": robot.name, "unit": "operations" if operations else "ns"}
    report["quantities"] = robot.operation_counts(*names) if operations else times(robot, names)
    if large:
        report["left_out"] = {name: {"numbers": size} for name, size in large.items()}
    if operations and not named:
        report["inverse_dynamics_formulations"] = formulations(robot)
    print(json.dumps(report, indent=2))


def print_counts(robot: Robot, named: Sequence[str], console: Console | None = None) -> None:
    names, large = wanted(robot, named)
    columns = {
        "+": "add",
        "×": "mul",
        "÷": "div",
        "sin, cos": "sincos",
        "instructions": "instructions",
    }
    table = _table(["quantity", *columns])
    for name, figures in robot.operation_counts(*names).items():
        table.add_row(name, *(f"{figures[key]:,}" for key in columns.values()))
    console = console or Console(highlight=False)
    console.print(Text(repr(robot)))
    console.print(table)
    console.print("Instructions: what is left where a multiplication and an addition are one.")
    _print_left_out(large, console)
    rows = {} if named else formulations(robot)
    if rows:
        console.print("\nInverse dynamics by older formulations, counted for this robot's links:")
        console.print(_formulations_table(rows))


def _formulations_table(rows: dict[str, dict[str, Any]]) -> Table:
    six = any("published" in row for row in rows.values())
    table = _table(["formulation", "×", "+"] + ["published for six joints: ×", "+"] * six)
    for name, row in rows.items():
        theirs = row.get("published", {"mul": "", "add": ""}) if six else {}
        cells = [row["mul"], row["add"], *theirs.values()]
        table.add_row(name, *(f"{cell:,}" if cell != "" else "" for cell in cells))
    return table


def _print_left_out(large: dict[str, int], console: Console) -> None:
    for name, size in large.items():
        console.print(f"Left out: {name}, of {size:,} numbers; --only {name} asks for it.")


def print_times(robot: Robot, named: Sequence[str], console: Console | None = None) -> None:
    names, large = wanted(robot, named)
    figures = times(robot, names)
    columns = ("batch", "batch float32", "one call")
    table = _table(["quantity", *columns])
    for name, row in figures.items():
        table.add_row(name, *(f"{row[key]:,.1f}" for key in columns))
    console = console or Console(highlight=False)
    console.print(Text(repr(robot)))
    console.print(table)
    console.print(f"Nanoseconds an evaluation, medians; batches of {BATCH:,} rows or 64 MB.")
    _print_left_out(large, console)


def _table(titles: list[str]) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    for title in titles:
        table.add_column(title, justify="left" if title in ("quantity", "formulation") else "right")
    return table
