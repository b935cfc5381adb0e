"""Compiled objects on disk, in a directory that only the user can write.

An entry is trusted where the user owns it, nobody else may write it, and its digest fits;
otherwise it is as if it were not there. Nothing here is fatal: without a usable directory there is
no cache.
"""

from __future__ import annotations

import hashlib
import os
import stat
import sys
import tempfile
from pathlib import Path

MAGIC = b"mcgee object 1\n"


def directory() -> Path | None:
    """Where entries live: MCGEE_CACHE_DIR, or the platform's place; None where it is set empty."""
    chosen = os.environ.get("MCGEE_CACHE_DIR")
    if chosen is not None:
        try:
            return Path(chosen).expanduser() if chosen else None
        except RuntimeError:  # ~ of nobody
            return None
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
        return Path(base) / "mcgee" / "cache" if base else None
    try:
        home = Path.home()
    except RuntimeError:
        return None
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "mcgee"
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(base) / "mcgee" if base and os.path.isabs(base) else home / ".cache" / "mcgee"


def read(key: str) -> bytes | None:
    """The object stored under a key, or None."""
    folder = directory()
    if folder is None or not _is_ours(folder):
        return None
    try:
        with open(folder / f"{key}.o", "rb") as file:
            if not _only_mine(os.fstat(file.fileno())):
                return None
            content = file.read()
    except OSError:
        return None
    head = len(MAGIC) + 32
    digest, code = content[len(MAGIC) : head], content[head:]
    return code if content.startswith(MAGIC) and digest == _digest(key, code) else None


def write(key: str, code: bytes) -> None:
    """Store an object; a reader sees all of it or nothing."""
    folder = directory()
    if folder is None:
        return
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not _is_ours(folder):
            return
        handle, name = tempfile.mkstemp(dir=folder, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(MAGIC + _digest(key, code) + code)
            os.replace(name, folder / f"{key}.o")
        except BaseException:
            os.unlink(name)
            raise
    except OSError:
        return


def _digest(key: str, code: bytes) -> bytes:
    return hashlib.sha256(key.encode() + code).digest()


def _is_ours(folder: Path) -> bool:
    try:
        return _only_mine(os.stat(folder))
    except OSError:
        return False


def _only_mine(status: os.stat_result) -> bool:
    """Owned by this user and writable by nobody else; Windows keeps such rights elsewhere."""
    if not hasattr(os, "getuid"):
        return True
    others = stat.S_IWGRP | stat.S_IWOTH
    return status.st_uid == os.getuid() and not status.st_mode & others
