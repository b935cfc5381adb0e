"""Angles as linear forms in symbols, and few of them that generate all by whole multiples.

Cosines and sines of angles that are linearly independent over Q are algebraically independent, but
for c² + s² = 1. Written in those of a basis, trigonometric polynomials have a normal form.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import lcm

from flint import fmpq, fmpq_mat
from sympy import Symbol

Form = tuple[tuple[Symbol, Fraction], ...]
"""Σ coefficient · symbol, in the order of the names, no coefficient zero."""

LARGEST_MULTIPLE = 4
"""A gear ratio beyond it (0.7, 3.1415) makes an angle a generator of its own, as if it were
independent. What is then shown to be zero is zero, and cos(0.7 q) stays as it is, when a polynomial
of degree 7 in cos(q/10) helps nobody; that cos(5 q) is a polynomial in cos q is not known."""


def form(coefficients: Iterable[tuple[Symbol, Fraction | int]]) -> Form:
    found = ((s, Fraction(k)) for s, k in coefficients)
    return tuple(sorted(((s, k) for s, k in found if k), key=lambda item: str(item[0])))


def plus(a: Form, b: Form, times: int = 1) -> Form:
    """a + times b."""
    total = dict(a)
    for symbol, k in b:
        total[symbol] = total.get(symbol, Fraction(0)) + times * k
    return form(total.items())


def scaled(a: Form, k: Fraction | int) -> Form:
    return form((symbol, v * k) for symbol, v in a)


class Table:
    """Angles by number, so that they compare and hash fast."""

    def __init__(self, forms: Iterable[Form]):
        self.forms = list(forms)
        self._numbers = {f: i for i, f in enumerate(self.forms)}

    def number(self, f: Form) -> int:
        if f not in self._numbers:
            self._numbers[f] = len(self.forms)
            self.forms.append(f)
        return self._numbers[f]


class Basis:
    """Angles of which all given ones are whole multiples, sums or differences."""

    def __init__(self, forms: Iterable[Form]):
        independent: list[Form] = []
        dependent: list[list[Fraction]] = []
        loose: list[Form] = []
        parts: list[int] = []
        for f in forms:
            f = f if not f or f[0][1] > 0 else scaled(f, -1)
            if not f or f in loose:
                continue
            found = _coordinates(f, independent)
            if found is None:
                independent.append(f)
                parts.append(1)
                continue
            fractions = [lcm(d, r.denominator) for d, r in zip(parts, found, strict=False)]
            rows = (*dependent, found)
            multiples: list[Fraction | int] = [
                abs(r) * d for row in rows for r, d in zip(row, fractions, strict=False)
            ]
            if max(*multiples, *fractions) > LARGEST_MULTIPLE:
                loose.append(f)
            else:
                dependent.append(found)
                parts[: len(fractions)] = fractions
        self.independent = [
            scaled(f, Fraction(1, d)) for f, d in zip(independent, parts, strict=True)
        ]
        self.forms = [*self.independent, *loose]

    @property
    def loose(self) -> bool:
        """Whether some angles are generators of their own, though not independent."""
        return len(self.forms) > len(self.independent)

    def multiples(self, f: Form) -> list[tuple[int, int]]:
        """(index of a basis angle, how many times) of which f is the sum."""
        for sign in (1, -1):
            if scaled(f, sign) in self.forms:
                return [(self.forms.index(scaled(f, sign)), sign)]
        found = _coordinates(f, self.independent)
        if found is None or any(r.denominator != 1 for r in found):
            raise ValueError(f"angle {f} is not among those of the ring.")
        return [(i, int(r)) for i, r in enumerate(found) if r]


def _coordinates(f: Form, basis: Sequence[Form]) -> list[Fraction] | None:
    """f as a sum of basis forms, None where it is independent of them."""
    if not f:
        return [Fraction(0)] * len(basis)
    symbols = sorted({s for g in (f, *basis) for s, _ in g}, key=str)
    columns = [[dict(g).get(s, Fraction(0)) for s in symbols] for g in (*basis, f)]
    rows = [[fmpq(c[i].numerator, c[i].denominator) for c in columns] for i in range(len(symbols))]
    reduced, rank = fmpq_mat(rows).rref()
    n = len(basis)
    if any(reduced[rank - 1, j] for j in range(n)) is False:
        return None
    found = [reduced[i, n] for i in range(n)]
    return [Fraction(int(r.p), int(r.q)) for r in found]
