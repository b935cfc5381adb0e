"""The numbers of our own cosine and sine, in kernels and in generated code.

Cody & Waite's reduction by pi/2 in three parts, of which the first two multiply a quadrant number
exactly, then the minimax polynomials of the freely distributable libm (Sun Microsystems 1993).
"""

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
    -1.66666666666666324348e-01,
)
COS = (
    -1.13596475577881948265e-11,
    2.08757232129817482790e-09,
    -2.75573143513906633035e-07,
    2.48015872894767294178e-05,
    -1.38888888888741095749e-03,
    4.16666666666666019037e-02,
)
