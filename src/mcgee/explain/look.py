"""How pictures look: colours that colour-blind people tell apart, short names, rounded numbers."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.explain.inertia import Array

if TYPE_CHECKING:
    from types import ModuleType

INK, MUTED, LINE, MIDDLE = "#1d2329", "#5d6875", "#d9dee4", "#f7f8fa"
BLUE, ORANGE, GREEN, SKY = "#0072b2", "#e69f00", "#009e73", "#56b4e9"
RED, PINK, GREY = "#d55e00", "#cc79a7", "#8a949e"
PALETTE = (BLUE, ORANGE, GREEN, PINK, SKY, RED, "#7a68b3")
"""Okabe & Ito 2008, without the yellow that a white page swallows."""
DARK = {
    INK: "#e8ecf0",
    MUTED: "#a3adb8",
    LINE: "#39424c",
    MIDDLE: "#1a1f25",
    BLUE: "#4a9fe0",
    SKY: "#a5dcf7",
    "#d45d01": "#b9500c",
    "#0072b1": "#1f78b4",
    GREEN: "#2cc295",
    RED: "#f2813a",
    "#7a68b3": "#a594e0",
}
"""What each colour becomes on a dark page."""

DIVERGING = [[0.0, "#0072b1"], [0.5, MIDDLE], [1.0, "#d45d01"]]
SEQUENTIAL = [  # cividis: Nuñez, Anderton & Renslow 2018
    [0.0, "#00224e"],
    [0.25, "#434e6c"],
    [0.5, "#7d7c78"],
    [0.75, "#bcae6c"],
    [1.0, "#fee838"],
]
OTHERS = "all others"


def plotly() -> ModuleType:
    """plotly.graph_objects, loaded when the first picture is asked for."""
    try:
        import plotly.graph_objects as go
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(
            "Pictures need Plotly: install mcgee[plot].", name=missing.name
        ) from missing
    return go


def figure(traces: Iterable[Any], height: int = 360, **layout: Any) -> Any:
    """A plotly Figure in the house's look."""
    axis = {"gridcolor": LINE, "linecolor": LINE, "zerolinecolor": MUTED, "automargin": True}
    axis["exponentformat"] = "power"
    base = {
        "height": height,
        "autosize": True,
        "margin": {"l": 8, "r": 8, "t": 8, "b": 8},
        "font": {"family": "system-ui, sans-serif", "size": 13, "color": INK},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "colorway": list(PALETTE),
        "legend": {"orientation": "h", "x": 0, "y": 1.02, "xanchor": "left", "yanchor": "bottom"},
        "hoverlabel": {"align": "left"},
        "barmode": "relative",
        "bargap": 0.35,
        "dragmode": False,
    }
    made = plotly().Figure(data=list(traces), layout=base | layout)
    return made.for_each_xaxis(lambda x: x.update({**axis, **_given(x)})).for_each_yaxis(
        lambda y: y.update({**axis, **_given(y)})
    )


def _given(axis: Any) -> dict[str, Any]:
    return axis.to_plotly_json()


def nothing(words: str) -> Any:
    """The empty state: why there is no picture."""
    said = {
        "text": words,
        "x": 0.5,
        "y": 0.5,
        "xref": "paper",
        "yref": "paper",
        "showarrow": False,
        "font": {"color": MUTED, "size": 15},
    }
    hidden = {"visible": False, "range": [0, 1]}
    return figure([], 120, annotations=[said], xaxis=hidden, yaxis=hidden)


def safe(name: str) -> str:
    """A name from a file as plotly shall show it: its pseudo-HTML must not read it."""
    return html.escape(name, quote=False)


def short_names(names: Sequence[str]) -> tuple[str, ...]:
    """The names without the words that all of them begin or end with, for pictures."""
    words = [name.split("_") for name in names]
    if len(names) < 2:
        return tuple(names)
    shortest = min(map(len, words))
    head = next((k for k in range(shortest) if len({w[k] for w in words}) > 1), shortest)
    tail = next((k for k in range(shortest) if len({w[-1 - k] for w in words}) > 1), shortest)
    cut = ["_".join(w[head : len(w) - tail]) for w in words]
    return tuple(cut) if all(cut) and len(set(cut)) == len(names) else tuple(names)


def label(name: str, longest: int = 22) -> str:
    """Safe, and not longer than a picture can bear."""
    return safe(name if len(name) <= longest else name[: longest - 1] + "…")


def plain(values: Any, digits: int = 6) -> Any:
    """Nested lists of numbers with few digits; None where they are not finite."""
    if isinstance(values, (list, tuple, np.ndarray)):
        return [plain(v, digits) for v in values]
    if values is None or not np.isfinite(values):
        return None
    return float(f"{float(values):.{digits}g}")


def cells(values: Array) -> list[list[str]]:
    """A matrix as texts: three digits for its largest entry, one or none for far smaller ones."""
    top = float(abs(values[np.isfinite(values)]).max(initial=0))
    decimals = 0 if top <= 0 else int(np.clip(2 - np.floor(np.log10(top)), 0, 6))

    def text(v: float) -> str:
        if not np.isfinite(v) or abs(v) <= 1e-12 * top:
            return "0" if np.isfinite(v) else "∞"
        if abs(v) < 1e-3 * top:
            return "≈0"
        return f"{v:.{decimals}f}" if abs(v) >= 10.0**-decimals else f"{v:.1g}"

    return [[text(float(v)).replace("-", "−") for v in row] for row in values]


def most(shares: Array, count: int = len(PALETTE)) -> tuple[list[int], list[int]]:
    """Which rows of (rows, ...) are largest, in their own order, and which remain."""
    size = abs(shares).reshape(len(shares), -1).max(-1)
    ranked = [int(k) for k in np.argsort(-size, kind="stable") if size[k] > 1e-12 * size.max()]
    kept = ranked if len(ranked) <= count else ranked[: count - 1]
    return sorted(kept), sorted(ranked[len(kept) :])
