"""How far a long run is, on a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np


@contextmanager
def progress(wanted: bool, times: np.ndarray) -> Iterator[Callable[[int], None]]:
    """A function that is told the number of the time that was reached."""
    if not wanted:
        yield lambda k: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("simulating"), BarColumn(), TextColumn("{task.fields[at]}"))
    with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True)) as bar:
        task = bar.add_task("", total=len(times) - 1, at="")
        end = f"{times[-1]:g} s"

        def at(k: int) -> None:
            bar.update(task, completed=k, at=f"{times[k]:.2f} of {end}")

        yield at
