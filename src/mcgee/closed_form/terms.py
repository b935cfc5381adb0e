"""Polynomials as sums of readable terms: cos(q1 + q2) instead of its product, parameters apart."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import combinations
from typing import NamedTuple

from mcgee.closed_form.angles import Table, plus, scaled
from mcgee.closed_form.ring import Polynomial, Ring

Wave = tuple[int, str]
"""(angle by its number in the ring's table, 'c' | 's'): a cosine or sine."""


class Factors(NamedTuple):
    """The product of waves and of powers of the ring's generators."""

    waves: tuple[Wave, ...]
    powers: tuple[tuple[int, int], ...]
    """(generator, exponent); cosines to a power higher than one are here."""


Sum = dict[Factors, Fraction]


def readable(x: Polynomial) -> Sum:
    """Its terms, products of two waves folded into one where that leaves fewer terms."""
    ring, last = x.ring, x.ring.first_symbol
    terms: Sum = {}
    for exponents, coefficient in x.terms():
        waves, powers = [], []
        for i, e in enumerate(exponents):
            if not e:
                continue
            if i < last and e == 1:
                waves.append((i // 2, "sc"[i % 2]))
            else:
                powers.append((i, e))
        terms[Factors(tuple(sorted(waves)), tuple(powers))] = coefficient
    while _fold(terms, ring.table):
        pass
    return terms


def _fold(terms: Sum, table: Table) -> bool:
    """cos a cos b + sin a sin b = cos(a − b), and so on, once through; whether anything folded."""
    groups: dict[tuple, dict[str, Fraction]] = {}
    for factors, coefficient in terms.items():
        for one, other in _pairs(factors.waves):
            rest = _without(factors.waves, one, other)
            key = (rest, factors.powers, one[0], other[0])
            groups.setdefault(key, {})[one[1] + other[1]] = coefficient
    folded = False
    for (rest, powers, a, b), found in groups.items():
        for first, second, minus, kind in _RULES:
            if first not in found or second not in found:
                continue
            pair = [_joined(rest, powers, (a, k[0]), (b, k[1])) for k in (first, second)]
            x, y = (terms.get(p) for p in pair)
            if x is None or y is None or abs(x) != abs(y):
                continue
            # cc ± ss = cos(a ∓ b); sc ± cs = sin(a ± b)
            sign = -1 if (x == y) == minus else 1
            for p in pair:
                del terms[p]
            angle = plus(table.forms[a], table.forms[b], sign)
            if angle[0][1] < 0:  # the first factor of an angle is positive
                angle, x = scaled(angle, -1), -x if kind == "s" else x
            _add(terms, _joined(rest, powers, (table.number(angle), kind)), x)
            folded = True
    return folded


_RULES = (("cc", "ss", True, "c"), ("sc", "cs", False, "s"))


def _pairs(waves: tuple[Wave, ...]) -> Iterator[tuple[Wave, Wave]]:
    """Of different angles, in the order of their numbers."""
    for one, other in combinations(waves, 2):
        if one[0] != other[0]:
            yield one, other


def _without(waves: tuple[Wave, ...], *gone: Wave) -> tuple[Wave, ...]:
    left = list(waves)
    for wave in gone:
        left.remove(wave)
    return tuple(left)


def _joined(rest: tuple[Wave, ...], powers: tuple[tuple[int, int], ...], *waves: Wave) -> Factors:
    return Factors(tuple(sorted((*rest, *waves))), powers)


def _add(terms: Sum, factors: Factors, coefficient: Fraction) -> None:
    total = terms.get(factors, Fraction(0)) + coefficient
    if total:
        terms[factors] = total
    else:
        terms.pop(factors, None)


# -- configuration and parameters apart -----------------------------------------------------------


def collected(terms: Sum, ring: Ring, moving: Iterable[int], coordinates: frozenset) -> dict:
    """By configuration: {factors of the state: {factors of the parameters: coefficient}}.

    Args:
        moving: the generators that are coordinates, velocities, accelerations
        coordinates: the symbols q; a wave with one of them in its angle belongs to the state
    """
    moving = frozenset(moving)
    found: dict[Factors, Sum] = {}
    for factors, coefficient in terms.items():
        state: tuple[list, list] = ([], [])
        parameter: tuple[list, list] = ([], [])
        for wave in factors.waves:
            part = (
                state if any(s in coordinates for s, _ in ring.table.forms[wave[0]]) else parameter
            )
            part[0].append(wave)
        for i, e in factors.powers:
            part = state if i in moving or _turns(ring, i, coordinates) else parameter
            part[1].append((i, e))
        a, b = (Factors(tuple(w), tuple(p)) for w, p in (state, parameter))
        found.setdefault(a, {})[b] = coefficient
    return found


def _turns(ring: Ring, i: int, coordinates: frozenset) -> bool:
    """Whether a generator is the cosine or sine of an angle that moves."""
    if i >= ring.first_symbol:
        return False
    return any(s in coordinates for s, _ in ring.angles.forms[i // 2])
