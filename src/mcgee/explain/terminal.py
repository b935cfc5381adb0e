"""An explanation as text, 80 columns wide."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np
from rich import box
from rich.console import Console, ConsoleRenderable, Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from mcgee.explain.look import short_names
from mcgee.explain.sentences import inertia_unit, worst_sentences
from mcgee.typeset import aligned, number, percent

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation

WIDTH = 80
FEW = 4
"""Joints up to which matrices have names beside their rows."""
MANY = 8
"""Joints beyond which matrices are left to JSON and HTML."""


def text(e: Explanation) -> str:
    """The report without colours."""
    written = io.StringIO()
    console = Console(file=written, width=WIDTH, color_system=None, highlight=False)
    console.print(report(e))
    return "\n".join(line.rstrip() for line in written.getvalue().splitlines())


def report(e: Explanation) -> Group:
    """The report for a rich console."""
    parts: list[ConsoleRenderable] = [
        Text(f"{e.robot.name} explained", style="bold"),
        *(_sentence(line) for line in e.conventions.lines()),
        _heading("Inertia: M(q)"),
        _inertia_table(e),
    ]
    if e.robot.n <= MANY:
        parts.append(
            _sentence("\nEfforts [N·m | N] at each joint (row) if one alone accelerates by 1:")
        )
        parts.append(_columns_table(e))
    if e.velocity.moving:
        parts += [_heading("Velocity: C(q, qd) qd"), _velocity_table(e), _balance(e)]
    parts += [_heading("Gravity: g(q)"), _gravity_table(e), _heading("In words")]
    parts += [_sentence(s) for s in e.sentences]
    parts.append(_heading("Over the joint ranges"))
    try:
        words = list(worst_sentences(e.conventions, e.worst))
    except ModuleNotFoundError as missing:
        words = [str(missing)]
    return Group(*parts, *(_sentence(s) for s in words))


def _heading(title: str) -> Padding:
    return Padding(Text(title, style="bold cyan"), (1, 0, 0, 0))


def _sentence(line: str) -> Padding:
    return Padding(Text(line), (0, 0, 0, 1))


def _table(*columns: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    for k, title in enumerate(columns):
        table.add_column(Text(title), justify="left" if k == 0 else "right", overflow="fold")
    return table


def _inertia_table(e: Explanation) -> Table:
    table = _table("joint", "locked", "free", "hidden", "unit", "most coupled to")
    f, joints = e.inertia, e.conventions.joints
    for i, joint in enumerate(joints):
        others = abs(f.coupling[i]).copy()
        others[i] = 0
        k = int(others.argmax())
        partner = (
            f"{joints[k].name} {f.coupling[i, k]:+.2f}".replace("-", "−")
            if others[k] > 5e-3
            else "none"
        )
        unit = inertia_unit(joint.effort_unit, joint.effort_unit)
        values = number(f.locked[i]), number(f.free[i]), percent(max(f.hidden[i], 0))
        table.add_row(Text(joint.name), *values, unit, Text(partner))
    return table


def _columns_table(e: Explanation) -> Table:
    """Column j: what accelerating joint j alone by one unit asks of every joint."""
    few = e.robot.n <= FEW
    table = _table("at / if alone" if few else "", *(str(j + 1) for j in range(e.robot.n)))
    for i, joint in enumerate(e.conventions.joints):
        entries = aligned(e.inertia.M[i], abs(e.inertia.M).max(), 4)
        table.add_row(Text(f"{i + 1} {joint.name}" if few else f"{i + 1}"), *entries)
    return table


def _velocity_table(e: Explanation) -> Table:
    table = _table("joint", "qd", "centrifugal", "Coriolis", "C qd", "unit", "½Ṁ−C [W]")
    v = e.velocity
    largest = max(abs(v.centrifugal).max(), abs(v.coriolis).max())
    for i, joint in enumerate(e.conventions.joints):
        parts = v.centrifugal[i].sum(), v.coriolis[i].sum(), v.Cqd[i]
        table.add_row(
            Text(joint.name),
            number(e.qd[i]),
            *(_entry(x, largest) for x in parts),
            joint.effort_unit,
            _entry(v.power[i], abs(v.power).max()),
        )
    return table


def _balance(e: Explanation) -> Padding:
    v = e.velocity
    return _sentence(
        f"\nqdᵀ C qd = {number(v.C_power)} W = ½ qdᵀ Ṁ qd = {number(v.half_Mdot_power)} W. "
        f"Parts less C qd: {number(v.residual)}. "
        f"Ṁ − 2C plus its transpose: {number(v.skew_residual)}."
    )


def _gravity_table(e: Explanation) -> Table:
    table = _table("joint", "g", "unit", "limit", "margin", "hangs on it most", "arm")
    shown = short_names(e.robot.joint_names)
    g, links = e.gravity, short_names(e.gravity.links)
    for i, joint in enumerate(e.conventions.joints):
        k = int(abs(g.parts[:, i]).argmax())
        limited = np.isfinite(g.effort[i])
        held = abs(g.g[i]) > 1e-9 * max(g.weight.sum(), 1e-300)
        table.add_row(
            Text(shown[i]),
            _entry(g.g[i], abs(g.g).max()),
            joint.effort_unit,
            number(g.effort[i]) if limited else "none",
            f"{number(g.margin[i])} %" if limited else "",
            Text(f"{links[k]} {number(g.weight[k])} N") if held else "nothing",
            f"{number(g.lever[k, i])} m" if held and joint.unit == "rad" else "",
        )
    return table


def _entry(x: float, largest: float) -> str:
    """Three digits; what is only rounding is 0."""
    return "0" if abs(x) <= 1e-12 * largest else number(x)
