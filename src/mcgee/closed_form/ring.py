"""Exact trigonometric polynomials in a normal form, so that equality is decidable.

Polynomials over Q in the cosines and sines of the ring's angles, in symbols, in inverses of symbols
and in square roots of primes, always reduced by s² = 1 − c², r² = p and x · 1/x = 1. The leading
monomials of these relations have no factor in common: they are a Gröbner basis, the reduced
polynomial is unique, and two expressions are equal where their difference is the polynomial 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import sympy
from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx
from sympy import Symbol

from mcgee.closed_form.angles import Basis, Form, Table
from mcgee.scalar import Scalar, Turn

TRANSCENDENTAL = {c: sympy.Dummy(str(c), positive=True) for c in (sympy.pi, sympy.E)}
"""What stands for π and e, which no relation binds; no symbol of a user's is the same."""


MOST = 200_000
"""Terms of two factors together beyond which a product is refused."""


def rational(x: Scalar) -> Fraction:
    """The number that was evidently written: of a float its shortest decimal, 0.1 is 1/10."""
    return Fraction(repr(float(x))) if isinstance(x, float) else Fraction(x)


class Ring:
    """The polynomials in given angles' cosines and sines, symbols, inverses and square roots."""

    def __init__(
        self,
        angles: Basis,
        symbols: Sequence[Symbol] = (),
        inverses: Sequence[Symbol] = (),
        roots: Sequence[int] = (),
    ):
        self.angles, self.symbols = angles, tuple(symbols)
        self.inverses, self.roots = tuple(inverses), tuple(roots)
        self.table = Table(angles.forms)  # first those of the generators, then sums of these
        named = [f"{kind}[{_name(f)}]" for f in angles.forms for kind in "sc"]
        named += [str(s) for s in self.symbols] + [f"1/{s}" for s in self.inverses]
        named += [f"sqrt{p}" for p in self.roots]
        named = [name.encode("ascii", "backslashreplace").decode() for name in named]
        self.context = fmpq_mpoly_ctx.get(tuple(named), Ordering.lex)
        self.generators = self.context.gens()
        self.at = {s: self.first_symbol + i for i, s in enumerate(self.symbols)}
        self.relations = self._relations()
        self.tracked = 0
        for i in self.relations:
            self.tracked |= 1 << i
        self.pairs = self._pairs()

    @property
    def first_symbol(self) -> int:
        return 2 * len(self.angles.forms)

    @property
    def first_inverse(self) -> int:
        return self.first_symbol + len(self.symbols)

    @property
    def first_root(self) -> int:
        return self.first_inverse + len(self.inverses)

    def _relations(self) -> dict[int, fmpq_mpoly]:
        """By the generator whose square they take away."""
        g, found = self.generators, {}
        for i in range(0, self.first_symbol, 2):
            found[i] = g[i] ** 2 + g[i + 1] ** 2 - 1
        for k, p in enumerate(self.roots):
            found[self.first_root + k] = g[self.first_root + k] ** 2 - p
        return found

    def _pairs(self) -> list[tuple[int, fmpq_mpoly]]:
        """(bits of x and 1/x, x · 1/x − 1)."""
        found = []
        for k, symbol in enumerate(self.inverses):
            i, j = self.at[symbol], self.first_inverse + k
            found.append((1 << i | 1 << j, self.generators[i] * self.generators[j] - 1))
            self.tracked |= 1 << i | 1 << j
        return found

    # -- elements ---------------------------------------------------------------------------------

    def __call__(self, x: Scalar) -> Polynomial:
        """A number, or a polynomial of a ring with fewer generators, as an element."""
        if not isinstance(x, Polynomial):
            return Polynomial(self, self.context.constant(_fmpq(x)), 0)
        return x if x.ring is self else self.element(x.p.project_to_context(self.context))

    def element(self, p: fmpq_mpoly) -> Polynomial:
        """A reduced flint polynomial as an element."""
        mask = sum(1 << i for i, d in enumerate(p.degrees()) if d) if len(p) else 0
        return Polynomial(self, p, mask & self.tracked)

    def generator(self, i: int) -> Polynomial:
        return Polynomial(self, self.generators[i], 1 << i & self.tracked)

    def symbol(self, s: Symbol) -> Polynomial:
        return self.generator(self.at[s])

    def inverse(self, s: Symbol) -> Polynomial:
        return self.generator(self.first_inverse + self.inverses.index(s))

    def root(self, p: int) -> Polynomial:
        return self.generator(self.first_root + self.roots.index(p))

    def turn(self, angle: Form) -> Turn:
        """Its cosine and sine."""
        total = Turn(self(1), self(0))
        for i, times in self.angles.multiples(angle):
            total = total + Turn(self.generator(2 * i + 1), self.generator(2 * i)) * times
        return total

    # -- what keeps the normal form ---------------------------------------------------------------

    def product(self, a: Polynomial, b: Polynomial) -> Polynomial:
        if len(a.p) + len(b.p) > MOST:
            raise ValueError(
                f"the closed form has a formula of more than {MOST:,} terms, which nobody reads. "
                f"Put numbers in for symbols with .subs, leave out symbolic_inertias, or give axes "
                f"in general directions as multiples of 15°: each of them makes formulas some five "
                f"times as long."
            )
        p, mask = a.p * b.p, a.mask | b.mask
        squared = a.mask & b.mask
        while squared:
            low = squared & -squared
            squared ^= low
            relation = self.relations.get(low.bit_length() - 1)
            if relation is not None:
                p = divmod(p, relation)[1]
        for bits, relation in self.pairs:
            if mask & bits == bits:
                p = divmod(p, relation)[1]
        return Polynomial(self, p, mask)

    def derivative(self, a: Polynomial, s: Symbol) -> Polynomial:
        """∂/∂s: s as itself, and within angles by ∂c = −s, ∂s = c."""
        total, g = self.context.constant(0), self.generators
        i = self.at.get(s)
        if i is not None:
            total = a.p.derivative(i)
        for k, angle in enumerate(self.angles.forms):
            rate = dict(angle).get(s)
            if rate is None:
                continue
            sine, cosine = 2 * k, 2 * k + 1
            turned = g[cosine] * a.p.derivative(sine)
            by_cosine = a.p.derivative(cosine)
            if len(by_cosine):
                turned -= g[sine] * by_cosine
                if a.mask >> sine & 1:
                    turned = divmod(turned, self.relations[sine])[1]
            total += turned if rate == 1 else turned * _fmpq(rate)
        return self.element(total)


class Polynomial:
    """An element of a ring; a scalar for every algorithm."""

    __slots__ = ("mask", "p", "ring")

    def __init__(self, ring: Ring, p: fmpq_mpoly, mask: int):
        self.ring, self.p, self.mask = ring, p, mask
        # the mask's bits: tracked generators that may occur

    def __add__(self, other: Scalar) -> Polynomial:
        if isinstance(other, Polynomial):
            return Polynomial(self.ring, self.p + other.p, self.mask | other.mask)
        return self if other == 0 else Polynomial(self.ring, self.p + _fmpq(other), self.mask)

    __radd__ = __add__

    def __neg__(self) -> Polynomial:
        return Polynomial(self.ring, -self.p, self.mask)

    def __sub__(self, other: Scalar) -> Polynomial:
        if isinstance(other, Polynomial):
            return Polynomial(self.ring, self.p - other.p, self.mask | other.mask)
        return self if other == 0 else Polynomial(self.ring, self.p - _fmpq(other), self.mask)

    def __rsub__(self, other: Scalar) -> Polynomial:
        return -self + other

    def __mul__(self, other: Scalar) -> Polynomial | int:
        if isinstance(other, Polynomial):
            return self.ring.product(self, other)
        if other == 0:
            return 0
        return self if other == 1 else Polynomial(self.ring, self.p * _fmpq(other), self.mask)

    __rmul__ = __mul__

    def __truediv__(self, number: Scalar) -> Polynomial:
        return Polynomial(self.ring, self.p / _fmpq(number), self.mask)

    def __pow__(self, times: int) -> Polynomial:
        total = self.ring(1)
        for _ in range(times):
            total = self.ring.product(total, self)
        return total

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Polynomial):
            return bool(self.p == other.p)
        if isinstance(other, (int, float, Fraction)):
            return bool(self.p == self.ring.context.constant(_fmpq(other)))
        return NotImplemented

    def __hash__(self) -> int:
        return hash(str(self.p))

    def __len__(self) -> int:
        """The number of terms."""
        return len(self.p)

    def __bool__(self) -> bool:
        return len(self.p) > 0

    def derivative(self, s: Symbol) -> Polynomial:
        return self.ring.derivative(self, s)

    def degree(self, s: Symbol) -> int:
        """In a symbol as itself, not in its cosine."""
        return self.p.degrees()[self.ring.at[s]] if self else 0

    def terms(self) -> list[tuple[tuple[int, ...], Fraction]]:
        """(exponents by generator, coefficient), in the ring's order."""
        coefficients = (Fraction(int(c.p), int(c.q)) for c in self.p.coeffs())
        return [(tuple(map(int, m)), c) for m, c in zip(self.p.monoms(), coefficients, strict=True)]

    def __repr__(self) -> str:
        text = str(self.p)
        return text if len(text) <= 200 else f"{text[:200]}… ({len(self)} terms)"


def simplest(x: Any) -> Any:
    """0 and ±1 as integers, by which the algorithms see structure; the rest as it is."""
    if isinstance(x, Polynomial) and len(x) <= 1:
        for k in (0, 1, -1):
            if x == k:
                return k
    return x


def _fmpq(x: Scalar) -> fmpq:
    if isinstance(x, int):
        return fmpq(x)
    value = rational(x)
    return fmpq(value.numerator, value.denominator)


def _name(angle: Form) -> str:
    return "+".join(str(s) if k == 1 else f"{k}*{s}" for s, k in angle)
