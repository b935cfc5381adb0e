"""What a language is to the generator: files from a unit, and the commands that try them out."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field

from mcgee.codegen.common import Files
from mcgee.codegen.unit import Unit

Command = list[str]


@dataclass(frozen=True)
class Tool:
    """A program that verification needs, under the names it goes by."""

    names: tuple[str, ...]
    version: tuple[str, ...] = ("--version",)
    get: str = ""
    """How to install it, for those who lack it."""

    def found(self) -> str | None:
        return next((path for name in self.names if (path := shutil.which(name))), None)

    def says(self) -> str:
        """The first line of its version."""
        command = [self.found() or "", *self.version]
        said = subprocess.run(command, capture_output=True, text=True, timeout=120)
        lines = (said.stdout or said.stderr).strip().splitlines()
        return lines[0] if lines else self.names[0]


@dataclass(frozen=True)
class Language:
    """A target of `mcgee codegen`.

    Commands run in the package's folder, and are made from the paths of the tools, in their order.
    """

    name: str
    title: str
    files: Callable[[Unit], Files]
    tools: tuple[Tool, ...]
    build: Callable[[Unit, list[str]], list[Command]]
    """Warnings are errors."""
    run: Callable[[Unit, list[str]], list[Command]]
    """The self-tests."""
    floats: bool = False
    """Whether it can be had in float."""
    parametric: bool = False
    """Whether its parameters stay open even where none are asked for."""
    functions: tuple[str, ...] = field(default=())
    """What it is always made of, whatever is asked for; nothing for most."""
