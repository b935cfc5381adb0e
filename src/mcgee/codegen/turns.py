"""Cosines and sines in C and C++: our own, several at once, as in the library's kernels."""

from __future__ import annotations

from collections.abc import Sequence

from mcgee.codegen.common import filled
from mcgee.codegen.expression import text
from mcgee.codegen.routine import Turn
from mcgee.codegen.statements import Style
from mcgee.trigonometry import COS, PIO2, REACH, ROUND, SIN, TWO_OVER_PI

LANES = 4
"""Angles that compilers turn at once; three or more are padded to a multiple."""


def together(name: str, turns: Sequence[Turn], own: Style) -> str:
    count = len(turns)
    room = count if count < 3 else -(-count // LANES) * LANES
    angles = ", ".join(text(turn.angle, own.syntax) for turn in turns)
    out = f"    const double angle[{room}] = {{{angles}}};\n"
    out += f"    double cosine[{room}], sine[{room}];\n"
    out += f"    {name}_turns({room}, angle, cosine, sine);\n"
    for k, turn in enumerate(turns):
        for given, array in ((turn.cosine, "cosine"), (turn.sine, "sine")):
            if given is not None:
                out += f"    const double {given} = {array}[{k}];\n"
    return out


def turns_function(head: str, restrict: str, exact: str = "EXACT") -> str:
    """A function of count, x, c and s, as C and as C++.

    Args:
        exact: the name of its macro
    """
    constants = {"TWO_OVER_PI": TWO_OVER_PI, "ROUND": ROUND, "REACH": REACH}
    constants |= {f"PIO2_{k}": part for k, part in enumerate(PIO2)}
    return filled(
        _TURNS,
        HEAD=head,
        NAME=head.rpartition(" ")[2],
        RESTRICT=restrict,
        EXACT=exact,
        COSINES=_horner(COS),
        SINES=_horner(SIN),
        **{name: repr(value) for name, value in constants.items()},
    )


def _horner(coefficients: Sequence[float]) -> str:
    first, *others = coefficients
    text = "(" * (len(others) - 1) + repr(first)
    for k, c in enumerate(others):
        close = ")" if k < len(others) - 1 else ""
        text += f"*z {'-' if c < 0 else '+'} {abs(c)!r}{close}"
        if k % 2 and close:
            text += "\n            "
    return text


_TURNS = """
/* Cosines and sines to less than a unit in the last place, in a loop that compilers vectorise. */
#if defined(__FAST_MATH__) || defined(_M_FP_FAST) || FLT_EVAL_METHOD != 0 || DBL_MANT_DIG != 53
#define EXACT 0 /* what compilers may round otherwise is left to the library */
#else
#define EXACT 1
#endif
HEAD_by_library(
    int count, const double *RESTRICT x, double *RESTRICT c, double *RESTRICT s, int all)
{
    for (int i = 0; i < count; ++i) {
        if (all || !(fabs(x[i]) < REACH)) {
            c[i] = cos(x[i]);
            s[i] = sin(x[i]);
        }
    }
}

HEAD(
    int count, const double *RESTRICT x, double *RESTRICT c, double *RESTRICT s)
{
    int exact = 0, beyond = 1;
#if EXACT
    const volatile double quarter = 0.25;
    /* Optimisations that reorder sums undo the rounding: then, too, the library. */
    exact = (quarter + ROUND) - ROUND == 0.0;
    beyond = !exact;
    for (int i = 0; i < count; ++i) {
        const double shifted = x[i]*TWO_OVER_PI + ROUND;
        const double n = shifted - ROUND;
        const double a = x[i] - n*PIO2_0;
        const double hi = a - n*PIO2_1;
        const double debt = n*PIO2_2 - ((a - hi) - n*PIO2_1);
        const double z = hi*hi;
        const double w = 1.0 - 0.5*z;
        const double pc = COSINES;
        const double ps = SINES;
        const double cosine = w + (hi*debt + (z*z*pc + ((1.0 - w) - 0.5*z)));
        const double sine = hi - (debt*w - hi*z*ps);
        const uint64_t sign = UINT64_C(1) << 63;
        uint64_t quadrant, cb, sb;
        memcpy(&quadrant, &shifted, sizeof quadrant);
        memcpy(&cb, &cosine, sizeof cb);
        memcpy(&sb, &sine, sizeof sb);
        const uint64_t odd = 0 - (quadrant & 1);
        const uint64_t cq = ((cb & ~odd) | (sb & odd)) ^ (((quadrant + 1) << 62) & sign);
        const uint64_t sq = ((sb & ~odd) | (cb & odd)) ^ ((quadrant << 62) & sign);
        memcpy(c + i, &cq, sizeof cq);
        memcpy(s + i, &sq, sizeof sq);
        beyond |= !(fabs(x[i]) < REACH);
    }
#endif
    if (beyond) {
        NAME_by_library(count, x, c, s, !exact);
    }
}
"""
