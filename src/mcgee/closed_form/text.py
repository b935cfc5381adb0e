"""Closed forms as plain text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy
from sympy import Expr

if TYPE_CHECKING:
    from mcgee.closed_form.form import ClosedForm
    from mcgee.closed_form.ring import Polynomial

SIMPLE = 8
"""Denominator up to which a fraction is shown as one."""
SHORT = 10_000
"""Numerator and denominator up to which one is that no decimal ends."""
LONG = 2_000
"""Terms beyond which a text names the size of a formula in its place."""
DIGITS = 6


def plain_text(form: ClosedForm) -> str:
    """Every element of M, C qd and g, and the energies, a line each."""
    lines = [f"Closed form of '{form.name}' in {', '.join(map(str, form.q))}"]
    for what in ("T", "P"):
        lines.append(f"{what} = {_element(form, getattr(form.exact, what))}")
    for i in range(form.n):
        for j in range(i, form.n):
            lines.append(f"M{i + 1}{j + 1} = {_element(form, form.exact.M[i][j])}")
    for what, title in (("Cqd", "(C qd)"), ("g", "g")):
        for i, x in enumerate(getattr(form.exact, what)):
            lines.append(f"{title}{i + 1} = {_element(form, x)}")
    lines += [f"{s} = {rounded(e)}" for s, e in form.lumps.items()]
    lines += [f"{s} = {value:.10g} rad" for s, value in form.constants.items()]
    return "\n".join(lines)


def _element(form: ClosedForm, x: Polynomial) -> str:
    if len(x) > LONG:
        return f"… {len(x)} terms"
    return str(rounded(form.write(x)))


def rounded(e: Expr) -> Expr:
    """For readers: simple fractions as they are, others as decimals, the long ones rounded."""
    put = {x: _decimal(x) for x in e.atoms(sympy.Rational) if x.q > SIMPLE or abs(x.p) > SHORT}
    return e.xreplace(put) if put else e


def is_rounded(e: Expr) -> bool:
    """Whether readers see some number without its last digits."""
    return any(sympy.Rational(str(rounded(x))) != x for x in e.atoms(sympy.Rational))


def _decimal(x: sympy.Rational) -> sympy.Rational | sympy.Float:
    if max(abs(x.p), x.q) <= SHORT and not _terminates(x.q):
        return x
    for digits in range(1, DIGITS + 1):
        short = sympy.Float(x, digits)
        if sympy.Rational(str(short)) == x:
            return short
    return sympy.Float(x, DIGITS)


def _terminates(q: int) -> bool:
    """Whether a fraction with this denominator is a decimal that ends."""
    for p in (2, 5):
        while q % p == 0:
            q //= p
    return q == 1
