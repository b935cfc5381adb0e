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


def counts(robot: Robot) -> dict[str, dict[str, int]]:
    return robot.operation_counts()


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


def print_json(robot: Robot, figures: dict[str, dict[str, Any]], unit: str) -> None:
    print(json.dumps({"robot": robot.name, "unit": unit, "quantities": figures}, indent=2))


def print_counts(robot: Robot, console: Console | None = None) -> None:
    columns = {
        "+": "add",
        "×": "mul",
        "÷": "div",
        "sin, cos": "sincos",
        "instructions": "instructions",
    }
    table = _table(["quantity", *columns])
    for name, figures in counts(robot).items():
        table.add_row(name, *(f"{figures[key]:,}" for key in columns.values()))
    console = console or Console(highlight=False)
    console.print(Text(repr(robot)))
    console.print(table)
    console.print("Instructions: what is left where a multiplication and an addition are one.")


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
        table.add_column(title, justify="left" if title == "quantity" else "right")
    return table
