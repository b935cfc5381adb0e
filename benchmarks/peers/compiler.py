"""The C and C++ compilers that peers are built with."""

import shutil
import subprocess
from pathlib import Path

from peers import AbsentError

FLAGS = ("-O3", "-march=native", "-DNDEBUG", "-shared", "-fPIC", "-w")


def found(*names: str) -> str:
    for name in names:
        if shutil.which(name):
            return name
    raise AbsentError(f"none of the compilers {', '.join(names)} is here")


def cpp() -> str:
    return found("clang++", "clang++-19", "clang++-18", "clang++-14", "g++")


def c() -> str:
    return found("clang", "clang-19", "clang-18", "clang-14", "gcc")


def built(compiler: str, source: Path, library: Path, *flags: str) -> Path:
    """The library, compiled where it is older than its source."""
    if not library.exists() or library.stat().st_mtime < source.stat().st_mtime:
        library.parent.mkdir(parents=True, exist_ok=True)
        command = [compiler, *FLAGS, str(source), "-o", str(library), *flags]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise AbsentError(f"{compiler} failed: {done.stderr.strip().splitlines()[:1]}")
    return library
