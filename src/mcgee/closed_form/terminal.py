"""A derivation as plain text of some width."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

from sympy import Symbol

from mcgee.closed_form.document import Document, Equation, Name, Section
from mcgee.closed_form.latex import signed
from mcgee.closed_form.text import rounded

LETTERS = {"Cqd": "(C qd)"}


def report(d: Document, width: int) -> str:
    return "\n".join([d.title, *(line for s in d.sections for line in _section(s, width))])


def _section(s: Section, width: int) -> Iterator[str]:
    yield ""
    yield s.title
    yield "-" * len(s.title)
    for sentence in s.sentences:
        yield from textwrap.wrap(sentence, width, break_long_words=False)
    if s.equations:
        yield ""
    for equation in s.equations:
        yield from (_matrix if equation.rows else _sum)(equation, width)
    for line in s.lines:
        yield from textwrap.wrap(line, width, subsequent_indent=10 * " ")
    if s.left_out:
        yield s.left_out


def _left(left: Name | Symbol) -> str:
    if isinstance(left, Symbol):
        return str(left)
    place = f"{left.above}→{left.place}" if left.above else left.place
    return LETTERS.get(left.letter, left.letter) + place


def _sum(e: Equation, width: int) -> Iterator[str]:
    """A line a few terms."""
    line, indent = f"{_left(e.left)} =", 4 * " "
    for k, (sign, exact) in enumerate(signed(e.terms)):
        term = rounded(exact)
        text = f"({term})" if term.is_Add and len(e.terms) > 1 else str(term)
        text = f" {sign} {text}" if k else f" {sign if sign == '-' else ''}{text}"
        if len(line) + len(text) > width and line.strip():
            yield from textwrap.wrap(line, width, subsequent_indent=2 * indent)
            line = indent + text.lstrip()
        else:
            line += text
    yield from textwrap.wrap(line, width, subsequent_indent=2 * indent)


def _matrix(e: Equation, width: int) -> Iterator[str]:
    rows = [[str(rounded(x)) for x in row] for row in e.rows]
    wide = [max(len(row[j]) for row in rows) for j in range(len(rows[0]))]
    name = f"{_left(e.left)} = "
    for i, row in enumerate(rows):
        cells = "  ".join(f"{x:>{w}}" for x, w in zip(row, wide, strict=True))
        yield f"{name if i == 0 else ' ' * len(name)}[{cells}]"
