"""Pictures of a motion, as plotly Figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.control.controller import Array
from mcgee.explain.drawing import Drawing, Line, View, view_of
from mcgee.explain.look import (
    BLUE,
    GREY,
    INK,
    LINE,
    MUTED,
    ORANGE,
    PALETTE,
    RED,
    figure,
    label,
    plain,
    plotly,
    safe,
    short_names,
)

if TYPE_CHECKING:
    from mcgee.simulate.trajectory import Trajectory

POINTS = 1500
"""Times that a curve shows at most."""


def thinned(trajectory: Trajectory, most: int = POINTS) -> Array:
    """Indices of times, evenly, first and last among them."""
    count = len(trajectory.t)
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


def one(trajectory: Trajectory) -> None:
    """Raises: ValueError: a batch"""
    if trajectory.q.ndim != 2:
        raise ValueError(
            f"a batch of shape {trajectory.q.shape[:-2]} is no picture; take one member of it."
        )


def _curves(trajectory: Trajectory, array: Array, legend: bool) -> list[Any]:
    at, names = thinned(trajectory), short_names(trajectory.robot.joint_names)
    return [
        plotly().Scatter(
            x=plain(trajectory.t[at], 6),
            y=plain(array[at, k], 5),
            mode="lines",
            name=label(name),
            legendgroup=str(k),
            showlegend=legend,
            line={"width": 2, "color": PALETTE[k % len(PALETTE)]},
        )
        for k, name in enumerate(names)
    ]


def _kinds(trajectory: Trajectory, turning: str, sliding: str) -> str:
    kinds = {joint.kind == "prismatic" for joint in trajectory.robot.independent_joints}
    return " | ".join(unit for unit, here in ((turning, False), (sliding, True)) if here in kinds)


def positions(trajectory: Trajectory) -> Any:
    return _panel(trajectory, trajectory.q, f"q [{_kinds(trajectory, 'rad', 'm')}]")


def velocities(trajectory: Trajectory) -> Any:
    return _panel(trajectory, trajectory.qd, f"qd [{_kinds(trajectory, 'rad/s', 'm/s')}]")


def efforts(trajectory: Trajectory) -> Any:
    return _panel(trajectory, trajectory.tau, f"tau [{_kinds(trajectory, 'N·m', 'N')}]")


def _panel(trajectory: Trajectory, array: Array, title: str) -> Any:
    one(trajectory)
    return figure(
        _curves(trajectory, array, True),
        260,
        xaxis={"title": "t [s]"},
        yaxis={"title": title},
    )


BOOKS = {
    "T": ("kinetic", BLUE),
    "P": ("potential", ORANGE),
    "work of the actuators": ("work", "#009e73"),
    "lost to friction": ("dissipated", RED),
    "stops": ("stopped", "#7a68b3"),
    "disturbance": ("disturbed", "#56b4e9"),
}


def ledger(trajectory: Trajectory) -> Any:
    """Energies over time; what is never there is left out."""
    one(trajectory)
    at, traces = thinned(trajectory), []
    for name, (what, colour) in BOOKS.items():
        values = np.asarray(getattr(trajectory, what))
        values = values.sum(-1) if values.ndim > 1 else values
        if what in ("kinetic", "potential") or values.any():
            traces.append(_energy(trajectory, values, name, colour, at))
    traces.append(_energy(trajectory, trajectory.energy, "T + P", INK, at, dash="dash"))
    return figure(traces, 280, xaxis={"title": "t [s]"}, yaxis={"title": "energy [J]"})


def residual(trajectory: Trajectory) -> Any:
    """Energy that came from nowhere: the integrator's error."""
    one(trajectory)
    at = thinned(trajectory)
    trace = _energy(trajectory, trajectory.residual, "residual", GREY, at)
    return figure(
        [trace], 180, xaxis={"title": "t [s]"}, yaxis={"title": "residual [J]"}, showlegend=False
    )


def _energy(
    trajectory: Trajectory, values: Array, name: str, colour: str, at: Array, dash: str = "solid"
) -> Any:
    return plotly().Scatter(
        x=plain(trajectory.t[at], 6),
        y=plain(values[at], 6),
        mode="lines",
        name=name,
        line={"width": 2, "color": colour, "dash": dash},
    )


def figure_of(trajectory: Trajectory) -> Any:
    """Positions, velocities, efforts and energies, one below the other."""
    one(trajectory)
    from plotly.subplots import make_subplots

    panels = [positions, velocities, efforts, ledger]
    made = make_subplots(rows=len(panels), cols=1, shared_xaxes=True, vertical_spacing=0.04)
    for row, panel in enumerate(panels, 1):
        part = panel(trajectory)
        for trace in part.data:
            trace.showlegend = row in (1, len(panels))
            made.add_trace(trace, row=row, col=1)
        made.update_yaxes(title=part.layout.yaxis.title.text, row=row, col=1)
    made.update_xaxes(title="t [s]", row=len(panels), col=1)
    return made.update_layout(height=980, font={"family": "system-ui, sans-serif", "size": 13})


# -- the arm ---------------------------------------------------------------------------------------


def arm(trajectory: Trajectory, frames: Array) -> tuple[Any, list[Any]]:
    """The arm at its first time, and for each of the frames what its traces' points are.

    Args:
        frames: indices of times
    Returns: the figure, and by trace a list over the frames of the coordinates
    """
    one(trajectory)
    robot = trajectory.robot
    drawing = Drawing(robot, robot.end_frame)
    points = drawing.points(trajectory.q[frames])
    view = view_of(drawing, trajectory.q[frames[0]])
    if view is not None:
        points = points @ view.axes.T
    lines: list[Line] = [drawing.links, [*drawing.joints], [*drawing.centres]]
    path = points[:, drawing.tip]
    made = _traces(drawing, points, lines, path, view is None)
    layout = _plane(view, points) if view is not None else _space(points)
    moves = [[_picked(p, line) for p in points] for line in lines]
    return figure(made, 460, showlegend=False, **layout), moves


def _picked(points: Array, line: Line) -> list[list[float | None]]:
    width = points.shape[-1]
    rows = [[None] * width if k is None else points[k].tolist() for k in line]
    return [plain([row[i] for row in rows], 5) for i in range(width)]


def _traces(
    drawing: Drawing, points: Array, lines: list[Line], path: Array, space: bool
) -> list[Any]:
    kind = plotly().Scatter3d if space else plotly().Scatter

    def trace(given: list[list[float | None]], **look: Any) -> Any:
        axes = dict(zip("xyz", given, strict=False))
        return kind(**axes, hoverinfo="skip", **look)

    first = [_picked(points[0], line) for line in lines]
    names = [safe(body.name) for body in drawing.bodies]
    looks: tuple[dict[str, Any], ...] = (
        {"mode": "lines", "line": {"color": BLUE, "width": 8 if space else 6}},
        {"mode": "markers", "marker": {"color": "#7d8894", "size": 4 if space else 10}},
        {"mode": "markers", "marker": {"color": ORANGE, "size": 3 if space else 7}},
    )
    found = [trace(g, **look) for g, look in zip(first, looks, strict=True)]
    found[1].update(hoverinfo="text", text=names)
    trail = trace(
        [plain(path[:, i], 5) for i in range(path.shape[1])],
        mode="lines",
        line={"color": MUTED if space else LINE, "width": 2},
    )
    return [*found, trail]


def _plane(view: View, points: Array) -> dict[str, Any]:
    flat = points.reshape(-1, 2)
    middle, half = (flat.max(0) + flat.min(0)) / 2, (flat.max(0) - flat.min(0)).max() * 0.55
    return {
        "xaxis": {
            "title": view.labels[0],
            "range": plain([middle[0] - half, middle[0] + half]),
            "constrain": "domain",
        },
        "yaxis": {
            "title": view.labels[1],
            "range": plain([middle[1] - half, middle[1] + half]),
            "scaleanchor": "x",
        },
    }


def _space(points: Array) -> dict[str, Any]:
    flat = points.reshape(-1, 3)
    middle, half = (flat.max(0) + flat.min(0)) / 2, (flat.max(0) - flat.min(0)).max() * 0.55
    axes = {
        f"{name}axis": {"title": f"{name} [m]", "range": plain([m - half, m + half])}
        for name, m in zip("xyz", middle, strict=True)
    }
    return {"scene": {**axes, "aspectmode": "cube"}, "dragmode": "orbit"}
