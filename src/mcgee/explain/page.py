"""An explanation as one HTML page that needs no network and no other file."""

from __future__ import annotations

import json
import re
from html import escape
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mcgee.explain.look import DARK, plotly
from mcgee.explain.sections import Page
from mcgee.writing import write_whole

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation


def write_page(e: Explanation, path: Path) -> Path:
    """Write the page whole or not at all.

    Returns: the path
    Raises:
        ValueError: the path cannot be written
        ModuleNotFoundError: Plotly or SciPy is not installed (mcgee[plot])
    """
    return write_whole(path, "the page", lambda: page(e))


def page(e: Explanation) -> str:
    """The page's text, the same for the same explanation.

    Raises: ModuleNotFoundError: Plotly or SciPy is not installed (mcgee[plot])
    """
    plotly()
    from plotly.offline import get_plotlyjs

    made = Page(e)
    parts = {
        "title": escape(f"{e.robot.name} explained"),
        "body": made.body(),
        "data": script_json({"dark": DARK, "figures": made.figures, "live": made.live.data()}),
        "plotly": get_plotlyjs(),
    }
    for part, name in (("style", "page.css"), ("script", "page.js")):
        parts[part] = (resources.files("mcgee.explain") / name).read_text("utf-8")
    frame = (resources.files("mcgee.explain") / "page.html").read_text("utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], frame)


def script_json(data: Any) -> str:
    """JSON that no text in it can end the script element of."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
