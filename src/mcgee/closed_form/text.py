"""Closed forms as plain text and LaTeX."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import sympy
from sympy import Expr, Symbol

if TYPE_CHECKING:
    from mcgee.closed_form.form import ClosedForm

SHORT = 10_000
"""Numerator and denominator up to which a fraction is shown as one; others as a decimal."""
LONG = 2_000
"""Terms beyond which a text names the size of a formula in its place."""
DIGITS = 6


def plain_text(form: ClosedForm) -> str:
    """Every element of M, C qd and g, and the energies, a line each."""
    lines = [f"Closed form of '{form.name}' in {', '.join(map(str, form.q))}"]
    for what in ("T", "P"):
        lines.append(f"{what} = {_element(form, what, getattr(form.exact, what))}")
    for i in range(form.n):
        for j in range(i, form.n):
            lines.append(f"M{i + 1}{j + 1} = {_element(form, 'M', form.exact.M[i][j])}")
    for what, title in (("Cqd", "(C qd)"), ("g", "g")):
        for i, x in enumerate(getattr(form.exact, what)):
            lines.append(f"{title}{i + 1} = {_element(form, what, x)}")
    lines += [f"{s} = {rounded(e)}" for s, e in form.lumps.items()]
    lines += [f"{s} = {value:.10g} rad" for s, value in form.constants.items()]
    return "\n".join(lines)


def _element(form: ClosedForm, what: str, x) -> str:  # type: ignore[no-untyped-def]
    if len(x) > LONG:
        return f"… {len(x)} terms"
    return str(rounded(form._write(x)))


def rounded(e: Expr) -> Expr:
    """Long fractions as decimals, for readers."""
    long = {
        x: sympy.Float(x, DIGITS) for x in e.atoms(sympy.Rational) if max(abs(x.p), x.q) > SHORT
    }
    return e.xreplace(long) if long else e


def latex(form: ClosedForm) -> str:
    """Equations in \\[ \\], one a quantity."""
    names = {s: _name(s) for s in form.exact.ring.symbols}
    names |= {s: f"q_{{{i + 1}}}" for i, s in enumerate(form.q)}
    names |= {s: _dotted(s, 1) for s in form.qd} | {s: _dotted(s, 2) for s in form.qdd}

    def shown(e: Expr) -> str:
        return sympy.latex(rounded(e), symbol_names=names)

    parts = [("T", form.T), ("P", form.P), ("M", form.M), ("C", form.C)]
    parts += [(r"C\,\dot q", form.Cqd), ("g", form.g)]
    parts += [(sympy.latex(s), e) for s, e in form.lumps.items()]
    return "\n".join(f"\\[ {name} = {shown(e)} \\]" for name, e in parts)


def _dotted(s: Symbol, dots: int) -> str:
    """qd1 is q̇₁; a user's own name, dotted no more."""
    match = re.fullmatch(r"q(d+)(\d+)", str(s))
    return f"\\{'d' * dots}ot{{q}}_{{{match[2]}}}" if match else _name(s)


def _name(s: Symbol) -> str:
    return sympy.latex(s)
