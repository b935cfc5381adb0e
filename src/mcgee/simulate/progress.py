"""How far a long run is, on a terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

PATIENCE = 2.0
"""Seconds before a run counts as long."""


@contextmanager
def progress(wanted: bool | None, times: np.ndarray) -> Iterator[Callable[[int], None]]:
    """A function that is told the number of the time that was reached.

    Args:
        wanted: None for runs that turn out long, where somebody may be looking
    """
    if wanted is False or (wanted is None and not sys.stderr.isatty()):
        yield lambda k: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("simulating"), BarColumn(), TextColumn("{task.fields[at]}"))
    bar = Progress(
        *columns, TimeRemainingColumn(), console=Console(stderr=True), transient=wanted is None
    )
    task = bar.add_task("", total=len(times) - 1, at="")
    end, begin = f"{times[-1]:g} s", time.monotonic()

    def at(k: int) -> None:
        if not bar.live.is_started and (wanted or time.monotonic() - begin > PATIENCE):
            bar.start()
        bar.update(task, completed=k, at=f"{times[k]:.2f} of {end}")

    try:
        yield at
    finally:
        bar.stop()
