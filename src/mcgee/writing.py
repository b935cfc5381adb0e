"""Files for people, written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path


def write_whole(path: Path, what: str, text: Callable[[], str | bytes]) -> Path:
    """Write a file, or leave what was there.

    Args:
        what: for messages, as in "the page"
        text: makes the text or bytes, once it is known that the place is good
    Returns: the path
    Raises: ValueError: the path cannot be written
    """
    try:
        path_as_given, path = path, path.resolve()  # a link stays a link
        check_place(path, what)
        if path.exists() and not path.is_file():  # a pipe, a device
            path.write_bytes(_bytes(text()))
        else:
            _replace(path, _bytes(text()))
    except OSError as error:
        reason = error.strerror or str(error)
        raise ValueError(f"cannot write {what} to '{path}': {reason}.") from error
    return path_as_given


def check_place(path: Path, what: str) -> None:
    """Whether a file can be there, before what is in it is made.

    Raises: ValueError: it cannot
    """
    if path.is_dir():
        raise ValueError(f"cannot write {what} to '{path}': it is a folder. Name a file in it.")
    if not path.parent.is_dir():
        raise ValueError(
            f"cannot write {what} to '{path}': there is no folder '{path.parent}'. Make it first."
        )
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise ValueError(f"cannot write {what} to '{path}': '{path.parent}' is not writable.")


def _bytes(text: str | bytes) -> bytes:
    return text if isinstance(text, bytes) else text.encode("utf-8")


def _replace(path: Path, content: bytes) -> None:
    """Into a temporary file beside it, which then takes its place."""
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(name, 0o666 & ~umask())  # mkstemp's own is for its user alone
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def umask() -> int:
    """The permissions that new files do not get."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
