"""Wolfram's language: a package with T and P in symbols, what derives from them, and numbers.

Written for Mathematica and for Mathics, which lacks some of it: Sum takes no D inside, ReadList no
RecordLists.
"""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from mcgee.closed_form import ClosedForm
from mcgee.codegen.common import (
    TOLERANCE,
    VECTORS,
    Files,
    comment,
    describes,
    header,
    readme,
    vectors,
    wrapped,
)
from mcgee.codegen.expression import WIDTH, lines, text
from mcgee.codegen.language import Language, Tool
from mcgee.codegen.names import pascal, words
from mcgee.codegen.routine import WORK, Expression, Item, Let, Operation, Put, Turn, op
from mcgee.codegen.unit import Function, Unit
from mcgee.codegen.wolfram_symbolic import (
    SYMBOLIC,
    Symbols,
    called,
    enclosed,
    energies,
    listed,
    number,
    numeric,
    template,
    written_out,
)
from mcgee.graph.program import Array

DERIVED_TOLERANCE = 1e-9
"""Relative to a result's scale: closed forms hold the decimals of a description, not the floats."""

STATES, STATES_OF_BODIES = 3, 1
"""Of the vectors at which derived terms are tried: Mathics takes seconds for each."""

MOST_BODIES = 7
"""With more Mathics takes minutes."""

OF_VELOCITIES = ("kinetic_energy", "coriolis_matrix", "coriolis_forces")


def files(unit: Unit) -> Files:
    name, form = context(unit), written_out(unit)
    return {
        f"{name}.wl": package(unit, form),
        "selftest.wl": selftest(unit, form),
        "README.md": readme(
            unit,
            "Wolfram's language",
            f"`{name}.wl` is a package for Mathematica and Mathics with T and P in symbols, "
            "and with M, the Christoffel symbols, C and g derived from them.",
            f'Load it with `Get["{name}.wl"]`; `?{Symbols(unit).own("*")}` lists what it holds.',
            "wolframscript -f selftest.wl` or `mathics -f selftest.wl",
        ),
        **vectors(unit),
    }


def context(unit: Unit) -> str:
    return f"{pascal(unit.name)}Dynamics"


def package(unit: Unit, form: ClosedForm | None) -> str:
    head = comment(header(unit), "(*", "   ", "*)")
    own = Symbols(unit)
    derived = own.filled(template("derived"))
    if unit.parameters:
        derived += "\n" + own.filled(template("values"), names=_wrapped(own.parameters, 3))
    functions = [definition(unit, f) for f in unit.functions]
    name = context(unit)
    return (
        f'{head}\nBeginPackage["{name}`"]\n\n'
        f'Quiet[ClearAll["{name}`*", "{name}`Private`*"]] (* of an earlier version *)\n\n'
        f'{"".join(_usages(unit))}{_parameters(unit)}\nBegin["`Private`"]\n\n'
        + "\n".join([energies(unit, form), derived, *functions])
        + "\nEnd[]\n\nEndPackage[]\n"
    )


# -- what the package says of itself --------------------------------------------------------------


def _usages(unit: Unit) -> Iterator[str]:
    own = Symbols(unit)
    more = {
        "kinetic_energy": [f"Joints: {'; '.join(unit.joints)}."],
        "coriolis_matrix": ["Mdot - 2 C is skew-symmetric."],
        "gravity_vector": unit.conventions,
    }
    for name, says in SYMBOLIC.items():
        given = "q, qdot" if name in OF_VELOCITIES else "q"
        yield _usage(own.own(name), f"[{given}] is {says}.", more.get(name, []))
    for f in unit.functions:
        given = ", ".join(a.name for a in f.inputs)
        arrays = map(describes, (*f.state, *f.outputs))
        names = listed(a.name for a in f.outputs)
        result = f"{names}: " if len(f.outputs) > 1 else ""
        yield _usage(own.own(numeric(f)), f"[{given}] is {result}{f.says}.", arrays)
    for p, symbol in zip(unit.parameters, own.parameters, strict=True):
        says = f" is the parameter {words(p.name)} in SI units, {p.value!r} in the description."
        yield _usage(symbol, says)


def _usage(symbol: str, says: str, more: Iterable[str] = ()) -> str:
    text = "\n".join(wrapped([f"{symbol}{says}", *more]))
    return f'{symbol}::usage =\n  "{text}";\n'


def _parameters(unit: Unit) -> str:
    own = Symbols(unit)
    names = zip(own.parameters, unit.parameters, strict=True)
    rules = [f"{name} -> {number(p.value)}" for name, p in names]
    says = (
        " are rules with the values of the description. Functions of params take such rules, or "
        "all the numbers in this order; what is left out has these values."
    )
    symbol = own.own("parameters")
    return f"{_usage(symbol, says)}\n{symbol} = {_wrapped(rules, 2)};\n"


def _wrapped(items: Iterable[str], indent: int) -> str:
    """A list on lines that are full."""
    whole = [item.replace(" ", "\0") for item in items]
    text = textwrap.fill(
        listed(whole),
        WIDTH - indent,
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return text.replace("\0", " ")


# -- numbers --------------------------------------------------------------------------------------


def definition(unit: Unit, f: Function) -> str:
    own = Symbols(unit)
    given = [own.each_of(a.name) for a in f.state]
    body = Block(own)
    if f.takes_parameters:
        given.append("params_List : {}")
        body.locals += own.parameters
        body.say(f"{_wrapped(own.parameters, 3)} = values[params]")
    body.run(f)
    results = [body.result(a) for a in f.outputs]
    whole = results[0] if len(results) == 1 else enclosed(results)
    return (
        f"{called(own.own(numeric(f)), *given)} := Block[\n"
        f"  {_wrapped(body.locals, 3)},\n{''.join(body.statements)}"
        f"{textwrap.indent(whole, '  ')}]\n"
    )


class Block:
    """A routine's parts as the statements of one Block: a kernel reads functions of any length.

    A Module would give all names new ones at each call.
    """

    def __init__(self, own: Symbols):
        self.own, self.syntax = own, replace(own.syntax, item=self._item)
        self.locals: list[str] = []
        self.statements: list[str] = []
        self.work: dict[int, str] = {}
        """What is in the work array at the moment."""
        self.results: dict[Item, str] = {}

    def run(self, f: Function) -> None:
        for step in (step for part in f.routine.parts for step in part):
            if isinstance(step, Turn):
                for name, function in ((step.cosine, "cos"), (step.sine, "sin")):
                    if name is not None:
                        self._let(name, op(function, step.angle))
            elif isinstance(step, Let):
                self._let(step.name, step.value)
            elif step.place.array == WORK:
                self._leave(step)
            else:
                self.results[step.place] = text(step.value, self.syntax)

    def result(self, array: Array) -> str:
        """An output as nested lists."""
        places = (Item(array.name, i) for i in range(array.size))
        items = [lines(self.results[i], "", self.syntax).rstrip() for i in places]
        for size in reversed(array.shape):
            items = [enclosed(items[i : i + size]) for i in range(0, len(items), size)]
        return items[0]

    def say(self, statement: str) -> None:
        self.statements.append(lines(f"{statement};", "  ", self.syntax))

    def _let(self, name: str, value: Expression) -> str:
        self.locals.append(self.own.local(name))
        self.say(f"{self.locals[-1]} = {text(value, self.syntax)}")
        return self.locals[-1]

    def _leave(self, step: Put) -> None:
        """A name instead of a place that later values take in turn."""
        if isinstance(step.value, Operation):
            self.work[step.place.index] = self._let(f"w{len(self.locals)}", step.value)
        else:
            self.work[step.place.index] = text(step.value, self.syntax)

    def _item(self, i: Item) -> str:
        return self.work[i.index] if i.array == WORK else self.own.element(i)


# -- the self-test --------------------------------------------------------------------------------


DERIVED = {
    "dynamics": "{<mass_matrix>[q], <coriolis_forces>[q, qdot], <gravity_vector>[q]}",
    "inverse_dynamics": "<mass_matrix>[q] . qddot + <coriolis_forces>[q, qdot]"
    " + <gravity_vector>[q]",
    "mass_matrix": "<mass_matrix>[q]",
    "coriolis": "<coriolis_forces>[q, qdot]",
    "coriolis_matrix": "<coriolis_matrix>[q, qdot]",
    "christoffel": "<christoffel>[q]",
    "gravity": "<gravity_vector>[q]",
    "kinetic_energy": "<kinetic_energy>[q, qdot]",
    "potential_energy": "<potential_energy>[q]",
}
"""What numeric functions give, by what derives from T and P."""


def selftest(unit: Unit, form: ClosedForm | None) -> str:
    few = STATES_OF_BODIES if len(unit.robot.mechanism.bodies) <= MOST_BODIES else 0
    states = STATES if form else few
    tests = [test for f in unit.functions for test in _tests(unit, f, states)]
    return Symbols(unit).filled(
        template("selftest"),
        package=context(unit),
        vectors=VECTORS,
        tests=textwrap.indent(",\n".join(tests), "  "),
    )


def _tests(unit: Unit, f: Function, states: int) -> Iterator[str]:
    """Of its numbers, and of what is derived at so many states."""
    own = Symbols(unit)
    sizes = ", ".join(listed(str(a.size) for a in arrays) for arrays in (f.inputs, f.outputs))
    yield f'test["{f.name}", "", Infinity, {sizes},\n  {own.own(numeric(f))}, {TOLERANCE}]'
    if f.takes_parameters:
        values = f"Map[Last, {own.own('parameters')}]"
        yield f'standard["{f.name}", {sizes}, {values}]'
    if f.name in DERIVED and states:
        terms = own.filled(DERIVED[f.name])
        if f.takes_parameters:
            names = _wrapped(own.parameters, 6)
            terms = f"Block[\n    {names},\n    {names} = params;\n    {terms}]"
        given = listed(a.name for a in f.inputs)
        tolerance = round(DERIVED_TOLERANCE / 2**-52)
        yield (
            f'test["{f.name}", " from T and P", {states}, {sizes},\n'
            f"  Function[{given}, {terms}],\n  {tolerance}]"
        )


# -- a kernel -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Kernel(Tool):
    """Wolfram's, or Mathics, which may be where this Python is and not on the path."""

    def found(self) -> str | None:
        beside = Path(sys.executable).parent / "mathics"
        return Tool.found(self) or shutil.which(str(beside))


WOLFRAM = Language(
    "wolfram",
    "Wolfram language",
    files,
    tools=(Kernel(("wolframscript", "mathics"), get="pip install Mathics3"),),
    build=lambda unit, tools: [],
    run=lambda unit, tools: [[tools[0], "-f", "selftest.wl"]],
)
