"""Cosine and sine of a vector, as LLVM IR.

Cody & Waite's reduction by pi/2 in three parts, of which the first two multiply a quadrant number
exactly, then the minimax polynomials of the freely distributable libm (Sun Microsystems 1993) with
the remainder's own rounding error carried along. Lanes beyond REACH, infinities and NaNs take the
C library's functions, and the fast path sees zeros in their place: NumPy reports the processor's
overflow and invalid flags as warnings, and no legal angle may raise them.
"""

import struct

from mcgee.jit.emit import Emitter
from mcgee.jit.target import Target

REACH = 1e5
"""Radians up to which the fast path is used."""

# their sum is pi/2 to 130 bits; the first two have 36 bits at most, a quadrant number below 17
PIO2 = (
    float.fromhex("0x1.921fb54440000p+0"),
    float.fromhex("0x1.68c234c4c0000p-39"),
    float.fromhex("0x1.98a2e03707345p-77"),
)
TWO_OVER_PI = float.fromhex("0x1.45f306dc9c883p-1")
ROUND = 6755399441055744.0  # 1.5 * 2^52: added, it leaves the nearest integer in the low bits
SIN = (
    1.58969099521155010221e-10,
    -2.50507602534068634195e-08,
    2.75573137070700676789e-06,
    -1.98412698298579493134e-04,
    8.33333333332248946124e-03,
)
SIN_FIRST = -1.66666666666666324348e-01
COS = (
    -1.13596475577881948265e-11,
    2.08757232129817482790e-09,
    -2.75573143513906633035e-07,
    2.48015872894767294178e-05,
    -1.38888888888741095749e-03,
    4.16666666666666019037e-02,
)


def sincos_ir(target: Target) -> str:
    """Text of `@cos_sin`, from a vector x to the pair of vectors (cos x, sin x)."""
    e = Emitter(target)
    v, w = e.vector, target.lanes
    size = e.let(f"call {v} @llvm.fabs.{e.suffix}({v} %x)")
    # compared as integers: a comparison of numbers raises the invalid flag on NaN
    order = e.let(f"bitcast {v} {size} to {e.integers}")
    reach = struct.unpack("<q", struct.pack("<d", REACH))[0]
    far = e.let(f"icmp sgt {e.integers} {order}, {e.integer(reach)}")
    zero = e.constant(0.0)
    near = e.let(f"select <{w} x i1> {far}, {v} {zero}, {v} %x")
    cosine, sine = _fast(e, near)
    bits = e.let(f"bitcast <{w} x i1> {far} to i{w}")
    some = e.let(f"icmp ne i{w} {bits}, 0")
    fast = "\n".join(e.lines)
    return _TEMPLATE.format(
        v=v,
        w=w,
        pair=f"{{ {v}, {v} }}",
        suffix=e.suffix,
        fast=fast,
        far=far,
        some=some,
        cosine=cosine,
        sine=sine,
    )


_TEMPLATE = """
declare double @cos(double)
declare double @sin(double)
declare {v} @llvm.fabs.{suffix}({v})
declare {v} @llvm.fma.{suffix}({v}, {v}, {v})

define internal {pair} @cos_sin({v} %x) noinline nounwind {{
{fast}
  br i1 {some}, label %lane, label %done
lane:
  %i = phi i64 [ 0, %0 ], [ %next, %merge ]
  %c = phi {v} [ {cosine}, %0 ], [ %c2, %merge ]
  %s = phi {v} [ {sine}, %0 ], [ %s2, %merge ]
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
  %cos = phi {v} [ {cosine}, %0 ], [ %c2, %merge ]
  %sin = phi {v} [ {sine}, %0 ], [ %s2, %merge ]
  %pair = insertvalue {pair} poison, {v} %cos, 0
  %both = insertvalue {pair} %pair, {v} %sin, 1
  ret {pair} %both
}}
"""


def _fast(e: Emitter, x: str) -> tuple[str, str]:
    shifted = e.muladd(x, e.constant(TWO_OVER_PI), e.constant(ROUND))
    n = e.sub(shifted, e.constant(ROUND))
    # x − n pi/2 as hi + lo: every step but the last two is exact
    a = e.submul(x, n, e.constant(PIO2[0]))
    w = e.mul(n, e.constant(PIO2[1]))
    y = e.sub(a, w)
    lost = e.sub(e.sub(a, y), w)
    d = e.mulsub(n, e.constant(PIO2[2]), lost)
    hi = e.sub(y, d)
    lo = e.sub(e.sub(y, hi), d)
    z = e.mul(hi, hi)
    cosine, sine = _cosine(e, hi, lo, z), _sine(e, hi, lo, z)
    return _turned(e, shifted, cosine, sine)


def _sine(e: Emitter, hi: str, lo: str, z: str) -> str:
    cube = e.mul(z, hi)
    inner = e.submul(e.mul(e.constant(0.5), lo), cube, e.horner(z, SIN))
    correction = e.submul(e.mulsub(z, inner, lo), cube, e.constant(SIN_FIRST))
    return e.sub(hi, correction)


def _cosine(e: Emitter, hi: str, lo: str, z: str) -> str:
    one, half = e.constant(1.0), e.mul(e.constant(0.5), z)
    w = e.sub(one, half)
    tail = e.mulsub(z, e.mul(z, e.horner(z, COS)), e.mul(hi, lo))
    return e.add(w, e.add(e.sub(e.sub(one, w), half), tail))


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
    bit = e.let(f"and {i} {quadrant}, {e.integer(2)}")
    sign = e.let(f"shl {i} {bit}, {e.integer(62)}")
    flipped = e.let(f"xor {i} {e.let(f'bitcast {v} {value} to {i}')}, {sign}")
    return e.let(f"bitcast {i} {flipped} to {v}")
