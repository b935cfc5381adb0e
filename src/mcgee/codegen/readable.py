"""The terms of a small arm as a person would write them, from the closed form.

Sums are grouped by configuration, and what is common is taken out: m2*l1*lc2*s2*qdot2*(2*qdot1 +
qdot2). Angles have names: c12 is cos(q1 + q2).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import reduce
from math import gcd
from typing import TYPE_CHECKING, Any

from mcgee.closed_form import ClosedForm
from mcgee.closed_form.angles import Form
from mcgee.closed_form.ring import TRANSCENDENTAL, Polynomial
from mcgee.closed_form.terms import Factors, readable
from mcgee.codegen.routine import (
    Expression,
    Item,
    Let,
    Local,
    Number,
    Put,
    Routine,
    Step,
    Turn,
    op,
)
from mcgee.graph.program import Array

if TYPE_CHECKING:
    from mcgee.codegen.symbols import Model

MOST = 400
"""Terms of M, C qd and g together up to which formulas are readable."""

Monomial = tuple[int, ...]
"""Generators of the ring, sorted, as often as their power says."""
Sum = dict[Monomial, Fraction]
Signed = tuple[bool, Expression]
"""Whether it is subtracted, and what."""


def dynamics(model: Model) -> Routine | None:
    """M, C qdot and g; None where the arm has no symbols, or no formulas for readers."""
    if not model.symbolic:
        return None
    try:
        form = model.robot.closed_form()
    except ValueError:  # a symbol is called like a coordinate, or is in no polynomial
        return None
    if sum(map(form.terms, ("M", "Cqd", "g"))) > MOST:
        return None
    writer = _Writer(form, list(model.defaults))
    n = form.n
    steps: list[Step] = []
    for i in range(n):
        for j in range(i, n):
            value = writer.formula(form.exact.M[i][j])
            name = f"M{i + 1}{j + 1}" if n < 10 else f"M{i + 1}_{j + 1}"
            if i != j and not isinstance(value, Number):
                steps.append(Let(name, value))
                value = Local(name)
            steps += [Put(Item("M", k), value) for k in sorted({i * n + j, j * n + i})]
    for array, entries in (("Cqdot", form.exact.Cqd), ("g", form.exact.g)):
        steps += [Put(Item(array, i), writer.formula(x)) for i, x in enumerate(entries)]
    inputs = (Array("q", (n,)), Array("qdot", (n,)), Array("params", (len(model.defaults),)))
    outputs = (Array("M", (n, n)), Array("Cqdot", (n,)), Array("g", (n,)))
    return Routine("terms", inputs, outputs, ((*writer.turns(), *steps),), readable=True)


class _Writer:
    def __init__(self, form: ClosedForm, parameters: list[str]):
        self.ring = form.exact.ring
        known: dict[Any, Expression] = {s: Item("q", i) for i, s in enumerate(form.q)}
        known |= {s: Item("qdot", i) for i, s in enumerate(form.qd)}
        known |= {s: Number(value) for s, value in form.constants.items()}
        known |= {symbol: Number(float(c)) for c, symbol in TRANSCENDENTAL.items()}
        self.known = known
        self.parameters = {name: i for i, name in enumerate(parameters)}
        self.rates = {self.ring.at[s] for s in form.qd if s in self.ring.at}
        self.q = {s: i + 1 for i, s in enumerate(form.q)}
        self.waves: dict[Form, tuple[str, set[str]]] = {}
        """By angle, its suffix and which of 'c' and 's' are used."""

    def turns(self) -> Iterable[Turn]:
        for angle, (suffix, kinds) in sorted(self.waves.items(), key=_by_suffix):
            cosine, sine = (f"{kind}{suffix}" if kind in kinds else None for kind in "cs")
            yield Turn(cosine, sine, self._angle(angle))

    # -- formulas ---------------------------------------------------------------------------------

    def formula(self, x: Polynomial) -> Expression:
        """By wave, then by what it depends on the velocities, then by parameters."""
        groups: dict[tuple, dict[Monomial, Sum]] = {}
        for factors, coefficient in readable(x).items():
            wave, rates, rest = self._apart(factors)
            groups.setdefault(wave, {}).setdefault(rest, {})[rates] = coefficient
        products: list[Signed] = []
        for wave, found in groups.items():
            alike: dict[tuple, Sum] = {}
            for rest, by_rates in found.items():
                content = _content(by_rates)
                same = tuple((m, k / content) for m, k in by_rates.items())
                alike.setdefault(same, {})[rest] = content
            products += [self._product(wave, dict(same), sums) for same, sums in alike.items()]
        return _total(products)

    def _apart(self, factors: Factors) -> tuple[tuple, Monomial, Monomial]:
        """The waves of a term, its velocities, and its parameters and lengths."""
        waves = list(factors.waves)
        rates: list[int] = []
        rest: list[int] = []
        for i, exponent in factors.powers:
            if i < self.ring.first_symbol:
                waves += [(i // 2, "sc"[i % 2])] * exponent
            else:
                (rates if i in self.rates else rest).extend([i] * exponent)
        return tuple(sorted(waves)), tuple(sorted(rates)), tuple(sorted(rest, key=self._place))

    def _place(self, i: int) -> tuple[int, int]:
        """Parameters in the arm's own order."""
        if self.ring.first_symbol <= i < self.ring.first_inverse:
            name = str(self.ring.symbols[i - self.ring.first_symbol])
            return self.parameters.get(name, len(self.parameters)), i
        return len(self.parameters), i

    def _product(self, wave: tuple, rates: Sum, rest: Sum) -> Signed:
        """Of parameters, waves and velocities."""
        content, parameters = self._factored(rest)
        waves = [Local(self._wave(*w)) for w in wave]
        also, velocities = self._factored(rates)
        return _product(content * also, [*parameters, *waves, *velocities])

    def _factored(self, terms: Sum) -> tuple[Fraction, list[Expression]]:
        """A sum as a number and factors, what all terms share among them."""
        content = _content(terms)
        terms = {m: k / content for m, k in terms.items()}
        shared: list[int] = []
        while common := [i for i in next(iter(terms)) if all(i in m for m in terms)]:
            shared.append(common[0])
            terms = {_without(m, common[0]): k for m, k in terms.items()}
        factors = [self._generator(i) for i in sorted(shared, key=self._place)]
        if terms != {(): 1}:
            factors.append(_total(self._grouped(terms)))
        return content, factors

    def _grouped(self, terms: Sum) -> list[Signed]:
        """Products that the sum is of: single terms, then those that share a generator."""
        groups = []
        while True:
            counts = Counter(i for m in terms for i in dict.fromkeys(m))
            order = sorted(counts, key=lambda i: (-counts[i], self._place(i)))
            if not order or counts[order[0]] < 2:
                break
            groups.append({m: k for m, k in terms.items() if order[0] in m})
            terms = {m: k for m, k in terms.items() if order[0] not in m}
        singles = [{m: k} for m, k in terms.items()]
        return [_product(*self._factored(group)) for group in (*singles, *groups)]

    # -- names ------------------------------------------------------------------------------------

    def _generator(self, i: int) -> Expression:
        ring = self.ring
        if i >= ring.first_root:
            return Number(float(ring.roots[i - ring.first_root]) ** 0.5)
        if i >= ring.first_inverse:
            return op("div", Number(1.0), self._symbol(ring.inverses[i - ring.first_inverse]))
        return self._symbol(ring.symbols[i - ring.first_symbol])

    def _symbol(self, s: Any) -> Expression:
        return self.known[s] if s in self.known else Item("params", self.parameters[str(s)])

    def _wave(self, number: int, kind: str) -> str:
        angle = self.ring.table.forms[number]
        suffix, kinds = self.waves.setdefault(angle, (self._suffix(angle), set()))
        kinds.add(kind)
        return f"{kind}{suffix}"

    def _suffix(self, angle: Form) -> str:
        """12 for q1 + q2."""
        plain = all(s in self.q and k == 1 and self.q[s] < 10 for s, k in angle)
        if plain:
            return "".join(str(self.q[s]) for s, _ in angle)
        return f"_{len(self.waves) + 1}"

    def _angle(self, angle: Form) -> Expression:
        products = []
        for s, k in angle:
            products.append(_product(k, [self._symbol(s)]))
        return _total(products)


def _by_suffix(item: tuple[Form, tuple[str, set[str]]]) -> tuple[int, str]:
    suffix = item[1][0]
    return len(suffix), suffix


def _content(terms: Mapping[Any, Fraction]) -> Fraction:
    """A number to take out: what whole coefficients share, or all are, and the first one's sign."""
    values = list(terms.values())
    sign = 1 if values[0] > 0 else -1
    if all(v.denominator == 1 for v in values):
        return Fraction(sign * gcd(*(v.numerator for v in values)))
    return values[0] if len({abs(v) for v in values}) == 1 else Fraction(sign)


def _without(monomial: Monomial, generator: int) -> Monomial:
    left = list(monomial)
    left.remove(generator)
    return tuple(left)


def _product(number: Fraction, factors: list[Expression]) -> Signed:
    size = abs(number)
    own = [] if size == 1 and factors else [Number(float(size))]
    return number < 0, reduce(lambda a, b: op("mul", a, b), [*own, *factors])


def _total(terms: list[Signed]) -> Expression:
    """The sum, with what is added first."""
    if not terms:
        return Number(0.0)
    (negative, total), *others = sorted(terms, key=lambda term: term[0])
    if negative:
        total = op("neg", total)
    for minus, term in others:
        total = op("sub" if minus else "add", total, term)
    return total
