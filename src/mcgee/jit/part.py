"""A stretch of a program's operations as one function of LLVM IR."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from mcgee.graph.node import Node, Value
from mcgee.jit.emit import Emitter
from mcgee.jit.target import Target

PARAMETERS = "ptr noalias %in, ptr noalias %out, ptr noalias %work"
TABLES = ", ptr noalias %constants, ptr noalias %places"


@dataclass(frozen=True)
class Layout:
    """Where the values live that go in and out of functions, in vectors."""

    offsets: Mapping[str, int]
    """The first place of each input array in the input tile."""
    outputs: Mapping[Node, int]
    """Of each distinct root in the output tile."""
    crossing: Mapping[Node, int]
    """In scratch space, of what one function computes and a later one reads."""
    given: Mapping[Node, tuple[int, int]]
    """In the input tile, cosine and sine of angles that come with both."""


@dataclass(frozen=True)
class Recipe:
    """A part but for its numbers; parts with equal steps can share a function.

    A step is an operation and the indices of the steps whose values it takes. The k-th "number"
    stands for constants[k]; what reads or writes an array goes to the next of the places.
    """

    steps: tuple[tuple, ...]
    constants: tuple[float, ...]
    places: tuple[int, ...]


def recipe(
    part: Sequence[Node], layout: Layout, left: Mapping[Node, tuple[str, tuple[Value, ...]]]
) -> Recipe:
    """Args:
    left: the operation that is left of each node, and what it reads
    """
    made = _Making(layout)
    for node in part:
        op, args = left[node]
        if op in ("cos", "sin"):
            made.known[node] = made.turn(op, args[0])  # type: ignore[arg-type]  # never a number
        elif op != "input":
            made.known[node] = made.step(op, *map(made.value, args))
        for array, goes in (("%out", layout.outputs), ("%work", layout.crossing)):
            if node in goes:
                made.write(made.value(node), array, goes[node])
    return Recipe(tuple(made.steps), tuple(made.constants), tuple(made.places))


@dataclass
class _Making:
    layout: Layout
    steps: list[tuple] = field(default_factory=list)
    constants: list[float] = field(default_factory=list)
    places: list[int] = field(default_factory=list)
    known: dict[Any, int] = field(default_factory=dict)
    """The steps that give a node's value, a constant's by its text (-0.0 is not 0.0), and those of
    an angle by its node and their names."""

    def step(self, *what: str | int) -> int:
        self.steps.append(what)
        return len(self.steps) - 1

    def read(self, array: str, place: int) -> int:
        self.places.append(place)
        return self.step("read", array)

    def write(self, value: int, array: str, place: int) -> None:
        self.places.append(place)
        self.step("write", value, array)

    def value(self, a: Value) -> int:
        key = a if isinstance(a, Node) else float(a).hex()
        if key not in self.known:
            self.known[key] = self._fetched(a)
        return self.known[key]

    def _fetched(self, a: Value) -> int:
        if not isinstance(a, Node):
            self.constants.append(float(a))
            return self.step("number", len(self.constants) - 1)
        if a.op == "input":
            return self.read("%in", self.layout.offsets[a.args[0]] + a.args[1])
        return self.read("%work", self.layout.crossing[a])

    def turn(self, op: str, angle: Node) -> int:
        """The step that gives an angle's cosine or sine; both come together."""
        if (op, angle) not in self.known:
            if angle in self.layout.given:
                cosine, sine = (self.read("%in", place) for place in self.layout.given[angle])
            else:
                pair = self.step("cos_sin", self.value(angle))
                cosine, sine = (self.step("pick", i, pair) for i in (0, 1))
            self.known["cos", angle], self.known["sin", angle] = cosine, sine
        return self.known[op, angle]


def written(made: Recipe, target: Target, *, tables: bool) -> str:
    """The function's body, its constants and places in the text or to come from tables."""
    writer = (_Tabled if tables else _Written)(Emitter(target), made)
    for op, *args in made.steps:
        own = getattr(writer, op, None)
        values = writer.values
        if own is not None:
            values.append(own(*args))
        else:
            values.append(getattr(writer.e, op)(*(values[a] for a in args)))
    return "\n".join(writer.e.lines)


@dataclass
class _Written:
    """Writes the steps that are no arithmetic."""

    e: Emitter
    recipe: Recipe
    values: list[str] = field(default_factory=list)
    moved: int = 0
    """Reads and writes so far."""

    def number(self, k: int) -> str:
        return self.e.constant(self.recipe.constants[k])

    def read(self, array: str) -> str:
        return self.e.load(*self.place(array))

    def write(self, i: int, array: str) -> str:
        self.e.store(self.values[i], *self.place(array))
        return ""

    def place(self, array: str) -> tuple[str, int]:
        """A pointer and an index, of the next vector that is read or written."""
        self.moved += 1
        return array, self.recipe.places[self.moved - 1]

    def cos_sin(self, i: int) -> str:
        v = self.e.vector
        return self.e.let(f"call {{ {v}, {v} }} @cos_sin({v} {self.values[i]})")

    def pick(self, which: int, pair: int) -> str:
        v = self.e.vector
        return self.e.let(f"extractvalue {{ {v}, {v} }} {self.values[pair]}, {which}")


class _Tabled(_Written):
    """With constants, and places in bytes, from tables."""

    def number(self, k: int) -> str:
        t = self.e.target
        entry = self.e.let(f"getelementptr {t.element}, ptr %constants, i64 {k}")
        return self.e.splat(self.e.let(f"load {t.element}, ptr {entry}, align {t.size}"))

    def place(self, array: str) -> tuple[str, int]:
        entry = self.e.let(f"getelementptr i32, ptr %places, i64 {self.moved}")
        self.moved += 1
        offset = self.e.let(f"zext i32 {self.e.let(f'load i32, ptr {entry}, align 4')} to i64")
        return self.e.let(f"getelementptr i8, ptr {array}, i64 {offset}"), 0


def function(name: str, parameters: str, body: str) -> str:
    return _FUNCTION.format(name=name, parameters=parameters, body=body)


_FUNCTION = """
define internal void {name}({parameters}) nounwind noinline {{
{body}
  ret void
}}
"""
