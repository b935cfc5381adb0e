"""Statements as lines, and the functions that a routine's parts become."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from mcgee.codegen.expression import Syntax, lines, text
from mcgee.codegen.routine import (
    WORK,
    Expression,
    Let,
    Number,
    Part,
    Put,
    Routine,
    Turn,
    arrays_of,
    op,
)
from mcgee.graph.program import Array


@dataclass(frozen=True)
class Style:
    """A language's statements."""

    syntax: Syntax
    let: str
    """With {0} for the name and {1} for the value."""
    put: str
    indent: str = "    "

    def body(self, part: Part) -> str:
        """A part's statements, a line each where they fit."""
        return "".join(self._lines(part))

    def _lines(self, part: Part) -> Iterator[str]:
        for step in part:
            if isinstance(step, Put):
                place, value = self.syntax.item(step.place), text(step.value, self.syntax)
                yield self._line(self.put.format(place, value))
            elif isinstance(step, Let):
                yield self._let(step.name, step.value)
            else:
                yield from self.turn(step)

    def turn(self, step: Turn) -> Iterator[str]:
        for name, function in ((step.cosine, "cos"), (step.sine, "sin")):
            if name is not None:
                yield self._let(name, op(function, step.angle))

    def _let(self, name: str, value: Expression) -> str:
        left = self.syntax.local(name)
        return self._line(self.let.format(left, text(value, self.syntax)))

    def _line(self, statement: str) -> str:
        return lines(statement, self.indent, self.syntax)


@dataclass(frozen=True)
class Piece:
    """A part of a routine that is a function of its own."""

    number: int
    part: Part
    inputs: tuple[Array, ...]
    outputs: tuple[Array, ...]
    work: bool
    """Whether it uses the work array."""


def pieces(routine: Routine) -> list[Piece]:
    """The functions of a routine in several parts, with the arrays that each uses."""
    found = []
    for k, part in enumerate(routine.parts, 1):
        used = arrays_of(part)
        inputs, outputs = (
            tuple(a for a in arrays if a.name in used)
            for arrays in (routine.inputs, routine.outputs)
        )
        found.append(Piece(k, part, inputs, outputs, WORK in used))
    return found


def unused(routine: Routine) -> list[Array]:
    """Inputs that no statement reads."""
    used = set().union(*map(arrays_of, routine.parts))
    return [array for array in routine.inputs if array.name not in used]


def turns_first(part: Part) -> tuple[list[Turn], Part]:
    """The turns that a part begins with, and the rest."""
    count = 0
    while count < len(part) and isinstance(part[count], Turn | Put):
        count += 1
    first = [step for step in part[:count] if isinstance(step, Turn)]
    return first, (*(s for s in part[:count] if not isinstance(s, Turn)), *part[count:])


MANY = 16
"""Zeros of an array from which on all of it is cleared first."""


def zeros_first(part: Part) -> tuple[list[str], Part]:
    """The outputs that are better cleared before a first part, and what is left of it."""
    zeros = [step for step in part if isinstance(step, Put) and step.value == Number(0.0)]
    count = Counter(step.place.array for step in zeros)
    cleared = [name for name, times in count.items() if times >= MANY]
    drop = {id(step) for step in zeros if step.place.array in cleared}
    return cleared, tuple(step for step in part if id(step) not in drop)
