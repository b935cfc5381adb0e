"""A robot with what its generated code takes as parameters: nothing, symbols, or inertias."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mcgee import arms, build
from mcgee.algorithms.parameters import with_parameters
from mcgee.closed_form.exact import PARAMETERS
from mcgee.graph.program import Program
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar, cos_sin

if TYPE_CHECKING:
    from mcgee.robot import Robot


@dataclass(frozen=True)
class Model:
    robot: Robot
    defaults: dict[str, float]
    """Of the parameters, in their order."""

    @property
    def symbolic(self) -> bool:
        """Whether the parameters are the description's symbols, not inertias of its bodies."""
        return bool(self.robot.symbols)

    def trace(self, quantity: str, *options: Any) -> Program:
        mechanism = self.robot.mechanism
        if self.symbolic:
            count = len(self.defaults)
            return build.trace_symbolic(mechanism, quantity, *options, symbols=count, put=self.put)
        parametric = bool(self.defaults) and quantity in build.PARAMETRIC
        return build.trace(mechanism, quantity, *options, parametric=parametric)

    def put(
        self,
        mechanism: Mechanism,
        values: list[Any] | None,
        number: Callable[[float], Scalar] = lambda x: x,
    ) -> Mechanism:
        """The mechanism with values of any scalar type in its parameters' places.

        Args:
            values: None for what takes no parameters
        """
        if values is None:
            return mechanism.map(number)
        if not self.symbolic:
            return with_parameters(mechanism.map(number), values)
        table = dict(zip(self.defaults, values, strict=True))
        return mechanism.map(lambda x: evaluated(x, table, number))


def model(robot: Robot, params: bool, values: Mapping[Any, float]) -> Model:
    """
    Raises: ValueError: symbols without values, or values that are no finite numbers or of what is
        no parameter
    """
    given = {str(name): _finite(str(name), value) for name, value in values.items()}
    if robot.symbols:
        return Model(robot, _chosen(robot.name, dict.fromkeys(robot.symbols), given))
    if not params:
        return Model(robot, _chosen(robot.name, {}, given))
    textbook = arms.symbolic(robot)
    if textbook is not None:
        symbolic, defaults = textbook
        return Model(symbolic, _chosen(robot.name, defaults, given))
    found = iter(map(float, robot.inertial_parameters))
    bodies = range(1, len(robot.mechanism.bodies) + 1)
    inertial = {f"{name}{k}": next(found) for k in bodies for name in PARAMETERS}
    return Model(robot, _chosen(robot.name, inertial, given))


def _finite(name: str, given: Any) -> float:
    try:
        value = float(given)
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"values gives '{name}' as {given!r}, expected a finite number.")
    return value


def _chosen(
    name: str, defaults: Mapping[str, float | None], given: Mapping[str, float]
) -> dict[str, float]:
    for key in given:
        if key not in defaults:
            known = ", ".join(defaults) or "none, for all its numbers are folded in"
            raise ValueError(
                f"values names '{key}', which is no parameter of '{name}'. Parameters: {known}."
            )
    found = {key: given.get(key, value) for key, value in defaults.items()}
    missing = [key for key, value in found.items() if value is None]
    if missing:
        raise ValueError(
            f"robot '{name}' has the symbols {', '.join(missing)} without values, which generated "
            f"code needs as defaults and for its self-test. Give them with "
            f"values={{{missing[0]!r}: 1.0, …}}."
        )
    return found  # type: ignore[return-value]  # None is gone


def evaluated(x: Scalar, table: Mapping[str, Any], number: Callable[[float], Scalar]) -> Scalar:
    """A SymPy expression over other scalars: sums, products, whole powers, cosines and sines."""
    if not hasattr(x, "free_symbols"):
        return number(x) if isinstance(x, float) else x
    if x.is_Symbol:
        return table[str(x)]
    if x.is_number:
        return number(float(x))
    of = [evaluated(a, table, number) for a in x.args]
    if x.is_Add or x.is_Mul:
        total, *rest = of
        for a in rest:
            total = total + a if x.is_Add else total * a
        return total
    if x.is_Pow and x.exp.is_Integer:
        power = of[0]
        for _ in range(abs(int(x.exp)) - 1):
            power = power * of[0]
        return power if x.exp > 0 else 1 / power
    if x.func.__name__ in ("cos", "sin"):
        return cos_sin(of[0])[x.func.__name__ == "sin"]
    raise ValueError(
        f"a parameter is {x}, expected sums, products, whole powers, cosines and sines of symbols: "
        f"what every language can write. Put a symbol of its own in the place of what is none."
    )
