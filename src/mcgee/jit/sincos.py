"""Cosine and sine of a vector, as LLVM IR.

Cody & Waite's reduction by pi/2 in three parts, of which the first two multiply a quadrant number
exactly, then the minimax polynomials of the freely distributable libm (Sun Microsystems 1993) with
the remainder's own rounding error carried along. Lanes beyond REACH, infinities and NaNs take the
C library's functions, and the fast path sees zeros in their place: NumPy reports the processor's
overflow and invalid flags as warnings, and no legal angle may raise them. Angles of float32 are
widened: the reduction needs more digits than they have.
"""

import struct
from dataclasses import replace

from mcgee.jit.emit import Emitter
from mcgee.jit.target import Target
from mcgee.trigonometry import COS, PIO2, REACH, ROUND, SIN, TWO_OVER_PI


def sincos_ir(target: Target, name: str = "cos_sin") -> str:
    """Text of `@cos_sin`, from a vector x to the pair of vectors (cos x, sin x)."""
    if target.bits == 32:
        wide = replace(target, bits=64)
        return sincos_ir(wide, "wide_cos_sin") + _NARROW.format(
            v=target.vector, wide=wide.vector, suffix=Emitter(target).suffix
        )
    e = Emitter(target)
    v, w = e.vector, target.lanes
    far = _beyond_reach(e)
    near = e.let(f"select <{w} x i1> {far}, {v} {e.constant(0.0)}, {v} %x")
    cosine, sine = _fast(e, near)
    some = e.let(f"icmp ne i{w} {e.let(f'bitcast <{w} x i1> {far} to i{w}')}, 0")
    fast = "\n".join(e.lines)
    names = {"name": name, "v": v, "w": w, "pair": f"{{ {v}, {v} }}", "suffix": e.suffix}
    again = Emitter(target)
    is_far = _beyond_reach(again)
    search = "\n".join(again.lines)
    return _TEMPLATE.format(
        **names, fast=fast, some=some, cosine=cosine, sine=sine, search=search, far=is_far
    )


def _beyond_reach(e: Emitter) -> str:
    """Which lanes of %x the fast path cannot take."""
    size = e.let(f"call {e.vector} @llvm.fabs.{e.suffix}({e.vector} %x)")
    # compared as integers: a comparison of numbers raises the invalid flag on NaN
    order = e.let(f"bitcast {e.vector} {size} to {e.integers}")
    reach = struct.unpack("<q", struct.pack("<d", REACH))[0]
    return e.let(f"icmp sgt {e.integers} {order}, {e.integer(reach)}")


# the slow lanes apart, so that the fast path is a leaf that saves no register
_TEMPLATE = """
declare double @cos(double)
declare double @sin(double)
declare {v} @llvm.fabs.{suffix}({v})
declare {v} @llvm.fma.{suffix}({v}, {v}, {v})

define internal {pair} @{name}({v} %x) noinline nounwind {{
{fast}
  br i1 {some}, label %slow, label %done
slow:
  %all = tail call {pair} @far_cos_sin({v} %x, {v} {cosine}, {v} {sine})
  ret {pair} %all
done:
  %pair = insertvalue {pair} poison, {v} {cosine}, 0
  %both = insertvalue {pair} %pair, {v} {sine}, 1
  ret {pair} %both
}}

define internal {pair} @far_cos_sin({v} %x, {v} %cosine, {v} %sine) noinline cold nounwind {{
{search}
  br label %lane
lane:
  %i = phi i64 [ 0, %0 ], [ %next, %merge ]
  %c = phi {v} [ %cosine, %0 ], [ %c2, %merge ]
  %s = phi {v} [ %sine, %0 ], [ %s2, %merge ]
  %is_far = extractelement <{w} x i1> {far}, i64 %i
  br i1 %is_far, label %call, label %merge
call:
  %xi = extractelement {v} %x, i64 %i
  %ci = call double @cos(double %xi)
  %si = call double @sin(double %xi)
  %c1 = insertelement {v} %c, double %ci, i64 %i
  %s1 = insertelement {v} %s, double %si, i64 %i
  br label %merge
merge:
  %c2 = phi {v} [ %c, %lane ], [ %c1, %call ]
  %s2 = phi {v} [ %s, %lane ], [ %s1, %call ]
  %next = add i64 %i, 1
  %more = icmp ult i64 %next, {w}
  br i1 %more, label %lane, label %done
done:
  %pair = insertvalue {pair} poison, {v} %c2, 0
  %both = insertvalue {pair} %pair, {v} %s2, 1
  ret {pair} %both
}}
"""


_NARROW = """
declare {v} @llvm.fma.{suffix}({v}, {v}, {v})

define internal {{ {v}, {v} }} @cos_sin({v} %x) noinline nounwind {{
  %wide = fpext {v} %x to {wide}
  %both = call {{ {wide}, {wide} }} @wide_cos_sin({wide} %wide)
  %c = extractvalue {{ {wide}, {wide} }} %both, 0
  %s = extractvalue {{ {wide}, {wide} }} %both, 1
  %cos = fptrunc {wide} %c to {v}
  %sin = fptrunc {wide} %s to {v}
  %pair = insertvalue {{ {v}, {v} }} poison, {v} %cos, 0
  %done = insertvalue {{ {v}, {v} }} %pair, {v} %sin, 1
  ret {{ {v}, {v} }} %done
}}
"""


def _fast(e: Emitter, x: str) -> tuple[str, str]:
    one, half = e.constant(1.0), e.constant(0.5)
    shifted = e.muladd(x, e.constant(TWO_OVER_PI), e.constant(ROUND))
    n = e.sub(shifted, e.constant(ROUND))
    # x − n pi/2 = hi − debt; only making hi, and the debt at last, rounds
    a = e.submul(x, n, e.constant(PIO2[0]))
    hi = e.submul(a, n, e.constant(PIO2[1]))
    lost = e.submul(e.sub(a, hi), n, e.constant(PIO2[1]))
    debt = e.mulsub(n, e.constant(PIO2[2]), lost)
    z = e.mul(hi, hi)
    w = e.submul(one, half, z)
    # cos = w + (what w lost + z² (…) + hi debt), sin = hi − (debt w − hi z (…)); signs keep −0
    tail = e.muladd(e.mul(z, z), e.horner(z, COS), e.submul(e.sub(one, w), half, z))
    cosine = e.add(w, e.muladd(hi, debt, tail))
    sine = e.sub(hi, e.submul(e.mul(debt, w), e.mul(hi, z), e.horner(z, SIN)))
    return _turned(e, shifted, cosine, sine)


def _turned(e: Emitter, shifted: str, cosine: str, sine: str) -> tuple[str, str]:
    """By the quadrant in the low bits of shifted: swap where odd, then signs."""
    v, i = e.vector, e.integers
    q = e.let(f"bitcast {v} {shifted} to {i}")
    odd = e.let(f"icmp ne {i} {e.let(f'and {i} {q}, {e.integer(1)}')}, {e.integer(0)}")
    mask = f"<{e.target.lanes} x i1>"
    c = e.let(f"select {mask} {odd}, {v} {sine}, {v} {cosine}")
    s = e.let(f"select {mask} {odd}, {v} {cosine}, {v} {sine}")
    later = e.let(f"add {i} {q}, {e.integer(1)}")
    return _signed(e, c, later), _signed(e, s, q)


def _signed(e: Emitter, value: str, quadrant: str) -> str:
    """The value, negated where bit 1 of the quadrant is set."""
    v, i = e.vector, e.integers
    top = e.let(f"shl {i} {quadrant}, {e.integer(62)}")
    sign = e.let(f"and {i} {top}, {e.integer(-(2**63))}")
    flipped = e.let(f"xor {i} {e.let(f'bitcast {v} {value} to {i}')}, {sign}")
    return e.let(f"bitcast {i} {flipped} to {v}")
