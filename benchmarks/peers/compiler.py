"""The C and C++ compilers that peers are built with."""

import shutil
import subprocess
from pathlib import Path

from peers import AbsentError

FLAGS = ("-O3", "-march=native", "-DNDEBUG", "-shared", "-fPIC", "-w")


NEWEST = range(24, 14, -1)
"""Versions of clang, tried from the newest down: for Pinocchio too it makes the faster code."""


def found(*names: str) -> str:
    for name in names:
        if shutil.which(name):
            return name
    raise AbsentError(f"none of the compilers {', '.join(names)} is here")


def cpp() -> str:
    return found(*(f"clang++-{version}" for version in NEWEST), "clang++", "g++")


def c() -> str:
    return found(*(f"clang-{version}" for version in NEWEST), "clang", "gcc")


def built(compiler: str, source: Path, library: Path, *flags: str) -> Path:
    """The library, compiled where it is older than its source."""
    if not library.exists() or library.stat().st_mtime < source.stat().st_mtime:
        library.parent.mkdir(parents=True, exist_ok=True)
        command = [compiler, *FLAGS, str(source), "-o", str(library), *flags]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise AbsentError(f"{compiler} failed: {done.stderr.strip().splitlines()[:1]}")
    return library
