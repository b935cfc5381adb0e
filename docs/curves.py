"""How the curves of these pages are drawn: matplotlib, in the colours of mcgee's own pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt

from mcgee.explain.look import INK, LINE, MUTED, PALETTE

IMAGES = Path(__file__).parent / "images"
LOOK = {
    "axes.edgecolor": LINE,
    "axes.grid": True,
    "axes.labelcolor": MUTED,
    "axes.prop_cycle": mpl.cycler(color=PALETTE),
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.titlesize": 11,
    "figure.constrained_layout.use": True,
    "font.family": "sans-serif",
    "font.size": 10,
    "grid.color": LINE,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "lines.linewidth": 1.4,
    "svg.fonttype": "none",
    "svg.hashsalt": "mcgee",
    "xtick.color": MUTED,
    "ytick.color": MUTED,
}


def panels(
    titles: Sequence[str], height: float, shares: Sequence[float] | None = None
) -> tuple[Any, list[Any]]:
    """A figure with a panel for each title, one below the other, of these shares of its height."""
    mpl.rcParams.update(LOOK)
    figure, axes = plt.subplots(
        len(titles), figsize=(8, height), squeeze=False, height_ratios=shares
    )
    for ax, title in zip(axes.flat, titles, strict=True):
        ax.set_title(title)
    return figure, list(axes.flat)


def save(figure: Any, name: str) -> None:
    figure.savefig(IMAGES / f"{name}.svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)
