"""What the physics asks of a scalar: +, -, *, / and a cosine with its sine.

Algorithms run on any type that has these: float, complex, NumPy arrays, graph nodes,
`fractions.Fraction`, mpmath, SymPy, casadi.SX, exact polynomials.
"""

import cmath
import math
import re
import struct
import sys
from dataclasses import dataclass
from typing import Any

Scalar = Any
"""A number, or anything that behaves like one."""


def cos_sin(x: Scalar) -> tuple[Scalar, Scalar]:
    """(cos x, sin x) by the scalar's own method `cos_sin`, or else by the library it comes from."""
    if isinstance(x, int) and x == 0:
        return 1, 0  # not 1.0 and 0.0, which would make exact scalars floats
    if isinstance(x, (float, int)):
        return math.cos(x), math.sin(x)
    if isinstance(x, complex):
        return cmath.cos(x), cmath.sin(x)
    own = getattr(x, "cos_sin", None)
    if own is not None:
        return own()
    library = sys.modules[type(x).__module__.partition(".")[0]]
    return library.cos(x), library.sin(x)


def plain(x: Scalar, what: str) -> Scalar:
    """Numbers of any library as floats; expressions with symbols as they are.

    Raises: ValueError: neither; `what` says in the message whose number it is
    """
    if getattr(x, "free_symbols", None):
        return x
    try:
        if isinstance(x, (str, bytes)):
            raise TypeError
        return float(x)
    except (TypeError, ValueError):
        raise ValueError(f"{what} is {x!r}, expected a number.") from None


@dataclass(frozen=True)
class Turn:
    """An angle known by its cosine and sine alone.

    Exact scalars have no transcendental functions; they enter the physics as points of the unit
    circle, such as `Turn(Fraction(3, 5), Fraction(4, 5))`, or as the generators c, s of a
    polynomial ring.
    """

    c: Scalar
    s: Scalar

    def cos_sin(self) -> tuple[Scalar, Scalar]:
        return self.c, self.s

    def __add__(self, other: "Turn") -> "Turn":
        return Turn(self.c * other.c - self.s * other.s, self.s * other.c + self.c * other.s)

    def __neg__(self) -> "Turn":
        return Turn(self.c, -self.s)

    def __mul__(self, times: Scalar) -> "Turn":
        if times != int(times):
            raise ValueError(f"a Turn can be repeated a whole number of times, not {times}")
        step = self if times > 0 else -self
        turn = Turn(self.c * 0 + 1, self.s * 0)
        for _ in range(abs(int(times))):
            turn = turn + step
        return turn

    __rmul__ = __mul__


# -- constant angles ------------------------------------------------------------------------------

# cosines of k 15 degrees, k = 0 … 6, correctly rounded
_TWELFTHS = (1.0, 0.9659258262890683, 0.75**0.5, 0.5**0.5, 0.5, 0.25881904510252074, 0.0)


def constant_cos_sin(angle: Scalar) -> tuple[Scalar, Scalar]:
    """(cos, sin) of a constant; exact where a float is k pi/12 to its last bits."""
    if not isinstance(angle, (float, int)):
        return cos_sin(angle)
    k = _twelfth(angle)
    return (_cos_twelfth(k), _cos_twelfth(k - 6)) if k is not None else cos_sin(angle)


def _twelfth(angle: float) -> int | None:
    """k where the angle is k pi/12 to within four units in the last place, else None."""
    if not math.isfinite(angle) or abs(angle) > 1e3:
        return None
    k = round(angle * 12 / math.pi)
    return k if abs(angle - k * math.pi / 12) <= 4 * math.ulp(abs(angle)) else None


def _cos_twelfth(k: int) -> float:
    k = abs(k) % 24
    k = min(k, 24 - k)
    return _TWELFTHS[k] if k <= 6 else -_TWELFTHS[12 - k]


_DECIMAL = re.compile(r"[-+]?(\d*)\.?(\d*)(?:[eE][-+]?\d+)?$")
ENOUGH_DIGITS = 8
POOR_ROUNDING = 0.01
"""Radians: a coarser last digit says nothing of what was meant."""


def read_angle(text: str) -> tuple[float, str | None]:
    """The angle that a decimal text means, and a remark where the text is a poor rounding.

    Descriptions write pi/2 as 1.57079632679. Where the text is a multiple of pi/12 rounded (or
    cut) to its own digits, eight or more, the exact angle is meant and returned; with fewer digits,
    or with the digits of its float32, the written value is kept and the remark says so.

    Raises: ValueError: the text is not a number
    """
    value = float(text)
    k = round(value * 12 / math.pi) if abs(value) <= 1e3 else 0
    match = _DECIMAL.match(text.strip())
    if k == 0 or match is None:
        return value, None
    exact = k * math.pi / 12
    digits = len((match[1] + match[2]).lstrip("0"))
    unit = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)  # of the last digit
    over, slack = abs(value) - abs(exact), 4 * math.ulp(exact)
    rounded_or_cut = -unit - slack <= over <= unit / 2 + slack
    if rounded_or_cut and digits >= ENOUGH_DIGITS:
        return exact, None
    poor = rounded_or_cut and digits >= 3 and unit <= POOR_ROUNDING
    single = value == _single(exact) or (digits <= 9 and _single(value) == _single(exact))
    if not poor and not single:
        return value, None
    return value, (
        f"angle {text.strip()} is taken as written; {_name_twelfth(k)} needs at least "
        f"{ENOUGH_DIGITS} digits ({exact:.11g})"
    )


def _single(x: float) -> float:
    """What float32 makes of it."""
    return struct.unpack("f", struct.pack("f", x))[0]


def _name_twelfth(k: int) -> str:
    divisor = math.gcd(k, 12)
    top, bottom = abs(k) // divisor, 12 // divisor
    sign = "-" if k < 0 else ""
    return f"{sign}{top if top > 1 else ''}pi{f'/{bottom}' if bottom > 1 else ''}"
