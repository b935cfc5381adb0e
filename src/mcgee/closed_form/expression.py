"""Polynomials as SymPy expressions."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import sympy
from sympy import Expr, Symbol

from mcgee.closed_form.lumps import Lumps
from mcgee.closed_form.ring import TRANSCENDENTAL, Polynomial, Ring
from mcgee.closed_form.terms import Factors, Sum, Wave, collected, readable

WAYS = ("expanded", "collected", "lumped")
"""Terms one by one; by configuration, each with its parameters; these named."""


class Writer:
    """Writes the polynomials of a ring, waves and generators made once."""

    def __init__(self, ring: Ring, q: Iterable[Symbol], rates: Iterable[Symbol]):
        self.ring, self.coordinates = ring, frozenset(q)
        moving = (*self.coordinates, *rates)
        self.moving = frozenset(ring.at[s] for s in moving if s in ring.at)
        self._waves: dict[Wave, Expr] = {}
        self._generators = self._generator_expressions()

    def _generator_expressions(self) -> list[Expr]:
        waves = [self._wave((i, kind)) for i in range(len(self.ring.angles.forms)) for kind in "sc"]
        known = {symbol: c for c, symbol in TRANSCENDENTAL.items()}
        symbols = [known.get(s, s) for s in self.ring.symbols]
        inverses = [1 / s for s in self.ring.inverses]
        return [*waves, *symbols, *inverses, *map(sympy.sqrt, self.ring.roots)]

    def _wave(self, wave: Wave) -> Expr:
        if wave not in self._waves:
            angle, kind = wave
            total = sympy.Add(*(s * number(k) for s, k in self.ring.table.forms[angle]))
            self._waves[wave] = (sympy.cos if kind == "c" else sympy.sin)(total)
        return self._waves[wave]

    # -- the three ways ---------------------------------------------------------------------------

    def write(self, x: Polynomial, way: str, lumps: Lumps) -> Expr:
        terms = readable(x)
        if way == "expanded":
            return self.sum(terms)
        parts = [
            self.factors(state) * self._parameters(found, way, lumps)
            for state, found in self.by_configuration(terms).items()
        ]
        return sympy.Add(*parts)

    def by_configuration(self, terms: Sum) -> dict[Factors, Sum]:
        return collected(terms, self.ring, self.moving, self.coordinates)

    def sum(self, terms: Sum) -> Expr:
        return sympy.Add(*(self._product(f, k) for f, k in terms.items()))

    def factors(self, x: Factors) -> Expr:
        return self._product(x, Fraction(1))

    def _product(self, x: Factors, k: Fraction) -> Expr:
        waves = map(self._wave, x.waves)
        powers = (self._generators[i] ** e for i, e in x.powers)
        return sympy.Mul(number(k), *waves, *powers)

    def _parameters(self, found: Sum, way: str, lumps: Lumps) -> Expr:
        if way == "lumped":
            return sympy.Add(
                *(number(k) * (1 if s is None else s) for s, k in lumps.write(found).items())
            )
        common, rest = _common(found)
        return self.factors(common) * self.sum(rest)


def _common(found: Sum) -> tuple[Factors, Sum]:
    """What all terms share, as factors, and the rest."""
    powers = [dict(f.powers) for f in found]
    least = {i: min(p.get(i, 0) for p in powers) for i in powers[0]}
    shared = tuple((i, e) for i, e in least.items() if e)
    rest = {}
    for factors, k in found.items():
        left = ((i, e - least.get(i, 0)) for i, e in factors.powers)
        rest[Factors(factors.waves, tuple((i, e) for i, e in left if e))] = k
    return Factors((), shared), rest


def number(k: Fraction) -> Expr:
    return sympy.Rational(k.numerator, k.denominator)
