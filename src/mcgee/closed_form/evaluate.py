"""Polynomials as NumPy functions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from sympy import Symbol

from mcgee.closed_form.ring import TRANSCENDENTAL, Polynomial, Ring


def values_of(ring: Ring, values: Mapping[Symbol, Any]) -> list[Any]:
    """The value of each generator, numbers or arrays of one shape.

    Raises: ValueError: a symbol without a value
    """

    values = {symbol: float(c) for c, symbol in TRANSCENDENTAL.items()} | dict(values)

    def of(symbol: Symbol) -> Any:
        if symbol not in values:
            raise ValueError(
                f"symbol '{symbol}' has no value. Give one in values={{'{symbol}': …}}."
            )
        return values[symbol]

    found: list[Any] = []
    for angle in ring.angles.forms:
        total = sum(float(k) * of(s) for s, k in angle)
        found += [np.sin(total), np.cos(total)]
    needed = [of(s) for s in ring.symbols]
    found += needed
    found += [1 / of(s) for s in ring.inverses]
    return found + [math.sqrt(p) for p in ring.roots]


class Compiled:
    """A polynomial's coefficients and exponents, ready to be evaluated often."""

    def __init__(self, x: Polynomial):
        self.coefficients = np.array([int(c.p) / int(c.q) for c in x.p.coeffs()])
        monomials = np.array([[int(e) for e in m] for m in x.p.monoms()], np.int64)
        used = np.flatnonzero(monomials.any(axis=0)) if len(monomials) else ()
        self.exponents = [(int(i), monomials[:, i]) for i in used]

    def __call__(self, generators: list[Any]) -> Any:
        """Its value at values of the generators."""
        total: Any = self.coefficients
        for i, exponents in self.exponents:
            total = total * np.asarray(generators[i])[..., None] ** exponents
        return total.sum(axis=-1)


def evaluate(x: Polynomial, generators: list[Any]) -> Any:
    return Compiled(x)(generators)
