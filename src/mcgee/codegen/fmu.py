"""Functional mock-up units of FMI 2.0 and 3.0: the arm as a block of other simulators.

The C of both is one text, with the arm's own functions beside it; each unit also holds a binary,
where a compiler is at hand.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import io
import platform
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from importlib import resources
from pathlib import Path

from mcgee.codegen import c, fmu_description
from mcgee.codegen.common import TOLERANCE, Files, comment, readme, vectors
from mcgee.codegen.fmu_description import MAX_STEP, METHOD, VERSIONS, source_names
from mcgee.codegen.language import Command, Language, Tool
from mcgee.codegen.package import as_bytes, put
from mcgee.codegen.unit import Function, Unit

GLUE = ("fmi2.c", "fmi3.c", "fmu.h", "fmu_motion.h")

STANDARD = {
    2: ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    3: ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
"""The standard's headers, which importers have and FMUs leave out."""

MOST_STEPS = 1e9
"""Of max_step in one communication step; more are a mistake."""

COMPILER = Tool(("gcc", "clang", "cc"), get="apt install gcc")

LIBRARY = ("-O2", "-fPIC", "-shared", "-fvisibility=hidden")

PLAIN = ("-s", "-Wl,--build-id=none") if sys.platform == "linux" else ()
"""Nothing in a binary but what runs."""

SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")

EPOCH = (1980, 1, 1, 0, 0, 0)
"""When everything in an archive is from, so that the same input gives the same bytes."""


@dataclass(frozen=True)
class Module(Tool):
    """A package of the Python that runs this, whose path stands for it."""

    def found(self) -> str | None:
        return sys.executable if importlib.util.find_spec(self.names[0]) else None

    def says(self) -> str:
        return f"{self.names[0]} {importlib.metadata.version(self.names[0])}"


def files(unit: Unit) -> Files:
    code = sources(unit)
    made = {version: binary(unit, code, version) for version in VERSIONS}
    return {
        **{
            archive_name(unit, version): archive(unit, code, version, made[version])
            for version in VERSIONS
        },
        **{f"sources/{name}": content for name, content in code.items()},
        "selftest.py": text("selftest.py").replace("TOLERANCE = 32", f"TOLERANCE = {TOLERANCE}"),
        "README.md": _readme(unit, all(made.values())),
        **vectors(unit),
    }


def archive_name(unit: Unit, version: int) -> str:
    return f"{unit.name}_fmi{version}.fmu"


def text(name: str) -> str:
    """Of what is the same for every arm."""
    return (resources.files("mcgee.codegen") / "texts" / "fmi" / name).read_text("utf-8")


def _readme(unit: Unit, binaries: bool) -> str:
    fmi2, fmi3 = (archive_name(unit, version) for version in VERSIONS)
    has = f"for {places()[3]}" if binaries else "left out, for no C compiler here could make it"
    return readme(
        unit,
        "FMUs",
        f"`{fmi2}` and `{fmi3}` are the arm by FMI 2.0 and 3.0, for model exchange and for "
        f"co-simulation: tau goes in; q, qd, qdd, T, P and E = T + P come out; parameters are "
        f"tunable. {METHOD} Each holds its C sources and a binary ({has}).",
        "`sources/` holds the C too, with the standard's headers and their licence. The self-test "
        "needs `pip install fmpy`.",
        "python selftest.py",
    )


# -- sources --------------------------------------------------------------------------------------


def sources(unit: Unit) -> Files:
    own = {f"{unit.name}.h": c.header_file(unit), f"{unit.name}.c": c.source(unit)}
    shared: Files = {name: text(name) for name in (*GLUE, *STANDARD[2], *STANDARD[3])}
    shared["fmu_model.h"] = model_header(unit)
    return shared | own


def model_header(unit: Unit) -> str:
    """What the shared sources know of the arm."""
    lines = comment([f"What the FMUs of {unit.title} consist of."], "/*", " * ", " */")
    return lines + _MODEL.format(
        name=unit.name,
        token=fmu_description.token(unit),
        joints=unit.n,
        parameters=len(unit.parameters),
        step=MAX_STEP,
        most=MOST_STEPS,
        calls="".join(map(partial(_call, unit), unit.functions)),
    )


def _call(unit: Unit, function: Function) -> str:
    arguments = ", ".join(a.name for a in (*function.inputs, *function.outputs))
    head = f"#define {function.name.upper()}({arguments})"
    return f"{head} \\\n    {c.symbol(unit, function)}({arguments})\n"


_MODEL = """
#ifndef FMU_MODEL_H
#define FMU_MODEL_H

#include "{name}.h"

#define FUNCTION_PREFIX {name}_
#define MODEL_TOKEN "{token}"

#define JOINTS {joints}
#define PARAMETERS {parameters}
#define DEFAULTS {name}_defaults
#define DEFAULT_MAX_STEP {step!r}
#define MOST_STEPS {most!r} /* of max_step in one communication step; more are a mistake */

typedef {name}_params Params;

{calls}
#endif
"""


# -- binaries and archives ------------------------------------------------------------------------


def places() -> dict[int, str]:
    """What the folders of this machine's binaries are called in each version."""
    system = {"win32": "windows"}.get(sys.platform, sys.platform)
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower())
    bits = 64 if sys.maxsize > 2**32 else 32
    return {
        2: f"{system.removesuffix('dows')}{bits}",
        3: f"{machine or platform.machine().lower()}-{system}",
    }


def compilation(
    compiler: str, unit: Unit, version: int, folder: str, options: Sequence[str]
) -> Command:
    """Of a shared library beside the sources, whose functions have no prefix."""
    prefix = f"-DFMI{version}_OVERRIDE_FUNCTION_PREFIX"
    paths = [f"{folder}{name}" for name in source_names(unit, version)]
    target = f"{folder}fmi{version}{SUFFIX}"
    return [compiler, *options, *LIBRARY, *PLAIN, prefix, "-o", target, *paths, "-lm"]


def binary(unit: Unit, code: Files, version: int) -> bytes | None:
    """The shared library; None where no compiler can make it."""
    compiler = COMPILER.found()
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory(prefix="mcgee-fmu-") as name:
        folder = Path(name)
        put(folder, code)
        command = compilation(compiler, unit, version, "", ["-std=c99"])
        done = subprocess.run(command, cwd=folder, capture_output=True)
        return None if done.returncode else (folder / f"fmi{version}{SUFFIX}").read_bytes()


def archive(unit: Unit, code: Files, version: int, binary: bytes | None) -> bytes:
    """The FMU."""
    headers = {name for names in STANDARD.values() for name in names}
    other = f"fmi{5 - version}.c"
    inside: Files = {
        "modelDescription.xml": fmu_description.model_description(unit, version),
        "documentation/index.html": fmu_description.page(unit),
        **{f"sources/{name}": x for name, x in code.items() if name not in {*headers, other}},
    }
    if version == 3:
        inside["sources/buildDescription.xml"] = fmu_description.build_description(unit)
    if binary is not None:
        inside[f"binaries/{places()[version]}/{unit.name}{SUFFIX}"] = binary
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as whole:
        for path in sorted(inside):
            entry = zipfile.ZipInfo(path, EPOCH)
            entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, 3
            entry.external_attr = 0o644 << 16
            whole.writestr(entry, as_bytes(inside[path]))
    return packed.getvalue()


# -- trying them ----------------------------------------------------------------------------------


def _build(unit: Unit, tools: list[str]) -> list[Command]:
    compiler = tools[0]
    return [compilation(compiler, unit, v, "sources/", c.WARNINGS) for v in VERSIONS]


FMU = Language(
    "fmu",
    "FMU",
    files,
    tools=(COMPILER, Module(("fmpy",), get="pip install fmpy")),
    build=_build,
    run=lambda unit, tools: [[tools[1], "selftest.py"]],
    parametric=True,
    functions=("forward_dynamics", "kinetic_energy", "potential_energy"),
)
