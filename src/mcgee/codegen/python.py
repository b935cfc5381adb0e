"""Python: one module that needs NumPy alone, and computes whole batches."""

from __future__ import annotations

from mcgee.codegen.c import passed, signature
from mcgee.codegen.common import (
    TOLERANCE,
    VECTORS,
    Files,
    capital,
    filled,
    header,
    layout,
    readme,
    vectors,
    wrapped,
)
from mcgee.codegen.expression import Syntax, text
from mcgee.codegen.language import Language, Tool
from mcgee.codegen.names import pascal
from mcgee.codegen.routine import WORK, Item, Routine, Turn
from mcgee.codegen.statements import Style, pieces
from mcgee.codegen.unit import MEANINGS, Function, Unit
from mcgee.graph.program import Array


def files(unit: Unit) -> Files:
    name = unit.name
    return {
        f"{name}.py": source(unit),
        "selftest.py": selftest(unit),
        "pyproject.toml": _PYPROJECT.format(name=name.replace("_", "-"), module=name),
        "README.md": readme(
            unit,
            "Python",
            f"`{name}.py` needs NumPy alone; leading dimensions of arrays broadcast, and a single "
            f"state is computed in plain floats.",
            "Copy it, or `pip install` this folder.",
            "python selftest.py",
        ),
        **vectors(unit),
    }


_PYPROJECT = """[build-system]
requires = ["setuptools>=61"]
build-backend = "setuptools.build_meta"

[project]
name = "{name}"
version = "1.0.0"
requires-python = ">=3.8"
dependencies = ["numpy"]

[tool.setuptools]
py-modules = ["{module}"]
"""


def params_type(unit: Unit) -> str:
    return f"{pascal(unit.name)}Params"


def symbol(unit: Unit, f: Function) -> str:
    return f"{unit.name}_{f.name}"


class _Style(Style):
    def turn(self, step: Turn):  # type: ignore[no-untyped-def]
        """A single angle stays a plain float."""
        names = f"{step.cosine or '_'}, {step.sine or '_'}"
        yield f"{self.indent}{names} = _cos_sin({text(step.angle, self.syntax)})\n"


def style(unit: Unit, routine: Routine) -> Style:
    names = [p.identifier for p in unit.parameters]

    def item(i: Item) -> str:
        if i.array == "params":
            return f"params.{names[i.index]}"
        array = routine.array(i.array)
        if array in routine.outputs:
            return f"{i.array}[{', '.join(['...', *map(str, indices(array, i.index))])}]"
        return f"{i.array}[{i.index}]"

    return _Style(Syntax(item, continued=" \\"), let="{0} = {1}", put="{0} = {1}")


def indices(array: Array, index: int) -> list[int]:
    """Of an element counted row by row."""
    found: list[int] = []
    for size in reversed(array.shape):
        found.insert(0, index % size)
        index //= size
    return found


def source(unit: Unit) -> str:
    lines = "".join(f"{line}\n" for line in header(unit))
    parts = [f'"""{lines}"""\n\n']
    if unit.parameters:
        fields = "".join(f"    {p.identifier}: float = {p.value!r}\n" for p in unit.parameters)
        parts.append("from dataclasses import dataclass\n\nimport numpy as np\n\n\n")
        parts.append(f"@dataclass(frozen=True)\nclass {params_type(unit)}:\n")
        parts.append(f'    """The parameters, with their values in the description."""\n\n{fields}')
    else:
        parts.append("import numpy as np\n")
    parts += [definition(unit, f) for f in unit.functions]
    return "".join([*parts, _HELPERS])


def definition(unit: Unit, f: Function) -> str:
    own, routine = style(unit, f.routine), f.routine
    arguments = [a.name for a in f.state]
    if f.takes_parameters:
        arguments.append(f"params={params_type(unit)}()")
    head = f"\n\n{signature(f'def {symbol(unit, f)}', arguments)}:\n{_doc(f)}"
    names = ", ".join(a.name for a in f.state)
    read = ", ".join(f'("{a.name}", {a.name}, {a.size})' for a in f.state)
    head += f"    lead, [{names}] = _columns({read})\n"
    for a in f.outputs:
        shape = f"(*lead, {', '.join(map(str, a.shape))})" if a.shape else "lead"
        head += f"    {a.name} = np.empty({shape})\n"
    results = ", ".join(a.name if a.shape else f"{a.name}[()]" for a in f.outputs)
    end = f"    return {results}\n"
    if len(routine.parts) == 1:
        return f"{head}{own.body(routine.parts[0])}{end}"
    functions, calls = [], [f"    {WORK} = [None] * {routine.work}\n"]
    for piece in pieces(routine):
        name = f"_{f.name}_part{piece.number}"
        call = f"{name}({', '.join(passed(piece))})"
        functions.append(f"\n\ndef {call}:\n{own.body(piece.part)}")
        calls.append(f"    {call}\n")
    return "".join([head, *calls, end, *functions])


def _doc(f: Function) -> str:
    lines = [f"{capital(f.says)}.", "", "Args:"]
    lines += [f"    {a.name}: {MEANINGS[a.name]} (..., {a.size})" for a in f.state]
    if f.takes_parameters:
        lines.append("    params: numbers, by default the description's")
    gives = []
    for a in f.outputs:
        shape = ", ".join(["...", *map(str, a.shape)])
        gives.append(f"{a.name}, {MEANINGS[a.name]} ({shape})")
    lines += ["Returns:", *(f"    {line}" for line in wrapped(["; ".join(gives)]))]
    lines.append("Raises: ValueError: a last dimension is wrong, or leading ones do not broadcast")
    inside = "".join(f"    {line}".rstrip() + "\n" for line in lines)
    return f'    """{inside.lstrip()}    """\n'


_HELPERS = '''

def _columns(*arrays):
    """The leading shape, and of each array its elements: floats, or arrays of that shape."""
    found = []
    for name, given, size in arrays:
        array = np.asarray(given, float)
        if array.shape[-1:] != (size,):
            raise ValueError(f"{name} has shape {array.shape}, expected (..., {size})")
        found.append(array)
    lead = np.broadcast_shapes(*(array.shape[:-1] for array in found))
    if not lead:
        return lead, [array.tolist() for array in found]
    return lead, [list(np.moveaxis(array, -1, 0)) for array in found]


def _cos_sin(angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    return (float(cosine), float(sine)) if isinstance(angle, float) else (cosine, sine)
'''


# -- the self-test --------------------------------------------------------------------------------


def selftest(unit: Unit) -> str:
    return (
        f'"""Compares {unit.name} with the vectors; exits non-zero where one is missed."""\n\n'
        + filled(
            _SELFTEST,
            NAME=unit.name,
            TOLERANCE=str(TOLERANCE),
            VECTORS=VECTORS,
            PARAMS=f"robot.{params_type(unit)}" if unit.parameters else "None",
            TESTS="".join(_test(unit, f) for f in unit.functions),
        )
    )


def _test(unit: Unit, f: Function) -> str:
    row = layout(f)
    inputs = ", ".join(f'("{a.name}", {at}, {a.size})' for a, at in row.inputs)
    outputs = ", ".join(f"({at}, {a.size}, {s})" for a, at, s in row.outputs)
    given = [f'"{f.name}"', f"robot.{symbol(unit, f)}", f"[{inputs}]", f"[{outputs}]", row.width]
    return "    test(\n" + "".join(f"        {x},\n" for x in given) + "    ),\n"


_SELFTEST = '''import sys
from pathlib import Path

import numpy as np

import NAME as robot

FOLDER = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "VECTORS")
PARAMETERS = PARAMS


def errors(result, row, outputs):
    """In units in the last place of the scale; infinite where a result is NaN."""
    results = result if isinstance(result, tuple) else (result,)
    for got, (at, size, scale) in zip(results, outputs):
        difference = abs(np.ravel(got) - row[at : at + size])
        worst = (difference / (row[scale] * np.finfo(float).eps)).max()
        yield np.inf if np.isnan(worst) else worst


def test(name, compute, inputs, outputs, width):
    rows = np.loadtxt(FOLDER / f"{name}.txt", ndmin=2)
    assert rows.shape[1:] == (width,), f"the rows of {name} are not as they should be"
    worst = 0.0
    for k, row in enumerate(rows):
        given = []
        for key, at, size in inputs:
            part = row[at : at + size]
            if key == "params":
                part = PARAMETERS(*part.tolist())
                if k == 0 and part != PARAMETERS():
                    worst = np.inf  # the first row holds the description's
            given.append(part)
        worst = max(worst, *errors(compute(*given), row, outputs))
    state = [rows[:, at : at + size] for key, at, size in inputs if key != "params"]
    if len(state) == len(inputs):  # the whole batch in one call
        whole = compute(*state)
        whole = whole if isinstance(whole, tuple) else (whole,)
        for k, row in enumerate(rows):
            worst = max(worst, *errors(tuple(part[k] for part in whole), row, outputs))
    print(f"{name}: {len(rows)} states, largest error {worst:.3g} ulp")
    return worst <= TOLERANCE


passed = [
TESTS]
sys.exit(not all(passed))
'''


class _NumPy(Tool):
    """This Python, which has NumPy."""

    def found(self) -> str | None:
        import sys

        return sys.executable


PYTHON = Language(
    "python",
    "Python",
    files,
    tools=(_NumPy(("python",)),),
    build=lambda unit, tools: [],
    run=lambda unit, tools: [[tools[0], "-W", "error", "selftest.py"]],
)
