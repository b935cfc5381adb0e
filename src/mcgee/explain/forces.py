"""Pictures of velocity terms, power and gravity, as plotly Figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.explain.inertia import Array
from mcgee.explain.look import (
    GREY,
    INK,
    LINE,
    MUTED,
    ORANGE,
    OTHERS,
    PALETTE,
    PINK,
    RED,
    SKY,
    figure,
    label,
    most,
    nothing,
    plain,
    plotly,
    short_names,
)
from mcgee.explain.plots import bar, joint_axis, joint_labels, tall
from mcgee.typeset import number

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation

SEEN = 0.01
"""Flows below this share of the largest are not drawn."""


def velocity_terms(e: Explanation) -> Any:
    """Every centrifugal and Coriolis effort on every joint, stacked; marks at their sums."""
    v, n, names = e.velocity, e.robot.n, joint_labels(e)
    if not abs(v.Cqd).max() > 0 and not (abs(v.centrifugal).max() > 0):
        return nothing("No velocity terms: C qd = 0.")
    terms = [(f"{names[j]}²", v.centrifugal[:, j], "") for j in range(n)]
    terms += [
        (f"{names[j]} × {names[k]}", v.coriolis[:, j, k], "/")
        for j in range(n)
        for k in range(j + 1, n)
    ]
    kept, rest = most(np.stack([term for _, term, _ in terms]))
    shown = [(*terms[k], PALETTE[c]) for c, k in enumerate(kept)]
    if rest:
        shown.append((OTHERS, np.sum([terms[k][1] for k in rest], 0), "", GREY))
    joints = list(range(n))
    bars = [bar(part, joints, name, "", color, hatch, "") for name, part, hatch, color in shown]
    return _bars_with_sum(e, bars, v.Cqd, "C qd")


def _bars_with_sum(e: Explanation, bars: list[Any], total: Array, name: str) -> Any:
    marks = plotly().Scatter(
        x=plain(total),
        y=list(range(e.robot.n)),
        mode="markers",
        name=f"sum: {name}",
        marker={"symbol": "diamond", "size": 10, "color": INK, "line": {"width": 1, "color": LINE}},
        hovertemplate=f"{name} <b>%{{x:.4g}}</b><extra></extra>",
    )
    return figure(
        [*bars, marks],
        tall(e.robot.n),
        xaxis={"title": {"text": effort_units(e)}, "zeroline": True},
        yaxis=joint_axis(e, autorange="reversed"),
    )


def effort_units(e: Explanation) -> str:
    return " | ".join(dict.fromkeys(joint.effort_unit for joint in e.conventions.joints))


def power_flow(e: Explanation) -> Any:
    """Power that the velocity terms carry, from joints that give to joints that take."""
    flow = e.velocity.flow
    if abs(flow).max() <= 1e-9 * max(e.velocity.kinetic_energy, 1e-300):
        still = not e.velocity.kinetic_energy > 0
        return nothing(
            "Nothing moves: no power flows." if still else "No power flows between the joints now."
        )
    names = joint_labels(e)
    takes, gives = np.nonzero(flow > SEEN * flow.max())
    left, right = sorted(set(gives.tolist())), sorted(set(takes.tolist()))
    nodes = [f"{names[j]} gives" for j in left] + [f"{names[i]} takes" for i in right]
    links = [
        (left.index(j), len(left) + right.index(i), flow[i, j], PALETTE[left.index(j) % 7])
        for i, j in zip(takes.tolist(), gives.tolist(), strict=True)
    ]
    colors = [PALETTE[k % 7] for k in range(len(left))] + [GREY] * len(right)
    return _sankey(nodes, colors, links)


def energy_budget(e: Explanation) -> Any:
    """Where the bodies' power comes from and goes: actuators, weights, motion."""
    f = e.energy
    parts = {"actuators": f.actuator, "weights": f.gravity, "motion": -f.rate}
    largest = max(abs(f.through).max(), *(abs(p).max() for p in parts.values()))
    if largest <= 1e-12:
        return nothing("Nothing moves: no power flows.")
    bodies = [label(name) for name in short_names(f.joints)]
    words = {
        "actuators": ("actuators drive", "actuators brake", ORANGE),
        "weights": ("weights fall", "weights rise", SKY),
        "motion": ("motion slows", "motion quickens", PINK),
    }
    nodes, colors = list(bodies), [GREY] * len(bodies)
    for giving, taking, color in words.values():
        nodes += [giving, taking]
        colors += [color, color]
    links = []
    for k, (what, power) in enumerate(parts.items()):
        for i, p in enumerate(power.tolist()):
            ends = (len(bodies) + 2 * k, i) if p > 0 else (i, len(bodies) + 2 * k + 1)
            links.append((*ends, abs(p), words[what][2]))
    for i, p in enumerate(f.through.tolist()):
        if f.parents[i] >= 0:
            links.append((*((f.parents[i], i) if p > 0 else (i, f.parents[i])), abs(p), GREY))
    return _sankey(nodes, colors, [link for link in links if link[2] > SEEN * largest])


def _sankey(nodes: list[str], colors: list[str], links: list[tuple[int, int, float, str]]) -> Any:
    used = sorted({k for link in links for k in link[:2]})
    picture = plotly().Sankey(
        valueformat=".3g",
        valuesuffix=" W",
        node={
            "label": [nodes[k] for k in used],
            "color": [colors[k] for k in used],
            "pad": 18,
            "thickness": 14,
            "line": {"width": 0},
            "hovertemplate": "%{label}<br><b>%{value:.3g} W</b><extra></extra>",
        },
        link={
            "source": [used.index(a) for a, *_ in links],
            "target": [used.index(b) for _, b, *_ in links],
            "value": plain([w for *_, w, _ in links]),
            "color": [_pale(c) for *_, c in links],
            "hovertemplate": (
                "%{source.label} → %{target.label}<br><b>%{value:.3g} W</b><extra></extra>"
            ),
        },
    )
    return figure([picture], 140 + 32 * min(len(used), 16), font={"size": 12, "color": INK})


def _pale(color: str) -> str:
    return f"rgba({','.join(str(int(color[k : k + 2], 16)) for k in (1, 3, 5))},0.4)"


# -- g --------------------------------------------------------------------------------------------


def gravity(e: Explanation) -> Any:
    """What each link adds to every holding effort, and their sums."""
    f = e.gravity
    if not abs(f.parts).max(initial=0) > 1e-9 * max(f.weight.sum(), 1e-300):
        return nothing("No joint holds any weight at this pose: g = 0.")
    kept, rest = most(f.parts)
    rows = [(label(f.links[k]), f.parts[k], PALETTE[c]) for c, k in enumerate(kept)]
    if rest:
        rows.append((OTHERS, f.parts[rest].sum(0), GREY))
    joints = list(range(e.robot.n))
    bars = [bar(part, joints, name, "", color, "", "") for name, part, color in rows]
    made = _bars_with_sum(e, bars, f.g, "g")
    room = f.parts.clip(max=0).sum(0).min(), f.parts.clip(0).sum(0).max()
    for i, limit in enumerate(f.effort):
        # far limits would squeeze the bars; they are told in percent instead
        for x in (-limit, limit):
            if x == 0 or not 1.15 * room[0] <= x <= 1.15 * room[1]:
                continue
            ends = {"x0": x, "x1": x, "y0": i - 0.4, "y1": i + 0.4}
            made.add_shape(type="line", **ends, line={"color": INK, "width": 4})
    return made


def effort_shares(e: Explanation) -> Any:
    """The holding efforts as shares of the actuators' limits."""
    f = e.gravity
    limited = np.isfinite(f.effort) & (f.effort > 0)
    if not limited.any():
        return nothing("The description sets no effort limits: no margins to show.")
    share = np.where(limited, 100 * f.share, 0.0)
    words = [
        f"{number(round(s, 9))} % of {number(limit)} {joint.effort_unit}" if has else "no limit set"
        for s, limit, has, joint in zip(share, f.effort, limited, e.conventions.joints, strict=True)
    ]
    shares = plotly().Bar(
        orientation="h",
        x=plain(share),
        y=list(range(e.robot.n)),
        marker={"color": [RED if s > 100 else PALETTE[0] for s in share]},
        text=words,
        textposition="outside",
        cliponaxis=False,
        textfont={"color": MUTED},
        hoverinfo="skip",
    )
    full = max(100.0, float(share.max()))
    made = figure(
        [shares],
        tall(e.robot.n),
        xaxis={"range": [0, 1.55 * full], "title": {"text": "% of the effort limit"}},
        yaxis=joint_axis(e, autorange="reversed"),
    )
    return made.add_vline(x=100, line={"color": RED, "width": 2, "dash": "dash"})


def holding(e: Explanation, around: Array) -> Any:
    """The holding efforts alone; the page's slider moves them over the poses around (..., n)."""
    go, joints = plotly(), list(range(e.robot.n))
    efforts = e.robot.gravity(around)
    low, high = min(float(efforts.min()), 0.0), max(float(efforts.max()), 0.0)
    margin = 0.05 * (high - low) or 1.0
    efforts_now = go.Bar(
        orientation="h",
        x=plain(e.gravity.g),
        y=joints,
        name="g",
        marker={"color": PALETTE[0]},
        meta={"role": "now"},
        hovertemplate="g <b>%{x:.4g}</b><extra></extra>",
    )
    before = go.Scatter(
        x=plain(e.gravity.g),
        y=joints,
        mode="markers",
        name="at the explained pose",
        marker={"symbol": "diamond-open", "size": 10, "color": INK, "line": {"width": 2}},
        hoverinfo="skip",
    )
    return figure(
        [efforts_now, before],
        max(tall(e.robot.n), 300),
        xaxis={
            "title": {"text": f"g [{effort_units(e)}]"},
            "range": plain([low - margin, high + margin], 4),
        },
        yaxis=joint_axis(e, autorange="reversed"),
    )
