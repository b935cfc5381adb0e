"""Generated code in its own toolchain: compiled with warnings as errors, run, and compared.

A package's self-test is run twice: on the vectors that it ships, which are 60-digit results rounded
once, and on fresh states with the results of the compiled kernels.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mcgee.codegen.common import TOLERANCE, VECTORS, Files
from mcgee.codegen.language import Command, Language
from mcgee.codegen.package import put
from mcgee.codegen.unit import Function, Unit
from mcgee.codegen.vectors import Vectors

LINE = re.compile(r"^(\w+): (\d+) states, largest error (\S+) ulp$", re.MULTILINE)
PATIENCE = 1800
"""Seconds that a command may take."""


@dataclass(frozen=True)
class Agreement:
    """How well one function agrees, in units in the last place of the results' scale."""

    function: str
    states: int
    exact: float
    """The largest error against 60 digits."""
    kernel_states: int
    kernel: float
    """The largest difference from the compiled kernels."""


@dataclass(frozen=True)
class Verification:
    target: str
    tools: tuple[str, ...]
    """What they say their versions are."""
    agreements: tuple[Agreement, ...]
    missing: str = ""
    """What toolchain is not here, and how to get it; then nothing was verified."""

    @property
    def done(self) -> bool:
        return not self.missing

    def text(self) -> str:
        """The table that goes into the package."""
        lines = [
            "# Verified",
            "",
            f"Compiled with warnings as errors and run by {'; '.join(self.tools)}.",
            "Largest errors in units in the last place of the results' scale: against 60-digit",
            "arithmetic on the vectors of this package, and against mcgee's kernels on others.",
            "",
            "| function | states | error, 60 digits | states | difference, kernels |",
            "|---|--:|--:|--:|--:|",
        ]
        for a in self.agreements:
            lines.append(
                f"| {a.function} | {a.states} | {a.exact:.2g} | {a.kernel_states} | "
                f"{a.kernel:.2g} |"
            )
        return "\n".join([*lines, ""])


class VerificationError(Exception):
    """Generated code does not compile, does not run, or gives wrong numbers."""


def verify(language: Language, unit: Unit, files: Files) -> Verification:
    """Try a package in a folder that is then gone.

    Returns: the largest errors, or which tool is missing
    Raises: VerificationError: it does not hold
    """
    paths = [tool.found() for tool in language.tools]
    lacking = [
        f"{' or '.join(tool.names)}{f' ({tool.get})' if tool.get else ''}"
        for tool, path in zip(language.tools, paths, strict=True)
        if path is None
    ]
    if lacking:
        return Verification(language.name, (), (), " and ".join(lacking))
    tools = [path for path in paths if path is not None]
    with tempfile.TemporaryDirectory(prefix="mcgee-verify-") as name:
        folder = Path(name)
        put(folder, files)
        for command in language.build(unit, tools):
            _run(command, folder, language)
        exact = _tested(language, unit, tools, folder)
        put(folder, {f"{VECTORS}/{f.name}.txt": _by_kernel(unit, f).text() for f in unit.functions})
        kernel = _tested(language, unit, tools, folder)
    agreements = tuple(Agreement(f.name, *exact[f.name], *kernel[f.name]) for f in unit.functions)
    return Verification(language.name, tuple(t.says() for t in language.tools), agreements)


def _tested(
    language: Language, unit: Unit, tools: list[str], folder: Path
) -> dict[str, tuple[int, float]]:
    """(states, largest error) by function, as the self-tests say."""
    said = "".join(_run(command, folder, language) for command in language.run(unit, tools))
    found: dict[str, tuple[int, float]] = {}
    for function, states, error in LINE.findall(said):
        before = found.get(function, (0, 0.0))
        found[function] = int(states), max(before[1], float(error))
    for f in unit.functions:
        states, error = found.get(f.name, (0, np.inf))
        if states != len((folder / VECTORS / f"{f.name}.txt").read_text().splitlines()):
            raise VerificationError(
                f"the self-test of {language.title} tried {states} states of {f.name}, not all:\n"
                f"{said}"
            )
        if not error <= TOLERANCE:
            raise VerificationError(f"{f.name} in {language.title} is {error:g} ulp off.")
    return found


def _run(command: Command, folder: Path, language: Language) -> str:
    try:
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE, errors="replace"
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise VerificationError(f"{language.title}: {error}") from error
    if done.returncode:
        said = (done.stderr + done.stdout).strip().splitlines()
        raise VerificationError(
            f"the {language.title} code was refused or is wrong. '{' '.join(command)}' ended with "
            f"{done.returncode}:\n" + "\n".join(said[:20])
        )
    return done.stdout


def _by_kernel(unit: Unit, function: Function) -> Vectors:
    """Fresh states with what the kernels give there; the scales stay those of exact results."""
    fresh = unit.fresh_vectors(function)
    rows = np.array(fresh.rows)
    inputs, at = {}, 0
    for array in function.inputs:
        inputs[array.name] = rows[:, at : at + array.size]
        at += array.size
    for values in unit.kernel(function, inputs):
        size = int(np.prod(values.shape[1:], dtype=int))
        rows[:, at : at + size] = values.reshape(len(rows), size)
        at += size
    return Vectors(tuple(tuple(map(float, row)) for row in rows))
