"""The arm as a picture: in its plane where it moves in one, else in space."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.explain.drawing import Drawing, Line, View, mobility_axes, view_of
from mcgee.explain.inertia import Array
from mcgee.explain.look import (
    BLUE,
    GREY,
    INK,
    LINE,
    MUTED,
    ORANGE,
    PINK,
    RED,
    figure,
    label,
    plain,
    plotly,
    safe,
    short_names,
)
from mcgee.typeset import number

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation


JOINT = "#7d8894"


def arm(e: Explanation, around: Array | None = None) -> Any:
    """The drawn arm with centres of mass, gravity, and the mobility ellipse of the frame.

    Args:
        around: other poses (..., n) that the axes leave room for
    """
    drawing = Drawing(e.robot, e.task.frame)
    view = view_of(drawing, e.q)
    poses = e.q[None] if around is None else np.vstack([e.q[None], around.reshape(-1, e.robot.n)])
    room = drawing.points(poses)[..., : drawing.tip + 1, :].reshape(-1, 3)
    return _flat(e, drawing, view, room) if view else _spatial(e, drawing, room)


def ellipse_scale(e: Explanation, drawing: Drawing) -> float:
    """Metres drawn for 1/kg of mobility."""
    longest = float(np.linalg.norm(mobility_axes(e.robot, e.q, e.task.frame), axis=-1).max())
    return 0.22 * drawing.reach / longest if longest > 0 else 0.0


def _sizes(e: Explanation, largest: float) -> list[float]:
    """Of dots whose areas are as the masses."""
    m = np.array([float(mass.inertia.mass) for mass in e.robot.mechanism.masses])
    return plain(np.maximum(largest * np.sqrt(m / m.max()), 3.0), 3)


def _mass_words(e: Explanation) -> list[str]:
    masses = e.robot.mechanism.masses
    return [f"{safe(m.link)}<br><b>{number(float(m.inertia.mass))} kg</b>" for m in masses]


def _joint_words(e: Explanation) -> list[str]:
    return [safe(body.name) for body in e.robot.mechanism.bodies]


@cache
def circle() -> Array:
    """Points of the unit circle (points, 2)."""
    turn = np.linspace(0, 2 * np.pi, 49)
    return np.stack([np.cos(turn), np.sin(turn)], -1)


@cache
def ball() -> Array:
    """Points of the unit sphere (13, 25, 3)."""
    down, around = np.linspace(0, np.pi, 13)[:, None], np.linspace(0, 2 * np.pi, 25)
    x, y = np.sin(down) * np.cos(around), np.sin(down) * np.sin(around)
    return np.stack([x, y, np.broadcast_to(np.cos(down), x.shape)], -1)


def _picked(points: Array, line: Sequence[int | None]) -> list[list[float | None]]:
    """The coordinates of a line, one list each."""
    width = points.shape[-1]
    rows = [[None] * width if k is None else points[k].tolist() for k in line]
    return [plain([row[i] for row in rows], 5) for i in range(width)]


# -- in a plane -----------------------------------------------------------------------------------


def _flat(e: Explanation, drawing: Drawing, view: View, room: Array) -> Any:
    points = drawing.points(e.q) @ view.axes.T
    axes = mobility_axes(e.robot, e.q, e.task.frame)[1:] @ view.axes.T
    ring = points[drawing.tip] + ellipse_scale(e, drawing) * circle() @ axes
    traces = [
        _line_2d(points, drawing.links, "at q", {"color": LINE, "width": 9}, ghost=True),
        plotly().Scatter(
            x=plain(ring[:, 0], 5),
            y=plain(ring[:, 1], 5),
            mode="lines",
            fill="toself",
            fillcolor="rgba(204,121,167,0.25)",
            line={"color": PINK, "width": 2},
            name="mobility",
            meta={"ellipse": drawing.tip},
            hoverinfo="name",
        ),
        _line_2d(points, drawing.links, "links", {"color": BLUE, "width": 6}),
        *_dots_2d(e, drawing, points),
    ]
    return figure(
        traces,
        460,
        annotations=_gravity_2d(e, view),
        showlegend=False,
        **_window(room @ view.axes.T, view),
    )


def _line_2d(
    points: Array, line: Line, name: str, look: dict[str, Any], ghost: bool = False
) -> Any:
    x, y = _picked(points, line)
    meta = {} if ghost else {"points": line}
    style = {"mode": "lines", "line": look, "name": name, "hoverinfo": "skip"}
    return plotly().Scatter(x=x, y=y, meta=meta, **style)


def _dots_2d(e: Explanation, drawing: Drawing, points: Array) -> list[Any]:
    bodies = e.robot.mechanism.bodies
    names = [label(name) for name in short_names([body.name for body in bodies])]
    symbols = ["square" if body.prismatic else "circle" for body in bodies]
    looks = (
        (
            "centres of mass",
            drawing.centres,
            {"size": _sizes(e, 26), "color": ORANGE, "opacity": 0.85},
            _mass_words(e),
            None,
        ),
        (
            "joints",
            drawing.joints,
            {"size": 13, "color": "#ffffff", "symbol": symbols, "line": {"color": INK, "width": 3}},
            _joint_words(e),
            names,
        ),
        (
            "frame",
            [drawing.tip],
            {"size": 12, "color": PINK, "symbol": "cross", "line": {"color": INK, "width": 1}},
            [safe(e.task.frame)],
            ["   " + label(e.task.frame)],
        ),
    )
    return [_dot_2d(points, *look) for look in looks]


def _dot_2d(
    points: Array,
    name: str,
    line: Sequence[int],
    marker: dict[str, Any],
    words: list[str],
    text: list[str] | None,
) -> Any:
    x, y = _picked(points, line)
    return plotly().Scatter(
        x=x,
        y=y,
        mode="markers+text" if text else "markers",
        text=text,
        textposition="middle right" if name == "frame" else "bottom right",
        marker=marker,
        name=name,
        hovertext=words,
        hoverinfo="text",
        meta={"points": line},
    )


def _gravity_2d(e: Explanation, view: View) -> list[dict[str, Any]]:
    strength = float(np.linalg.norm(np.array(e.robot.gravity_vector, float)))
    corner = {"xref": "paper", "yref": "paper", "x": 0.03, "font": {"color": RED}}
    if not view.gravity.any():
        words = "gravity: square to the page" if strength else "no gravity"
        return [{**corner, "y": 0.98, "text": words, "showarrow": False}]
    arrow = {"ax": 0, "ay": -44, "arrowcolor": RED, "arrowwidth": 3, "arrowhead": 2}
    words = f"gravity<br>{number(strength)} m/s²"
    beside = {**corner, "x": 0.055, "y": 0.98, "text": words, "showarrow": False, "align": "left"}
    return [{**corner, "y": 0.88, "text": "", **arrow}, beside]


def _window(room: Array, view: View) -> dict[str, Any]:
    """Axes with equal steps around all the points."""
    low, high = room.min(0), room.max(0)
    margin = 0.12 * float((high - low).max() or 1.0)
    axes = {}
    for k, name in enumerate(("xaxis", "yaxis")):
        axes[name] = {
            "range": plain([low[k] - margin, high[k] + margin], 4),
            "title": {"text": view.labels[k]},
            "zeroline": False,
        }
    axes["yaxis"] |= {"scaleanchor": "x", "scaleratio": 1}
    return axes


# -- in space -------------------------------------------------------------------------------------


def _spatial(e: Explanation, drawing: Drawing, room: Array) -> Any:
    points = drawing.points(e.q)
    turning, sliding = drawing.axes
    rows = (
        ("at q", drawing.links, {"color": GREY, "width": 4}, False),
        ("links", drawing.links, {"color": BLUE, "width": 9}, True),
        ("turning joints", turning, {"color": JOINT, "width": 13}, True),
        ("sliding joints", sliding, {"color": RED, "width": 13}, True),
    )
    traces = [_line_3d(points, *row) for row in rows if row[1]]
    dots = (
        ("joints", drawing.joints, {"size": 5, "color": JOINT}, _joint_words(e)),
        (
            "centres of mass",
            drawing.centres,
            {"size": _sizes(e, 16), "color": ORANGE, "opacity": 0.9},
            _mass_words(e),
        ),
        (
            "frame",
            [drawing.tip],
            {"size": 6, "color": PINK, "symbol": "cross"},
            [safe(e.task.frame)],
        ),
    )
    traces += [_dot_3d(points, *dot) for dot in dots]
    traces += [_ellipsoid(e, drawing, points), *_gravity_3d(e, room)]
    return figure(traces, 520, showlegend=False, scene=_scene(e, room), dragmode="orbit")


def _line_3d(points: Array, name: str, line: Line, look: dict[str, Any], moves: bool) -> Any:
    x, y, z = _picked(points, line)
    style: dict[str, Any] = {"mode": "lines", "line": look, "name": name, "hoverinfo": "skip"}
    style["opacity"] = 1 if moves else 0.35
    return plotly().Scatter3d(x=x, y=y, z=z, meta={"points": line} if moves else {}, **style)


def _dot_3d(
    points: Array, name: str, line: Sequence[int], marker: dict[str, Any], words: list[str]
) -> Any:
    x, y, z = _picked(points, line)
    look = {"mode": "markers", "marker": marker, "hovertext": words, "hoverinfo": "text"}
    return plotly().Scatter3d(x=x, y=y, z=z, name=name, meta={"points": line}, **look)


def _ellipsoid(e: Explanation, drawing: Drawing, points: Array) -> Any:
    axes = mobility_axes(e.robot, e.q, e.task.frame)
    skin = points[drawing.tip] + ellipse_scale(e, drawing) * ball() @ axes
    return plotly().Surface(
        x=plain(skin[..., 0], 5),
        y=plain(skin[..., 1], 5),
        z=plain(skin[..., 2], 5),
        colorscale=[[0, PINK], [1, PINK]],
        showscale=False,
        opacity=0.35,
        name="mobility",
        hoverinfo="name",
        contours={axis: {"highlight": False} for axis in "xyz"},
        meta={"ellipsoid": drawing.tip},
    )


def _gravity_3d(e: Explanation, room: Array) -> list[Any]:
    field = np.array(e.robot.gravity_vector, float)
    strength = float(np.linalg.norm(field))
    if not strength:
        return []
    low, high = room.min(0), room.max(0)
    length = 0.22 * float((high - low).max())
    down = field / strength
    start = np.where(abs(down) > 0.5, (low + high) / 2 - down * length, low)
    end = start + down * length
    x, y, z = (plain([a, b], 5) for a, b in zip(start, end, strict=True))
    words = [f"gravity {number(strength)} m/s²", ""]
    line = plotly().Scatter3d(
        x=x,
        y=y,
        z=z,
        mode="lines+text",
        text=words,
        textposition="middle right",
        textfont={"color": RED, "size": 12},
        line={"color": RED, "width": 7},
        hoverinfo="skip",
    )
    head = plotly().Cone(
        **{axis: [v[1]] for axis, v in zip("xyz", (x, y, z), strict=True)},
        **{axis: [v] for axis, v in zip("uvw", plain(down * length * 0.45), strict=True)},
        anchor="tip",
        sizemode="absolute",
        sizeref=plain(length * 0.45, 4),
        colorscale=[[0, RED], [1, RED]],
        showscale=False,
        hoverinfo="skip",
    )
    return [line, head]


def _scene(e: Explanation, room: Array) -> dict[str, Any]:
    low, high = room.min(0), room.max(0)
    margin = 0.1 * float((high - low).max() or 1.0)
    low, high = low - margin, high + margin
    field = np.array(e.robot.gravity_vector, float)
    up = -field / np.linalg.norm(field) if field.any() else np.array([0.0, 0.0, 1.0])
    look = {
        "gridcolor": LINE,
        "zerolinecolor": LINE,
        "color": MUTED,
        "showbackground": False,
        "showspikes": False,
        "nticks": 5,
    }
    scene: dict[str, Any] = {
        f"{name}axis": {"title": {"text": f"{name} [m]"}, "range": plain([a, b], 4), **look}
        for name, a, b in zip("xyz", low, high, strict=True)
    }
    span = high - low
    ratio = dict(zip("xyz", plain(1.4 * span / span.max(), 4), strict=True))
    eye = np.array([1.25, -1.25, 0.55]) if abs(up[2]) > 0.5 else np.array([1.1, 0.7, 1.3])
    camera = {
        "up": dict(zip("xyz", plain(up), strict=True)),
        "eye": dict(zip("xyz", plain(eye), strict=True)),
        "projection": {"type": "orthographic"},
    }
    return {**scene, "aspectmode": "manual", "aspectratio": ratio, "camera": camera}
