"""Whether a graph is legal: the rules in the docstring of mcgee.graph.node, as a checker."""

from __future__ import annotations

import math
from collections.abc import Iterable

from mcgee.graph.node import OPERATIONS, Node


def violations(nodes: Iterable[Node]) -> list[str]:
    """One sentence for each broken rule; an empty list for a legal graph."""
    found: list[str] = []
    seen: set[tuple] = set()
    for node in nodes:
        if node.op == "input":
            continue
        if len(node.args) != OPERATIONS[node.op].arity:
            found.append(f"{node} has the wrong number of arguments")
        inner = [a for a in node.args if isinstance(a, Node)]
        constants = [a for a in node.args if not isinstance(a, Node)]
        if any(a.index >= node.index for a in inner):
            found.append(f"{node} comes before its argument")
        key = (node.op, *(_name(a) for a in _ordered(node)))
        if key in seen:
            found.append(f"{node} is there twice")
        seen.add(key)
        if any(a.op == "neg" for a in inner):
            found.append(f"{node} could absorb the sign of its argument")
        if not inner:
            found.append(f"{node} is an operation on constants")
        elif constants:
            found += [f"{node} {why}" for why in _unfolded(node, constants[0], inner[0])]
        if node.op == "sub" and ("sub", *(_name(a) for a in reversed(node.args))) in seen:
            found.append(f"{node} is the negation of another difference")
        if node.op in ("add", "sub", "mul") and not isinstance(node.args[-1], Node):
            found.append(f"{node} has its constant on the right")
    return found


def _unfolded(node: Node, k: float, other: Node) -> Iterable[str]:
    """Reasons why the constant argument should have folded away or into its neighbour."""
    if not isinstance(k, float):
        yield "holds a constant that is no float"
    if k == 0 and not (
        node.op == "div" and node.args[0] is other
    ):  # a quotient by zero is the text's own
        yield "holds a zero"
    if node.op in ("mul", "div") and k < 0:
        yield "holds a sign that could move outward"
    if node.op == "mul" and k == 1:
        yield "multiplies by one"
    if node.op == "mul" and other.op == "mul" and _has_constant(other):
        yield "multiplies a constant product by a constant"
    if node.op in ("add", "sub") and other.op in ("add", "sub") and _has_constant(other):
        yield "adds a constant to a constant sum"
    if node.op == "div" and node.args[0] is other and abs(math.frexp(k)[0]) == 0.5:
        yield "divides by a power of two"


def _has_constant(node: Node) -> bool:
    return any(not isinstance(a, Node) for a in node.args)


def _name(a: Node | float) -> str:
    return f"%{a.index}" if isinstance(a, Node) else repr(a)


def _ordered(node: Node) -> tuple:
    """Arguments in one order where the order does not matter."""
    if not OPERATIONS[node.op].commutes:
        return node.args
    return tuple(sorted(node.args, key=_name))
