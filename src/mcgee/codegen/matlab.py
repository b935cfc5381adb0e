"""MATLAB: function files that GNU Octave runs too, and Simulink's MATLAB Function block takes."""

from __future__ import annotations

from collections.abc import Sequence

from mcgee.codegen.common import (
    TOLERANCE,
    VECTORS,
    Files,
    documentation,
    filled,
    header,
    layout,
    readme,
    vectors,
)
from mcgee.codegen.expression import Syntax
from mcgee.codegen.language import Language, Tool
from mcgee.codegen.python import indices
from mcgee.codegen.routine import WORK, Item, Routine
from mcgee.codegen.statements import Style, pieces
from mcgee.codegen.unit import Function, Unit
from mcgee.graph.program import Array


def files(unit: Unit) -> Files:
    return {
        **functions(unit),
        f"{unit.name}_selftest.m": selftest(unit),
        "README.md": readme(
            unit,
            "MATLAB",
            "Each function is a file of its own, for MATLAB, GNU Octave and Simulink's MATLAB "
            "Function block.",
            "Put the folder on the path.",
            f'octave-cli --eval "exit({unit.name}_selftest)"',
        ),
        **vectors(unit),
    }


def functions(unit: Unit) -> Files:
    found: Files = {f"{symbol(unit, f)}.m": source(unit, f) for f in unit.functions}
    if unit.parameters:
        name = f"{unit.name}_params"
        values = "".join(f"params.{p.identifier} = {p.value!r};\n" for p in unit.parameters)
        found[f"{name}.m"] = (
            f"function params = {name}()\n"
            f"%{name.upper()}  The parameters, with their values in the description.\n"
            f"%#codegen\n{values}end\n"
        )
    return found


def symbol(unit: Unit, f: Function) -> str:
    return f"{unit.name}_{f.name}"


def style(unit: Unit, routine: Routine) -> Style:
    names = [p.identifier for p in unit.parameters]

    def item(i: Item) -> str:
        if i.array == "params":
            return f"params.{names[i.index]}"
        array = routine.array(i.array)
        if not array.shape:
            return i.array
        return f"{i.array}({', '.join(str(k + 1) for k in indices(array, i.index))})"

    return Style(Syntax(item, continued=" ..."), let="{0} = {1};", put="{0} = {1};", indent="")


def zeros(array: Array) -> str:
    rows, *others = array.shape or (1,)
    return f"zeros({', '.join(map(str, (rows, *(others or [1]))))})"


def source(unit: Unit, f: Function) -> str:
    routine, own, name = f.routine, style(unit, f.routine), symbol(unit, f)
    results = ", ".join(a.name for a in f.outputs)
    results = f"[{results}]" if len(f.outputs) > 1 else results
    first, *rest = documentation(f)
    lines = [f"{name.upper()}  {first}", *(f"  {x}" for x in (*rest, "", *header(unit)))]
    head = f"function {results} = {name}({', '.join(a.name for a in f.inputs)})\n"
    head += "".join(f"%{line}".rstrip() + "\n" for line in lines) + "%#codegen\n"
    if f.takes_parameters:
        head += f"if nargin < {len(f.inputs)}\n    params = {unit.name}_params();\nend\n"
    head += "".join(f"{a.name} = {zeros(a)};\n" for a in f.outputs)
    if len(routine.parts) == 1:
        return f"{head}{own.body(routine.parts[0])}end\n"
    parts, calls = [], [f"{WORK} = zeros({max(routine.work, 1)}, 1);\n"]
    for piece in pieces(routine):
        changed = [*(a.name for a in piece.outputs), *([WORK] if piece.work else [])]
        given = [*(a.name for a in piece.inputs), *changed]
        call = f"{_list(changed)}part{piece.number}({', '.join(given)})"
        calls.append(f"{call};\n")
        parts.append(f"\nfunction {call}\n{own.body(piece.part)}end\n")
    return "".join([head, *calls, "end\n", *parts])


def _list(changed: Sequence[str]) -> str:
    return f"[{', '.join(changed)}] = " if changed else ""


# -- the self-test --------------------------------------------------------------------------------


def selftest(unit: Unit) -> str:
    calls = "".join(f"failed = failed | {f.name}_(folder);\n" for f in unit.functions)
    tests = "".join(_test(unit, f) for f in unit.functions)
    return filled(
        _SELFTEST,
        NAME=unit.name,
        TITLE=unit.name.upper(),
        TOLERANCE=str(TOLERANCE),
        VECTORS=VECTORS,
        CALLS=calls,
        TESTS=tests,
    )


def _test(unit: Unit, f: Function) -> str:
    row, lines = layout(f), []
    for array, at in row.inputs:
        if array.name == "params":
            lines += [
                f"params.{p.identifier} = row({at + i + 1});" for i, p in enumerate(unit.parameters)
            ]
            lines += [
                f"if k == 1 && ~isequal(params, {unit.name}_params())  % which the first row holds",
                "    worst = Inf;",
                "end",
            ]
        else:
            lines.append(f"{array.name} = row({at + 1}:{at + array.size});")
    given = ", ".join(a.name for a in f.inputs)
    lines.append(f"[{', '.join(a.name for a in f.outputs)}] = {symbol(unit, f)}({given});")
    for array, at, scale in row.outputs:
        axes = list(range(max(len(array.shape), 2), 0, -1))
        rows = f"permute({array.name}, [{' '.join(map(str, axes))}])"
        flat = rows if len(array.shape) > 1 else array.name
        end = at + array.size
        lines.append(f"worst = worse(worst, {flat}, row({at + 1}:{end}), row({scale + 1}));")
    inside = "".join(f"    {line}\n" for line in lines)
    return (
        f"\nfunction failed = {f.name}_(folder)\n"
        f"rows = load(fullfile(folder, '{f.name}.txt'), '-ascii');\n"
        f"worst = 0;\nfor k = 1:size(rows, 1)\n    row = rows(k, :);\n{inside}end\n"
        f"failed = report('{f.name}', rows, {row.width}, worst);\nend\n"
    )


_SELFTEST = """function failed = NAME_selftest(folder)
%TITLE_SELFTEST  1 where a result misses the vectors, else 0.
if nargin < 1
    folder = fullfile(fileparts(mfilename('fullpath')), 'VECTORS');
end
lastwarn('');
failed = false;
CALLSfailed = double(failed || ~isempty(lastwarn()));
end
TESTS
function worst = worse(worst, got, want, scale)
% The largest error in units in the last place of the scale; infinite where a result is NaN.
errors = abs(got(:)' - want)/(scale*eps);
if any(isnan(errors))
    errors = Inf;
end
worst = max([worst, errors]);
end

function failed = report(name, rows, width, worst)
fprintf('%s: %d states, largest error %.3g ulp\\n', name, size(rows, 1), worst);
failed = ~(size(rows, 1) > 0 && size(rows, 2) == width && worst <= TOLERANCE);
end
"""


OCTAVE = Tool(("octave-cli", "octave"), get="apt install octave")

MATLAB = Language(
    "matlab",
    "MATLAB",
    files,
    tools=(OCTAVE,),
    build=lambda unit, tools: [],
    run=lambda unit, tools: [
        [tools[0], "--norc", "--quiet", "--eval", f"exit({unit.name}_selftest())"]
    ],
)
