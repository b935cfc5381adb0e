"""A program as LLVM IR: straight-line code on tiles of a few rows.

A tile holds one vector of lanes for each scalar. `@kernel(in, out, work)` reads the input tile and
writes one vector for each distinct root to the output tile; what one part computes and a later
part needs passes through `work`. Of a long program, parts that do the same with other numbers are
one function, called with tables of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from mcgee.graph import cut
from mcgee.graph.node import Node
from mcgee.graph.program import LONG, Program, fusions, live
from mcgee.jit.emit import hexadecimal
from mcgee.jit.part import PARAMETERS, TABLES, Layout, Recipe, function, recipe, written
from mcgee.jit.target import Target

NOTHING: Mapping[Node, tuple[int, int]] = MappingProxyType({})


PART = 800
"""Operations a function: code generators take more than linear time in its length."""


@dataclass(frozen=True)
class Kernel:
    text: str
    work: int
    """Vectors of scratch space."""
    slots: tuple[int, ...]
    """For each element of the outputs, its vector in the output tile."""
    constants: tuple[tuple[int, float], ...]
    """Vectors of the output tile that no input changes: (slot, value)."""
    tile: int
    """Vectors in the output tile."""


def kernel_ir(
    program: Program, target: Target, given: Mapping[Node, tuple[int, int]] = NOTHING
) -> Kernel:
    """Args:
    given: the places in the input tile of cosine and sine, for angles that come with both
    """
    outputs = _places(program)
    left = live(program, fusions(program) if target.fma else {})
    nodes = [node for node in left if node.op != "input" or node in outputs]
    long = len(program.nodes) > LONG
    parts = cut.where_alike(nodes, left) if long else cut.evenly(nodes, PART)
    crossing, work = cut.crossing(parts, left)
    offsets, start = {}, 0
    for array in program.inputs:
        offsets[array.name], start = start, start + array.size
    layout = Layout(offsets, outputs, crossing, given)
    text = _text([recipe(part, layout, left) for part in parts], target)
    return Kernel(text, work, *_slots(program, outputs))


def _places(program: Program) -> dict[Node, int]:
    """The output vector of each distinct root."""
    places: dict[Node, int] = {}
    for root in program.roots:
        if isinstance(root, Node):
            places.setdefault(root, len(places))
    return places


def _slots(
    program: Program, places: dict[Node, int]
) -> tuple[tuple[int, ...], tuple[tuple[int, float], ...], int]:
    values: dict[str, int] = {}  # in hexadecimal, which tells -0.0 from 0.0
    slots = []
    for root in program.roots:
        if isinstance(root, Node):
            slots.append(places[root])
        else:
            slots.append(values.setdefault(float(root).hex(), len(places) + len(values)))
    constants = tuple((slot, float.fromhex(value)) for value, slot in values.items())
    return tuple(slots), constants, len(places) + len(values)


def _text(parts: Sequence[Recipe], target: Target) -> str:
    """The functions of the parts, and `@kernel`, which calls them in order."""
    times = Counter(part.steps for part in parts)
    shared: dict[tuple, str] = {}
    texts, calls, tables = [], [], _Tables(target)
    for k, part in enumerate(parts):
        again = times[part.steps] > 1
        name = shared.setdefault(part.steps, f"@part{k}") if again else f"@part{k}"
        if name == f"@part{k}":
            body = written(part, target, tables=again)
            texts.append(function(name, PARAMETERS + again * TABLES, body))
        numbers = tables.put(part) if again else ""
        calls.append(f"  call void {name}(ptr %in, ptr %out, ptr %work{numbers})\n")
    texts.append(f"\ndefine internal void @kernel({PARAMETERS}) nounwind {{\n")
    return "".join([tables.text(), *texts, *calls, "  ret void\n}\n"])


@dataclass
class _Tables:
    """The numbers of parts that share functions, one after the other."""

    target: Target
    constants: list[str] = field(default_factory=list)
    places: list[str] = field(default_factory=list)

    def put(self, part: Recipe) -> str:
        """A part's numbers at the ends of the tables; where they begin, as arguments."""
        t = self.target
        starts = (t.element, "constants", len(self.constants)), ("i32", "places", len(self.places))
        self.constants += [f"{t.element} {hexadecimal(c, t.bits)}" for c in part.constants]
        self.places += [f"i32 {place * t.lanes * t.size}" for place in part.places]
        return "".join(
            f", ptr getelementptr ({kind}, ptr @{table}, i64 {at})" for kind, table, at in starts
        )

    def text(self) -> str:
        if not self.places:
            return ""
        tables = (self.target.element, "constants", self.constants), ("i32", "places", self.places)
        return "".join(
            f"\n@{name} = internal constant [{len(entries)} x {kind}] [{', '.join(entries)}]\n"
            for kind, name, entries in tables
        )
