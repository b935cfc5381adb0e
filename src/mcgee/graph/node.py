"""The expression graph: nodes that fold and share themselves as they are made.

A legal graph: every node comes after its arguments; no two nodes are the same operation on the
same arguments, and of a difference and its opposite only one is a node; no argument is a constant
that the operation could have folded; a negation is an argument of nothing, for every operation
passes its sign on. Folding never changes the order of a sum or a
product of non-constants, so a graph computes what its source text said.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Number = float | int


@dataclass(frozen=True)
class Operation:
    arity: int
    evaluate: Callable
    commutes: bool = False


OPERATIONS = {
    "add": Operation(2, np.add, commutes=True),
    "sub": Operation(2, np.subtract),
    "mul": Operation(2, np.multiply, commutes=True),
    "div": Operation(2, np.divide),
    "neg": Operation(1, np.negative),
    "cos": Operation(1, np.cos),
    "sin": Operation(1, np.sin),
}


class Node:
    """One operation on earlier nodes or constants; made by `Graph`, combined by arithmetic."""

    __slots__ = ("args", "graph", "index", "op")
    __array_ufunc__ = None  # NumPy scalars leave arithmetic with nodes to the nodes
    __hash__ = object.__hash__

    def __init__(self, graph: Graph, op: str, args: tuple, index: int):
        self.graph, self.op, self.args, self.index = graph, op, args, index

    def __repr__(self) -> str:
        inside = ", ".join(f"%{a.index}" if isinstance(a, Node) else repr(a) for a in self.args)
        return f"%{self.index} = {self.op}({inside})"

    def __add__(self, other: Value) -> Value:
        return self.graph.add(self, other)

    def __radd__(self, other: Value) -> Value:
        return self.graph.add(other, self)

    def __sub__(self, other: Value) -> Value:
        return self.graph.add(self, -other)

    def __rsub__(self, other: Value) -> Value:
        return self.graph.add(other, -self)

    def __mul__(self, other: Value) -> Value:
        return self.graph.mul(self, other)

    def __rmul__(self, other: Value) -> Value:
        return self.graph.mul(other, self)

    def __truediv__(self, other: Value) -> Value:
        return self.graph.div(self, other)

    def __rtruediv__(self, other: Value) -> Value:
        return self.graph.div(other, self)

    def __neg__(self) -> Value:
        return self.graph.neg(self)

    def cos_sin(self) -> tuple[Value, Value]:
        return self.graph.cos(self), self.graph.sin(self)


Value = Node | Number


class LimitError(Exception):
    """A graph has reached its limit."""


class Graph:
    """An arena of nodes in which equal expressions are one node.

    Args:
        limit: nodes at which `LimitError` is raised
        signed: whether a constant factor keeps its sign. Without it goes to the product, which
            makes more expressions equal; with it what repeats with other constants stays alike.
    """

    def __init__(self, limit: float = math.inf, signed: bool = False) -> None:
        self.limit, self.signed = limit, signed
        self.nodes: list[Node] = []
        self._known: dict[tuple, Node] = {}

    def inputs(self, name: str, size: int) -> list[Node]:
        """Nodes for the elements of an input array."""
        return [self._node("input", name, i) for i in range(size)]

    def _node(self, op: str, *args: Any) -> Node:
        if op in OPERATIONS and OPERATIONS[op].commutes and _order(args[0]) > _order(args[1]):
            args = (args[1], args[0])
        key = (op, *args)
        node = self._known.get(key)
        if node is None:
            node = self._known[key] = Node(self, op, args, len(self.nodes))
            self.nodes.append(node)
            if node.index > self.limit:
                raise LimitError
        return node

    def add(self, a: Value, b: Value) -> Value:
        if not isinstance(a, Node):
            a, b = b, a
        if not isinstance(a, Node):
            return float(a) + float(b)  # type: ignore[arg-type]
        if not isinstance(b, Node):
            return self._plus_constant(a, float(b))
        if a.op == "neg" and b.op == "neg":
            return self.neg(self.add(a.args[0], b.args[0]))
        if a.op == "neg":
            a, b = b, a
        if b.op == "neg":
            return self._minus(a, b.args[0])
        return self.mul(a, 2.0) if a is b else self._node("add", a, b)

    def _plus_constant(self, a: Node, k: float) -> Value:
        if k == 0:
            return a
        if a.op == "neg":
            return self._constant_minus(k, a.args[0])
        if a.op == "add" and not isinstance(a.args[0], Node):
            return self._plus_constant(a.args[1], a.args[0] + k)
        if a.op == "sub" and not isinstance(a.args[0], Node):
            return self._constant_minus(a.args[0] + k, a.args[1])
        return self._node("add", k, a)

    def _constant_minus(self, k: float, b: Node) -> Value:
        if b.op == "add" and not isinstance(b.args[0], Node):
            return self._constant_minus(k - b.args[0], b.args[1])
        return self._node("sub", k, b) if k != 0 else self.neg(b)

    def _minus(self, a: Node, b: Node) -> Value:
        if a is b:
            return 0.0
        turned = self._known.get(("sub", b, a))
        return self._node("sub", a, b) if turned is None else self.neg(turned)

    def mul(self, a: Value, b: Value) -> Value:
        if not isinstance(a, Node):
            a, b = b, a
        if not isinstance(a, Node):
            return float(a) * float(b)  # type: ignore[arg-type]
        if not isinstance(b, Node):
            return self._times_constant(a, float(b))
        if (a.op == "neg") != (b.op == "neg"):
            a, b = (x.args[0] if x.op == "neg" else x for x in (a, b))
            return self.neg(self.mul(a, b))
        if a.op == "neg":
            a, b = a.args[0], b.args[0]
        return self._node("mul", a, b)

    def _times_constant(self, a: Node, k: float) -> Value:
        if k == 0:
            return 0.0
        if a.op == "neg":
            a, k = a.args[0], -k
        if k == 1:
            return a
        if k == -1 or (k < 0 and not self.signed):
            return self.neg(self._times_constant(a, -k))
        if a.op == "mul" and not isinstance(a.args[0], Node):
            return self._times_constant(a.args[1], a.args[0] * k)
        return self._node("mul", k, a)

    def div(self, a: Value, b: Value) -> Value:
        if not isinstance(a, Node):
            a = float(a)
            if not isinstance(b, Node):
                return a / float(b)
            if a == 0:
                return 0.0
        if not isinstance(b, Node):
            b = float(b)
            # exact for powers of two; a quotient of nodes and odd numbers stays a quotient
            if math.frexp(b)[0] in (0.5, -0.5) and math.isfinite(1 / b):
                return self.mul(a, 1 / b)
        negative = _is_negative(a) != _is_negative(b)
        quotient = self._node("div", *(self.neg(x) if _is_negative(x) else x for x in (a, b)))
        return self.neg(quotient) if negative else quotient

    def neg(self, a: Value) -> Value:
        if not isinstance(a, Node):
            return -a
        if a.op == "neg":
            return a.args[0]
        if a.op == "sub" and not isinstance(a.args[0], Node):
            return self.add(a.args[1], -a.args[0])
        return self._node("neg", a)

    def cos(self, a: Node) -> Value:
        return self._node("cos", a.args[0] if a.op == "neg" else a)

    def sin(self, a: Node) -> Value:
        return self.neg(self._node("sin", a.args[0])) if a.op == "neg" else self._node("sin", a)


def _is_negative(a: Value) -> bool:
    """Whether a sign can be taken off."""
    return a.op == "neg" if isinstance(a, Node) else a < 0


def _order(a: Value) -> int:
    """Constants first, then nodes by age."""
    return a.index if isinstance(a, Node) else -1
