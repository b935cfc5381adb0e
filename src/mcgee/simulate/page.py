"""A motion as one HTML page that needs no network and no other file."""

from __future__ import annotations

import json
import re
from html import escape
from importlib import resources
from typing import TYPE_CHECKING

from mcgee.explain.look import DARK, plain, plotly
from mcgee.explain.page import script_json
from mcgee.simulate import plots
from mcgee.typeset import number

if TYPE_CHECKING:
    from mcgee.simulate.trajectory import Trajectory

FRAMES = 600
"""Poses that the animation has at most."""


def page(trajectory: Trajectory) -> str:
    """
    Raises:
        ValueError: a batch
        ModuleNotFoundError: Plotly is not installed (mcgee[plot])
    """
    plots.one(trajectory)
    plotly()
    from plotly.offline import get_plotlyjs

    frames = plots.thinned(trajectory, FRAMES)
    arm, moves = plots.arm(trajectory, frames)
    panels = (plots.ledger, plots.residual, plots.positions, plots.velocities, plots.efforts)
    figures = {"arm": arm} | {panel.__name__: panel(trajectory) for panel in panels}
    data = {
        "dark": DARK,
        "times": plain(trajectory.t[frames], 7),
        "moves": moves,
        "figures": {name: json.loads(made.to_json()) for name, made in figures.items()},
    }
    for made in data["figures"].values():
        made["layout"].pop("template", None)
    parts = {
        "title": escape(f"{trajectory.robot.name} in motion"),
        "said": escape(said(trajectory)),
        "last": str(len(frames) - 1),
        "data": script_json(data),
        "plotly": get_plotlyjs(),
        "style": (resources.files("mcgee.explain") / "page.css").read_text("utf-8"),
        "script": (resources.files("mcgee.simulate") / "page.js").read_text("utf-8"),
    }
    frame = (resources.files("mcgee.simulate") / "page.html").read_text("utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], frame)


def said(trajectory: Trajectory) -> str:
    """The motion in a sentence or two."""
    gone = float(abs(trajectory.residual).max())
    largest = float(trajectory.kinetic.max())
    words = f"{number(trajectory.t[-1])} s"
    if not trajectory.complete:
        words += f", {trajectory.status}"
    return (
        f"{words}. Kinetic energy reaches {number(largest)} J; the energy that the ledger misses, "
        f"the integrator's error, is {number(gone)} J at most."
    )
