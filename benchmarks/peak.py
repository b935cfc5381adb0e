"""What this machine could do at most: fused multiply-adds on whole vectors, measured."""

from __future__ import annotations

import ctypes
import time

from mcgee.jit.compile import address
from mcgee.jit.target import host

CHAINS, TURNS = 24, 200_000


def vectors_per_nanosecond() -> float:
    """Fused multiply-adds a nanosecond on independent vectors in registers, the best of several."""
    v, s = host().vector, f"v{host().lanes}f64"
    phis = "\n".join(
        f"  %a{i} = phi {v} [ zeroinitializer, %0 ], [ %b{i}, %loop ]" for i in range(CHAINS)
    )
    steps = "\n".join(
        f"  %b{i} = call {v} @llvm.fma.{s}({v} %a{i}, {v} %x, {v} %x)" for i in range(CHAINS)
    )
    sums = "\n".join(
        f"  %s{i} = fadd {v} %b{i}, {f'%s{i - 1}' if i else 'zeroinitializer'}"
        for i in range(CHAINS)
    )
    text = f"""
declare {v} @llvm.fma.{s}({v}, {v}, {v})
define void @peak(ptr %out, i64 %n) {{
  %x = load {v}, ptr %out, align 8
  br label %loop
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
{phis}
{steps}
  %next = add i64 %i, 1
  %more = icmp slt i64 %next, %n
  br i1 %more, label %loop, label %done
done:
{sums}
  store {v} %s{CHAINS - 1}, ptr %out, align 8
  ret void
}}
"""
    run = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64)(address("peak", text))
    out = (ctypes.c_double * host().lanes)()
    times = []
    for _ in range(15):
        start = time.perf_counter()
        run(ctypes.addressof(out), TURNS)
        times.append(time.perf_counter() - start)
    return CHAINS * TURNS / (min(times) * 1e9)
