"""Numbers, SymPy expressions and rotations as elements of a ring.

What the ring must hold is found by reading everything once and noting what is asked for; the second
reading then builds. A float is the decimal it was written as. A rotation is exact: its entries are
those of multiples of 15°, or the turn by a generic angle about one axis gets a named angle, or a
general one becomes the rational rotation nearest to its floats, exactly orthogonal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from fractions import Fraction
from functools import cache
from itertools import count, product
from typing import Any, NoReturn, TypeGuard

import sympy
from sympy import Expr, Symbol

from mcgee.closed_form.angles import Basis, Form, form
from mcgee.closed_form.ring import TRANSCENDENTAL, Ring, rational, simplest
from mcgee.model import Mat3
from mcgee.scalar import Scalar, Turn

SAME = 4e-15
"""Entries of rotations closer than that differ by rounding alone."""


SIMPLE = 1000
"""The largest denominator of a cosine and sine that are taken as rational: 3/5 and 4/5."""


class Needs:
    """What a ring must have; stands for the ring in the first reading, where values are dummies."""

    def __init__(self) -> None:
        self.angles: dict[Form, None] = {}
        self.symbols: dict[Symbol, None] = {}
        self.inverses: dict[Symbol, None] = {}
        self.roots: dict[int, None] = {}

    def __call__(self, x: Scalar) -> int:
        return 1

    def symbol(self, s: Symbol) -> int:
        self.symbols[s] = None
        return 1

    def inverse(self, s: Symbol) -> int:
        self.symbols[s] = self.inverses[s] = None
        return 1

    def root(self, p: int) -> int:
        self.roots[p] = None
        return 1

    def turn(self, angle: Form) -> Turn:
        self.angles[angle] = None
        return Turn(1, 0)

    def ring(self, angles: Sequence[Form] = (), symbols: Sequence[Symbol] = ()) -> Ring:
        names: dict[str, Symbol] = {}
        everything = [*symbols, *sorted(self.symbols, key=str)]
        for symbol in (*everything, *(s for angle in self.angles for s, _ in angle)):
            if names.setdefault(str(symbol), symbol) != symbol:
                raise ValueError(
                    f"two symbols are called '{symbol}' and differ in their assumptions. Make one "
                    f"with sympy.Symbol and use it everywhere."
                )
        basis = Basis([*angles, *self.angles])
        inverses = sorted(self.inverses, key=str)
        return Ring(basis, list(dict.fromkeys(everything)), inverses, sorted(self.roots))


class Reader:
    """Reads into a ring, or into the needs of one.

    Args:
        algebra: the ring, or Needs
        constants: the named angles so far, by symbol, with their values; grows while reading
        refuse: called with an expression that is no trigonometric polynomial; raises
        taken: names that a named angle must not have
    """

    def __init__(
        self,
        algebra: Ring | Needs,
        constants: dict[Symbol, float],
        refuse: Callable[[Any], NoReturn],
        taken: Collection[str] = (),
    ):
        self.ring, self.constants, self.refuse, self.taken = algebra, constants, refuse, taken

    def number(self, x: Scalar) -> Scalar:
        """A parameter; whole numbers stay integers."""
        if isinstance(x, (int, float, Fraction)):
            value = rational(x)
            return int(value) if value.denominator == 1 and abs(value) <= 1 else self.ring(value)
        return self._expression(sympy.sympify(x))

    def _expression(self, e: Expr) -> Scalar:
        if e.is_Rational:
            return self.ring(Fraction(int(e.p), int(e.q)))
        if e.is_Float:
            return self.ring(rational(float(e)))
        if e.is_Symbol:
            return self.ring.symbol(e)
        if e.is_Add or e.is_Mul:
            first, *rest = (self._expression(part) for part in e.args)
            for part in rest:
                first = first + part if e.is_Add else first * part
            return first
        if e.is_Pow:
            return self._power(e)
        if isinstance(e, (sympy.cos, sympy.sin)):
            turn = self._angle(e.args[0])
            return turn.c if isinstance(e, sympy.cos) else turn.s
        if e in TRANSCENDENTAL:
            return self.ring.symbol(TRANSCENDENTAL[e])
        return self.refuse(e)

    def _power(self, e: Expr) -> Scalar:
        base, times = e.as_base_exp()
        if times.is_Integer and times > 0:
            return _repeated(self._expression(base), int(times))
        if times.is_Integer and base.is_Symbol:
            return _repeated(self.ring.inverse(base), -int(times))
        if times.is_Rational and times.q == 2 and base.is_Integer and base > 0:
            whole = Fraction(int(base)) ** ((int(times.p) - 1) // 2)
            return self._root(int(base)) * self.ring(whole)
        return self.refuse(e)

    def _root(self, n: int) -> Scalar:
        total = self.ring(1)
        for p, times in sympy.factorint(n).items():
            total = total * self.ring(Fraction(p ** (times // 2)))
            total = total * self.ring.root(p) if times % 2 else total
        return total

    def _angle(self, angle: Expr) -> Turn:
        """A linear form in symbols with rational factors, and a constant."""
        total, moving = Turn(self.ring(1), self.ring(0)), {}
        for part in sympy.Add.make_args(sympy.expand(angle)):
            factor, rest = part.as_coeff_Mul()
            if rest.is_Symbol and factor.is_number:
                moving[rest] = rational(float(factor)) if factor.is_Float else Fraction(str(factor))
            elif part.is_number:
                total = total + self.constant_turn(part)
            else:
                self.refuse(angle)
        return total + self.ring.turn(form(moving.items())) if moving else total

    def constant_turn(self, angle: Scalar) -> Turn:
        """By a multiple of 15°, or by a named constant."""
        twelfths = sympy.sympify(angle) * 12 / sympy.pi
        if twelfths.is_Integer:
            k = int(twelfths)
            return Turn(self.nice(_twelfth(k)), self.nice(_twelfth(k - 6)))
        return self.turn_at(math.cos(angle), math.sin(angle))

    # -- rotations --------------------------------------------------------------------------------

    def nice(self, value: tuple[Fraction, ...]) -> Scalar:
        """a + b √2 + c √3 + d √6."""
        if value[0].denominator == 1 and not any(value[1:]):
            return int(value[0])
        total = self.ring(value[0])
        for k, roots in zip(value[1:], ((2,), (3,), (2, 3)), strict=True):
            if k:
                part = self.ring(k)
                for p in roots:
                    part = part * self.ring.root(p)
                total = total + part
        return total

    def turn_at(self, c: float, s: float) -> Turn:
        """The turn with this cosine and sine: exact for multiples of 15° and simple rational points
        of the circle, else by a named angle below 90°."""
        if (exact := (_recognised(c), _recognised(s))) and None not in exact:
            return Turn(*map(self.nice, exact))  # type: ignore[arg-type]
        simple = [Fraction(x).limit_denominator(SIMPLE) for x in (c, s)]
        if sum(x * x for x in simple) == 1 and all(
            abs(a - b) < SAME for a, b in zip(simple, (c, s), strict=True)
        ):
            return Turn(*map(self.ring, simple))
        acute = math.atan2(abs(s), abs(c))
        for symbol, value in self.constants.items():
            for same, swapped in ((value, False), (math.pi / 2 - value, True)):
                if abs(same - acute) < SAME:
                    return self._signed(symbol, c, s, swapped)
        names = (f"phi{k}" for k in count(1))
        used = {*map(str, self.constants), *self.taken}
        symbol = Symbol(next(name for name in names if name not in used))
        self.constants[symbol] = acute
        return self._signed(symbol, c, s, False)

    def _signed(self, symbol: Symbol, c: float, s: float, swapped: bool) -> Turn:
        turn = self.ring.turn(form([(symbol, 1)]))
        a, b = (turn.s, turn.c) if swapped else (turn.c, turn.s)
        return Turn(a if c > 0 else -a, b if s > 0 else -b)

    def rotation(self, R: Mat3) -> Mat3:
        """Exactly orthogonal."""
        if any(hasattr(x, "free_symbols") for row in R for x in row):
            read = _mapped(R, self._rotation_entry)
            if isinstance(self.ring, Ring) and not _is_orthogonal(read):
                self.refuse(R)
            return read
        nice = [[_recognised(float(x)) for x in row] for row in R]
        if _orthogonal(nice):
            return _mapped(nice, self.nice)
        for i, j in product(range(3), repeat=2):
            if abs(abs(R[i][j]) - 1) < SAME and sum(abs(x) > SAME for x in R[i]) == 1:
                return self._about_one_axis(R, i, j)
        return _mapped(nearest_rotation(R), self.ring)

    def _about_one_axis(self, R: Mat3, i: int, j: int) -> Mat3:
        """R[i][j] is ±1; the other four are cosines and sines of one angle."""
        rows, columns = [a for a in range(3) if a != i], [b for b in range(3) if b != j]
        turn = self.turn_at(R[rows[0]][columns[0]], R[rows[1]][columns[0]])
        sense = round(R[i][j]) * (-1) ** (i + j)  # det R = 1
        entries: list[list[Scalar]] = [[0] * 3 for _ in range(3)]
        entries[i][j] = round(R[i][j])
        entries[rows[0]][columns[0]], entries[rows[1]][columns[0]] = turn.c, turn.s
        entries[rows[0]][columns[1]], entries[rows[1]][columns[1]] = -turn.s * sense, turn.c * sense
        return _mapped(entries, lambda x: x)

    def _rotation_entry(self, x: Any) -> Scalar:
        """Of a rotation with symbols; its floats are cosines and sines of multiples of 15°."""
        floats = {f: _recognised(float(f)) for f in getattr(x, "atoms", lambda _: ())(sympy.Float)}
        if not hasattr(x, "atoms"):
            exact = _recognised(float(x))
            return self.nice(exact) if exact is not None else self.refuse(x)
        if any(v is None for v in floats.values()):
            return self.refuse(x)
        return self._expression(x.xreplace({f: _as_sympy(v) for f, v in floats.items()}))  # type: ignore[arg-type]


def _mapped(rows: Sequence[Sequence[Any]], convert: Callable[[Any], Scalar]) -> Mat3:
    a, b, c = (tuple(convert(x) for x in row) for row in rows)
    return a, b, c


def _is_orthogonal(R: Mat3) -> bool:
    return all(
        simplest(sum(x * y for x, y in zip(R[i], R[j], strict=True)) - int(i == j)) == 0
        for i, j in product(range(3), repeat=2)
    )


def _repeated(x: Scalar, times: int) -> Scalar:
    total = x
    for _ in range(times - 1):
        total = total * x
    return total


# -- numbers of the form a + b √2 + c √3 + d √6 ---------------------------------------------------

Nice = tuple[Fraction, Fraction, Fraction, Fraction]
_QUARTER = Fraction(1, 4)


def _nice(*parts: Fraction | int) -> Nice:
    a, b, c, d = map(Fraction, parts)
    return a, b, c, d


_TWELFTHS = (
    _nice(1, 0, 0, 0),
    _nice(0, _QUARTER, 0, _QUARTER),
    _nice(0, 0, Fraction(1, 2), 0),
    _nice(0, Fraction(1, 2), 0, 0),
    _nice(Fraction(1, 2), 0, 0, 0),
    _nice(0, -_QUARTER, 0, _QUARTER),
    _nice(0, 0, 0, 0),
)
"""cos(k 15°), k = 0 … 6."""


def _twelfth(k: int) -> Nice:
    """cos(k 15°)."""
    k = abs(k) % 24
    k = min(k, 24 - k)
    return _TWELFTHS[k] if k <= 6 else _times(_TWELFTHS[12 - k], _nice(-1, 0, 0, 0))


def _times(x: Nice, y: Nice) -> Nice:
    a, b, c, d = x
    e, f, g, h = y
    return (
        a * e + 2 * b * f + 3 * c * g + 6 * d * h,
        a * f + b * e + 3 * (c * h + d * g),
        a * g + c * e + 2 * (b * h + d * f),
        a * h + d * e + b * g + c * f,
    )


def _value(x: Nice) -> float:
    return math.fsum(float(k) * r for k, r in zip(x, (1, 2**0.5, 3**0.5, 6**0.5), strict=True))


def _sum(x: Nice, y: Nice) -> Nice:
    return _nice(*(a + b for a, b in zip(x, y, strict=True)))


@cache
def _entries(all_three: bool) -> dict[int, Nice]:
    """Entries of one turn, or of up to three, by multiples of 15°, by their value times 10¹²."""
    ones = {_twelfth(k) for k in range(13)}
    found = ones
    if all_three:
        twos = {_times(x, y) for x in ones for y in ones}
        threes = {_times(x, y) for x in twos for y in ones}
        found = {_sum(x, y) for x in threes for y in twos}
    return {round(_value(x) * 1e12): x for x in found if abs(_value(x)) < 1 + SAME}


def _recognised(x: float) -> Nice | None:
    """The number that the float rounds, of entries of rotations by multiples of 15°."""
    key = round(x * 1e12)
    for all_three in (False, True):
        for near in (key, key - 1, key + 1):
            found = _entries(all_three).get(near)
            if found is not None and abs(_value(found) - x) < SAME:
                return found
    return None


def _orthogonal(rows: Sequence[Sequence[Nice | None]]) -> TypeGuard[Sequence[Sequence[Nice]]]:
    """All recognised, and not by chance."""
    for i, a in enumerate(rows):
        for j, b in enumerate(rows):
            total = _nice(0, 0, 0, 0)
            for x, y in zip(a, b, strict=True):
                if x is None or y is None:
                    return False
                total = _sum(total, _times(x, y))
            if total != _nice(int(i == j), 0, 0, 0):
                return False
    return True


def _as_sympy(x: Nice) -> Expr:
    parts = zip(x, (1, sympy.sqrt(2), sympy.sqrt(3), sympy.sqrt(6)), strict=True)
    return sympy.Add(*(sympy.Rational(k.numerator, k.denominator) * r for k, r in parts))


# -- general rotations ----------------------------------------------------------------------------


def nearest_rotation(R: Mat3) -> list[list[Fraction]]:
    """An exactly orthogonal matrix of rational numbers within rounding of R.

    From the quaternion, its parts rounded to 2⁻⁵⁶ of the largest; dividing by its squared length
    takes no square root.
    """
    (a, b, c), (d, e, f), (g, h, i) = ([float(x) for x in row] for row in R)
    rows = (
        (a + e + i, h - f, c - g, d - b),
        (h - f, a - e - i, b + d, c + g),
        (c - g, b + d, e - a - i, f + h),
        (d - b, c + g, f + h, i - a - e),
    )
    k = max(range(4), key=lambda k: rows[k][k])
    q = [x + (1 if j == k else 0) for j, x in enumerate(rows[k])]
    w, x, y, z = (Fraction(round(v / q[k] * 2**56), 2**56) for v in q)
    n = w * w + x * x + y * y + z * z
    return [
        [(w * w + x * x - y * y - z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n],
        [2 * (x * y + w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z - w * x) / n],
        [2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, (w * w - x * x - y * y + z * z) / n],
    ]
