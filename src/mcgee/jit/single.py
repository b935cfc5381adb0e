"""One row of a program, scalar by scalar, as LLVM IR: what a single call runs.

The kernel is the batch's own on vectors of one lane: the same operations, fused alike, so the same
bits. Angles that are inputs go through the sine and cosine of whole vectors, a few at a time.
"""

from __future__ import annotations

import struct
import sys
from dataclasses import replace

from mcgee.graph.node import Node
from mcgee.graph.program import Program
from mcgee.jit.emit import hexadecimal
from mcgee.jit.kernel import Kernel, kernel_ir
from mcgee.jit.loop import STACK, slots_ir
from mcgee.jit.sincos import sincos_ir
from mcgee.jit.target import Target

FEW = 64
"""Numbers up to which code for each is written out, and beyond which there is a loop."""

LARGE = 1e60
"""Inputs up to which a row is computed here: from their products no overflow comes."""


def single_ir(program: Program, target: Target) -> str:
    """`i64 @single(inputs, outputs)`, each an array of pointers to contiguous float64.

    Returns 1 where the row is not for it: an input is NaN or beyond LARGE, a result is not finite,
    or there is no memory. NumPy's loop then says what there is to say.
    """
    w = target.lanes
    angles = _input_angles(program)
    size = _padded(sum(array.size for array in program.inputs), w)
    given = {a: (size + k, size + _padded(len(angles), w) + k) for k, a in enumerate(angles)}
    one = replace(target, lanes=1)
    kernel = kernel_ir(program, one, given)
    in_tile = size + 2 * _padded(len(angles), w)
    total = in_tile + kernel.tile + kernel.work
    lines = _Lines(target)
    lines += _scratch(total)
    lines += [f"%out = getelementptr double, ptr %in, i64 {in_tile}"]
    lines += [f"%work = getelementptr double, ptr %in, i64 {in_tile + kernel.tile}"]
    _read(lines, program, size)
    for start in range(0, len(angles), w):
        _turn(lines, program, angles[start : start + w], size, start, _padded(len(angles), w))
    _write(lines, program, kernel)
    lines += ["br label %end", "end:", "%left = phi i64 [ 1, %start ], [ %unfit, %compute ]"]
    if total * 8 > STACK:
        lines += ["call void @PyMem_RawFree(ptr %in)", "ret i64 %left", "none:", "ret i64 1"]
    else:
        lines.append("ret i64 %left")
    body = "\n".join(line if line.endswith(":") else f"  {line}" for line in lines)
    return (
        _MEMORY
        + sincos_ir(target, "cos_sins")
        + _ONE.format(w=w, v=target.vector)
        + kernel.text
        + _LOOPS.format(limit=_bits(sys.float_info.max))
        + slots_ir(kernel)
        + f"\ndefine i64 @single(ptr %ins, ptr %outs) nounwind {{\n{body}\n}}\n"
    )


class _Lines(list):
    """Of IR, with fresh names."""

    def __init__(self, target: Target):
        super().__init__()
        self.target = target

    def let(self, text: str) -> str:
        name = f"%n{len(self)}"
        self.append(f"{name} = {text}")
        return name

    def at(self, base: str, index: int) -> str:
        return self.let(f"getelementptr double, ptr {base}, i64 {index}")

    def beyond(self, base: str, size: int, limit: float) -> str:
        """Whether some |x| of an array is greater than the limit, or NaN, as i64."""
        w, vector = self.target.lanes, f"<{self.target.lanes} x i64>"
        found = "0"
        for lanes, start in [(w, i) for i in range(0, size - size % w, w)] + [
            (1, i) for i in range(size - size % w, size)
        ]:
            kind = vector if lanes == w else "i64"
            bits = self.let(f"load {kind}, ptr {self.at(base, start)}, align 8")
            mask, bound = (_splat(x, lanes) for x in (2**63 - 1, _bits(limit)))
            order = self.let(f"and {kind} {bits}, {mask}")
            more = self.let(f"icmp ugt {kind} {order}, {bound}")
            if lanes == w:
                more = self.let(f"bitcast <{w} x i1> {more} to i{w}")
            wide = self.let(f"zext i{lanes} {more} to i64")
            found = self.let(f"or i64 {found}, {wide}")
        return found


def _bits(x: float) -> int:
    return struct.unpack("<q", struct.pack("<d", x))[0]


def _splat(x: int, lanes: int) -> str:
    return str(x) if lanes == 1 else "<" + ", ".join([f"i64 {x}"] * lanes) + ">"


def _padded(size: int, w: int) -> int:
    return -(-size // w) * w


def _input_angles(program: Program) -> list[Node]:
    """The inputs whose cosine or sine is wanted."""
    angles = {n.args[0]: None for n in program.nodes if n.op in ("cos", "sin")}
    return [a for a in angles if isinstance(a, Node) and a.op == "input"]


def _scratch(total: int) -> list[str]:
    if total * 8 <= STACK:
        return [f"%in = alloca [{total} x double], align 64", "br label %start", "start:"]
    return [
        f"%in = call ptr @PyMem_RawMalloc(i64 {total * 8})",
        "%starved = icmp eq ptr %in, null",
        "br i1 %starved, label %none, label %start",
        "start:",
    ]


def _read(lines: _Lines, program: Program, size: int) -> None:
    """Inputs side by side, zeros to the end of the last vector, and a look at their sizes."""
    start = sum(array.size for array in program.inputs)
    for i in range(start, size):
        lines.append(f"store double 0.0, ptr {lines.at('%in', i)}, align 8")
    start = 0
    for k, array in enumerate(program.inputs):
        place = lines.let(f"getelementptr ptr, ptr %ins, i64 {k}")
        source = lines.let(f"load ptr, ptr {place}")
        for i in range(array.size):
            value = lines.let(f"load double, ptr {lines.at(source, i)}, align 8")
            lines.append(f"store double {value}, ptr {lines.at('%in', start + i)}, align 8")
        start += array.size
    large = lines.beyond("%in", size, LARGE)
    lines.append(f"%large = icmp ne i64 {large}, 0")
    lines.append("br i1 %large, label %end, label %compute")
    lines.append("compute:")


def _turn(
    lines: _Lines, program: Program, angles: list[Node], size: int, start: int, apart: int
) -> None:
    """Cosines and sines of a vector of angles, behind the inputs."""
    offsets, at = {}, 0
    for array in program.inputs:
        offsets[array.name], at = at, at + array.size
    v, x = lines.target.vector, "zeroinitializer"
    for lane, angle in enumerate(angles):
        place = lines.at("%in", offsets[angle.args[0]] + angle.args[1])
        value = lines.let(f"load double, ptr {place}, align 8")
        x = lines.let(f"insertelement {v} {x}, double {value}, i64 {lane}")
    both = lines.let(f"call {{ {v}, {v} }} @cos_sins({v} {x})")
    for part in (0, 1):
        values = lines.let(f"extractvalue {{ {v}, {v} }} {both}, {part}")
        place = lines.at("%in", size + part * apart + start)
        lines.append(f"store {v} {values}, ptr {place}, align 8")


def _write(lines: _Lines, program: Program, kernel: Kernel) -> None:
    """Run the kernel and put its results where they belong."""
    pointers = []
    for k in range(len(program.outputs)):
        place = lines.let(f"getelementptr ptr, ptr %outs, i64 {k}")
        pointers.append(lines.let(f"load ptr, ptr {place}"))
    size = sum(array.size for array in program.outputs)
    in_place = len(pointers) == 1 and kernel.slots == tuple(range(size))
    out = pointers[0] if in_place else "%out"
    lines.append(f"call void @kernel(ptr %in, ptr {out}, ptr %work)")
    for slot, value in kernel.constants:
        lines.append(f"store double {hexadecimal(value)}, ptr {lines.at(out, slot)}, align 8")
    if kernel.tile <= FEW:
        lines.append(f"%unfit = or i64 0, {lines.beyond(out, kernel.tile, sys.float_info.max)}")
    else:
        lines.append(f"%unfit = call i64 @infinite(ptr {out}, i64 {kernel.tile})")
    if in_place:
        return
    start = 0
    for pointer, array in zip(pointers, program.outputs, strict=True):
        if array.size <= FEW:
            for i, slot in enumerate(kernel.slots[start : start + array.size]):
                moved = lines.let(f"load double, ptr {lines.at(out, slot)}, align 8")
                lines.append(f"store double {moved}, ptr {lines.at(pointer, i)}, align 8")
        else:
            slots = lines.let(f"getelementptr i32, ptr @slots, i64 {start}")
            arguments = f"ptr {out}, ptr {slots}, ptr {pointer}, i64 {array.size}"
            lines.append(f"call void @move({arguments})")
        start += array.size


_MEMORY = """
declare ptr @PyMem_RawMalloc(i64)
declare void @PyMem_RawFree(ptr)
"""

_LOOPS = """
define internal i64 @infinite(ptr %values, i64 %size) nounwind {{
  br label %next
next:
  %i = phi i64 [ 0, %0 ], [ %up, %next ]
  %found = phi i64 [ 0, %0 ], [ %all, %next ]
  %at = getelementptr i64, ptr %values, i64 %i
  %bits = load i64, ptr %at, align 8
  %order = and i64 %bits, 9223372036854775807
  %more = icmp ugt i64 %order, {limit}
  %one = zext i1 %more to i64
  %all = or i64 %found, %one
  %up = add i64 %i, 1
  %again = icmp ult i64 %up, %size
  br i1 %again, label %next, label %done
done:
  ret i64 %all
}}

define internal void @move(ptr %from, ptr %slots, ptr %to, i64 %size) nounwind {{
  br label %next
next:
  %i = phi i64 [ 0, %0 ], [ %up, %next ]
  %entry = getelementptr i32, ptr %slots, i64 %i
  %slot = load i32, ptr %entry, align 4
  %place = zext i32 %slot to i64
  %source = getelementptr double, ptr %from, i64 %place
  %value = load double, ptr %source, align 8
  %target = getelementptr double, ptr %to, i64 %i
  store double %value, ptr %target, align 8
  %up = add i64 %i, 1
  %again = icmp ult i64 %up, %size
  br i1 %again, label %next, label %done
done:
  ret void
}}
"""

# an angle that the program computes
_ONE = """
declare <1 x double> @llvm.fma.v1f64(<1 x double>, <1 x double>, <1 x double>)

define internal {{ <1 x double>, <1 x double> }} @cos_sin(<1 x double> %x) noinline nounwind {{
  %one = extractelement <1 x double> %x, i64 0
  %wide = insertelement {v} zeroinitializer, double %one, i64 0
  %both = call {{ {v}, {v} }} @cos_sins({v} %wide)
  %c = extractvalue {{ {v}, {v} }} %both, 0
  %s = extractvalue {{ {v}, {v} }} %both, 1
  %cos = shufflevector {v} %c, {v} %c, <1 x i32> zeroinitializer
  %sin = shufflevector {v} %s, {v} %s, <1 x i32> zeroinitializer
  %pair = insertvalue {{ <1 x double>, <1 x double> }} poison, <1 x double> %cos, 0
  %all = insertvalue {{ <1 x double>, <1 x double> }} %pair, <1 x double> %sin, 1
  ret {{ <1 x double>, <1 x double> }} %all
}}
"""
