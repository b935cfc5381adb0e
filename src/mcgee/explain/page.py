"""An explanation as one HTML page that needs no network and no other file."""

from __future__ import annotations

import json
import os
import re
import tempfile
from html import escape
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mcgee.explain.look import DARK, plotly
from mcgee.explain.sections import Page

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation


def write_page(e: Explanation, path: Path) -> Path:
    """Write the page whole or not at all.

    Returns: the path
    Raises:
        ValueError: the path cannot be written
        ModuleNotFoundError: Plotly or SciPy is not installed (mcgee[plot])
    """
    try:
        _check(path)
        _replace(path, page(e))
    except OSError as error:
        reason = error.strerror or str(error)
        raise ValueError(f"cannot write the page to '{path}': {reason}.") from error
    return path


def _check(path: Path) -> None:
    """Before the page's work is done."""
    if path.is_dir():
        raise ValueError(f"cannot write the page to '{path}': it is a folder. Name a file in it.")
    if not path.parent.is_dir():
        raise ValueError(
            f"cannot write the page to '{path}': there is no folder '{path.parent}'. Make it first."
        )
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise ValueError(f"cannot write the page to '{path}': '{path.parent}' is not writable.")


def _replace(path: Path, text: str) -> None:
    """Into a temporary file beside it, which then takes its place."""
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        os.chmod(name, 0o666 & ~_umask())  # mkstemp's own is for its user alone
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


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
