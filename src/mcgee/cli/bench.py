"""What each quantity of a robot costs: operations, and time on this machine."""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from mcgee.robot import Robot

BATCH, ROUNDS = 4096, 7
MOMENT = 1e-3
"""Seconds of calls that are timed together."""


def times(robot: Robot) -> dict[str, dict[str, float]]:
    """By quantity, nanoseconds an evaluation: of a batch, of a batch in float32, of one call."""
    random, found = np.random.default_rng(0), {}
    for name in robot.operation_counts():
        method = getattr(robot, name)
        takes = len(_inputs(robot, name))
        arrays = [random.normal(size=(BATCH, robot.n)) for _ in range(takes)]
        rows = [array[0].copy() for array in arrays]
        single = [array.astype(np.float32) for array in arrays]
        found[name] = {
            "batch": _seconds(partial(method, *arrays)) / BATCH * 1e9,
            "batch float32": _seconds(partial(method, *single, dtype=np.float32)) / BATCH * 1e9,
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
    """Inverse dynamics by the formulations of old, where the robot is a chain they know."""
    from mcgee.algorithms.classic import FORMULATIONS, PUBLISHED, counted

    found: dict[str, dict[str, Any]] = {}
    for name in FORMULATIONS:
        try:
            mul, add = counted(name, robot.mechanism)
        except ValueError:
            return {}
        found[name] = {"mul": mul, "add": add}
        if robot.n == 6:
            found[name]["published"] = dict(zip(("mul", "add"), PUBLISHED[name], strict=True))
    ours = robot.operation_counts()["inverse_dynamics"]
    return found | {"mcgee": {"mul": ours["mul"], "add": ours["add"]}}


def print_json(robot: Robot, operations: bool) -> None:
    report: dict[str, Any] = {"robot": robot.name, "unit": "operations" if operations else "ns"}
    report["quantities"] = robot.operation_counts() if operations else times(robot)
    if operations:
        report["inverse_dynamics_formulations"] = formulations(robot)
    print(json.dumps(report, indent=2))


def print_counts(robot: Robot, console: Console | None = None) -> None:
    columns = {
        "+": "add",
        "×": "mul",
        "÷": "div",
        "sin, cos": "sincos",
        "instructions": "instructions",
    }
    table = _table(["quantity", *columns])
    for name, figures in robot.operation_counts().items():
        table.add_row(name, *(f"{figures[key]:,}" for key in columns.values()))
    console = console or Console(highlight=False)
    console.print(Text(repr(robot)))
    console.print(table)
    console.print("Instructions: what is left where a multiplication and an addition are one.")
    rows = formulations(robot)
    if rows:
        console.print("\nInverse dynamics by older formulations, counted for this robot:")
        console.print(_formulations_table(rows))


def _formulations_table(rows: dict[str, dict[str, Any]]) -> Table:
    six = any("published" in row for row in rows.values())
    table = _table(["formulation", "×", "+"] + ["published for six joints: ×", "+"] * six)
    for name, row in rows.items():
        theirs = row.get("published", {"mul": "", "add": ""}) if six else {}
        cells = [row["mul"], row["add"], *theirs.values()]
        table.add_row(name, *(f"{cell:,}" if cell != "" else "" for cell in cells))
    return table


def print_times(robot: Robot, console: Console | None = None) -> None:
    figures = times(robot)
    columns = ("batch", "batch float32", "one call")
    table = _table(["quantity", *columns])
    for name, row in figures.items():
        table.add_row(name, *(f"{row[key]:,.1f}" for key in columns))
    console = console or Console(highlight=False)
    console.print(Text(repr(robot)))
    console.print(table)
    console.print(f"Nanoseconds an evaluation, medians; batches of {BATCH:,} rows.")


def _table(titles: list[str]) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    for title in titles:
        table.add_column(title, justify="left" if title in ("quantity", "formulation") else "right")
    return table
