"""From a program to an address: IR, object code, cache, link."""

from __future__ import annotations

import ctypes
import ctypes.util
import hashlib
import os
import sys
import threading
from collections.abc import Mapping
from functools import cache as remembered
from types import MappingProxyType
from typing import Any

from mcgee.graph.program import Program
from mcgee.jit import cache
from mcgee.jit.kernel import kernel_ir
from mcgee.jit.loop import loop_ir
from mcgee.jit.rollout import rollout_ir
from mcgee.jit.sincos import sincos_ir
from mcgee.jit.single import single_ir
from mcgee.jit.target import Target, host

NEAR = sys.platform != "win32"
"""Whether the linker puts constants beside code, so that short addresses reach them."""

SETTINGS = {
    "opt": 2,
    "reloc": "pic",
    "codemodel": "small" if NEAR else "jitdefault",
    "jit": True,
}
"""Of the code generator; part of the cache's key, as is everything else that shapes an object."""

PYTHON_FUNCTIONS = (
    "PyMem_RawMalloc",
    "PyMem_RawFree",
    "PyGILState_Ensure",
    "PyErr_NoMemory",
    "PyGILState_Release",
)

NO_SYMBOLS: Mapping[str, int] = MappingProxyType({})

_lock = threading.Lock()
if hasattr(os, "register_at_fork"):  # a child must not inherit a lock that nobody will release
    os.register_at_fork(
        before=_lock.acquire, after_in_parent=_lock.release, after_in_child=_lock.release
    )
_kept: list = []  # linked code lives as long as the process
_linked_here: dict[str, int] = {}


def compiled(program: Program, *, single: bool = False) -> int:
    """The address of the program's gufunc loop, of float64 or of float32."""
    target = host().single if single else host()
    kernel = kernel_ir(program, target)
    text = sincos_ir(target) + kernel.text + loop_ir(program, kernel, target)
    return address("loop", text)


def compiled_rollout(program: Program) -> int:
    """The address of the loop of many steps of a program, see `rollout_ir`."""
    target = host()
    kernel = kernel_ir(program, target)
    return address("rollout", sincos_ir(target) + kernel.text + rollout_ir(program, kernel, target))


def compiled_row(program: Program) -> int:
    """The address of the function that computes one row, see `single_ir`."""
    return address("single", single_ir(program, host()))


def address(entry: str, text: str, symbols: Mapping[str, int] = NO_SYMBOLS) -> int:
    """Where a function is, from the cache where it holds it.

    Args:
        symbols: addresses of this process that the text names, besides those of `_symbols`
    """
    target = host()
    key = _key(text, target)
    with _lock:
        if key not in _linked_here:
            code = cache.read(key)
            if code is None:
                code = _object(text, target)
                cache.write(key, code)
            _linked_here[key] = _link(code, key, entry, symbols)
        return _linked_here[key]


def _key(text: str, target: Target) -> str:
    import llvmlite
    import llvmlite.binding as llvm

    versions = f"{llvmlite.__version__} {llvm.llvm_version_info}"
    parts = (versions, repr(SETTINGS), target.triple, target.cpu, target.features, text)
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _machine(target: Target) -> Any:
    import llvmlite.binding as llvm

    return llvm.Target.from_triple(target.triple).create_target_machine(
        cpu=target.cpu, features=target.features, **SETTINGS
    )


def _object(text: str, target: Target) -> bytes:
    import llvmlite.binding as llvm

    machine = _machine(target)
    module = llvm.parse_assembly(text)
    module.triple = target.triple
    module.data_layout = str(machine.target_data)
    module.verify()
    return machine.emit_object(module)


def _link(code: bytes, key: str, entry: str, symbols: Mapping[str, int]) -> int:
    import llvmlite.binding as llvm

    target = host()
    linker = llvm.create_lljit_compiler(_machine(target), use_jit_link=NEAR or target.arm64)
    library = llvm.JITLibraryBuilder().add_object_img(code).export_symbol(entry)
    for name, place in {**_symbols(), **symbols}.items():
        library = library.import_symbol(name, place)
    tracker = library.link(linker, key)
    _kept.append((linker, tracker))
    return tracker[entry]


@remembered
def _symbols() -> dict[str, int]:
    """Functions of this process that kernels call; they enter by name, never as numbers."""
    name = "ucrtbase" if sys.platform == "win32" else ctypes.util.find_library("m")
    mathematics = ctypes.CDLL(name)
    functions = {name: getattr(mathematics, name) for name in ("cos", "sin")}
    functions |= {name: getattr(ctypes.pythonapi, name) for name in PYTHON_FUNCTIONS}
    return {
        name: ctypes.cast(function, ctypes.c_void_p).value or 0
        for name, function in functions.items()
    }
