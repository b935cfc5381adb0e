"""Java: one class that allocates nothing it is not asked to return."""

from __future__ import annotations

from collections.abc import Sequence

from mcgee.codegen.c import signature
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
from mcgee.codegen.names import camel, pascal
from mcgee.codegen.routine import WORK, Item, Routine
from mcgee.codegen.statements import Style, pieces
from mcgee.codegen.unit import Function, Unit
from mcgee.graph.program import Array


def files(unit: Unit) -> Files:
    name = type_name(unit)
    return {
        f"{name}.java": source(unit),
        "SelfTest.java": selftest(unit),
        "README.md": readme(
            unit,
            "Java",
            f"`{name}.java` is Java 8 without dependencies; matrices are `double[rows][columns]`.",
            "Put it among your sources, under a package of yours if you like.",
            "javac *.java && java SelfTest",
        ),
        **vectors(unit),
    }


def type_name(unit: Unit) -> str:
    return f"{pascal(unit.name)}Dynamics"


def method(f: Function) -> str:
    return "compute" if f.name == "dynamics" else camel(f.name)


def kind(array: Array) -> str:
    if array.name == "params":
        return "Params"
    return "double" + "[]" * max(len(array.shape), 1)


def new(array: Array) -> str:
    sizes = array.shape or (1,)
    return "new double" + "".join(f"[{size}]" for size in sizes)


def style(unit: Unit, routine: Routine) -> Style:
    names = [p.identifier for p in unit.parameters]

    def item(i: Item) -> str:
        if i.array == "params":
            return f"params.{names[i.index]}"
        return f"{i.array}{place(routine.array(i.array), i.index)}"

    calls = {"cos": "Math.cos(", "sin": "Math.sin("}
    return Style(
        Syntax(item, call=calls),
        let="final double {0} = {1};",
        put="{0} = {1};",
        indent=" " * 8,
    )


def place(array: Array, index: int) -> str:
    """[i][j] of an element counted row by row; a number is an array of one."""
    indices: list[int] = []
    for size in reversed(array.shape or (1,)):
        indices.insert(0, index % size)
        index //= size
    return "".join(f"[{i}]" for i in indices)


def source(unit: Unit) -> str:
    name = type_name(unit)
    parts = [comment(header(unit), "/*", " * ", " */"), f"public final class {name} {{\n"]
    parts.append(f"    private {name}() {{\n    }}\n")
    if unit.parameters:
        fields = "".join(
            f"        public double {p.identifier} = {p.value!r};\n" for p in unit.parameters
        )
        parts.append(
            f"\n    /** The parameters, with their values in the description. */\n"
            f"    public static final class Params {{\n{fields}    }}\n"
        )
    parts += [definition(unit, f) for f in unit.functions]
    return "".join([*parts, "}\n"])


def definition(unit: Unit, f: Function) -> str:
    single = len(f.outputs) == 1
    return (_one if single else _several)(unit, f) + _core(unit, f)


def _doc(unit: Unit, f: Function) -> str:
    first, *rest = documentation(f)
    lines = [first, "<ul>", *(f"<li>{line}</li>" for line in rest), "</ul>"]
    inside = "".join(f"     * {line}\n" for line in lines)
    return f"\n    /**\n{inside}     */\n"


def _head(name: str, gives: str, arguments: Sequence[str]) -> str:
    head = signature(f"    public static {gives} {name}", arguments)
    return head.replace("\n    ", "\n            ") + " {\n"


def _inputs(f: Function) -> list[str]:
    return [f"{kind(a)} {a.name}" for a in f.inputs]


def _one(unit: Unit, f: Function) -> str:
    """A function of one result: returned, or written where the caller wants it."""
    (out,) = f.outputs
    given = ", ".join(a.name for a in (*f.inputs, out))
    gives, result = (kind(out), out.name) if out.shape else ("double", f"{out.name}[0]")
    text = (
        _doc(unit, f)
        + _head(method(f), gives, _inputs(f))
        + f"        final {kind(out)} {out.name} = {new(out)};\n"
        f"        {_core_name(f)}({given});\n        return {result};\n    }}\n"
    )
    if out.shape:
        text += (
            f"\n    /** The same, into {out.name}, which must not be an argument too. */\n"
            + _head(method(f), "void", [*_inputs(f), f"{kind(out)} {out.name}"])
            + f"        {_core_name(f)}({given});\n    }}\n"
        )
    return text


def _several(unit: Unit, f: Function) -> str:
    result = "Result" if f.name == "dynamics" else f"{pascal(f.name)}Result"
    fields = "".join(f"        public final {kind(a)} {a.name} = {new(a)};\n" for a in f.outputs)
    given = ", ".join([*(a.name for a in f.inputs), *(f"result.{a.name}" for a in f.outputs)])
    ours = ", ".join(a.name for a in f.inputs)
    return (
        f"\n    /** What {{@code {method(f)}}} gives. */\n"
        f"    public static final class {result} {{\n{fields}    }}\n"
        + _doc(unit, f)
        + _head(method(f), result, _inputs(f))
        + f"        final {result} result = new {result}();\n"
        f"        {method(f)}({ours}, result);\n        return result;\n    }}\n"
        "\n    /** The same, into result. */\n"
        + _head(method(f), "void", [*_inputs(f), f"{result} result"])
        + f"        {_core_name(f)}({given});\n    }}\n"
    )


def _core_name(f: Function) -> str:
    return f"{camel(f.name)}Into"


def _core(unit: Unit, f: Function) -> str:
    """The statements; long ones in methods that HotSpot compiles."""
    routine, own = f.routine, style(unit, f.routine)
    head = _private(_core_name(f), (*f.inputs, *f.outputs), False)
    if len(routine.parts) == 1:
        return f"{head}{own.body(routine.parts[0])}    }}\n"
    methods, calls = [], [f"        final double[] {WORK} = new double[{max(routine.work, 1)}];\n"]
    for piece in pieces(routine):
        name = f"{camel(f.name)}Part{piece.number}"
        arrays = (*piece.inputs, *piece.outputs)
        methods.append(f"{_private(name, arrays, piece.work)}{own.body(piece.part)}    }}\n")
        given = [*(a.name for a in arrays), *([WORK] if piece.work else [])]
        calls.append(f"        {name}({', '.join(given)});\n")
    return "".join([head, *calls, "    }\n", *methods])


def _private(name: str, arrays: Sequence[Array], work: bool) -> str:
    arguments = [f"{kind(a)} {a.name}" for a in arrays]
    arguments += [f"double[] {WORK}"] if work else []
    head = signature(f"    private static void {name}", arguments)
    return "\n" + head.replace("\n    ", "\n            ") + " {\n"


# -- the self-test --------------------------------------------------------------------------------


def selftest(unit: Unit) -> str:
    calls = "".join(f"        failed |= {camel(f.name)}(folder);\n" for f in unit.functions)
    return (
        f"/** Compares {type_name(unit)} with the vectors; exits non-zero where one is missed. */\n"
        + filled(
            _SELFTEST,
            TOLERANCE=str(TOLERANCE),
            VECTORS=VECTORS,
            TESTS="".join(_test(unit, f) for f in unit.functions),
            CALLS=calls,
        )
    )


def _test(unit: Unit, f: Function) -> str:
    row, lines, owner = layout(f), [], type_name(unit)
    for array, at in row.inputs:
        if array.name == "params":
            lines.append(f"final {owner}.Params params = new {owner}.Params();")
            for i, p in enumerate(unit.parameters):  # the first row holds the description's
                wrong = f"row == rows.get(0) && params.{p.identifier} != row[{at + i}]"
                lines.append(f"worst = {wrong} ? Double.POSITIVE_INFINITY : worst;")
                lines.append(f"params.{p.identifier} = row[{at + i}];")
        else:
            end = at + array.size
            lines.append(f"final double[] {array.name} = Arrays.copyOfRange(row, {at}, {end});")
    given = ", ".join(a.name for a in f.inputs)
    several = len(f.outputs) > 1
    lines.append(f"final Object result = {owner}.{method(f)}({given});")
    if several:
        kind_ = "Result" if f.name == "dynamics" else f"{pascal(f.name)}Result"
        lines[-1] = f"final {owner}.{kind_} result = {owner}.{method(f)}({given});"
    for array, at, scale in row.outputs:
        got = f"result.{array.name}" if several else "result"
        lines.append(f"worst = worse(worst, flat({got}), row, {at}, row[{scale}]);")
    inside = "".join(f"            {line}\n" for line in lines)
    return (
        f"\n    private static boolean {camel(f.name)}(String folder) throws IOException {{\n"
        f"        double worst = 0;\n"
        f'        final List<double[]> rows = rows(folder, "{f.name}", {row.width});\n'
        f"        for (double[] row : rows) {{\n{inside}        }}\n"
        f'        return report("{f.name}", rows.size(), worst);\n    }}\n'
    )


_SELFTEST = """import java.io.IOException;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.nio.file.Paths;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.Locale;

public final class SelfTest {
    private SelfTest() {
    }

    private static List<double[]> rows(String folder, String name, int width) throws IOException {
        final List<double[]> rows = new ArrayList<>();
        for (String line : Files.readAllLines(
                Paths.get(folder, name + ".txt"), StandardCharsets.US_ASCII)) {
            final double[] row =
                Arrays.stream(line.split(" ")).mapToDouble(Double::parseDouble).toArray();
            if (row.length != width) {
                throw new IOException("a row of " + name + " is not as long as it should be");
            }
            rows.add(row);
        }
        return rows;
    }

    private static double[] flat(Object array) {
        if (array instanceof Double) {
            return new double[] {(Double) array};
        }
        if (array instanceof double[]) {
            return (double[]) array;
        }
        return Arrays.stream((Object[]) array)
            .flatMapToDouble(x -> Arrays.stream(flat(x))).toArray();
    }

    /** The largest error in units in the last place of the scale; infinite where one is NaN. */
    private static double worse(double worst, double[] got, double[] row, int at, double scale) {
        for (int i = 0; i < got.length; ++i) {
            final double error = Math.abs(got[i] - row[at + i])/(scale*Math.ulp(1.0));
            worst = Double.isNaN(error) ? Double.POSITIVE_INFINITY : Math.max(worst, error);
        }
        return worst;
    }

    private static boolean report(String name, int rows, double worst) {
        System.out.println(String.format(
            Locale.ROOT, "%s: %d states, largest error %.3g ulp", name, rows, worst));
        return !(rows > 0 && worst <= TOLERANCE);
    }
TESTS
    public static void main(String[] words) throws IOException {
        final String folder = words.length > 0 ? words[0] : "VECTORS";
        boolean failed = false;
CALLS        System.exit(failed ? 1 : 0);
    }
}
"""

JAVA = Language(
    "java",
    "Java",
    files,
    tools=(
        Tool(("javac",), ("-version",), get="apt install default-jdk-headless"),
        Tool(("java",), ("-version",), get="apt install default-jre-headless"),
    ),
    build=lambda unit, tools: [
        [tools[0], "-Xlint:all", "-Werror", f"{type_name(unit)}.java", "SelfTest.java"]
    ],
    run=lambda unit, tools: [[tools[1], "SelfTest"]],
)
