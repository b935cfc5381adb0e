"""The workspace as pictures: M and g while one joint sweeps its range, or two."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.explain.inertia import Array
from mcgee.explain.look import (
    BLUE,
    GREEN,
    INK,
    LINE,
    MUTED,
    ORANGE,
    RED,
    SEQUENTIAL,
    figure,
    plain,
    plotly,
)
from mcgee.explain.plots import joint_labels
from mcgee.explain.sentences import inertia_unit
from mcgee.explain.workspace import Sweep
from mcgee.robot import Robot

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation


def skater(e: Explanation) -> Any:
    """What the first joint feels while the joint that changes it most moves."""
    return curves(e, e.skater, 0)


def felt_free(robot: Robot, q: Array) -> Array:
    """1/(M⁻¹)_ii: what each joint feels while the others give way (..., n)."""
    with np.errstate(divide="ignore"):
        return 1 / np.diagonal(robot.mass_matrix_inverse(q), axis1=-2, axis2=-1)


def curves(e: Explanation, s: Sweep, i: int) -> Any:
    """What joint i feels and holds, and M's condition number, along a sweep of one joint."""
    moved = e.robot.joint_names.index(s.joints[0])
    locked, free = np.diagonal(s.M, axis1=-2, axis2=-1), felt_free(e.robot, s.q)
    x, now = s.at[0], float(e.q[moved])
    traces = [
        _curve(x, locked[:, i], "others locked", {"color": BLUE, "width": 3}, "locked", ""),
        _curve(x, free[:, i], "others free", {"color": ORANGE, "dash": "dash"}, "free", ""),
        _extremes(x, locked[:, i]),
        _here(now, e.inertia.locked[i], "locked", ""),
        _curve(x, s.g[:, i], "g", {"color": GREEN, "width": 3}, "g", "2"),
        _here(now, e.gravity.g[i], "g", "2"),
        _curve(x, s.condition, "condition", {"color": MUTED, "width": 3}, "condition", "3"),
        _here(now, e.inertia.condition, "condition", "3"),
    ]
    joint, of = e.conventions.joints[i], e.conventions.joints[moved]
    unit = inertia_unit(joint.effort_unit, joint.effort_unit)
    name = joint_labels(e)[i]
    titles = (
        f"inertia felt by {name} [{unit}]",
        f"holding effort of {name} [{joint.effort_unit}]",
        "condition number of M",
    )
    rows: dict[str, Any] = {
        "annotations": [_heading(t, d) for t, d in zip(titles, _DOMAINS, strict=True)]
    }
    for name, domain in zip(("yaxis", "yaxis2", "yaxis3"), _DOMAINS, strict=True):
        rows[name] = {"domain": domain, "nticks": 5, "rangemode": "tozero"}
    rows["yaxis2"]["rangemode"] = "normal"
    across = {
        "title": {"text": f"{joint_labels(e)[moved]} [{of.unit}]"},
        "anchor": "y3",
        "zeroline": False,
    }
    line = {"color": INK, "width": 1, "dash": "dot"}
    here = {"type": "line", "x0": now, "x1": now, "y0": 0, "y1": 1, "yref": "paper", "line": line}
    return figure(traces, 540, xaxis=across, shapes=[here], hovermode="x", **rows)


_DOMAINS = ([0.62, 0.94], [0.31, 0.5], [0.0, 0.19])


def _heading(words: str, domain: list[float]) -> dict[str, Any]:
    """Above its row, where long tick labels cannot run into it."""
    place = {"xref": "paper", "yref": "paper", "x": 0, "y": domain[1], "yanchor": "bottom"}
    return {**place, "xanchor": "left", "text": words, "showarrow": False, "font": {"size": 12}}


def _curve(x: Array, y: Array, name: str, line: dict[str, Any], role: str, axis: str) -> Any:
    return plotly().Scatter(
        x=plain(x, 5),
        y=plain(y, 5),
        mode="lines",
        line=line,
        name=name,
        yaxis=f"y{axis}",
        showlegend=not axis,
        meta={"curve": role},
        hovertemplate="<b>%{y:.3g}</b>",
    )


def _extremes(x: Array, y: Array) -> Any:
    """The least and the most, each where it first occurs."""
    at = [int(y.argmin()), int(y.argmax())]
    return plotly().Scatter(
        x=plain(x[at], 5),
        y=plain(y[at], 5),
        mode="markers",
        marker={"symbol": ["triangle-down", "triangle-up"], "size": 12, "color": RED},
        name="least ▾ and most ▴",
        meta={"extremes": "locked"},
        hoverinfo="skip",
    )


def _here(x: float, y: float, role: str, axis: str) -> Any:
    return plotly().Scatter(
        x=[x],
        y=plain([y], 5),
        mode="markers",
        marker={"size": 11, "color": INK, "line": {"color": LINE, "width": 2}},
        name="this pose",
        yaxis=f"y{axis}",
        showlegend=not axis,
        meta={"here": role},
        hoverinfo="skip",
    )


def plane(e: Explanation, s: Sweep, values: Array, unit: str) -> Any:
    """A quantity over two joints, with its least and most, and the pose that is explained."""
    moved = [e.robot.joint_names.index(name) for name in s.joints]
    x, y = s.at
    heat = plotly().Heatmap(
        x=plain(x, 5),
        y=plain(y, 5),
        z=plain(values.T, 4),
        colorscale=SEQUENTIAL,
        colorbar={"title": {"text": unit}, "thickness": 12, "outlinewidth": 0},
        meta={"map": "values"},
        hovertemplate="(%{x:.3g}, %{y:.3g})<br><b>%{z:.4g}</b><extra></extra>",
    )
    at = _least_and_most(values, s, e.q[moved])
    looks = (
        ("least ▾ and most ▴", x[at[:, 0]], y[at[:, 1]], ["triangle-down", "triangle-up"], RED),
        ("explained pose", e.q[moved[:1]], e.q[moved[1:]], "circle", "#ffffff"),
    )
    dots = [
        plotly().Scatter(
            x=plain(across, 5),
            y=plain(upward, 5),
            mode="markers",
            marker={"symbol": symbol, "size": 13, "color": color, "line": {"width": 2}},
            name=name,
            cliponaxis=False,
            meta={"map": "extremes" if color == RED else "pose"},
            hoverinfo="name",
        )
        for name, across, upward, symbol, color in looks
    ]
    titles = [f"{joint_labels(e)[k]} [{e.conventions.joints[k].unit}]" for k in moved]
    axes = {
        name: {"title": {"text": title}, "showgrid": False, "zeroline": False, "range": edges}
        for name, title, edges in zip(
            ("xaxis", "yaxis"), titles, (_edges(x), _edges(y)), strict=True
        )
    }
    return figure([heat, *dots], 430, **axes)


def _least_and_most(values: Array, s: Sweep, pose: Array) -> Array:
    """Their indices (2, 2); of many equal places the one nearest to the pose (2,)."""
    low, high = values.min(), values.max()
    grids = np.meshgrid(*s.at, indexing="ij")
    off = sum(((g - x) / np.ptp(g)) ** 2 for g, x in zip(grids, pose, strict=True))
    ties = [np.where(abs(values - v) <= 1e-9 * (high - low), off, np.inf) for v in (low, high)]
    return np.array([np.unravel_index(tie.argmin(), values.shape) for tie in ties])


def _edges(grid: Array) -> list[float]:
    """Of the outermost cells."""
    half = (grid[1] - grid[0]) / 2
    return plain([grid[0] - half, grid[-1] + half])
