"""A function of arrays as statements, in parts short enough for compilers: what languages write.

Expressions are trees; a value that is used once stands inside the expression that uses it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Union

from mcgee.graph import cut
from mcgee.graph.node import Node, Value
from mcgee.graph.program import Array, Program, live

PART = 500
"""Operations a function: register allocators take more than linear time, and Java's just-in-time
compiler leaves methods beyond 8,000 bytes alone."""

LEAVES = 8
"""Names and numbers that an expression may hold."""

WORK = "work"
"""The array in which a part leaves what later parts read."""


@dataclass(frozen=True)
class Number:
    value: float


@dataclass(frozen=True)
class Local:
    name: str


@dataclass(frozen=True)
class Item:
    """An element of an input, an output or the work array, counted row by row."""

    array: str
    index: int


@dataclass(frozen=True)
class Operation:
    op: str
    """'add', 'sub', 'mul', 'div', 'neg', 'cos' or 'sin'."""
    args: tuple[Expression, ...]


Expression = Union[Number, Local, Item, Operation]  # noqa: UP007  # recursive


def op(name: str, *args: Expression) -> Operation:
    return Operation(name, args)


@dataclass(frozen=True)
class Let:
    name: str
    value: Expression


@dataclass(frozen=True)
class Turn:
    """An angle's cosine and sine under names; at least one of them."""

    cosine: str | None
    sine: str | None
    angle: Expression


@dataclass(frozen=True)
class Put:
    place: Item
    value: Expression


Step = Let | Turn | Put
Part = tuple[Step, ...]


@dataclass(frozen=True)
class Routine:
    """Parts run in order; names are known within a part, `work` numbers pass between parts."""

    quantity: str
    inputs: tuple[Array, ...]
    outputs: tuple[Array, ...]
    parts: tuple[Part, ...]
    work: int = 0
    readable: bool = False
    """Whether a person is to read the formulas."""

    def array(self, name: str) -> Array:
        if name == WORK:
            return Array(WORK, (self.work,))
        return next(a for a in (*self.inputs, *self.outputs) if a.name == name)

    def renamed(self, names: Mapping[str, str]) -> Routine:
        """The same with other names for its arrays."""

        def new(x: Expression) -> Expression:
            if isinstance(x, Item):
                return Item(names.get(x.array, x.array), x.index)
            return Operation(x.op, tuple(map(new, x.args))) if isinstance(x, Operation) else x

        def of(step: Step) -> Step:
            if isinstance(step, Let):
                return Let(step.name, new(step.value))
            if isinstance(step, Turn):
                return Turn(step.cosine, step.sine, new(step.angle))
            place = Item(names.get(step.place.array, step.place.array), step.place.index)
            return Put(place, new(step.value))

        inputs, outputs = (
            tuple(replace(a, name=names.get(a.name, a.name)) for a in group)
            for group in (self.inputs, self.outputs)
        )
        parts = tuple(tuple(map(of, part)) for part in self.parts)
        return replace(self, inputs=inputs, outputs=outputs, parts=parts)


def arrays_of(part: Part) -> set[str]:
    """The arrays that a part's statements read or write."""
    items = [item for step in part for item in _items(_read(step))]
    return {item.array for item in items} | {s.place.array for s in part if isinstance(s, Put)}


def _read(step: Step) -> Expression:
    return step.angle if isinstance(step, Turn) else step.value


def _items(x: Expression) -> Iterator[Item]:
    if isinstance(x, Item):
        yield x
    elif isinstance(x, Operation):
        for a in x.args:
            yield from _items(a)


# -- from a graph ---------------------------------------------------------------------------------


def routine(program: Program, longest: int = PART) -> Routine:
    """A program's operations as statements, in its order."""
    left = live(program, {})
    nodes = [node for node in left if node.op != "input"]
    parts = cut.evenly(nodes, longest)
    crossing, work = cut.crossing(parts, left)
    maker = _Maker(program, left, crossing)
    made = [_PartMaker(maker, part).made() for part in parts]
    made[0] = (*maker.direct, *made[0])
    return Routine(program.name, program.inputs, program.outputs, tuple(made), work)


class _Maker:
    """What the parts of one program share."""

    def __init__(self, program: Program, left: cut.Left, crossing: Mapping[Node, int]):
        self.left = left
        self.homes: dict[Node, list[Item]] = {
            node: [Item(WORK, place)] for node, place in crossing.items()
        }
        """Where a value is left for others."""
        self.direct: list[Put] = []
        """Outputs that are inputs or constants."""
        places = (Item(array.name, i) for array in program.outputs for i in range(array.size))
        for place, root in zip(places, program.roots, strict=True):
            if isinstance(root, Node) and root.op != "input":
                self.homes.setdefault(root, []).append(place)
            else:
                self.direct.append(Put(place, _leaf(root)))
        self.crossing = crossing
        self.named = 0

    def next(self) -> int:
        self.named += 1
        return self.named


class _PartMaker:
    def __init__(self, of: _Maker, nodes: Sequence[Node]):
        self.of, self.nodes = of, nodes
        self.uses = Counter(a for node in nodes for a in of.left[node][1] if isinstance(a, Node))
        self.known: dict[Node, Expression] = {}
        """How a later statement of this part reads a value."""
        self.steps: list[Step] = []

    def made(self) -> Part:
        for node in self.nodes:  # first all that turn by inputs
            if node.op in ("cos", "sin") and node.args[0].op == "input":
                self._turn(node)
        for node in self.nodes:
            if node.op in ("cos", "sin"):
                self._turn(node)
            else:
                self._arithmetic(node)
        return tuple(self.steps)

    def _turn(self, node: Node) -> None:
        if node in self.known:
            return
        angle = node.args[0]
        is_position = angle.op == "input" and angle.args[0] == "q"
        suffix = f"{angle.args[1] + 1}" if is_position else f"_{self.of.next()}"
        both = [
            other for other in self.nodes if other.op in ("cos", "sin") and other.args[0] is angle
        ]
        names = {other.op: f"{other.op[0]}{suffix}" for other in both}
        self.steps.append(Turn(names.get("cos"), names.get("sin"), self._value(angle)))
        for other in both:
            self.known[other] = Local(names[other.op])
            self._leave(other)

    def _arithmetic(self, node: Node) -> None:
        op, args = self.of.left[node]
        value = Operation(op, tuple(map(self._value, args)))
        homes = self.of.homes.get(node, ())
        if self.uses[node] == 1 and not homes and _leaves(value) < LEAVES:
            self.known[node] = value
            return
        if self.uses[node] == 0 and len(homes) == 1:
            self.known[node] = value
        else:
            name = f"t{self.of.next()}"
            self.known[node] = Local(name)
            self.steps.append(Let(name, value))
        self._leave(node)

    def _leave(self, node: Node) -> None:
        for home in self.of.homes.get(node, ()):
            self.steps.append(Put(home, self.known[node]))

    def _value(self, a: Value) -> Expression:
        if not isinstance(a, Node) or a.op == "input":
            return _leaf(a)
        if a not in self.known:  # an earlier part left it
            self.known[a] = Item(WORK, self.of.crossing[a])
        return self.known[a]


def _leaf(a: Value) -> Expression:
    return Item(*a.args) if isinstance(a, Node) else Number(float(a))


def _leaves(x: Expression) -> int:
    return sum(map(_leaves, x.args)) if isinstance(x, Operation) else 1
