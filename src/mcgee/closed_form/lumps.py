"""Lumped constants: each combination of parameters named once."""

from __future__ import annotations

from fractions import Fraction

from sympy import Symbol

from mcgee.closed_form.terms import Factors, Sum

NOTHING = Factors((), ())


class Lumps:
    """Names for sums of parameters; a sum that holds an earlier one says so."""

    def __init__(self, letter: str = "a"):
        self.letter = letter
        self.named: dict[Symbol, Sum] = {}
        self._starting: dict[Factors, list[Symbol]] = {}  # lumps by their first term

    def learn(self, sums: list[Sum]) -> None:
        """Name what the sums need, short ones first, so that long ones are written by them."""
        for found in sorted(sums, key=len):
            self.write(found)

    def write(self, given: Sum) -> dict[Symbol | None, Fraction]:
        """The sum as Σ factor · lump, a plain number under None; what is missing gets a name."""
        rest = dict(given)
        written: dict[Symbol | None, Fraction] = {}
        number = rest.pop(NOTHING, None)
        if number is not None:
            written[None] = number
        near = {symbol: None for key in rest for symbol in self._starting.get(key, ())}
        for symbol in near:
            lump = self.named[symbol]
            factor = _contained(lump, rest)
            if factor is None:
                continue
            written[symbol] = factor
            for key, value in lump.items():
                left = rest[key] - factor * value
                if left:
                    rest[key] = left
                else:
                    del rest[key]
        if rest:
            symbol = Symbol(f"{self.letter}{len(self.named) + 1}")
            size = _content(rest)
            self.named[symbol] = {key: value / size for key, value in rest.items()}
            self._starting.setdefault(next(iter(rest)), []).insert(0, symbol)
            written[symbol] = size
        return written


def _contained(lump: Sum, whole: Sum) -> Fraction | None:
    """k where k · lump is a part of the whole, all of its terms."""
    factor = None
    for key, value in lump.items():
        if key not in whole:
            return None
        ratio = whole[key] / value
        if factor is not None and ratio != factor:
            return None
        factor = ratio
    return factor


def _content(x: Sum) -> Fraction:
    """The factor that makes the first coefficient 1, where all are as large; else 1."""
    values = list(x.values())
    return values[0] if all(abs(v) == abs(values[0]) for v in values) else Fraction(1)
