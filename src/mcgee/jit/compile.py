"""From a program to an address: IR, object code, cache, link."""

from __future__ import annotations

import ctypes
import ctypes.util
import hashlib
import sys
import threading
from typing import Any

from mcgee.graph.program import Program
from mcgee.jit import cache
from mcgee.jit.kernel import kernel_ir
from mcgee.jit.loop import loop_ir
from mcgee.jit.sincos import sincos_ir
from mcgee.jit.target import Target, host

_lock = threading.Lock()
_kept: list = []  # linked code lives as long as the process


def compiled(program: Program) -> int:
    """The address of the program's gufunc loop, from the cache where it holds one."""
    target = host()
    kernel = kernel_ir(program, target)
    text = sincos_ir(target) + kernel.text + loop_ir(program, kernel, target)
    key = _key(text, target)
    with _lock:
        code = cache.read(key)
        if code is None:
            code = _object(text, target)
            cache.write(key, code)
        return _linked(code, key)


def _key(text: str, target: Target) -> str:
    import llvmlite
    import llvmlite.binding as llvm

    versions = f"{llvmlite.__version__} {llvm.llvm_version_info}"
    parts = (versions, target.triple, target.cpu, target.features, text)
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _machine(target: Target) -> Any:
    import llvmlite.binding as llvm

    return llvm.Target.from_triple(target.triple).create_target_machine(
        cpu=target.cpu, features=target.features, opt=2, reloc="pic", jit=True
    )


def _object(text: str, target: Target) -> bytes:
    import llvmlite.binding as llvm

    machine = _machine(target)
    module = llvm.parse_assembly(text)
    module.triple = target.triple
    module.data_layout = str(machine.target_data)
    module.verify()
    return machine.emit_object(module)


def _linked(code: bytes, key: str) -> int:
    import llvmlite.binding as llvm

    linker = llvm.create_lljit_compiler(_machine(host()))
    library = llvm.JITLibraryBuilder().add_object_img(code).export_symbol("loop")
    for name, address in _symbols().items():
        library = library.import_symbol(name, address)
    tracker = library.link(linker, key)
    _kept.append((linker, tracker))
    return tracker["loop"]


def _symbols() -> dict[str, int]:
    """Functions of this process that kernels call; they enter by name, never as numbers."""
    name = "ucrtbase" if sys.platform == "win32" else ctypes.util.find_library("m")
    mathematics = ctypes.CDLL(name)
    functions = {
        "cos": mathematics.cos,
        "sin": mathematics.sin,
        "PyMem_RawMalloc": ctypes.pythonapi.PyMem_RawMalloc,
        "PyMem_RawFree": ctypes.pythonapi.PyMem_RawFree,
    }
    return {
        name: ctypes.cast(function, ctypes.c_void_p).value or 0
        for name, function in functions.items()
    }
