"""The cache of objects: what is trusted, what is not, and that nothing about it is fatal."""

from __future__ import annotations

import dataclasses
import os
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import compiling_for, program, targets

from mcgee.jit import cache
from mcgee.jit import compile as jit_compile
from mcgee.jit.target import host
from mcgee.jit.ufunc import gufunc

POSIX = os.name == "posix"
KEY, CODE = "a" * 64, b"\x7fELF and more"
X = np.linspace(-3, 3, 22).reshape(11, 2)


class Forgetful(dict):
    """What this process has linked, as if it had not: every look goes to the disk."""

    def __contains__(self, key: object) -> bool:
        return False


@pytest.fixture(autouse=True)
def _each_look_is_the_first(monkeypatch) -> None:
    monkeypatch.setattr(jit_compile, "_linked_here", Forgetful())


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """An empty cache, not yet made."""
    chosen = tmp_path / "deep" / "cache"
    monkeypatch.setenv("MCGEE_CACHE_DIR", str(chosen))
    return chosen


@pytest.fixture
def objects(monkeypatch) -> list[bytes]:
    """What the code generator has made."""
    made: list[bytes] = []
    make = jit_compile._object

    def counted(text, target):
        made.append(make(text, target))
        return made[-1]

    monkeypatch.setattr(jit_compile, "_object", counted)
    return made


def small(k: float = 2.0):
    return program(lambda x: (x[0] * k + x[1], x[0].cos_sin()[1]), (2,))


def works(k: float = 2.0) -> None:
    got = gufunc(small(k))(X)
    assert np.allclose(got, np.stack([X[:, 0] * k + X[:, 1], np.sin(X[:, 0])], -1), atol=1e-14)


def entries(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.o"))


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


# -- hits and misses ------------------------------------------------------------------------------


def test_the_second_time_nothing_is_compiled(folder, objects):
    works()
    assert len(objects) == 1
    works()
    assert len(objects) == 1
    works(3.0)
    assert len(objects) == 2
    assert len(entries(folder)) == 2
    assert [p for p in folder.iterdir() if p.suffix != ".o"] == []


def test_the_key_depends_on_text_target_and_versions(monkeypatch):
    import llvmlite
    import llvmlite.binding as llvm

    t = host()
    keys = {
        jit_compile._key("text", t),
        jit_compile._key("text 2", t),
        jit_compile._key("text", dataclasses.replace(t, cpu="other")),
        jit_compile._key("text", dataclasses.replace(t, features="+other")),
        jit_compile._key("text", dataclasses.replace(t, triple="other")),
    }
    assert jit_compile._key("text", t) in keys
    monkeypatch.setattr(llvmlite, "__version__", "0.0.1")
    keys.add(jit_compile._key("text", t))
    monkeypatch.setattr(llvm, "llvm_version_info", (0, 0, 1))
    keys.add(jit_compile._key("text", t))
    assert len(keys) == 7
    assert all(len(key) == 64 and key.isalnum() for key in keys)


def test_targets_do_not_share_entries(folder, objects):
    for t in targets().values():
        with compiling_for(t):
            works()
    assert len(objects) == len(entries(folder)) == len(set(targets().values()))


def test_nobodys_home_means_no_cache(monkeypatch):
    monkeypatch.setenv("MCGEE_CACHE_DIR", "~no such user/cache")
    assert cache.directory() is None


def test_an_empty_variable_means_no_cache(monkeypatch, objects, tmp_path):
    monkeypatch.setenv("MCGEE_CACHE_DIR", "")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache.directory() is None
    works()
    works()
    assert len(objects) == 2
    assert cache.read(KEY) is None
    cache.write(KEY, CODE)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("platform", "variables", "wanted"),
    [
        ("linux", {"XDG_CACHE_HOME": "/x"}, "/x/mcgee"),
        ("linux", {"XDG_CACHE_HOME": "relative"}, "/home/me/.cache/mcgee"),
        ("linux", {"XDG_CACHE_HOME": ""}, "/home/me/.cache/mcgee"),
        ("linux", {}, "/home/me/.cache/mcgee"),
        ("darwin", {"XDG_CACHE_HOME": "/x"}, "/home/me/Library/Caches/mcgee"),
        ("win32", {"LOCALAPPDATA": "/l"}, "/l/mcgee/cache"),
        ("win32", {}, None),
        ("linux", {"MCGEE_CACHE_DIR": "/c", "XDG_CACHE_HOME": "/x"}, "/c"),
    ],
)
def test_the_place(platform, variables, wanted, monkeypatch):
    for name in ("MCGEE_CACHE_DIR", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    for name, value in {"HOME": "/home/me", "USERPROFILE": "/home/me", **variables}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "platform", platform)
    assert cache.directory() == (Path(wanted) if wanted else None)


def test_nobody_at_home(monkeypatch):
    def lost():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("MCGEE_CACHE_DIR", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(Path, "home", lost)
    assert cache.directory() is None


# -- damage ---------------------------------------------------------------------------------------


def damaged(content: bytes, other: bytes) -> dict[str, bytes]:
    flipped = bytearray(content)
    flipped[len(content) // 2] ^= 1
    late = bytearray(content)
    late[-1] ^= 0x80
    return {
        "empty": b"",
        "half": content[: len(content) // 2],
        "one byte short": content[:-1],
        "oversized": content + b"\0",
        "much oversized": content + bytes(1 << 22),
        "a bit flipped": bytes(flipped),
        "the last bit flipped": bytes(late),
        "only the magic": cache.MAGIC,
        "magic and digest": content[: len(cache.MAGIC) + 32],
        "another magic": b"mcgee object 0\n" + content[len(cache.MAGIC) :],
        "foreign": b"#!/bin/sh\necho hello\n",
        "valid for another key": other,
        "code without a head": content[len(cache.MAGIC) + 32 :],
    }


KINDS = tuple(damaged(bytes(100), b""))


@pytest.mark.parametrize("kind", KINDS)
def test_damage_is_recompiled_and_mended(kind, folder, objects):
    works(3.0)
    (other,) = entries(folder)
    works()
    entry = next(path for path in entries(folder) if path != other)
    sound = entry.read_bytes()
    entry.write_bytes(damaged(sound, other.read_bytes())[kind])
    assert len(objects) == 2
    assert cache.read(entry.stem) is None
    works()
    assert len(objects) == 3
    assert entry.read_bytes() == sound
    works()
    assert len(objects) == 3


def test_a_directory_in_the_place_of_an_entry(folder, objects):
    works()
    (entry,) = entries(folder)
    entry.unlink()
    (entry / "full").mkdir(parents=True)
    works()
    assert len(objects) == 2
    assert sorted(folder.iterdir()) == [entry]  # and no part was left behind


# -- trust ----------------------------------------------------------------------------------------


def test_modes(folder):
    before = os.umask(0)
    try:
        works()
    finally:
        os.umask(before)
    (entry,) = entries(folder)
    if POSIX:
        assert mode(folder) == 0o700
        assert mode(entry) == 0o600


if POSIX:

    @pytest.mark.parametrize("bits", [0o770, 0o702, 0o777, 0o1777, 0o720])
    def test_a_directory_that_others_can_write_is_not_used(bits, folder, objects):
        works()
        assert cache.read(entries(folder)[0].stem) is not None
        folder.chmod(bits)
        assert cache.read(entries(folder)[0].stem) is None
        works()
        works(3.0)
        assert len(objects) == 3
        assert len(entries(folder)) == 1

    @pytest.mark.parametrize("bits", [0o660, 0o602, 0o666])
    def test_an_entry_that_others_can_write_is_not_used(bits, folder, objects):
        works()
        (entry,) = entries(folder)
        entry.chmod(bits)
        works()
        assert len(objects) == 2
        assert mode(entry) == 0o600  # it was replaced
        works()
        assert len(objects) == 2

    def test_another_users_directory_is_not_used(folder, objects, monkeypatch):
        works()
        me = os.getuid()
        if me == 0:  # only root can give things away
            os.chown(folder, 12345, -1)
        else:
            monkeypatch.setattr(os, "getuid", lambda: me + 1)
        works()
        works(3.0)
        assert len(objects) == 3
        assert len(entries(folder)) == 1

    def test_another_users_entry_is_not_used(folder, objects, monkeypatch):
        works()
        (entry,) = entries(folder)
        if os.getuid() == 0:
            os.chown(entry, 12345, -1)
            works()
            assert len(objects) == 2
            assert entry.stat().st_uid == 0  # it was replaced
        else:
            fstat = os.fstat

            def foreign(fd):
                status = list(fstat(fd))
                status[stat.ST_UID] += 1
                return os.stat_result(status)

            monkeypatch.setattr(os, "fstat", foreign)
            works()
            assert len(objects) == 2

    def test_a_link_to_a_directory_of_others_is_not_followed_blindly(folder, objects, tmp_path):
        """What a link points to is what must be trustworthy."""
        real = tmp_path / "real"
        real.mkdir()
        real.chmod(0o777)
        folder.parent.mkdir(parents=True)
        folder.symlink_to(real)
        works()
        assert list(real.iterdir()) == []
        real.chmod(0o700)
        works()
        works()
        assert len(objects) == 2
        assert len(entries(real)) == 1

    def test_a_linked_entry(folder, objects, tmp_path):
        works()
        (entry,) = entries(folder)
        sound = entry.read_bytes()
        elsewhere = tmp_path / "elsewhere"
        elsewhere.write_bytes(b"precious")
        entry.unlink()
        entry.symlink_to(elsewhere)
        works()  # the link is replaced, what it points to is not written
        assert elsewhere.read_bytes() == b"precious"
        assert not entry.is_symlink()
        assert entry.read_bytes() == sound
        entry.unlink()
        entry.symlink_to(tmp_path / "nowhere")
        works()
        assert len(objects) == 3
        assert not (tmp_path / "nowhere").exists()
        entry.unlink()
        entry.symlink_to(entry)
        works()
        assert len(objects) == 4


def test_a_file_in_the_place_of_the_directory(folder, objects):
    folder.parent.mkdir(parents=True)
    folder.write_text("not a directory")
    works()
    works()
    assert len(objects) == 2
    assert folder.read_text() == "not a directory"


def test_a_file_among_its_parents(tmp_path, monkeypatch, objects):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("MCGEE_CACHE_DIR", str(tmp_path / "file" / "cache"))
    works()
    assert len(objects) == 1


@pytest.mark.parametrize("path", ["/proc/nowhere/mcgee", "/dev/null/x", "x" * 5000])
def test_places_where_nothing_can_be_written(path, monkeypatch, objects):
    monkeypatch.setenv("MCGEE_CACHE_DIR", path)
    works()
    works()
    assert len(objects) == 2


@pytest.mark.parametrize("broken", ["mkstemp", "fdopen", "replace", "mkdir"])
def test_a_disk_that_fails(broken, folder, objects, monkeypatch):
    def fail(*args, **kwargs):
        raise OSError(28, "No space left on device")

    owner = {"mkstemp": cache.tempfile, "fdopen": os, "replace": os, "mkdir": Path}[broken]
    with monkeypatch.context() as patch:
        patch.setattr(owner, broken, fail)
        works()
    assert not folder.exists() or list(folder.iterdir()) == []
    works()
    works()
    assert len(objects) == 2


# -- processes ------------------------------------------------------------------------------------

USE = """
import sys
import numpy as np
from mcgee import arms, build
from mcgee.jit import compile as c
from mcgee.jit.ufunc import gufunc
made, make = [], c._object
c._object = lambda *a: made.append(1) or make(*a)
def show(name, quantity, scale):
    f = gufunc(build.trace(arms.BUILTIN[name]().mechanism, quantity))
    q = np.random.default_rng(0).normal(size=(21, 3)) * scale
    return f(*[q] * f.nin).tobytes().hex()
print(show("planar_3r", "mass_matrix", 1), show("planar_3r", "inverse_dynamics", 1e6))
from mcgee.jit import loop
loop.STACK = 0  # a tile from PyMem_RawMalloc
print(show("planar_3r", "mass_matrix", 1))
print(len(made))
"""


def in_a_process(folder: Path) -> list[str]:
    run = subprocess.run(
        [sys.executable, "-c", USE],
        env={**os.environ, "MCGEE_CACHE_DIR": str(folder)},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    assert run.stderr == ""
    return run.stdout.splitlines()


def test_an_object_of_another_process_gives_the_same_bits(tmp_path):
    """Functions enter by name: their addresses differ from process to process."""
    *first, made = in_a_process(tmp_path / "cache")
    assert made == "3"
    for _ in range(2):
        *again, made = in_a_process(tmp_path / "cache")
        assert made == "0"
        assert again == first


def test_objects_hold_no_address_of_this_process(folder, objects):
    works()
    for address in jit_compile._symbols().values():
        assert address.to_bytes(8, "little") not in objects[0]
        assert address > 0


WRITE = """
import sys
from mcgee.jit import cache
code = bytes(range(256)) * 200
for i in range(80):
    cache.write("shared", code)
    found = cache.read("shared")
    assert found == code, found if found is None else len(found)
"""


def test_writers_at_once(tmp_path):
    """A reader sees a whole entry or none, whoever writes at the same time."""
    environment = {**os.environ, "MCGEE_CACHE_DIR": str(tmp_path / "cache")}
    writers = [
        subprocess.Popen([sys.executable, "-c", WRITE], env=environment, stderr=subprocess.PIPE)
        for _ in range(3)
    ]
    for writer in writers:
        _, errors = writer.communicate(timeout=60)
        assert (writer.returncode, errors) == (0, b"")
    assert [path.name for path in (tmp_path / "cache").iterdir()] == ["shared.o"]
