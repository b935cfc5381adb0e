"""The loop of a NumPy gufunc around a kernel, as LLVM IR.

A few rows at a time are packed into a tile (rows across, so that one vector holds one scalar of
all rows), computed, and unpacked: whole vectors through a transpose where rows are contiguous,
scalar by scalar otherwise and at the end of a batch. Idle lanes repeat the last row, so a row's
bits do not depend on its company. A row with a NaN among its inputs gives NaN in all its outputs.
"""

from __future__ import annotations

from collections.abc import Sequence

from mcgee.graph.program import Array, Program
from mcgee.jit.copies import chunk, common_ir, copies_ir
from mcgee.jit.emit import hexadecimal
from mcgee.jit.kernel import Kernel
from mcgee.jit.target import Target

CORE = 3
"""Core dimensions an operand may have; those it lacks have size 1."""

STACK = 1 << 15
"""Bytes of tile that may live on a thread's stack."""


def loop_ir(program: Program, kernel: Kernel, target: Target) -> str:
    """`@loop`, with the signature of NumPy's PyUFuncGenericFunction."""
    w, t, nin = target.lanes, target.element, len(program.inputs)
    arrays = (*program.inputs, *program.outputs)
    in_tile = sum(array.size for array in program.inputs)
    total = in_tile + kernel.tile + kernel.work
    large = total * w * target.size > STACK
    lines = ["%n = load i64, ptr %dims"]
    lines += _operands(arrays, target.size)
    if large:
        lines.append(f"%tile = call ptr @PyMem_RawMalloc(i64 {total * w * target.size})")
        lines += ["%none = icmp eq ptr %tile, null", "br i1 %none, label %starved, label %start"]
        lines += _NO_MEMORY
    else:
        lines += [f"%tile = alloca [{total * w} x {t}], align 64", "br label %start"]
    lines += ["start:", f"%results = getelementptr {t}, ptr %tile, i64 {in_tile * w}"]
    lines.append(f"%work = getelementptr {t}, ptr %tile, i64 {(in_tile + kernel.tile) * w}")
    for slot, value in kernel.constants:
        for lane in range(w):
            lines.append(
                f"%c{slot}.{lane} = getelementptr {t}, ptr %results, i64 {slot * w + lane}"
            )
            lines.append(f"store {t} {hexadecimal(value, target.bits)}, ptr %c{slot}.{lane}")
    lines += ["%some = icmp sgt i64 %n, 0", "br i1 %some, label %block, label %done", "block:"]
    lines += ["%row = phi i64 [ 0, %start ], [ %next, %tail ]", "%left = sub i64 %n, %row"]
    lines += [f"%rows = call i64 @llvm.umin.i64(i64 %left, i64 {w})"]
    lines += _body(arrays, nin, target)
    lines += ["done:"]
    lines += ["call void @PyMem_RawFree(ptr %tile)"] if large else []
    lines += ["br label %out", "out:", "ret void"]
    body = "\n".join(line if line.endswith(":") else f"  {line}" for line in lines)
    text = common_ir(target, in_tile)
    text += "".join(copies_ir(target, b) for b in sorted({chunk(array, w) for array in arrays}))
    text += slots_ir(kernel)
    return (
        text
        + (_PYTHON if large else "")
        + "\ndefine void @loop(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {\n"
        + f"{body}\n}}\n"
    )


_PYTHON = """
declare ptr @PyMem_RawMalloc(i64)
declare void @PyMem_RawFree(ptr)
declare i32 @PyGILState_Ensure()
declare ptr @PyErr_NoMemory()
declare void @PyGILState_Release(i32)
"""

# NumPy looks for a Python error when the loop is done
_NO_MEMORY = [
    "starved:",
    "%held = call i32 @PyGILState_Ensure()",
    "%error = call ptr @PyErr_NoMemory()",
    "call void @PyGILState_Release(i32 %held)",
    "br label %out",
]


def _operands(arrays: Sequence[Array], size: int) -> list[str]:
    """Base pointer, outer stride and core strides of each operand; missing core strides are 0."""
    lines, core = [], len(arrays)
    for k, array in enumerate(arrays):
        lines += [
            f"%a{k} = getelementptr ptr, ptr %args, i64 {k}",
            f"%base{k} = load ptr, ptr %a{k}",
            f"%o{k} = getelementptr i64, ptr %steps, i64 {k}",
            f"%outer{k} = load i64, ptr %o{k}",
        ]
        contiguous, expected = [], size
        for axis in reversed(range(len(array.shape))):
            lines += [
                f"%s{k}.{axis} = getelementptr i64, ptr %steps, i64 {core + axis}",
                f"%stride{k}.{axis} = load i64, ptr %s{k}.{axis}",
                f"%packed{k}.{axis} = icmp eq i64 %stride{k}.{axis}, {expected}",
            ]
            contiguous.append(f"%packed{k}.{axis}")
            expected *= array.shape[axis]
        core += len(array.shape)
        lines += [f"%all{k}.0 = and i1 true, true"]
        for i, flag in enumerate(contiguous):
            lines.append(f"%all{k}.{i + 1} = and i1 %all{k}.{i}, {flag}")
        lines.append(f"%contiguous{k} = and i1 %all{k}.{len(contiguous)}, true")
    return lines


def _rows(array: Array, k: int) -> str:
    """Operand k in this tile as arguments; of its core sizes and strides the last axis is last."""
    missing = CORE - len(array.shape)
    sizes = [1] * missing + list(array.shape)
    strides = ["0"] * missing + [f"%stride{k}.{axis}" for axis in range(len(array.shape))]
    core = ", ".join([f"i64 {s}" for s in sizes] + [f"i64 {s}" for s in strides])
    return f"ptr %at{k}, i64 %outer{k}, i64 %rows, {core}"


def _body(arrays: Sequence[Array], nin: int, target: Target) -> list[str]:
    w = target.lanes
    lines, start, slots = [f"%full = icmp eq i64 %rows, {w}"], 0, 0
    for k, array in enumerate(arrays[:nin]):
        lines.append(f"%tile{k} = getelementptr {target.element}, ptr %tile, i64 {start * w}")
        lines += _copy(array, k, "pack", "gather", f"ptr %tile{k}", w)
        start += array.size
    lines += [
        "%bad = call i64 @nans(ptr %tile)",
        "call void @kernel(ptr %tile, ptr %results, ptr %work)",
    ]
    for k, array in enumerate(arrays[nin:], nin):
        lines.append(f"%slots{k} = getelementptr i32, ptr @slots, i64 {slots}")
        lines += _copy(array, k, "unpack", "scatter", f"ptr %results, ptr %slots{k}", w)
        slots += array.size
    lines += ["%clean = icmp eq i64 %bad, 0", "br i1 %clean, label %tail, label %poison", "poison:"]
    for k, array in enumerate(arrays[nin:], nin):
        lines.append(f"call void @poison({_rows(array, k)}, i64 %bad)")
    lines += ["br label %tail", "tail:", f"%next = add i64 %row, {w}"]
    lines += ["%again = icmp slt i64 %next, %n", "br i1 %again, label %block, label %done"]
    return lines


def _copy(array: Array, k: int, whole: str, piecewise: str, tile: str, w: int) -> list[str]:
    """Move the rows of operand k between memory and the tile."""
    return [
        f"%skip{k} = mul i64 %row, %outer{k}",
        f"%at{k} = getelementptr i8, ptr %base{k}, i64 %skip{k}",
        f"%fast{k} = and i1 %full, %contiguous{k}",
        f"br i1 %fast{k}, label %whole{k}, label %piecewise{k}",
        f"whole{k}:",
        f"call void @{whole}{chunk(array, w)}(ptr %at{k}, i64 %outer{k}, i64 {array.size}, {tile})",
        f"br label %moved{k}",
        f"piecewise{k}:",
        f"call void @{piecewise}({_rows(array, k)}, {tile})",
        f"br label %moved{k}",
        f"moved{k}:",
    ]


def slots_ir(kernel: Kernel) -> str:
    """`@slots`, for each element of the outputs its vector in the output tile."""
    entries = ", ".join(f"i32 {slot}" for slot in kernel.slots)
    return f"\n@slots = internal constant [{len(kernel.slots)} x i32] [{entries}]\n"
