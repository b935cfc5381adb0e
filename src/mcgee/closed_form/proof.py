"""Identities of the equation of motion, decided: their difference is the polynomial 0, or not."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mcgee.closed_form.expression import Writer
from mcgee.closed_form.lumps import Lumps
from mcgee.closed_form.ring import Polynomial

LONG = 12
"""Terms beyond which a difference is not written out."""


@dataclass(frozen=True)
class Identity:
    """A statement, and the differences of its two sides."""

    name: str
    statement: str
    differences: tuple[Polynomial, ...]
    """One for each element; all are 0 where the identity holds."""
    terms: tuple[int, int]
    """How many terms the two sides had."""
    note: str = ""
    decidable: bool = True
    """Whether a difference that is not the polynomial 0 is not 0: angles of gears, and named ones,
    may depend on one another."""

    @property
    def holds(self) -> bool:
        return not any(self.differences)

    def __str__(self) -> str:
        left, right = self.terms
        note = f" {self.note}" if self.note else ""
        if self.holds:
            size = (
                f"{len(self.differences)} differences"
                if len(self.differences) > 1
                else "difference"
            )
            return f"proved    {self.statement}: {size} 0, from {left} and {right} terms.{note}"
        if not self.decidable:
            return f"undecided {self.statement}: angles in it may depend on one another.{note}"
        wrong = sum(map(bool, self.differences))
        example = next(d for d in self.differences if d)
        return (
            f"FALSE     {self.statement}: {wrong} of {len(self.differences)} differences are "
            f"not 0, the first is {shown(example)}.{note}"
        )


@dataclass(frozen=True)
class Definiteness:
    """Whether M is positive definite, and how that is known."""

    how: str
    """'proved', 'sampled' (numerically), 'undecided' or 'false'."""
    reason: str
    name: str = "positive definite"
    statement: str = "M is positive definite"

    @property
    def holds(self) -> bool:
        return self.how != "false"

    def __str__(self) -> str:
        how = "FALSE" if self.how == "false" else self.how
        return f"{how:<10}{self.statement}: {self.reason}"


class Proof(tuple):
    """Identities by position or by name; true where all hold, and M may be positive definite."""

    def __bool__(self) -> bool:
        return all(identity.holds for identity in self)

    def __getitem__(self, key):
        if not isinstance(key, str):
            return super().__getitem__(key)
        for identity in self:
            if identity.name == key:
                return identity
        raise KeyError(f"no identity is called '{key}'. Names: {', '.join(i.name for i in self)}.")

    def __str__(self) -> str:
        return "\n".join(map(str, self))

    __repr__ = __str__


def shown(x: Polynomial) -> str:
    """As a formula, if it is short enough to be read."""
    if len(x) > LONG:
        return f"a polynomial with {len(x)} terms"
    return str(Writer(x.ring, (), ()).write(x, "expanded", Lumps()))


def identity(
    name: str,
    statement: str,
    left: Iterable[Polynomial],
    right: Iterable[Polynomial],
    note: str = "",
    decidable: bool = True,
) -> Identity:
    a, b = list(left), list(right)
    differences = tuple(x - y for x, y in zip(a, b, strict=True))
    return Identity(name, statement, differences, (_terms(a), _terms(b)), note, decidable)


def _terms(found: Sequence[Polynomial]) -> int:
    return sum(map(len, found))
