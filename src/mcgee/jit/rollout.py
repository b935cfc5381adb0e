"""Many steps of a program whose outputs are its next inputs, as the loop of a gufunc.

The program takes two vectors of state, an input that changes from step to step, and a number; it
gives the vectors of state. A tile of rows stays in registers and cache for all its steps.
"""

from __future__ import annotations

from mcgee.graph.program import Program
from mcgee.jit.copies import chunk, common_ir, copies_ir
from mcgee.jit.emit import hexadecimal
from mcgee.jit.kernel import Kernel
from mcgee.jit.loop import slots_ir
from mcgee.jit.target import Target


def rollout_ir(program: Program, kernel: Kernel, target: Target) -> str:
    """`@rollout`, with the signature of NumPy's PyUFuncGenericFunction.

    Operands: both states (n), inputs (steps, n), the number (), how often each input is used (),
    and as results both states after each input (steps, n).
    """
    w, t = target.lanes, target.element
    n = program.inputs[0].size
    in_tile = 3 * n + 1
    body = _BODY.format(
        w=w,
        t=t,
        v=target.vector,
        n=n,
        two=2 * n,
        three=3 * n,
        b=chunk(program.inputs[0], w),
        size=target.size,
        total=(in_tile + kernel.tile + kernel.work) * w,
        results=in_tile * w,
        work=(in_tile + kernel.tile) * w,
        first=n * w,
        second=2 * n * w,
        third=3 * n * w,
        constants="\n".join(_constants(kernel, target)),
        back="\n".join(_back(kernel, target, 2 * n)),
    )
    return (
        common_ir(target, in_tile)
        + copies_ir(target, chunk(program.inputs[0], w))
        + slots_ir(kernel)
        + body
    )


def _constants(kernel: Kernel, target: Target) -> list[str]:
    lines = []
    for slot, value in kernel.constants:
        for lane in range(target.lanes):
            name, at = f"%c{slot}.{lane}", slot * target.lanes + lane
            lines.append(f"  {name} = getelementptr {target.element}, ptr %results, i64 {at}")
            lines.append(f"  store {target.element} {hexadecimal(value, target.bits)}, ptr {name}")
    return lines


def _back(kernel: Kernel, target: Target, count: int) -> list[str]:
    """The results become the state."""
    v, lines = target.vector, []
    for i in range(count):
        lines += [
            f"  %from.{i} = getelementptr {v}, ptr %results, i64 {kernel.slots[i]}",
            f"  %new.{i} = load {v}, ptr %from.{i}, align {target.size}",
        ]
    for i in range(count):
        lines += [
            f"  %to.{i} = getelementptr {v}, ptr %tile, i64 {i}",
            f"  store {v} %new.{i}, ptr %to.{i}, align {target.size}",
        ]
    return lines


_BODY = """
define internal void @take(ptr %at, i64 %outer, i64 %inner, i64 %rows, ptr %to) nounwind {{
  %full = icmp eq i64 %rows, {w}
  %packed = icmp eq i64 %inner, {size}
  %fast = and i1 %full, %packed
  br i1 %fast, label %whole, label %piecewise
whole:
  call void @pack{b}(ptr %at, i64 %outer, i64 {n}, ptr %to)
  ret void
piecewise:
  call void @gather(ptr %at, i64 %outer, i64 %rows, i64 1, i64 1, i64 {n}, i64 0, i64 0, i64 %inner,
                    ptr %to)
  ret void
}}

define internal void @give(ptr %at, i64 %outer, i64 %inner, i64 %rows, ptr %results, ptr %slots)
    nounwind {{
  %full = icmp eq i64 %rows, {w}
  %packed = icmp eq i64 %inner, {size}
  %fast = and i1 %full, %packed
  br i1 %fast, label %whole, label %piecewise
whole:
  call void @unpack{b}(ptr %at, i64 %outer, i64 {n}, ptr %results, ptr %slots)
  ret void
piecewise:
  call void @scatter(ptr %at, i64 %outer, i64 %rows, i64 1, i64 1, i64 {n}, i64 0, i64 0,
                     i64 %inner, ptr %results, ptr %slots)
  ret void
}}

define internal i64 @stride(ptr %steps, i64 %k) nounwind {{
  %at = getelementptr i64, ptr %steps, i64 %k
  %value = load i64, ptr %at
  ret i64 %value
}}

define internal ptr @base(ptr %args, i64 %k, i64 %row, i64 %outer) nounwind {{
  %at = getelementptr ptr, ptr %args, i64 %k
  %start = load ptr, ptr %at
  %skip = mul i64 %row, %outer
  %base = getelementptr i8, ptr %start, i64 %skip
  ret ptr %base
}}

define void @rollout(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {{
start:
  %tile = alloca [{total} x {t}], align 64
  %results = getelementptr {t}, ptr %tile, i64 {results}
  %work = getelementptr {t}, ptr %tile, i64 {work}
  %tile_qd = getelementptr {t}, ptr %tile, i64 {first}
  %tile_tau = getelementptr {t}, ptr %tile, i64 {second}
  %tile_h = getelementptr {t}, ptr %tile, i64 {third}
  %slots_qd = getelementptr i32, ptr @slots, i64 {n}
{constants}
  %n = load i64, ptr %dims
  %dim1 = getelementptr i64, ptr %dims, i64 2
  %times = load i64, ptr %dim1
  %o0 = call i64 @stride(ptr %steps, i64 0)
  %o1 = call i64 @stride(ptr %steps, i64 1)
  %o2 = call i64 @stride(ptr %steps, i64 2)
  %o3 = call i64 @stride(ptr %steps, i64 3)
  %o4 = call i64 @stride(ptr %steps, i64 4)
  %o5 = call i64 @stride(ptr %steps, i64 5)
  %o6 = call i64 @stride(ptr %steps, i64 6)
  %i0 = call i64 @stride(ptr %steps, i64 7)
  %i1 = call i64 @stride(ptr %steps, i64 8)
  %s2 = call i64 @stride(ptr %steps, i64 9)
  %i2 = call i64 @stride(ptr %steps, i64 10)
  %s5 = call i64 @stride(ptr %steps, i64 11)
  %i5 = call i64 @stride(ptr %steps, i64 12)
  %s6 = call i64 @stride(ptr %steps, i64 13)
  %i6 = call i64 @stride(ptr %steps, i64 14)
  %some = icmp sgt i64 %n, 0
  br i1 %some, label %block, label %done
block:
  %row = phi i64 [ 0, %start ], [ %next_row, %tail ]
  %left = sub i64 %n, %row
  %rows = call i64 @llvm.umin.i64(i64 %left, i64 {w})
  %at0 = call ptr @base(ptr %args, i64 0, i64 %row, i64 %o0)
  %at1 = call ptr @base(ptr %args, i64 1, i64 %row, i64 %o1)
  %at2 = call ptr @base(ptr %args, i64 2, i64 %row, i64 %o2)
  %at3 = call ptr @base(ptr %args, i64 3, i64 %row, i64 %o3)
  %at4 = call ptr @base(ptr %args, i64 4, i64 %row, i64 %o4)
  %at5 = call ptr @base(ptr %args, i64 5, i64 %row, i64 %o5)
  %at6 = call ptr @base(ptr %args, i64 6, i64 %row, i64 %o6)
  call void @take(ptr %at0, i64 %o0, i64 %i0, i64 %rows, ptr %tile)
  call void @take(ptr %at1, i64 %o1, i64 %i1, i64 %rows, ptr %tile_qd)
  call void @gather(ptr %at3, i64 %o3, i64 %rows, i64 1, i64 1, i64 1, i64 0, i64 0, i64 0,
                    ptr %tile_h)
  %often_number = load {t}, ptr %at4
  %often = fptosi {t} %often_number to i64
  %any = icmp sgt i64 %times, 0
  br i1 %any, label %step, label %tail
step:
  %k = phi i64 [ 0, %block ], [ %next_k, %told ]
  %skip2 = mul i64 %k, %s2
  %skip5 = mul i64 %k, %s5
  %skip6 = mul i64 %k, %s6
  %tau = getelementptr i8, ptr %at2, i64 %skip2
  %out5 = getelementptr i8, ptr %at5, i64 %skip5
  %out6 = getelementptr i8, ptr %at6, i64 %skip6
  call void @take(ptr %tau, i64 %o2, i64 %i2, i64 %rows, ptr %tile_tau)
  br label %sub
sub:
  %j = phi i64 [ 0, %step ], [ %next_j, %sub ]
  call void @kernel(ptr %tile, ptr %results, ptr %work)
{back}
  %next_j = add i64 %j, 1
  %again = icmp slt i64 %next_j, %often
  br i1 %again, label %sub, label %told
told:
  call void @give(ptr %out5, i64 %o5, i64 %i5, i64 %rows, ptr %results, ptr @slots)
  call void @give(ptr %out6, i64 %o6, i64 %i6, i64 %rows, ptr %results, ptr %slots_qd)
  %next_k = add i64 %k, 1
  %more = icmp slt i64 %next_k, %times
  br i1 %more, label %step, label %tail
tail:
  %next_row = add i64 %row, {w}
  %unfinished = icmp slt i64 %next_row, %n
  br i1 %unfinished, label %block, label %done
done:
  ret void
}}
"""
