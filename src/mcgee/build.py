"""The one place where a mechanism and a quantity become a graph."""

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from mcgee import quantities
from mcgee.algorithms.frames import canonical, slid
from mcgee.algorithms.parameters import TEN, with_parameters
from mcgee.algorithms.regroup import regrouped
from mcgee.algorithms.runge_kutta import runge_kutta
from mcgee.algorithms.turns import COMPOSITES, NEWTON_EULER, STATICS
from mcgee.graph.differentiate import jacobian
from mcgee.graph.node import Graph, LimitError, Node, Value
from mcgee.graph.program import LONG, Array, Program
from mcgee.mechanism import Mechanism


@dataclass(frozen=True)
class Signature:
    """What a quantity takes (each (n,), parameters apart) and gives.

    n, links and parameters (ten a body) stand for their numbers.
    """

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

OF_A_FRAME = ("forward_kinematics", "jacobian")
"""Their option is the name of a frame."""


PARAMETRIC = {
    name: replace(signature, inputs=(*signature.inputs, "parameters"))
    for name, signature in SIGNATURES.items()
    if not {size for _, shape in signature.outputs for size in shape}
    & {"links", "parameters", 4, 6}
}
"""What depends on inertias: the same with the inertial parameters as one more input."""


def signature(quantity: str, parametric: bool = False) -> Signature:
    return (PARAMETRIC if parametric else SIGNATURES)[quantity]


def width(mechanism: Mechanism, name: str) -> int:
    """How many numbers an input of this name holds."""
    return TEN * len(mechanism.bodies) if name == "parameters" else mechanism.n


ALTERNATIVES = {"forward_dynamics": ("forward_dynamics_by_elimination",)}
"""Other ways to the same quantity, which may take fewer operations where joints are few."""

COSTS = {
    **dict.fromkeys(("mass_matrix", "mass_matrix_inverse"), COMPOSITES),
    **dict.fromkeys(("gravity", "gravity_gradient"), STATICS),
}
"""What tells which turns of frames save operations; Newton-Euler's for the rest."""

SLID_ALONE = (*OF_A_FRAME, "link_poses", "link_jacobians", "link_accelerations", "regressor")
"""Whose frames are not turned: the regressor is in the bodies' axes, and in poses of links the
rounding of turned constants would be seen: 3.1 units of a general arm's last place, not 1.3."""

SHORT, FEW = 40, 8
"""Joints up to which ways of higher order are tried: elimination, and derivatives of the graph."""


def trace(mechanism: Mechanism, quantity: str, *options: Any, parametric: bool = False) -> Program:
    """Run the quantity's algorithm on graph nodes; of several ways, that with fewest operations.

    Regrouping known inertias costs nothing. Inertias that are inputs are regrouped where that
    saves more operations than it takes.
    """
    ways = (quantity, *ALTERNATIVES.get(quantity, ())) if mechanism.n <= SHORT else (quantity,)
    regroup = (False, True) if parametric else (True,)
    if signature(quantity).energy:
        regroup = (False,)
    with collection_paused():
        programs = [
            _traced(mechanism, quantity, way, options, parametric, yes)
            for way in ways
            for yes in regroup
        ]
        if quantity == "inverse_dynamics_derivatives" and mechanism.n <= FEW:
            tau = trace(mechanism, "inverse_dynamics", parametric=parametric)
            programs.append(_differentiated(tau, programs[0].outputs))
    return min(programs, key=Program.arithmetic)


def trace_symbolic(
    mechanism: Mechanism,
    quantity: str,
    *options: Any,
    symbols: int,
    put: Callable[[Mechanism, list[Node]], Mechanism],
) -> Program:
    """As `trace`, with symbols of the mechanism as one more input, called params.

    Args:
        symbols: how many
        put: the mechanism with these nodes in the symbols' places
    """
    inputs, outputs = arrays(mechanism, quantity)
    inputs = (*inputs, Array("params", (symbols,)))
    ways = (quantity, *ALTERNATIVES.get(quantity, ())) if mechanism.n <= SHORT else (quantity,)

    def on(way: str, regroup: bool) -> Program:
        graph = Graph()
        *state, given = [graph.inputs(array.name, array.size) for array in inputs]
        model = put(mechanism, given)
        model = regrouped(model) if regroup else model
        result = getattr(quantities, way)(model, *state, *options)
        return Program(quantity, inputs, outputs, tuple(_flat(result)))

    choices = (False,) if signature(quantity).energy else (False, True)
    with collection_paused():
        programs = [on(way, regroup) for way in ways for regroup in choices]
    return min(programs, key=Program.arithmetic)


def trace_step(mechanism: Mechanism, viscous: Sequence[float]) -> Program:
    """One step of the classical Runge-Kutta method: (q, qd, tau, h) -> (q, qd).

    Args:
        viscous: friction of the coordinates (n,), zeros for none
    """
    n, way = mechanism.n, "forward_dynamics"
    if n <= SHORT:
        ways = ("forward_dynamics", *ALTERNATIVES["forward_dynamics"])
        way = min(ways, key=lambda w: _traced(mechanism, way, w, (), False, True).arithmetic())
    vector, model = Array("q", (n,)), regrouped(_with_frames(mechanism, way, turned=True))
    inputs = (vector, Array("qd", (n,)), Array("tau", (n,)), Array("h", ()))
    with collection_paused():
        graph = Graph()
        q, qd, tau, (h,) = (graph.inputs(array.name, array.size) for array in inputs)
        result = runge_kutta(partial(getattr(quantities, way), model), q, qd, tau, h, viscous)
    return Program("rollout", inputs, inputs[:2], tuple(_flat(result)))


def _differentiated(tau: Program, outputs: tuple[Array, ...]) -> Program:
    """Inverse dynamics' derivatives on its graph, M symmetric to the last bit."""
    roots = jacobian(tau, ("q", "qd", "qdd"), reverse=False).roots
    n, size = outputs[0].shape[0], outputs[0].size
    M = [roots[2 * size + max(i, j) * n + min(i, j)] for i in range(n) for j in range(n)]
    name = "inverse_dynamics_derivatives"
    return Program(name, tau.inputs, outputs, (*roots[: 2 * size], *M))


def _traced(
    mechanism: Mechanism,
    quantity: str,
    way: str,
    options: tuple,
    parametric: bool,
    regroup: bool,
) -> Program:
    inputs, outputs = arrays(mechanism, quantity, parametric)

    def on(graph: Graph) -> Program:
        nodes = [graph.inputs(array.name, array.size) for array in inputs]
        model = with_parameters(mechanism, nodes.pop()) if parametric else mechanism
        if not parametric and regroup:
            model = _with_frames(mechanism, quantity, turned=not graph.signed)
        if regroup:
            model = regrouped(model)
        result = getattr(quantities, way)(model, *nodes, *options)
        return Program(quantity, inputs, outputs, tuple(_flat(result)))

    try:
        program = on(Graph(limit=2 * LONG))  # some nodes turn out not to be needed
    except LimitError:
        return on(Graph(signed=True))
    return program if len(program.nodes) <= LONG else on(Graph(signed=True))


def _with_frames(mechanism: Mechanism, quantity: str, turned: bool) -> Mechanism:
    """The mechanism with its frames where the quantity takes few operations.

    Args:
        turned: not where joints should be alike, which turns make less so
    """
    if quantity in SLID_ALONE or not turned:
        return slid(mechanism)
    return canonical(mechanism, COSTS.get(quantity, NEWTON_EULER))


def arrays(
    mechanism: Mechanism, quantity: str, parametric: bool = False
) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """What the quantity takes and gives, for one state."""
    takes = signature(quantity, parametric)
    inputs = tuple(Array(name, (width(mechanism, name),)) for name in takes.inputs)
    sizes = {"n": mechanism.n, "links": len(mechanism.masses)}
    sizes["parameters"] = width(mechanism, "parameters")
    outputs = tuple(
        Array(name, tuple(sizes[size] if isinstance(size, str) else size for size in shape))
        for name, shape in takes.outputs
    )
    return inputs, outputs


def operation_counts(
    mechanism: Mechanism, frame: str, names: Sequence[str] = (), parametric: bool = False
) -> dict[str, dict[str, int]]:
    """Of the named quantities or all that exist for the mechanism, those of frames at the given.

    Raises: ValueError: a name of no quantity
    """
    known = PARAMETRIC if parametric else SIGNATURES
    for name in names:
        if name not in known:
            raise ValueError(f"there is no quantity {name!r}; there are {', '.join(known)}.")
    counts = {}
    for name in names or known:
        options = (frame,) if name in OF_A_FRAME else ()
        try:
            program = trace(mechanism, name, *options, parametric=parametric)
        except ZeroDivisionError:  # M is singular in every pose
            continue
        counts[name] = program.operation_counts()
    return counts


@contextmanager
def collection_paused() -> Iterator[None]:
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
