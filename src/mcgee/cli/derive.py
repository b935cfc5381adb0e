"""A robot's closed forms on the terminal, as JSON, and in files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from mcgee.cli.working import working
from mcgee.robot import Robot

if TYPE_CHECKING:
    from mcgee.closed_form import ClosedForm

TERMINAL, FILES = 200, 1_000
"""Terms that a section shows, unless another limit is wanted."""

WIDTH = 100
SLOW = 20_000
"""Terms whose writing takes long enough to be announced; some thousands take a second."""


def check(latex: Path | None, html: Path | None) -> None:
    """Raises: ValueError: both outputs are one file"""
    if latex is not None and latex == html:
        raise ValueError(f"--latex and --html both name '{latex}'. Give each a file of its own.")


def derived(robot: Robot, simplify: str, symbolic: bool) -> ClosedForm:
    with working(f"deriving M, C and g of {robot.name}"):
        form = robot.closed_form(simplify=simplify, symbolic_inertias=symbolic)
        form.terms("christoffel")
    return form


def print_report(form: ClosedForm, limit: int | None) -> None:
    from mcgee.closed_form.document import document
    from mcgee.closed_form.terminal import report

    width = min(Console().width, WIDTH)
    with working("writing"):
        text = report(document(form, limit), width)
    print(text)


def print_json(form: ClosedForm) -> None:
    """Everything, with exact numbers."""
    terms = {name: form.terms(name) for name in ("T", "P", "M", "christoffel", "C", "Cqd", "g")}
    total = sum(terms.values())
    if total > SLOW:
        Console(stderr=True, highlight=False).print(
            f"mcgee: {total:,} terms to write, some {total / 4000:,.0f} s; there are fewer without "
            f"--symbolic, and on the terminal"
        )
    with working("writing"):
        print(json.dumps(_content(form, terms), indent=1))


def _content(form: ClosedForm, terms: dict[str, int]) -> dict[str, Any]:
    n = range(form.n)
    content: dict[str, Any] = {
        "robot": form.name,
        "simplify": form.simplify,
        "q": [str(s) for s in form.q],
        "terms": terms,
        "T": str(form.T),
        "P": str(form.P),
        "M": [[str(form.M[i, j]) for j in n] for i in n],
        "christoffel": [[[str(x) for x in row] for row in plane] for plane in form.christoffel],
        "C": [[str(form.C[i, j]) for j in n] for i in n],
        "Cqd": [str(x) for x in form.Cqd],
        "g": [str(x) for x in form.g],
        "lumps": {str(s): str(e) for s, e in form.lumps.items()},
        "constants": {str(s): value for s, value in form.constants.items()},
    }
    base = form.base_parameters()
    content["base_parameters"] = {b.name: str(b.formula) for b in base}
    content["unseen_parameters"] = list(base.unseen)
    content["proofs"] = [
        {"name": p.name, "statement": p.statement, "holds": p.holds, "said": str(p)}
        for p in form.prove()
    ]
    return content


def write(form: ClosedForm, limit: int | None, latex: Path | None, html: Path | None) -> list[Path]:
    with working("writing"):
        written = [form.to_latex(latex, limit)] if latex is not None else []
        return written + ([form.to_html(html, limit)] if html is not None else [])
