"""Tables of these pages that scripts write."""

from __future__ import annotations

import re
from pathlib import Path


def fill(page: Path, head: str, rows: str) -> None:
    """Put rows under a table's head, in place of those that are there."""
    text = page.read_text()
    assert head in text, f"{page.name} has no table {head!r}"
    old = re.compile(re.escape(head) + r"(\|.+\n)+")
    page.write_text(old.sub(lambda _: head + rows, text))
