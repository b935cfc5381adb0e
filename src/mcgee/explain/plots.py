"""Pictures of an explanation's figures, as plotly Figures.

Every function takes an Explanation and returns a Figure that also stands alone in a notebook.
`meta` of a trace says what the page's script may move: which points it draws, or its role.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.explain.inertia import Array
from mcgee.explain.look import (
    DIVERGING,
    GREY,
    INK,
    ORANGE,
    OTHERS,
    PALETTE,
    cells,
    figure,
    label,
    most,
    plain,
    plotly,
    safe,
    short_names,
)
from mcgee.explain.sentences import inertia_unit
from mcgee.typeset import number

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation

READABLE = 10
"""Joints up to which the cells of a matrix hold their numbers."""


def joint_labels(e: Explanation) -> list[str]:
    return [label(name) for name in short_names(e.robot.joint_names)]


def joint_axis(e: Explanation, **more: Any) -> dict[str, Any]:
    """Joints at 0, 1, … with their names."""
    n = e.robot.n
    axis = {"tickvals": list(range(n)), "ticktext": joint_labels(e), "showgrid": False}
    return axis | {"zeroline": False} | more


# -- M --------------------------------------------------------------------------------------------


def mass_matrix(e: Explanation, height: int = 0) -> Any:
    """The heat map of M; column j is what accelerating joint j alone by 1 takes everywhere."""
    units = [joint.effort_unit for joint in e.conventions.joints]
    names = [safe(name) for name in e.robot.joint_names]
    hover = [
        [f"{names[i]}, {names[j]}<br>{inertia_unit(a, b)}" for j, b in enumerate(units)]
        for i, a in enumerate(units)
    ]
    return _matrix(e, e.inertia.M, hover, float(abs(e.inertia.M).max()), height)


def coupling(e: Explanation) -> Any:
    """The heat map of M_ij/√(M_ii M_jj)."""
    names = [safe(name) for name in e.robot.joint_names]
    hover = [[f"{a}, {b}" for b in names] for a in names]
    return _matrix(e, e.inertia.coupling, hover, 1.0)


def _matrix(
    e: Explanation, values: Array, hover: list[list[str]], top: float, height: int = 0
) -> Any:
    few = e.robot.n <= READABLE
    heat = plotly().Heatmap(
        z=plain(values),
        zmin=-top,
        zmax=top,
        colorscale=DIVERGING,
        text=cells(values) if few else None,
        texttemplate="%{text}" if few else None,
        textfont={"size": 15 if e.robot.n < 5 else 11},
        customdata=hover,
        hovertemplate="%{customdata}<br><b>%{z:.4g}</b><extra></extra>",
        showscale=not few,
        colorbar={"thickness": 10, "outlinewidth": 0, "tickfont": {"size": 11}},
        xgap=2 if few else 0,
        ygap=2 if few else 0,
    )
    slanted = -90 if e.robot.n > READABLE else -45 if e.robot.n > 4 else 0
    size = {"size": 9 if e.robot.n > 20 else 12}
    columns = joint_axis(e, side="top", tickangle=slanted, tickfont=size, showline=False)
    rows = joint_axis(e, autorange="reversed", tickfont=size, showline=False)
    return figure([heat], height or (300 if e.robot.n < 5 else 420), xaxis=columns, yaxis=rows)


def link_shares(e: Explanation) -> Any:
    """What each link's translation and rotation, and the rotors, make of every M_ii."""
    f, joints = e.inertia, list(range(e.robot.n))
    moved, turned = (np.einsum("kii->ki", part) for part in (f.translation, f.rotation))
    share = 100 / f.locked
    kept, rest = most((moved + turned) * share)
    rows = [(label(f.links[k]), moved[k], turned[k]) for k in kept]
    if rest:
        rows.append((OTHERS, moved[rest].sum(0), turned[rest].sum(0)))
    bars = []
    for k, (name, *parts) in enumerate(rows):
        color = GREY if name == OTHERS else PALETTE[k]
        for what, part, hatch in zip(("translation", "rotation"), parts, ("", "/"), strict=True):
            if abs(part).max() > 1e-9 * f.locked.max():
                bars.append(bar(part * share, joints, name, what, color, hatch, "%"))
    if f.armature.any():
        bars.append(bar(np.diag(f.armature) * share, joints, "rotors", "", INK, ".", "%"))
    total = [
        {
            "x": 101,
            "y": i,
            "text": f"{number(f.locked[i])} {_own_unit(e, i)}",
            "showarrow": False,
            "xanchor": "left",
            "font": {"size": 12},
        }
        for i in joints
    ]
    ticks = {"range": [0, 142], "tickvals": [0, 25, 50, 75, 100], "title": {"text": "% of M_ii"}}
    return figure(
        bars,
        tall(e.robot.n),
        xaxis=ticks,
        yaxis=joint_axis(e, autorange="reversed"),
        annotations=total,
    )


def _own_unit(e: Explanation, i: int) -> str:
    unit = e.conventions.joints[i].effort_unit
    return inertia_unit(unit, unit)


def bar(
    values: Array, at: list[int], name: str, what: str, color: str, hatch: str, unit: str
) -> Any:
    """A horizontal bar piece per joint; one legend entry for both parts of a link."""
    return plotly().Bar(
        orientation="h",
        x=plain(values),
        y=at,
        name=name,
        legendgroup=name,
        showlegend=what != "rotation",
        marker={"color": color, "pattern": {"shape": hatch, "size": 5, "solidity": 0.25}},
        hovertext=[f"{name} {what}".strip()] * len(at),
        hovertemplate="%{hovertext}<br><b>%{x:.4g}</b> " + unit + "<extra></extra>",
    )


def entry_by_link(e: Explanation, i: int, j: int) -> Any:
    """What each link adds to one entry M_ij."""
    f = e.inertia
    names = [label(name) for name in f.links]
    at, rotor = list(range(len(names) + 1)), len(names)
    parts = [
        ("translation", [*f.translation[:, i, j], None], PALETTE[0], ""),
        ("rotation", [*f.rotation[:, i, j], None], ORANGE, "/"),
        ("rotors", [None] * rotor + [f.armature[i, j]], GREY, "."),
    ]
    bars = [
        plotly().Bar(
            orientation="h",
            x=plain(values),
            y=at,
            name=what,
            marker={"color": color, "pattern": {"shape": hatch, "size": 5, "solidity": 0.25}},
            meta={"role": what},
            hovertemplate="%{fullData.name}<br><b>%{x:.4g}</b><extra></extra>",
        )
        for what, values, color, hatch in parts
    ]
    units = (e.conventions.joints[k].effort_unit for k in (i, j))
    ticks = {"tickvals": at, "ticktext": [*names, "rotors"], "autorange": "reversed"}
    return figure(
        bars,
        tall(len(at)),
        xaxis={"title": {"text": inertia_unit(*units)}, "zeroline": True},
        yaxis=ticks | {"showgrid": False, "zeroline": False},
    )


def tall(rows: int) -> int:
    return 110 + max(rows, 3) * (34 if rows <= 12 else 20)
