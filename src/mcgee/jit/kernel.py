"""A program as LLVM IR: straight-line code on tiles of a few rows.

A tile holds one vector of lanes for each scalar. `@kernel(in, out, work)` reads the input tile and
writes one vector for each distinct root to the output tile; what one part computes and a later
part needs passes through `work`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from mcgee.graph.node import Node, Value
from mcgee.graph.program import Program, arguments, fusions, live
from mcgee.jit.emit import Emitter
from mcgee.jit.target import Target

PART = 800
"""Operations a function: code generators take more than linear time in its length."""

NOTHING: Mapping[Node, tuple[int, int]] = MappingProxyType({})

PARAMETERS = "ptr noalias %in, ptr noalias %out, ptr noalias %work"


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
    places = _places(program)
    fused = fusions(program) if target.fma else {}
    order = live(program, fused)
    parts = [order[i : i + PART] for i in range(0, len(order), PART)] or [[]]
    crossing = _crossing(parts, fused)
    offsets, start = {}, 0
    for array in program.inputs:
        offsets[array.name], start = start, start + array.size
    texts = [
        _Part(Emitter(target), offsets, places, fused, crossing, given).text(f"part{k}", part)
        for k, part in enumerate(parts)
    ]
    calls = "\n".join(
        f"  call void @part{k}(ptr %in, ptr %out, ptr %work)" for k in range(len(parts))
    )
    body = f"""
define internal void @kernel({PARAMETERS}) nounwind {{
{calls}
  ret void
}}
"""
    slots, constants, tile = _slots(program, places)
    return Kernel("".join(texts) + body, len(crossing), slots, constants, tile)


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


def _crossing(parts: list[list[Node]], fused: dict[Node, Node]) -> dict[Node, int]:
    """Scratch vectors for values that a later part reads."""
    home = {node: k for k, part in enumerate(parts) for node in part}
    crossing: dict[Node, int] = {}
    for k, part in enumerate(parts):
        for node in part:
            for a in arguments(node, fused):
                if home[a] != k and a.op != "input":
                    crossing.setdefault(a, len(crossing))
    return crossing


@dataclass
class _Part:
    """Writes one function: some operations, and the vectors that go in and out of it."""

    e: Emitter
    offsets: dict[str, int]
    places: dict[Node, int]
    fused: dict[Node, Node]
    crossing: dict[Node, int]
    given: Mapping[Node, tuple[int, int]]
    known: dict[Node, str] = field(default_factory=dict)
    angles: dict[Value, tuple[str, str]] = field(default_factory=dict)

    def text(self, name: str, nodes: list[Node]) -> str:
        for node in nodes:
            if node.op in ("cos", "sin"):
                self.known[node] = self.cos_sin(node.args[0])[node.op == "sin"]
            elif node.op != "input":
                self.known[node] = self.operation(node)
            if node in self.places:
                self.e.store(self.value(node), "%out", self.places[node])
            if node in self.crossing:
                self.e.store(self.value(node), "%work", self.crossing[node])
        return _FUNCTION.format(name=name, body="\n".join(self.e.lines))

    def value(self, a: Value) -> str:
        if not isinstance(a, Node):
            return self.e.constant(a)
        if a not in self.known:
            if a.op == "input":
                self.known[a] = self.e.load("%in", self.offsets[a.args[0]] + a.args[1])
            else:
                self.known[a] = self.e.load("%work", self.crossing[a])
        return self.known[a]

    def cos_sin(self, angle: Value) -> tuple[str, str]:
        if isinstance(angle, Node) and angle in self.given:
            cosine, sine = (self.e.load("%in", place) for place in self.given[angle])
            self.angles[angle] = cosine, sine
        if angle not in self.angles:
            v, x = self.e.vector, self.value(angle)
            both = self.e.let(f"call {{ {v}, {v} }} @cos_sin({v} {x})")
            cos, sin = (self.e.let(f"extractvalue {{ {v}, {v} }} {both}, {i}") for i in (0, 1))
            self.angles[angle] = cos, sin
        return self.angles[angle]

    def operation(self, node: Node) -> str:
        product = self.fused.get(node)
        if product is None:
            return getattr(self.e, node.op)(*(self.value(a) for a in node.args))
        x, y = (self.value(a) for a in product.args)
        a, b = node.args
        if node.op == "add":
            return self.e.muladd(x, y, self.value(b if a is product else a))
        if a is product:
            return self.e.mulsub(x, y, self.value(b))
        return self.e.submul(self.value(a), x, y)


_FUNCTION = f"""
define internal void @{{name}}({PARAMETERS}) nounwind noinline {{{{
{{body}}
  ret void
}}}}
"""
