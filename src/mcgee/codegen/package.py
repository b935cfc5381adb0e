"""Folders of generated files, written whole or not at all."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import tempfile
from pathlib import Path

import mcgee
from mcgee.codegen.common import Files
from mcgee.codegen.unit import Unit
from mcgee.writing import umask

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

    Nobody sees half of a new one; in an existing one files are exchanged one by one, the manifest
    last, and come back where that fails or is stopped.

    Raises: ValueError: it cannot be written
    """
    check(folder, overwrite)
    place = folder.resolve()
    try:
        if place.is_dir():
            _check_inside(place, files)
            _exchange(place, files)
        else:
            place.parent.mkdir(parents=True, exist_ok=True)
            _make(place, files)
    except OSError as error:
        at = f" ('{error.filename}')" if error.filename else ""
        raise ValueError(
            f"cannot write to '{folder}': {error.strerror or error}{at}. Name another folder."
        ) from error
    return folder


def put(folder: Path, files: Files) -> None:
    for path, content in files.items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(as_bytes(content))


def _make(place: Path, files: Files) -> None:
    """Made beside its place and moved there."""
    staged = Path(tempfile.mkdtemp(prefix=f".{place.name}-", dir=place.parent))
    try:
        staged.chmod(0o777 & ~umask())
        put(staged, files)
        staged.rename(place)
    except BaseException:
        shutil.rmtree(staged, ignore_errors=True)
        raise


def _check_inside(place: Path, files: Files) -> None:
    """Raises: ValueError: a link would lead the files elsewhere, or a folder is in a file's way"""
    for path in files:
        target = place / path
        for parent in target.parents:
            if parent == place:
                break
            if parent.is_symlink() or (parent.exists() and not parent.is_dir()):
                what = "a link" if parent.is_symlink() else "a file"
                raise ValueError(
                    f"cannot write '{path}' to '{place}': '{parent.relative_to(place)}' is {what} "
                    f"there. Remove it, or name another folder."
                )
        if target.is_dir() and not target.is_symlink():
            raise ValueError(
                f"cannot write '{path}' to '{place}': a folder has that name. Remove it, or name "
                f"another folder."
            )


def _exchange(place: Path, files: Files) -> None:
    """New files for those of before."""
    paths = [*sorted(_stale(place, files)), *sorted(files, key=lambda path: path == MANIFEST)]
    missing = {parent for path in files for parent in (place / path).parents if not parent.exists()}
    with tempfile.TemporaryDirectory(prefix=".mcgee-", dir=place) as name:
        new, old = Path(name) / "new", Path(name) / "old"
        put(new, files)
        moved: list[tuple[str, bool]] = []
        try:
            for path in paths:
                target, there = place / path, os.path.lexists(place / path)
                moved.append((path, there))
                if there:
                    (old / path).parent.mkdir(parents=True, exist_ok=True)
                    os.replace(target, old / path)  # a link itself, not what it leads to
                if path in files:
                    target.parent.mkdir(parents=True, exist_ok=True)
                    os.replace(new / path, target)
        except BaseException:
            _put_back(place, old, moved)
            for folder in sorted(missing, reverse=True):
                with contextlib.suppress(OSError):
                    folder.rmdir()
            raise


def _put_back(place: Path, old: Path, moved: list[tuple[str, bool]]) -> None:
    for path, there in reversed(moved):
        if not there:
            (place / path).unlink(missing_ok=True)
        elif os.path.lexists(old / path):
            os.replace(old / path, place / path)


def _stale(folder: Path, files: Files) -> set[str]:
    """What an earlier package put there, its owner left as it was, and this one has not."""
    try:
        known = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["files"]
        listed = {str(path): str(digest) for path, digest in known.items() if path not in files}
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return set()  # no package
    found = set()
    for path, digest in listed.items():
        file = folder / path
        inside = folder in file.resolve().parents and not file.is_symlink()
        if inside and file.is_file() and hashlib.sha256(file.read_bytes()).hexdigest() == digest:
            found.add(file.resolve().relative_to(folder).as_posix())
    return found
