"""C99: a header and a source, no allocation, no dependency but the mathematics library."""

from __future__ import annotations

from collections.abc import Sequence

from mcgee.codegen.common import (
    TOLERANCE,
    VECTORS,
    Files,
    comment,
    documentation,
    filled,
    header,
    layout,
    readme,
    vectors,
)
from mcgee.codegen.expression import WIDTH, Syntax, decimal
from mcgee.codegen.language import Command, Language, Tool
from mcgee.codegen.routine import WORK, Item, Routine
from mcgee.codegen.statements import Piece, Style, pieces, turns_first, unused, zeros_first
from mcgee.codegen.turns import together, turns_function
from mcgee.codegen.unit import Function, Unit
from mcgee.graph.program import Array


def files(unit: Unit) -> Files:
    name = unit.name
    return {
        f"{name}.h": header_file(unit),
        f"{name}.c": source(unit),
        "selftest.c": selftest(unit),
        "CMakeLists.txt": _CMAKE.format(name=name),
        "README.md": readme(
            unit,
            "C",
            f"`{name}.h` and `{name}.c` are C99 without allocation or dependency; arrays are "
            f"row by row and must not overlap.",
            "Compile the source with your program and link `-lm`, or `add_subdirectory` it.",
            f"cc -std=c99 -O2 selftest.c {name}.c -lm && ./a.out",
        ),
        **vectors(unit),
    }


# -- declarations ---------------------------------------------------------------------------------


def scalar(unit: Unit) -> str:
    return "float" if unit.single else "double"


def params_type(unit: Unit) -> str:
    return f"{unit.name}_params"


def symbol(unit: Unit, function: Function) -> str:
    return f"{unit.name}_{function.name}"


def arguments(
    unit: Unit, inputs: Sequence[Array], outputs: Sequence[Array], work: int = 0
) -> list[str]:
    """A parameter list; results are restrict, so that writing one reloads no input."""
    t = scalar(unit)
    found = []
    for array in inputs:
        if array.name == "params":
            found.append(f"const {params_type(unit)} *params")
        else:
            found.append(f"const {t} {array.name}[{array.size}]")
    restrict = f"{unit.name.upper()}_RESTRICT"
    found += [f"{t} *{restrict} {a.name}" for a in outputs]
    if work:
        found.append(f"{t} *{restrict} {WORK}")
    return found


def signature(head: str, arguments: Sequence[str]) -> str:
    """A function's head, on as many lines as it takes."""
    whole = f"{head}({', '.join(arguments)})"
    if len(whole) <= WIDTH:
        return whole
    return f"{head}(\n    " + ",\n    ".join(arguments) + ")"


def header_file(unit: Unit) -> str:
    guard = f"{unit.name.upper()}_H"
    rows = "Matrices lie row by row; arrays must not overlap."
    parts = [comment(header(unit, rows), "/*", " * ", " */")]
    parts.append(_GUARDED.format(guard=guard, NAME=unit.name.upper()))
    if unit.parameters:
        fields = "".join(f"    {scalar(unit)} {p.identifier};\n" for p in unit.parameters)
        parts.append(f"typedef struct {params_type(unit)} {{\n{fields}}} {params_type(unit)};\n\n")
        parts.append(
            f"/* The parameters of the description. */\n"
            f"extern const {params_type(unit)} {unit.name}_defaults;\n\n"
        )
    for f in unit.functions:
        parts.append(comment(documentation(f), "/*", " * ", " */"))
        head = signature(f"void {symbol(unit, f)}", arguments(unit, f.inputs, f.outputs))
        parts.append(f"{head};\n\n")
    parts.append("#ifdef __cplusplus\n}\n#endif\n\n#endif\n")
    return "".join(parts)


_GUARDED = """#ifndef {guard}
#define {guard}

#if defined(__cplusplus) || defined(_MSC_VER)
#define {NAME}_RESTRICT __restrict
#else
#define {NAME}_RESTRICT restrict
#endif

#ifdef __cplusplus
extern "C" {{
#endif

"""


# -- definitions ----------------------------------------------------------------------------------


def source(unit: Unit) -> str:
    parts = [comment(header(unit), "/*", " * ", " */")]
    parts.append(f'#include "{unit.name}.h"\n\n')
    if _has_turns(unit):
        parts.append("#include <float.h>\n#include <math.h>\n#include <stdint.h>\n")
        parts.append("#include <string.h>\n")
        restrict = f"{unit.name.upper()}_RESTRICT"
        parts.append(turns_function(f"static void {unit.name}_turns", restrict))
    else:
        parts.append("#include <math.h>\n")
    if unit.parameters:
        values = "".join(f"    {number(unit)(p.value)},\n" for p in unit.parameters)
        parts.append(f"\nconst {params_type(unit)} {unit.name}_defaults = {{\n{values}}};\n")
    for f in unit.functions:
        parts.append(definition(unit, f))
    return "".join(parts)


def _has_turns(unit: Unit) -> bool:
    return any(fast(unit, f.routine) for f in unit.functions)


def fast(unit: Unit, routine: Routine) -> bool:
    """Whether angles go through our own cosine and sine."""
    return not unit.single and not routine.readable and bool(turns_first(routine.parts[0])[0])


def number(unit: Unit):  # type: ignore[no-untyped-def]
    return (lambda x: f"{_float32(x)}f") if unit.single else decimal


def _float32(x: float) -> str:
    """Nine digits tell floats apart."""
    text = f"{x:.9g}"
    return text if "." in text or "e" in text else f"{text}.0"


def style(unit: Unit) -> Style:
    names = [p.identifier for p in unit.parameters]

    def item(i: Item) -> str:
        return f"params->{names[i.index]}" if i.array == "params" else f"{i.array}[{i.index}]"

    calls = {"cos": "cosf(", "sin": "sinf("} if unit.single else None
    return Style(
        Syntax(item, number(unit), calls),
        let=f"const {scalar(unit)} {{0}} = {{1}};",
        put="{0} = {1};",
    )


def definition(unit: Unit, f: Function) -> str:
    routine = f.routine
    head = signature(f"void {symbol(unit, f)}", arguments(unit, f.inputs, f.outputs))
    head = f"\n{head}\n{{\n" + "".join(f"    (void){array.name};\n" for array in unused(routine))
    if len(routine.parts) == 1:
        return f"{head}{body(unit, routine, 0, style(unit))}}}\n"
    functions, calls = [], [f"    {scalar(unit)} {WORK}[{routine.work}];\n"]
    for piece in pieces(routine):
        name = f"{symbol(unit, f)}_part{piece.number}"
        work = routine.work if piece.work else 0
        own = signature(f"static void {name}", arguments(unit, piece.inputs, piece.outputs, work))
        functions.append(f"\n{own}\n{{\n{body(unit, routine, piece.number - 1, style(unit))}}}\n")
        calls.append(f"    {name}({', '.join(passed(piece))});\n")
    return "".join([*functions, head, *calls, "}\n"])


def passed(piece: Piece) -> list[str]:
    names = [a.name for a in (*piece.inputs, *piece.outputs)]
    return [*names, WORK] if piece.work else names


def body(unit: Unit, routine: Routine, k: int, own: Style) -> str:
    """Of the k-th part; the first clears what is mostly zeros, and turns by all angles at once."""
    part = routine.parts[k]
    if k or routine.readable:
        return own.body(part)
    cleared, part = zeros_first(part)
    text = "".join(_clear(name, routine.array(name).size) for name in cleared)
    if fast(unit, routine):
        turns, part = turns_first(part)
        text += together(unit.name, turns, own)
    return text + own.body(part)


def _clear(name: str, size: int) -> str:
    return f"    for (int i = 0; i < {size}; ++i) {{\n        {name}[i] = 0;\n    }}\n"


_CMAKE = """cmake_minimum_required(VERSION 3.13)
project({name} C)
add_library({name} {name}.c)
target_include_directories({name} PUBLIC ${{CMAKE_CURRENT_SOURCE_DIR}})
target_compile_features({name} PUBLIC c_std_99)
if(UNIX)
  target_link_libraries({name} PUBLIC m)
endif()
enable_testing()
add_executable({name}_selftest selftest.c)
target_link_libraries({name}_selftest {name})
add_test(NAME {name}_selftest COMMAND {name}_selftest ${{CMAKE_CURRENT_SOURCE_DIR}}/vectors)
"""


# -- the self-test --------------------------------------------------------------------------------


def selftest(unit: Unit) -> str:
    calls = "".join(f"    failed += test_{f.name}(folder);\n" for f in unit.functions)
    return (
        f"/* Compares {unit.name} with the vectors; exits non-zero where one is missed. */\n"
        + filled(
            _SELFTEST,
            NAME=unit.name,
            TOLERANCE=str(TOLERANCE),
            EPSILON="FLT_EPSILON" if unit.single else "DBL_EPSILON",
            VECTORS=VECTORS,
            SCALAR=scalar(unit),
            TESTS="".join(_test(unit, f) for f in unit.functions),
            CALLS=calls,
        )
    )


def _test(unit: Unit, f: Function) -> str:
    t, row = scalar(unit), layout(f)
    lines, given = [], []
    for array, at in row.inputs:
        if array.name == "params":
            sets = ", ".join(f"({t})row[{at + i}]" for i in range(array.size))
            lines.append(f"const {params_type(unit)} params = {{{sets}}};")
            standard = f"memcmp(&params, &{unit.name}_defaults, sizeof params)"
            lines.append(f"if (rows == 0 && {standard} != 0) {{ /* the first row holds those */")
            lines += ["    worst = HUGE_VAL;", "}"]
            given.append("&params")
        else:
            lines.append(f"{t} {array.name}[{array.size}];")
            lines.append(f"read_row({array.name}, row + {at}, {array.size});")
            given.append(array.name)
    lines += [f"{t} {array.name}[{array.size}];" for array in f.outputs]
    given += [array.name for array in f.outputs]
    lines.append(f"{symbol(unit, f)}({', '.join(given)});")
    for array, at, scale in row.outputs:
        told = f"{array.name}, row + {at}, {array.size}, row[{scale}]"
        lines.append(f"worst = worse(worst, {told});")
    inside = "".join(f"        {line}\n" for line in lines)
    return (
        f"\nstatic int test_{f.name}(const char *folder)\n{{\n"
        f"    static double row[{row.width}];\n    int rows = 0;\n    double worst = 0;\n"
        f'    FILE *file = opened(folder, "{f.name}");\n'
        f"    for (; next(file, row, {row.width}); ++rows) {{\n{inside}    }}\n"
        f'    return report("{f.name}", file, rows, worst);\n}}\n'
    )


_SELFTEST = """#include "NAME.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static FILE *opened(const char *folder, const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.txt", folder, name);
    FILE *file = fopen(path, "r");
    if (!file) {
        fprintf(stderr, "cannot read %s\\n", path);
        exit(2);
    }
    return file;
}

static int next(FILE *file, double *row, int width)
{
    int i = 0;
    while (i < width && fscanf(file, "%lf", row + i) == 1) {
        ++i;
    }
    if (i > 0 && i < width) {
        fprintf(stderr, "a row is not as long as it should be\\n");
        exit(2);
    }
    return i == width;
}

static void read_row(SCALAR *to, const double *from, int size)
{
    for (int i = 0; i < size; ++i) {
        to[i] = (SCALAR)from[i];
    }
}

/* The largest error in units in the last place of the scale; infinite where a result is NaN. */
static double worse(double worst, const SCALAR *got, const double *want, int size, double scale)
{
    for (int i = 0; i < size; ++i) {
        const double error = fabs((double)got[i] - want[i])/(scale*(double)EPSILON);
        if (!(error <= worst)) {
            worst = error == error ? error : HUGE_VAL;
        }
    }
    return worst;
}

static int report(const char *name, FILE *file, int rows, double worst)
{
    const int ended = feof(file);
    fclose(file);
    printf("%s: %d states, largest error %.3g ulp\\n", name, rows, worst);
    return !(rows > 0 && ended && worst <= TOLERANCE);
}
TESTS
int main(int count, char **words)
{
    const char *folder = count > 1 ? words[1] : "VECTORS";
    int failed = 0;
CALLS    return failed ? 1 : 0;
}
"""


def _build(unit: Unit, tools: list[str]) -> list[Command]:
    return [[tools[0], *WARNINGS, "selftest.c", f"{unit.name}.c", "-o", "selftest", "-lm"]]


WARNINGS = [
    *("-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wconversion", "-Wshadow"),
    *("-Wdouble-promotion", "-Wstrict-prototypes", "-Wmissing-prototypes", "-Wunused"),
]

C = Language(
    "c",
    "C",
    files,
    tools=(Tool(("gcc", "clang", "cc"), get="apt install gcc"),),
    build=_build,
    run=lambda unit, tools: [["./selftest"]],
    floats=True,
)
