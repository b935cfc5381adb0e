"""Derivatives of a program, as a program: the chain rule on the graph.

Folding and sharing happen as the new nodes are made, so that zeros cost nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mcgee.graph.node import Node, Value
from mcgee.graph.program import Array, Program

PARTIALS: dict[str, Callable[..., tuple[Value, ...]]] = {
    "add": lambda node, a, b: (1.0, 1.0),
    "sub": lambda node, a, b: (1.0, -1.0),
    "mul": lambda node, a, b: (b, a),
    "div": lambda node, a, b: (1.0 / b, -(node / b)),
    "neg": lambda node, a: (-1.0,),
    "cos": lambda node, a: (-node.graph.sin(a),),
    "sin": lambda node, a: (node.graph.cos(a),),
}
"""By operation, the derivatives of a node by its arguments."""


def jacobian(program: Program, by: Sequence[str], *, reverse: bool) -> Program:
    """The program that gives every output's derivatives by some inputs, each along a last axis.

    Forward: a sweep over the graph for each input element; reverse: for each output element.
    """
    inputs = [array for array in program.inputs if array.name in by]
    rows = (_reverse if reverse else _forward)(program)
    outputs, roots, start = [], [], 0
    for output in program.outputs:
        for array in inputs:
            name = f"d{output.name}_d{array.name}"
            outputs.append(Array(name, (*output.shape, array.size)))
            for row in rows[start : start + output.size]:
                roots += [row.get((array.name, k), 0.0) for k in range(array.size)]
        start += output.size
    return Program(program.name, program.inputs, tuple(outputs), tuple(roots))


Slopes = dict[tuple[str, int], Value]
"""By input element (name, index); what is missing is zero."""


def _forward(program: Program) -> list[Slopes]:
    slopes: dict[Node, Slopes] = {}
    for node in list(program.nodes):
        if node.op == "input":
            slopes[node] = {node.args: 1.0}
            continue
        own: Slopes = {}
        for a, partial in zip(node.args, PARTIALS[node.op](node, *node.args), strict=True):
            for element, slope in slopes[a].items() if isinstance(a, Node) else ():
                own[element] = own.get(element, 0.0) + partial * slope
        slopes[node] = own
    return [slopes[root] if isinstance(root, Node) else {} for root in program.roots]


def _reverse(program: Program) -> list[Slopes]:
    return [_adjoint(program, root) if isinstance(root, Node) else {} for root in program.roots]


def _adjoint(program: Program, root: Node) -> Slopes:
    slope: dict[Node, Value] = {root: 1.0}
    own: Slopes = {}
    for node in reversed(program.nodes):
        along = slope.pop(node, 0.0)
        if isinstance(along, float) and along == 0:
            continue
        if node.op == "input":
            own[node.args] = along
            continue
        for a, partial in zip(node.args, PARTIALS[node.op](node, *node.args), strict=True):
            if isinstance(a, Node):
                slope[a] = slope.get(a, 0.0) + partial * along
    return own
