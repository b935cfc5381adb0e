"""JavaScript: an ES module for browsers and Node.js."""

from __future__ import annotations

import json
from collections.abc import Sequence

from mcgee.codegen.c import passed, signature
from mcgee.codegen.common import (
    TOLERANCE,
    VECTORS,
    Files,
    comment,
    describes,
    filled,
    header,
    layout,
    readme,
    vectors,
)
from mcgee.codegen.expression import Syntax
from mcgee.codegen.language import Language, Tool
from mcgee.codegen.names import camel
from mcgee.codegen.routine import WORK, Item
from mcgee.codegen.statements import Style, pieces
from mcgee.codegen.unit import Function, Unit
from mcgee.graph.program import Array


def files(unit: Unit) -> Files:
    name = unit.name
    package = {
        "name": name,
        "version": "1.0.0",
        "private": True,
        "type": "module",
        "exports": f"./{name}.js",
        "scripts": {"test": "node selftest.js"},
    }
    return {
        f"{name}.js": source(unit),
        "selftest.js": selftest(unit),
        "package.json": json.dumps(package, indent=2) + "\n",
        "README.md": readme(
            unit,
            "JavaScript",
            f"`{name}.js` is an ES module without dependencies, for browsers and Node.js; results "
            f"are `Float64Array`s, matrices row by row.",
            f'`import {{ {camel(unit.functions[0].name)} }} from "./{name}.js"`.',
            "node selftest.js",
        ),
        **vectors(unit),
    }


def style(unit: Unit) -> Style:
    names = [p.identifier for p in unit.parameters]

    def item(i: Item) -> str:
        return f"params.{names[i.index]}" if i.array == "params" else f"{i.array}[{i.index}]"

    calls = {"cos": "Math.cos(", "sin": "Math.sin("}
    return Style(Syntax(item, call=calls), let="const {0} = {1};", put="{0} = {1};", indent="  ")


def new(array: Array) -> str:
    return f"new Float64Array({array.size})"


def source(unit: Unit) -> str:
    parts = [comment(header(unit), "/*", " * ", " */")]
    if unit.parameters:
        values = "".join(f"  {p.identifier}: {p.value!r},\n" for p in unit.parameters)
        parts.append(
            "\n/** The parameters of the description; take a copy to change them. */\n"
            f"export const defaults = Object.freeze({{\n{values}}});\n"
        )
    parts += [definition(unit, f) for f in unit.functions]
    return "".join(parts)


def definition(unit: Unit, f: Function) -> str:
    own, routine = style(unit), f.routine
    inputs = [a.name for a in f.state] + (["params = defaults"] if f.takes_parameters else [])
    single = len(f.outputs) == 1
    if single:
        (out,) = f.outputs
        inputs.append(f"{out.name} = {new(out)}")
        start, result = "", out.name if out.shape else f"{out.name}[0]"
    else:
        made = ", ".join(f"{a.name}: {new(a)}" for a in f.outputs)
        inputs.append(f"out = {{ {made} }}")
        start = f"  const {{ {', '.join(a.name for a in f.outputs)} }} = out;\n"
        result = "out"
    head = _doc(unit, f) + _head(f"export function {camel(f.name)}", inputs) + start
    end = f"  return {result};\n}}\n"
    if len(routine.parts) == 1:
        return f"{head}{own.body(routine.parts[0])}{end}"
    functions, calls = [], [f"  const {WORK} = new Float64Array({max(routine.work, 1)});\n"]
    for piece in pieces(routine):
        name = f"{camel(f.name)}Part{piece.number}"
        functions.append(
            "\n" + _head(f"function {name}", passed(piece)) + own.body(piece.part) + "}\n"
        )
        calls.append(f"  {name}({', '.join(passed(piece))});\n")
    return "".join([*functions, head, *calls, end])


def _head(name: str, arguments: Sequence[str]) -> str:
    return signature(name, arguments).replace("\n    ", "\n  ") + " {\n"


def _doc(unit: Unit, f: Function) -> str:
    lines = [f"{f.says}.", *(f"@param {describes(a)}" for a in f.state)]
    if f.takes_parameters:
        lines.append("@param params: as defaults")
    what = "; ".join(describes(a) for a in f.outputs)
    lines.append(f"@returns {what}; written into the last argument, where there is one")
    return "\n" + comment(lines, "/**", " * ", " */")


# -- the self-test --------------------------------------------------------------------------------


def selftest(unit: Unit) -> str:
    names = "".join(f"  {p.identifier!r},\n" for p in unit.parameters).replace("'", '"')
    return (
        f"// Compares {unit.name} with the vectors; exits non-zero where one is missed.\n"
        + filled(
            _SELFTEST,
            NAME=unit.name,
            TOLERANCE=str(TOLERANCE),
            VECTORS=VECTORS,
            PARAMETERS=f"[\n{names}]" if names else "[]",
            TESTS="".join(_test(f) for f in unit.functions),
        )
    )


def _test(f: Function) -> str:
    row = layout(f)
    inputs = ", ".join(f'["{a.name}", {at}, {a.size}]' for a, at in row.inputs)
    outputs = ", ".join(f'["{a.name}", {at}, {a.size}, {s}]' for a, at, s in row.outputs)
    return f'test("{f.name}", robot.{camel(f.name)}, [{inputs}], [{outputs}], {row.width});\n'


_SELFTEST = """import { readFileSync } from "node:fs";
import * as robot from "./NAME.js";

const folder = process.argv[2] ?? "VECTORS";
const parameters = PARAMETERS;

function given(row, [name, at, size]) {
  const values = row.slice(at, at + size);
  return name === "params"
    ? Object.fromEntries(parameters.map((key, i) => [key, values[i]]))
    : Float64Array.from(values);
}

function test(name, compute, inputs, outputs, width) {
  const text = readFileSync(`${folder}/${name}.txt`, "utf8").trim();
  const rows = text.split("\\n").map((line) => line.split(" ").map(Number));
  // units in the last place of the scale; infinite where a result is NaN
  let worst = 0;
  for (const row of rows) {
    const first = row === rows[0] && inputs.find(([key]) => key === "params");
    if (first && parameters.some((key, i) => robot.defaults[key] !== row[first[1] + i])) {
      worst = Infinity; // the first row holds the description's
    }
    if (row.length !== width) {
      throw new Error(`a row of ${name} is not as long as it should be`);
    }
    const result = compute(...inputs.map((input) => given(row, input)));
    for (const [key, at, size, scale] of outputs) {
      const one = outputs.length > 1 ? result[key] : result;
      const got = typeof one === "number" ? [one] : one;
      for (let i = 0; i < size; ++i) {
        const error = Math.abs(got[i] - row[at + i]) / (row[scale] * Number.EPSILON);
        worst = Number.isNaN(error) ? Infinity : Math.max(worst, error);
      }
    }
  }
  console.log(`${name}: ${rows.length} states, largest error ${worst.toPrecision(3)} ulp`);
  if (!(worst <= TOLERANCE)) {
    process.exitCode = 1;
  }
}

TESTS"""

JAVASCRIPT = Language(
    "javascript",
    "JavaScript",
    files,
    tools=(Tool(("node", "nodejs"), get="apt install nodejs"),),
    build=lambda unit, tools: [],
    run=lambda unit, tools: [[tools[0], "--throw-deprecation", "selftest.js"]],
)
