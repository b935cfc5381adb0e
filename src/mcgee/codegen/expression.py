"""Expressions as text: the same arithmetic in every language, in the order that the tree says."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from mcgee.codegen.routine import Expression, Item, Local, Number

WIDTH = 96
"""Characters of a line, about."""

SUM, PRODUCT, SIGN, ATOM = range(4)
BINARY = {"add": ("+", SUM), "sub": ("-", SUM), "mul": ("*", PRODUCT), "div": ("/", PRODUCT)}


@dataclass(frozen=True)
class Syntax:
    """What differs between languages in an expression and an assignment."""

    item: Callable[[Item], str]
    """An element of an array, or a parameter."""
    number: Callable[[float], str] = field(default=lambda x: decimal(x))
    call: Mapping[str, str] | None = None
    """By operation, a function's name with what opens its argument; else cos( and sin(."""
    close: str = ")"
    continued: str = ""
    """What ends a line whose statement goes on."""
    local: Callable[[str], str] = field(default=lambda name: name)


def decimal(x: float) -> str:
    """The shortest text that reads back as this float, with a point or exponent."""
    text = repr(float(x))
    return text if "inf" not in text and "nan" not in text else _refuse(x)


def _refuse(x: float) -> str:
    raise ValueError(f"a constant of the dynamics is {x}, which no generated code can hold.")


def text(x: Expression, syntax: Syntax) -> str:
    return _text(x, syntax)[0]


def _text(x: Expression, syntax: Syntax) -> tuple[str, int]:
    """And how tightly it holds together."""
    if isinstance(x, Number):
        written = syntax.number(x.value)
        return written, SIGN if written.startswith("-") else ATOM
    if isinstance(x, Local):
        return syntax.local(x.name), ATOM
    if isinstance(x, Item):
        return syntax.item(x), ATOM
    if x.op in ("cos", "sin"):
        opening = (syntax.call or {}).get(x.op, f"{x.op}(")
        return f"{opening}{text(x.args[0], syntax)}{syntax.close}", ATOM
    if x.op == "neg":
        return f"-{_within(x.args[0], syntax, ATOM)}", SIGN
    sign, level = BINARY[x.op]
    left = _within(x.args[0], syntax, level)
    # floating-point sums and products keep their order: the right side never loses its brackets
    right = _within(x.args[1], syntax, level + 1, right=True)
    return (f"{left} {sign} {right}" if level == SUM else f"{left}{sign}{right}"), level


def _within(x: Expression, syntax: Syntax, level: int, right: bool = False) -> str:
    written, tight = _text(x, syntax)
    loose = tight < level or (right and tight == SIGN)
    return f"({written})" if loose else written


def lines(statement: str, indent: str, syntax: Syntax, width: int = WIDTH) -> str:
    """A statement of one line or, where that is long, of several, broken before operators."""
    if len(indent) + len(statement) <= width:
        return f"{indent}{statement}\n"
    deeper = indent + "    "
    out, line = [], indent
    for word in re.split(r" (?=[-+] )", statement):
        if len(line) + len(word) + 1 > width and line.strip():
            out.append(f"{line}{syntax.continued}\n")
            line = deeper
        line += word if not line.strip() else f" {word}"
    return "".join([*out, f"{line}\n"])
