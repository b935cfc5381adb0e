"""Where a program is cut into parts, and what passes between them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from mcgee.graph.node import Node, Value

SHORTEST, LONGEST = 100, 500
"""Operations of a part that may repeat."""

SURROUNDINGS = 12
"""Operations before a place that decide whether to cut there."""

Left = Mapping[Node, tuple[str, tuple[Value, ...]]]
"""In order, the operation that is left of each node, and what it reads."""


def evenly(nodes: Sequence[Node], size: int) -> list[Sequence[Node]]:
    return [nodes[i : i + size] for i in range(0, len(nodes), size)] or [[]]


def where_alike(nodes: Sequence[Node], left: Left) -> list[Sequence[Node]]:
    """Parts that repeat where the operations do.

    A long program is mostly a chain's joints, or their pairs and triples, one after the other.
    The cuts follow it: each comes, among the places in reach, where the surroundings are the most
    frequent in the program.
    """
    words = [_word(node, left) for node in nodes]
    around = [tuple(words[max(0, i - SURROUNDINGS) : i]) for i in range(len(nodes))]
    often = Counter(around)
    cuts = [0]
    while len(nodes) - cuts[-1] > LONGEST:
        reach = range(cuts[-1] + SHORTEST, cuts[-1] + LONGEST)
        cuts.append(max(reach, key=lambda i: (often[around[i]], around[i])))
    return [nodes[i:j] for i, j in zip(cuts, [*cuts[1:], len(nodes)], strict=True)]


def _word(node: Node, left: Left) -> str:
    """What an operation is, as far as others like it are the same."""
    op, args = left[node]
    return " ".join([op, *(a.op if isinstance(a, Node) else "number" for a in args)])


def crossing(parts: Sequence[Sequence[Node]], left: Left) -> tuple[dict[Node, int], int]:
    """Scratch vectors for values that a later part reads, and how many there are.

    A vector is free again when the last part that reads it is done.
    """
    home = {node: k for k, part in enumerate(parts) for node in part}
    last: dict[Node, int] = {}
    for k, part in enumerate(parts):
        for node in part:
            for a in left[node][1]:
                if isinstance(a, Node) and a.op != "input" and home[a] != k:
                    last[a] = k
    places: dict[Node, int] = {}
    ends: dict[int, list[int]] = {}
    free: list[int] = []
    size = 0
    for k, part in enumerate(parts):
        for node in part:
            if node in last:
                if not free:
                    free.append(size)
                    size += 1
                places[node] = free.pop()
                ends.setdefault(last[node], []).append(places[node])
        free.extend(reversed(ends.get(k, [])))
    return places, size
