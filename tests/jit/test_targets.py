"""Code for processors and systems that are not this one: that it can be made, and what it calls.

In a process of its own, for LLVM aborts where it cannot go on.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

from mcgee.jit.compile import PYTHON_FUNCTIONS
from mcgee.jit.target import _lanes, host

FOREIGN = {
    "aarch64-unknown-linux-gnu": (2, True),
    "arm64-apple-macosx11.0.0": (2, True),
    "aarch64-pc-windows-msvc": (2, True),
    "x86_64-unknown-linux-gnu": (4, True),
    "x86_64-apple-macosx10.15.0": (8, True),
    "x86_64-pc-windows-msvc": (4, True),
}
# beyond what compile._symbols gives; the Windows stack probe is in ntdll, in every process, and
# LLVM finds it there; _fltused is a mark that nothing refers to
KNOWN = {"cos", "sin", *PYTHON_FUNCTIONS, "__chkstk", "_fltused", ""}
KNOWN |= {"_GLOBAL_OFFSET_TABLE_"}

CROSS = """
import struct, sys
import llvmlite.binding as llvm
llvm.initialize_all_targets()
llvm.initialize_all_asmprinters()
from mcgee import arms, build
from mcgee.graph import cut
from mcgee.jit import kernel as kernels, loop
from mcgee.jit.compile import _object
from mcgee.jit.kernel import kernel_ir
from mcgee.jit.sincos import sincos_ir
from mcgee.jit.target import Target

def undefined(code):
    if code[:4] == b"\\x7fELF":
        table = struct.unpack_from("<Q", code, 40)[0]
        count = struct.unpack_from("<H", code, 60)[0]
        sections = [struct.unpack_from("<IIQQQQIIQQ", code, table + 64 * i) for i in range(count)]
        symbols = next(s for s in sections if s[1] == 2)
        strings = sections[symbols[6]][4]
        for at in range(symbols[4], symbols[4] + symbols[5], 24):
            name, _, _, section = struct.unpack_from("<IBBH", code, at)
            if section == 0:
                yield code[strings + name : code.index(b"\\0", strings + name)].decode()
    elif code[:4] == b"\\xcf\\xfa\\xed\\xfe":
        at = 32
        while struct.unpack_from("<I", code, at)[0] != 2:
            at += struct.unpack_from("<I", code, at + 4)[0]
        table, count, strings = struct.unpack_from("<III", code, at + 8)
        for i in range(count):
            name, kind = struct.unpack_from("<IB", code, table + 16 * i)
            if kind & 0x0E == 0:
                text = code[strings + name : code.index(b"\\0", strings + name)].decode()
                yield text.removeprefix("_")
    else:
        table, count = struct.unpack_from("<II", code, 8)
        strings, i = table + 18 * count, 0
        while i < count:
            at = table + 18 * i
            section, _, storage, extra = struct.unpack_from("<hHBB", code, at + 12)
            if section == 0 and storage == 2:
                zero, far = struct.unpack_from("<II", code, at)
                start = at if zero else strings + far
                yield code[start : start + 8 if zero else None].split(b"\\0")[0].decode()
            i += 1 + extra

triple, lanes, fma = sys.argv[1], int(sys.argv[2]), sys.argv[3] == "True"
features = "" if not triple.startswith("x86") else "+avx512f,+fma" if lanes == 8 else "+avx2,+fma"
target = Target(triple, "", features, lanes, fma)
for stack, quantity in ((loop.STACK, "christoffel"), (0, "terms")):
    loop.STACK = stack
    kernels.LONG = 0 if stack else 10**9  # with tables, and without
    cut.SHORTEST, cut.LONGEST, cut.SURROUNDINGS = 4, 12, 2
    program = build.trace(arms.ur5e().mechanism, quantity)
    kernel = kernel_ir(program, target)
    assert ("@places" in kernel.text) == bool(stack)
    text = sincos_ir(target) + kernel.text + loop.loop_ir(program, kernel, target)
    print(*sorted(set(undefined(_object(text, target)))))
"""


@pytest.mark.parametrize("triple", FOREIGN)
def test_objects_for_other_systems(triple):
    run = subprocess.run(
        [sys.executable, "-c", CROSS, triple, *map(str, FOREIGN[triple])],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (run.returncode, run.stderr) == (0, "")
    lines = [set(line.split(" ")) for line in run.stdout.splitlines()]
    assert len(lines) == 2
    for names in lines:
        assert {"cos", "sin"} <= names <= KNOWN
    assert "PyMem_RawMalloc" not in lines[0]
    assert "PyMem_RawMalloc" in lines[1]


def test_lanes_of_the_registers():
    assert _lanes({}) == 2
    assert _lanes({"sse2": True, "avx": False}) == 2
    assert _lanes({"avx": True, "avx512f": False}) == 4
    assert _lanes({"avx": True, "avx512f": True, "avx512dq": True}) == 8
    assert _lanes({"avx": True, "avx512f": True}) == 4
    assert host().lanes in (2, 4, 8)
    assert host() is host()
