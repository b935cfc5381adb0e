"""Formulas and derivations as LaTeX."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import sympy
from sympy import Expr, Symbol

from mcgee.closed_form.document import Document, Equation, Name, Section
from mcgee.closed_form.names import GREEK, INDEXED, written
from mcgee.closed_form.text import rounded

if TYPE_CHECKING:
    from mcgee.closed_form.form import ClosedForm

DOTTED = r"\dot q"

WIDTH = 78
"""Characters a line of a sum may have, about."""

PREAMBLE = r"""\documentclass[a4paper]{article}
\usepackage[utf8]{inputenc}
\usepackage[T1]{fontenc}
\usepackage[margin=2cm]{geometry}
\usepackage{amsmath}
\allowdisplaybreaks
\setlength{\parindent}{0pt}
\setlength{\parskip}{4pt}
"""

SIGNS = {
    "ᵀ": r"^{\mathsf T}",
    "∂": r"\partial ",
    "Ṁ": r"\dot M",
    "½": r"\tfrac12 ",
    "−": "-",
    "π": r"\pi ",
    "β": r"\beta ",
    "ω": r"\omega ",
    "Σ": r"\sum ",
    "²": "^2",
    "·": r"\cdot ",
    "°": r"^\circ ",
}
SPECIAL = {c: f"\\{c}" for c in "#$%&_{}"} | {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
}
RIGHT = {"Cqd": r"(C\dot q)", "tau": r"\tau", "field": r"\text{field}"}


def latex(form: ClosedForm) -> str:
    """T, P, M, C, C qd and g in \\[ \\], one a quantity."""
    names = symbol_names(form)

    def shown(e: Expr) -> str:
        return sympy.latex(rounded(e), symbol_names=names)

    parts = [("T", form.T), ("P", form.P), ("M", form.M), ("C", form.C)]
    parts += [(r"C\,\dot q", form.Cqd), ("g", form.g)]
    parts += [(names.get(s) or symbol(s), e) for s, e in form.lumps.items()]
    return "\n".join(f"\\[ {name} = {shown(e)} \\]" for name, e in parts)


def symbol_names(form: ClosedForm) -> dict[Symbol, str]:
    rates = {*form.qd, *form.qdd}
    symbols = (*form.exact.ring.symbols, *form.q, *rates, *form.lumps, *form.constants)
    return {s: symbol(s, s in rates) for s in symbols}


def symbol(s: Symbol, is_rate: bool = False) -> str:
    name = written(str(s), is_rate)
    if name is None:
        return rf"\text{{{text(str(s))}}}"
    letter = f"\\{name.letter}" if name.letter in GREEK else name.letter
    if name.dots:
        letter = rf"\{'d' * name.dots}ot{{{letter}}}"
    return f"{letter}_{{{name.subscript}}}" if name.subscript else letter


def text(words: str) -> str:
    """A sentence, whatever is in it; what LaTeX has no letter for is told by its number."""
    out, end = [], 0
    for found in INDEXED.finditer(words):
        out.append(_plain(words[end : found.start()]))
        out.append(rf"${found[1].replace('qd', DOTTED)}_{{{found[2]}}}$")
        end = found.end()
    return "".join([*out, _plain(words[end:])]).replace("$$", "")


def _plain(words: str) -> str:
    out = []
    for c in words:
        if c in SIGNS:
            out.append(f"${SIGNS[c]}$")
        elif c in SPECIAL:
            out.append(SPECIAL[c])
        elif c.isascii() and c.isprintable():
            out.append(c)
        else:
            out.append(c if "À" <= c <= "ÿ" else f"[U+{ord(c):04X}]")
    return "".join(out)


def paper(d: Document) -> str:
    """An article, which pdflatex takes as it is."""
    names = symbol_names(d.form)
    parts = [
        PREAMBLE,
        f"\\title{{{text(d.title)}}}\n\\date{{}}\n\\begin{{document}}\n\\maketitle\n",
    ]
    for section in d.sections:
        parts += _section(section, names)
    return "".join([*parts, "\\end{document}\n"])


def _section(s: Section, names: dict[Symbol, str]) -> Iterator[str]:
    yield f"\n\\section{{{text(s.title)}}}\n"
    for sentence in s.sentences:
        yield f"{text(sentence)}\\par\n"
    sums = [e for e in s.equations if not e.rows]
    for equation in s.equations:
        if equation.rows:
            yield _matrix(equation, names)
    if sums:
        lines = " \\\\\n".join(_sum(e, names) for e in sums)
        yield f"\\begin{{align*}}\n{lines}\n\\end{{align*}}\n"
    for line in s.lines:
        yield f"{text(line)}\\par\n"
    if s.left_out:
        yield f"\\emph{{{text(s.left_out)}}}\\par\n"


def _left(left: Name | Symbol) -> str:
    if isinstance(left, Symbol):
        return symbol(left)
    above = f"{{}}^{{{left.above}}}" if left.above else ""
    place = f"_{{{left.place}}}" if left.place else ""
    return f"{above}{RIGHT.get(left.letter, left.letter)}{place}"


def _matrix(e: Equation, names: dict[Symbol, str]) -> str:
    rows = [" & ".join(sympy.latex(rounded(x), symbol_names=names) for x in row) for row in e.rows]
    body = " \\\\ ".join(rows)
    return f"\\[ {_left(e.left)} = \\begin{{pmatrix}} {body} \\end{{pmatrix}} \\]\n"


def _sum(e: Equation, names: dict[Symbol, str]) -> str:
    """A line of align*, broken where it gets long."""
    lines, length = [f"{_left(e.left)} ={{}}& "], 0
    for k, (sign, term) in enumerate(signed(e.terms)):
        shown = sympy.latex(rounded(term), symbol_names=names)
        size = len(re.sub(r"\\[a-zA-Z]+|[{}_^\\ ]", "", shown)) + 3
        if length and length + size > WIDTH:
            lines.append(" \\\\\n&{}")
            length = 0
        lines.append(f"{sign} {shown} " if k or sign == "-" else f"{shown} ")
        length += size
    return "".join(lines).rstrip()


def signed(terms: Sequence[Expr]) -> Iterator[tuple[str, Expr]]:
    for term in terms:
        negative = term.could_extract_minus_sign() and not term.is_Add
        yield ("-", -term) if negative else ("+", term)
