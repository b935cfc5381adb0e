"""Verified code in other languages: robot → routines → text → compiled, run and compared.

Adding a language: docs/codegen.md.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mcgee import build
from mcgee.codegen.c import C
from mcgee.codegen.cpp import CPP
from mcgee.codegen.fmu import FMU
from mcgee.codegen.java import JAVA
from mcgee.codegen.javascript import JAVASCRIPT
from mcgee.codegen.language import Language
from mcgee.codegen.matlab import MATLAB
from mcgee.codegen.package import MANIFEST, check, manifest, write
from mcgee.codegen.python import PYTHON
from mcgee.codegen.simulink import SIMULINK
from mcgee.codegen.unit import unit
from mcgee.codegen.verify import Verification, VerificationError, verify
from mcgee.codegen.wolfram import WOLFRAM

if TYPE_CHECKING:
    from mcgee.robot import Robot

__all__ = [
    "FUNCTIONS",
    "LANGUAGES",
    "Package",
    "Verification",
    "VerificationError",
    "codegen",
    "language",
]

_ALL = (PYTHON, C, CPP, JAVA, MATLAB, SIMULINK, FMU, WOLFRAM, JAVASCRIPT)

LANGUAGES: dict[str, Language] = {known.name: known for known in _ALL}
"""By the name of a target."""

FUNCTIONS = tuple(build.SIGNATURES)
"""What can be asked for; terms are M, C qd and g."""

VERIFIED = "VERIFIED.md"


@dataclass(frozen=True)
class Package:
    """Generated code in its folder."""

    folder: Path
    target: str
    files: tuple[str, ...]
    """Paths in the folder."""
    verification: Verification | None
    """What came of trying it; None where that was not asked for."""

    @property
    def verified(self) -> bool:
        return self.verification is not None and self.verification.done


def codegen(
    robot: Robot,
    target: str,
    directory: str | os.PathLike[str],
    functions: Sequence[str],
    *,
    params: bool,
    values: Mapping[Any, float] | None,
    frame: str,
    single: bool,
    overwrite: bool,
    verified: bool,
) -> Package:
    """See Robot.codegen."""
    chosen = language(target, single)
    folder = Path(directory)
    check(folder, overwrite)
    asked = _functions(functions)
    wanted = chosen.functions or asked
    open_ = params or chosen.parametric
    made = unit(robot, wanted, open_, values or {}, frame, single)
    files = chosen.files(made)
    done = verify(chosen, made, files) if verified else None
    if done is not None and done.done:
        files[VERIFIED] = done.text()
    files[MANIFEST] = manifest(made, target, files)
    write(folder, files, overwrite)
    return Package(folder, target, tuple(sorted(files)), done)


def language(target: str, single: bool = False) -> Language:
    """Raises: ValueError: there is no such target, or none in float"""
    if target not in LANGUAGES:
        raise ValueError(f"target is {target!r}, expected one of: {', '.join(LANGUAGES)}.")
    found = LANGUAGES[target]
    if single and not found.floats:
        can = ", ".join(x.name for x in LANGUAGES.values() if x.floats)
        raise ValueError(f"target '{target}' has no float numbers. Targets that have: {can}.")
    return found


def _functions(functions: Sequence[str]) -> tuple[str, ...]:
    wanted = (functions,) if isinstance(functions, str) else tuple(functions)
    for name in wanted:
        if name not in FUNCTIONS:
            raise ValueError(f"there is no function {name!r}; there are {', '.join(FUNCTIONS)}.")
    if not wanted:
        raise ValueError(f"no function is asked for; there are {', '.join(FUNCTIONS)}.")
    return tuple(dict.fromkeys(wanted))
