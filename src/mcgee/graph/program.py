"""A traced function: named inputs, named outputs, and the nodes between them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from mcgee.graph.node import OPERATIONS, Node, Value

LONG = 60_000
"""Nodes from which on a program is cut where it repeats, and should repeat."""


@dataclass(frozen=True)
class Array:
    name: str
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        return math.prod(self.shape)


@dataclass(frozen=True)
class Program:
    """roots holds the elements of the outputs, in order, row by row."""

    name: str
    inputs: tuple[Array, ...]
    outputs: tuple[Array, ...]
    roots: tuple[Value, ...]

    @cached_property
    def nodes(self) -> list[Node]:
        """The nodes that the outputs need, arguments first, in the order they were made."""
        needed: set[Node] = set()
        stack = [root for root in self.roots if isinstance(root, Node)]
        while stack:
            node = stack.pop()
            if node not in needed:
                needed.add(node)
                stack.extend(a for a in node.args if isinstance(a, Node))
        return sorted(needed, key=lambda node: node.index)

    def operation_counts(self) -> dict[str, int]:
        """Additions, multiplications, divisions, negations and sine-cosine pairs.

        fma is how many of the additions take a product into one instruction where the machine
        has that, instructions how many are then left of the first four.
        """
        count = Counter(node.op for node in self.nodes)
        angles = {node.args[0] for node in self.nodes if node.op in ("cos", "sin")}
        fused = fusions(self)
        remaining = live(self, fused)
        return {
            "add": count["add"] + count["sub"],
            "mul": count["mul"],
            "div": count["div"],
            "neg": count["neg"],
            "sincos": len(angles),
            "fma": sum(node in fused for node in remaining),
            "instructions": sum(node.op not in ("input", "cos", "sin") for node in remaining),
        }

    def arithmetic(self) -> int:
        """Additions, multiplications and divisions, together."""
        return sum(node.op in ("add", "sub", "mul", "div") for node in self.nodes)


# -- fused multiply-add ---------------------------------------------------------------------------


def fusions(program: Program) -> dict[Node, Node]:
    """For each sum that takes a product into one rounding, that product."""
    uses = Counter(a for node in program.nodes for a in node.args if isinstance(a, Node))
    uses.update(root for root in program.roots if isinstance(root, Node))
    fused = {}
    for node in program.nodes:
        if node.op in ("add", "sub"):
            products = [a for a in node.args if isinstance(a, Node) and a.op == "mul"]
            if products:
                fused[node] = min(products, key=lambda a: (uses[a], -a.index))
    return fused


def left(node: Node, fused: Mapping[Node, Node]) -> tuple[str, tuple[Value, ...]]:
    """The operation that is left of a node, and what it reads.

    muladd(a, b, c) = a b + c, mulsub(a, b, c) = a b - c, submul(c, a, b) = c - a b.
    """
    product = fused.get(node)
    if product is None:
        return node.op, node.args if node.op != "input" else ()
    a, b = node.args
    if node.op == "add":
        return "muladd", (*product.args, b if a is product else a)
    if a is product:
        return "mulsub", (*product.args, b)
    return "submul", (a, *product.args)


def live(program: Program, fused: Mapping[Node, Node]) -> dict[Node, tuple[str, tuple[Value, ...]]]:
    """What is left of the nodes when fused products have gone, in order."""
    needed = {root for root in program.roots if isinstance(root, Node)}
    found = []
    for node in reversed(program.nodes):
        if node in needed:
            found.append((node, left(node, fused)))
            needed.update(a for a in found[-1][1][1] if isinstance(a, Node))
    return dict(reversed(found))


# -- the reference interpreter ---------------------------------------------------------------------


def evaluate(program: Program, *arrays: Any) -> list[np.ndarray]:
    """The reference interpreter: each node a NumPy operation on whole batches."""
    given = {
        array.name: np.asarray(values, float)
        for array, values in zip(program.inputs, arrays, strict=True)
    }
    lead = np.broadcast_shapes(*(values.shape[:-1] for values in given.values()))
    known: dict[Node, np.ndarray] = {}
    for node in program.nodes:
        if node.op == "input":
            name, i = node.args
            known[node] = np.broadcast_to(given[name][..., i], lead)
        else:
            args = [known[a] if isinstance(a, Node) else a for a in node.args]
            known[node] = OPERATIONS[node.op].evaluate(*args)
    columns = [
        known[root] if isinstance(root, Node) else np.full(lead, float(root))
        for root in program.roots
    ]
    results, start = [], 0
    for array in program.outputs:
        flat = np.stack(columns[start : start + array.size], axis=-1)
        results.append(flat.reshape(lead + array.shape))
        start += array.size
    return results
