"""C++ with Eigen: one header."""

from __future__ import annotations

import re
from pathlib import Path

from mcgee.codegen import c
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
from mcgee.codegen.expression import Syntax
from mcgee.codegen.language import Language, Tool
from mcgee.codegen.names import pascal
from mcgee.codegen.routine import WORK, Item, Routine
from mcgee.codegen.statements import Piece, Style, pieces, unused
from mcgee.codegen.turns import turns_function
from mcgee.codegen.unit import Function, Unit
from mcgee.graph.program import Array

ON_STACK = 4096
"""Elements up to which a matrix has its size in its type."""


def files(unit: Unit) -> Files:
    name = unit.name
    return {
        f"{name}.hpp": header_file(unit),
        "selftest.cpp": selftest(unit),
        "CMakeLists.txt": _CMAKE.format(name=name),
        "README.md": readme(
            unit,
            "C++ with Eigen",
            f"`{name}.hpp` is all there is, C++14 without allocation; results must not share "
            f"memory with arguments.",
            "Put it and Eigen (3.3 or newer) on the include path, or `add_subdirectory` it.",
            "c++ -std=c++14 -O2 -I /usr/include/eigen3 selftest.cpp -o selftest && ./selftest",
        ),
        **vectors(unit),
    }


def params_type(unit: Unit) -> str:
    return f"{pascal(unit.name)}Params"


def kind(unit: Unit, array: Array) -> str:
    """The type of an array."""
    t = c.scalar(unit)
    if array.name == "params":
        return params_type(unit)
    if not array.shape:
        return t
    if len(array.shape) > 2:
        return f"std::array<{t}, {array.size}>"
    rows, columns = (*array.shape, 1)[:2]
    if array.size > ON_STACK:
        return f"Eigen::Matrix<{t}, Eigen::Dynamic, Eigen::Dynamic>"
    return f"Eigen::Matrix<{t}, {rows}, {columns}>"


def arguments(unit: Unit, f: Function) -> list[str]:
    found = [f"const {kind(unit, a)}& {a.name}" for a in f.inputs]
    return found + [f"{kind(unit, a)}& {a.name}" for a in f.outputs]


def pointers(unit: Unit, piece: Piece) -> list[str]:
    """As `arguments`, of a part: no result is reloaded for fear that another one changed it."""
    t, found = c.scalar(unit), []
    for a in piece.inputs:
        is_array = a.name != "params"
        found.append(f"const {t} *{a.name}" if is_array else f"const {kind(unit, a)}& params")
    names = [a.name for a in piece.outputs] + ([WORK] if piece.work else [])
    return found + [f"{t} *__restrict {name}" for name in names]


def style(unit: Unit, routine: Routine) -> Style:
    """Formulas for readers are of Eigen's vectors and matrices, others of pointers."""
    names = [p.identifier for p in unit.parameters]

    def item(i: Item) -> str:
        if i.array == "params":
            return f"params.{names[i.index]}"
        shape = routine.array(i.array).shape
        row, column = divmod(i.index, shape[1]) if len(shape) == 2 else (i.index, 0)
        if routine.readable and len(shape) == 2:
            return f"{i.array}({row}, {column})"
        # matrices lie column by column
        return f"{i.array}[{row + column * shape[0] if len(shape) == 2 else i.index}]"

    t = c.scalar(unit)
    calls = {"cos": "std::cos(", "sin": "std::sin("}
    return Style(
        Syntax(item, c.number(unit), calls), let=f"const {t} {{0}} = {{1}};", put="{0} = {1};"
    )


def header_file(unit: Unit) -> str:
    guard = f"{unit.name.upper()}_HPP"
    fast = any(c.fast(unit, f.routine) for f in unit.functions)
    standard = ["array", "cmath", *(["cfloat", "cstdint", "cstring"] if fast else [])]
    includes = "".join(f"#include <{name}>\n" for name in sorted(standard))
    apart = "Results must not share memory with each other or with arguments."
    parts = [
        comment(header(unit, apart), "/*", " * ", " */"),
        f"#ifndef {guard}\n#define {guard}\n\n#include <Eigen/Core>\n\n{includes}",
    ]
    if unit.parameters:
        t = c.scalar(unit)
        fields = "".join(
            f"    {t} {p.identifier} = {c.number(unit)(p.value)};\n" for p in unit.parameters
        )
        parts.append(f"\nstruct {params_type(unit)} {{\n{fields}}};\n")
    if fast:
        head, exact = f"inline void {unit.name}_turns", f"{unit.name.upper()}_EXACT"
        parts.append(turns_function(head, "__restrict", exact))
    parts += [definition(unit, f) for f in unit.functions]
    return "".join([*parts, "\n#endif\n"])


def definition(unit: Unit, f: Function) -> str:
    routine, name = f.routine, c.symbol(unit, f)
    head = c.signature(f"inline void {name}", arguments(unit, f))
    head = "\n" + comment(documentation(f), "/*", " * ", " */") + f"{head}\n{{\n"
    head += "".join(f"    (void){array.name};\n" for array in unused(routine))
    head += "".join(
        f"    {a.name}.resize({a.shape[0]}, {a.shape[1]});\n"
        for a in f.outputs
        if "Dynamic" in kind(unit, a)
    )
    if routine.readable:
        return f"{head}{c.body(unit, routine, 0, style(unit, routine))}}}\n"
    functions, calls = [], []
    if routine.work:
        calls.append(f"    {c.scalar(unit)} {WORK}[{routine.work}];\n")
    for piece in pieces(routine):
        part = f"{name}_part{piece.number}"
        own = c.signature(f"inline void {part}", pointers(unit, piece))
        inside = c.body(unit, routine, piece.number - 1, style(unit, routine))
        functions.append(f"\n{own}\n{{\n{inside}}}\n")
        calls.append(f"    {part}({', '.join(_passed(piece))});\n")
    return "".join([*functions, head, *calls, "}\n"])


def _passed(piece: Piece) -> list[str]:
    found = []
    for a in (*piece.inputs, *piece.outputs):
        if a.name == "params":
            found.append(a.name)
        else:
            found.append(f"{a.name}.data()" if a.shape else f"&{a.name}")
    return [*found, WORK] if piece.work else found


_CMAKE = """cmake_minimum_required(VERSION 3.13)
project({name} CXX)
find_package(Eigen3 REQUIRED NO_MODULE)
add_library({name} INTERFACE)
target_include_directories({name} INTERFACE ${{CMAKE_CURRENT_SOURCE_DIR}})
target_link_libraries({name} INTERFACE Eigen3::Eigen)
target_compile_features({name} INTERFACE cxx_std_14)
enable_testing()
add_executable({name}_selftest selftest.cpp)
target_link_libraries({name}_selftest {name})
add_test(NAME {name}_selftest COMMAND {name}_selftest ${{CMAKE_CURRENT_SOURCE_DIR}}/vectors)
"""


# -- the self-test --------------------------------------------------------------------------------


def selftest(unit: Unit) -> str:
    calls = "".join(f"    failed |= test_{f.name}(folder);\n" for f in unit.functions)
    return (
        f"// Compares {unit.name} with the vectors; exits non-zero where one is missed.\n"
        + filled(
            _SELFTEST,
            NAME=unit.name,
            TOLERANCE=str(TOLERANCE),
            VECTORS=VECTORS,
            SCALAR=c.scalar(unit),
            TESTS="".join(_test(unit, f) for f in unit.functions),
            CALLS=calls,
        )
    )


def _test(unit: Unit, f: Function) -> str:
    row, lines = layout(f), []
    for array, at in row.inputs:
        lines.append(f"{kind(unit, array)} {array.name};")
        if array.name == "params":
            for i, p in enumerate(unit.parameters):
                lines.append(
                    f"params.{p.identifier} = static_cast<{c.scalar(unit)}>(row[{at + i}]);"
                )
            lines += [
                f"const {params_type(unit)} standard{{}};  // which the first row holds",
                "if (&row == &rows[0] && std::memcmp(&params, &standard, sizeof params) != 0) {",
                "    worst = std::numeric_limits<double>::infinity();",
                "}",
            ]
        else:
            lines.append(f"read({array.name}, row, {at});")
    lines += [f"{kind(unit, array)} {array.name};" for array in f.outputs]
    given = ", ".join(a.name for a in (*f.inputs, *f.outputs))
    lines.append(f"{c.symbol(unit, f)}({given});")
    lines += [f"compare(worst, {a.name}, row, {at}, {s});" for a, at, s in row.outputs]
    inside = "".join(f"        {line}\n" for line in lines)
    return (
        f"\nbool test_{f.name}(const std::string& folder)\n{{\n    double worst = 0;\n"
        f'    const auto rows = rows_of(folder, "{f.name}", {row.width});\n'
        f"    for (const auto& row : rows) {{\n{inside}    }}\n"
        f'    return report("{f.name}", rows.size(), worst);\n}}\n'
    )


_SELFTEST = """#include "NAME.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Row = std::vector<double>;

std::vector<Row> rows_of(const std::string& folder, const std::string& name, std::size_t width)
{
    const std::string path = folder + "/" + name + ".txt";
    std::ifstream file(path);
    std::vector<Row> rows;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        Row row;
        for (std::string word; words >> word;) {
            row.push_back(std::strtod(word.c_str(), nullptr));
        }
        if (row.size() != width) {
            std::fprintf(stderr, "a row of %s is not as long as it should be\\n", path.c_str());
            std::exit(2);
        }
        rows.push_back(row);
    }
    if (rows.empty()) {
        std::fprintf(stderr, "cannot read %s\\n", path.c_str());
        std::exit(2);
    }
    return rows;
}

template <typename Vector>
void read(Vector& to, const Row& row, std::size_t at)
{
    for (Eigen::Index i = 0; i < to.size(); ++i) {
        to[i] = static_cast<SCALAR>(row[at + static_cast<std::size_t>(i)]);
    }
}

// The largest error in units in the last place of the scale; infinite where a result is NaN.
void compare_one(double& worst, SCALAR got, double want, double scale)
{
    const double unit = scale*static_cast<double>(std::numeric_limits<SCALAR>::epsilon());
    const double error = std::abs(static_cast<double>(got) - want)/unit;
    if (!(error <= worst)) {
        worst = std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
    }
}

inline void compare(double& worst, SCALAR got, const Row& row, std::size_t at, std::size_t scale)
{
    compare_one(worst, got, row[at], row[scale]);
}

template <std::size_t N>
void compare(
    double& worst, const std::array<SCALAR, N>& got, const Row& row, std::size_t at,
    std::size_t scale)
{
    for (std::size_t i = 0; i < N; ++i) {
        compare_one(worst, got[i], row[at + i], row[scale]);
    }
}

template <typename Derived>
void compare(
    double& worst, const Eigen::MatrixBase<Derived>& got, const Row& row, std::size_t at,
    std::size_t scale)
{
    for (Eigen::Index i = 0; i < got.rows(); ++i) {
        for (Eigen::Index j = 0; j < got.cols(); ++j) {
            compare_one(worst, got(i, j), row[at++], row[scale]);
        }
    }
}

bool report(const char* name, std::size_t rows, double worst)
{
    std::printf("%s: %d states, largest error %.3g ulp\\n", name, static_cast<int>(rows), worst);
    return !(worst <= TOLERANCE);
}
TESTS
}  // namespace

int main(int count, char** words)
{
    const std::string folder = count > 1 ? words[1] : "VECTORS";
    bool failed = false;
CALLS    return failed ? 1 : 0;
}
"""


class _Eigen(Tool):
    """The folder of Eigen's headers."""

    def found(self) -> str | None:
        places = [
            "/usr/include/eigen3",
            "/usr/local/include/eigen3",
            "/opt/homebrew/include/eigen3",
        ]
        return next((p for p in places if (Path(p) / "Eigen" / "Core").is_file()), None)

    def says(self) -> str:
        folder = Path(self.found() or "")
        text = (folder / "Eigen/src/Core/util/Macros.h").read_text()
        numbers = re.findall(r"define EIGEN_(?:WORLD|MAJOR|MINOR)_VERSION (\d+)", text)
        return f"Eigen {'.'.join(numbers)}"


WARNINGS = [
    *("-std=c++14", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wconversion"),
    *("-Wshadow", "-Wold-style-cast", "-Wdouble-promotion"),
]

CPP = Language(
    "cpp",
    "C++",
    files,
    tools=(
        Tool(("g++", "clang++", "c++"), get="apt install g++"),
        _Eigen(("Eigen",), get="apt install libeigen3-dev"),
    ),
    build=lambda unit, tools: [
        [tools[0], *WARNINGS, "-isystem", tools[1], "selftest.cpp", "-o", "selftest"]
    ],
    run=lambda unit, tools: [["./selftest"]],
    floats=True,
)
