"""The one place where a mechanism and a quantity become a graph."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from mcgee import quantities
from mcgee.algorithms.parameters import TEN
from mcgee.algorithms.regroup import regrouped
from mcgee.graph.node import Graph, Value
from mcgee.graph.program import Array, Program
from mcgee.mechanism import Mechanism


@dataclass(frozen=True)
class Signature:
    """What a quantity takes (each (n,)) and gives; n and links stand for their numbers."""

    inputs: tuple[str, ...]
    outputs: tuple[tuple[str, tuple[int | str, ...]], ...]
    energy: bool = False
    """Whether single bodies matter, so that regrouped inertias will not do."""


def _gives(name: str, *shape: int | str) -> tuple[tuple[str, tuple[int | str, ...]], ...]:
    return ((name, shape),)


_SQUARE = ("n", "n")

SIGNATURES = {
    "mass_matrix": Signature(("q",), _gives("M", "n", "n")),
    "mass_matrix_inverse": Signature(("q",), _gives("Minv", "n", "n")),
    "coriolis": Signature(("q", "qd"), _gives("Cqd", "n")),
    "coriolis_matrix": Signature(("q", "qd"), _gives("C", "n", "n")),
    "coriolis_product": Signature(("q", "qd", "v"), _gives("Cv", "n")),
    "christoffel": Signature(("q",), _gives("c", "n", "n", "n")),
    "gravity": Signature(("q",), _gives("g", "n")),
    "gravity_gradient": Signature(("q",), _gives("dg_dq", "n", "n")),
    "terms": Signature(("q", "qd"), (("M", ("n", "n")), ("Cqd", ("n",)), ("g", ("n",)))),
    "inverse_dynamics": Signature(("q", "qd", "qdd"), _gives("tau", "n")),
    "forward_dynamics": Signature(("q", "qd", "tau"), _gives("qdd", "n")),
    "inverse_dynamics_derivatives": Signature(
        ("q", "qd", "qdd"), (("dtau_dq", _SQUARE), ("dtau_dqd", _SQUARE), ("M", _SQUARE))
    ),
    "forward_dynamics_derivatives": Signature(
        ("q", "qd", "tau"), (("dqdd_dq", _SQUARE), ("dqdd_dqd", _SQUARE), ("Minv", _SQUARE))
    ),
    "regressor": Signature(("q", "qd", "qdd"), _gives("Y", "n", "parameters")),
    "kinetic_energy": Signature(("q", "qd"), _gives("T")),
    "potential_energy": Signature(("q",), _gives("P"), energy=True),
    "forward_kinematics": Signature(("q",), _gives("T", 4, 4)),
    "jacobian": Signature(("q",), _gives("J", 6, "n")),
    "link_poses": Signature(("q",), _gives("T", "links", 4, 4)),
    "link_accelerations": Signature(("q", "qd", "qdd"), _gives("a", "links", 6)),
    "link_jacobians": Signature(("q",), _gives("J", "links", 6, "n")),
}


def trace(mechanism: Mechanism, quantity: str, *options: Any) -> Program:
    """Run the quantity's algorithm on graph nodes."""
    signature, graph, n = SIGNATURES[quantity], Graph(), mechanism.n
    inputs = tuple(Array(name, (n,)) for name in signature.inputs)
    nodes = [graph.inputs(array.name, n) for array in inputs]
    with _collection_paused():
        model = mechanism if signature.energy else regrouped(mechanism)
        result = getattr(quantities, quantity)(model, *nodes, *options)
    sizes = {"n": n, "links": len(mechanism.masses), "parameters": TEN * len(mechanism.bodies)}
    outputs = tuple(
        Array(name, tuple(sizes[size] if isinstance(size, str) else size for size in shape))
        for name, shape in signature.outputs
    )
    return Program(quantity, inputs, outputs, tuple(_flat(result)))


@contextmanager
def _collection_paused() -> Iterator[None]:
    """Tracing makes no garbage in cycles, and looking for some took 40 % of its time."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def _flat(result: Any) -> Iterator[Value]:
    if isinstance(result, (list, tuple)):
        for part in result:
            yield from _flat(part)
    else:
        yield result
