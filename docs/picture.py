"""Draws the README's picture: what `mcgee terms` shows of the Panda, as SVG.

.venv/bin/python docs/picture.py        rewrites docs/images/terms.svg
"""

import io
import re
from pathlib import Path

from rich.console import Console
from rich.terminal_theme import MONOKAI

import mcgee
from mcgee.cli.state import read_state
from mcgee.cli.terms import print_tables

TARGET = Path(__file__).parent / "images" / "terms.svg"
COMMAND = "mcgee terms panda --q 0,-0.8,0,-2.4,0,1.6,0.8 --qd 0.5,0,0,0.5,0,0,1"


def picture() -> str:
    console = Console(record=True, width=80, highlight=False, file=io.StringIO())
    console.print(f"$ {COMMAND}", style="bold green")
    arm = mcgee.load("panda")
    words = COMMAND.split()
    print_tables(arm, read_state(arm, words[4], words[6]), console)
    svg = console.export_svg(title="M(q) qdd + C(q, qd) qd + g(q) = tau", theme=MONOKAI)
    svg = re.sub(r"@font-face \{.*?\}\s*", "", svg, flags=re.DOTALL)  # no fonts from elsewhere
    svg = svg.replace("Fira Code", "Menlo, DejaVu Sans Mono, Consolas")
    svg = re.sub(r"terminal-\d+-", "terminal-", svg)  # the same picture, the same bytes
    return re.sub(r"<!--.*?-->\s*", "", svg)


if __name__ == "__main__":
    TARGET.write_text(picture())
