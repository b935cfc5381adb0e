"""M, C qd and g of one state, as tables and as JSON."""

from __future__ import annotations

import json

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from mcgee.cli.state import State, as_shown
from mcgee.robot import Robot, Terms
from mcgee.typeset import aligned

COLUMNS = 7
"""Columns of M side by side in 80 characters."""


def print_json(robot: Robot, state: State) -> None:
    terms = robot.terms(state.q, state.qd)
    slides = [joint.kind == "prismatic" for joint in robot.independent_joints]
    report = {
        "robot": robot.name,
        "joints": list(robot.joint_names),
        "units": {
            "q": ["m" if s else "rad" for s in slides],
            "qd": ["m/s" if s else "rad/s" for s in slides],
            "effort": ["N" if s else "N·m" for s in slides],
        },
        "gravity_vector": list(robot.gravity_vector),
        "q": state.q.tolist(),
        "qd": state.qd.tolist(),
        **{name: values.tolist() for name, values in zip(Terms._fields, terms, strict=True)},
    }
    try:
        print(json.dumps(report, indent=2, allow_nan=False))
    except ValueError:
        raise ValueError(
            "the terms of this state are beyond float64: take smaller numbers."
        ) from None


def print_tables(robot: Robot, state: State, console: Console | None = None) -> None:
    terms = robot.terms(state.q, state.qd)
    console = console or Console(highlight=False)
    console.print(Text(repr(robot)))
    console.print(_state_table(robot, state, terms))
    for first in range(0, robot.n, COLUMNS):
        console.print(_matrix_table(robot, terms.M, range(first, min(first + COLUMNS, robot.n))))


def _state_table(robot: Robot, state: State, terms: Terms) -> Table:
    table = _table("State, and the efforts it asks for: C(q, qd) qd and g(q)")
    for title in ("", "joint", "q", "qd", "C qd", "g", "unit"):
        table.add_column(title, justify="left" if title in ("joint", "unit") else "right")
    joints = robot.independent_joints
    shown, units = as_shown(robot, state.degrees)
    columns = (state.q * shown, state.qd * shown, terms.Cqd, terms.g)
    for i, row in enumerate(zip(*(aligned(column) for column in columns), strict=True)):
        table.add_row(str(i + 1), Text(joints[i].name), *row, "{0}, {0}/s, {1}".format(*units[i]))
    return table


def _matrix_table(robot: Robot, M: np.ndarray, columns: range) -> Table:
    kinds = {joint.kind == "prismatic" for joint in robot.independent_joints}
    unit = "kg·m²" if kinds == {False} else "kg" if kinds == {True} else "kg·m², kg·m, kg"
    table = _table(f"M(q) [{unit}]")
    table.add_column("", justify="right")
    for j in columns:
        table.add_column(str(j + 1), justify="right", min_width=7)
    entries = aligned(M[:, columns].ravel(), abs(M).max())
    for i in range(robot.n):
        table.add_row(str(i + 1), *entries[i * len(columns) : (i + 1) * len(columns)])
    return table


def _table(title: str) -> Table:
    return Table(
        title=Text(title, style="bold"), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1)
    )
