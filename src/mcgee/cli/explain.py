"""An explanation on the terminal, and as JSON."""

from __future__ import annotations

import json

from rich.console import Console

from mcgee.explain import Explanation
from mcgee.explain.terminal import WIDTH, report


def print_json(explanation: Explanation) -> None:
    print(json.dumps(explanation.to_dict(), indent=2, allow_nan=False))


def print_report(explanation: Explanation) -> None:
    console = Console(highlight=False)
    console.width = min(console.width, WIDTH)
    console.print(report(explanation))
