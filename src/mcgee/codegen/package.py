"""Folders of generated files, written whole or not at all."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from pathlib import Path

import mcgee
from mcgee.codegen.common import Files
from mcgee.codegen.unit import Unit

MANIFEST = "mcgee.json"


def manifest(unit: Unit, target: str, files: Files) -> str:
    """What the folder holds, so that it can be known again."""
    content = {
        "generator": f"mcgee {mcgee.__version__}",
        "target": target,
        "robot": unit.robot.name,
        "description_sha256": unit.fingerprint,
        "functions": [f.name for f in unit.functions],
        "parameters": {p.identifier: p.value for p in unit.parameters},
        "files": {
            path: hashlib.sha256(as_bytes(files[path])).hexdigest() for path in sorted(files)
        },
    }
    return json.dumps(content, indent=1) + "\n"


def as_bytes(content: str | bytes) -> bytes:
    return content if isinstance(content, bytes) else content.encode("utf-8")


def check(folder: Path, overwrite: bool) -> None:
    """Raises: ValueError: files cannot or should not go there"""
    try:
        if folder.is_symlink() and not folder.exists():
            raise ValueError(f"cannot write to '{folder}': it is a link to nothing.")
        if folder.exists() and not folder.is_dir():
            raise ValueError(f"cannot write to '{folder}': it is a file. Name a folder.")
        if folder.is_dir() and any(folder.iterdir()) and not overwrite:
            raise ValueError(
                f"'{folder}' exists and is not empty. Name another folder, or write over the "
                f"generated files in it with overwrite=True (--force)."
            )
    except OSError as error:
        raise ValueError(f"cannot write to '{folder}': {error.strerror or error}.") from error


def write(folder: Path, files: Files, overwrite: bool) -> Path:
    """Write a package. What else is in an existing folder stays; what an earlier package had goes.

    The folder is made beside its place and moved there, so nobody sees half of it.

    Raises: ValueError: it cannot be written
    """
    check(folder, overwrite)
    place = folder.resolve()
    staged: Path | None = None
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        staged = Path(tempfile.mkdtemp(prefix=f".{place.name}-", dir=place.parent))
        if place.is_dir():
            shutil.copytree(place, staged, dirs_exist_ok=True, symlinks=True)
            _forget(staged)
        else:
            staged.chmod(0o777 & ~_umask())
        put(staged, files)
        _swap(staged, place)
    except OSError as error:
        raise ValueError(f"cannot write to '{folder}': {error.strerror or error}.") from error
    finally:
        if staged is not None:
            shutil.rmtree(staged, ignore_errors=True)
    return folder


def put(folder: Path, files: Files) -> None:
    for path, content in files.items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.unlink(missing_ok=True)  # a link is replaced, not followed
        target.write_bytes(as_bytes(content))


def _forget(folder: Path) -> None:
    """Remove what an earlier package put there and its owner left as it was."""
    try:
        known = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["files"]
        listed = {str(path): str(digest) for path, digest in known.items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return  # no package
    for path, digest in listed.items():
        file = folder / path
        inside = folder.resolve() in file.resolve().parents
        if inside and file.is_file() and hashlib.sha256(file.read_bytes()).hexdigest() == digest:
            file.unlink()


def _swap(staged: Path, place: Path) -> None:
    if not place.exists():
        staged.rename(place)
        return
    aside = staged.with_name(f"{staged.name}-old")
    shutil.copystat(place, staged)
    os.replace(place, aside)
    try:
        os.replace(staged, place)
    except OSError:
        os.replace(aside, place)
        raise
    shutil.rmtree(aside, ignore_errors=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
