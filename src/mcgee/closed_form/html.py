"""A derivation as one HTML page; its formulas are MathML, which browsers show without scripts."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from importlib import resources
from typing import Any

from sympy import Symbol
from sympy.printing.mathml import MathMLPresentationPrinter

from mcgee.closed_form.document import Document, Equation, Name, Section
from mcgee.closed_form.latex import signed
from mcgee.closed_form.names import GREEK, INDEXED, written
from mcgee.closed_form.text import rounded

DOTS = {1: "˙", 2: "¨"}


class _Printer(MathMLPresentationPrinter):
    """SymPy's, with our letters."""

    def __init__(self, rates: set[Symbol]):
        super().__init__()
        self.rates = rates

    def _print_Symbol(self, sym: Symbol, style: str = "plain") -> Any:
        name = written(str(sym), sym in self.rates)
        if name is None:
            return self._of("mtext", str(sym))
        letter = self._of("mi", GREEK.get(name.letter, name.letter))
        if name.dots:
            letter = self._around("mover", letter, self._of("mo", DOTS[name.dots]))
        if name.subscript:
            letter = self._around("msub", letter, self._of("mi", name.subscript))
        return letter

    def _print_Function(self, e: Any, **_: Any) -> Any:
        inside = self._around("mrow", self._of("mo", "("), self._print(e.args[0]))
        inside.appendChild(self._of("mo", ")"))
        space = self._of("mspace", "")
        space.setAttribute("width", "0.17em")
        return self._around("mrow", space, self._of("mi", e.func.__name__), inside)

    def _of(self, tag: str, content: str) -> Any:
        node = self.dom.createElement(tag)
        node.appendChild(self.dom.createTextNode(escape(content)))  # SymPy writes it as it is
        return node

    def _around(self, tag: str, *inside: Any) -> Any:
        node = self.dom.createElement(tag)
        for child in inside:
            node.appendChild(child)
        return node


def page(d: Document) -> str:
    printer = _Printer({*d.form.qd, *d.form.qdd})
    sections = "\n".join("".join(_section(s, printer)) for s in d.sections)
    links = " ".join(f'<a href="#{_anchor(s)}">{escape(s.title)}</a>' for s in d.sections)
    style = resources.files("mcgee.closed_form").joinpath("page.css").read_text("utf-8")
    return _PAGE.format(title=escape(d.title), style=style, links=links, sections=sections)


def _anchor(s: Section) -> str:
    return "".join(c if c.isalnum() else "-" for c in s.title.lower())


def _section(s: Section, printer: _Printer) -> Iterator[str]:
    yield f'<section id="{_anchor(s)}">\n<h2>{escape(s.title)}</h2>\n'
    for sentence in s.sentences:
        yield f"<p>{_words(sentence)}</p>\n"
    for equation in s.equations:
        yield (_matrix if equation.rows else _sum)(equation, printer)
    if s.lines:
        yield "<ul>\n" + "".join(f"<li>{_words(line)}</li>\n" for line in s.lines) + "</ul>\n"
    if s.left_out:
        yield f'<p class="muted">{escape(s.left_out)}</p>\n'
    yield "</section>"


def _words(sentence: str) -> str:
    return INDEXED.sub(r"<i>\1</i><sub>\2</sub>", escape(sentence))


def _sum(e: Equation, printer: _Printer) -> str:
    """Each term a formula of its own, so that lines break between them."""
    parts = [f"<math>{_left(e.left, printer)}<mo>=</mo></math>"]
    for k, (sign, term) in enumerate(signed(e.terms)):
        shown = printer.doprint(rounded(term))
        minus = f"<mo form='infix'>{'−' if sign == '-' else '+'}</mo>" if k or sign == "-" else ""
        parts.append(f"<math><mrow>{minus}{shown}</mrow></math>")
    return f'<p class="sum">{" ".join(parts)}</p>\n'


def _matrix(e: Equation, printer: _Printer) -> str:
    rows = "".join(
        "<mtr>" + "".join(f"<mtd>{printer.doprint(rounded(x))}</mtd>" for x in row) + "</mtr>"
        for row in e.rows
    )
    table = f"<mrow><mo>(</mo><mtable>{rows}</mtable><mo>)</mo></mrow>"
    formula = f"{_left(e.left, printer)}<mo>=</mo>{table}"
    return f'<p class="matrix"><math><mrow>{formula}</mrow></math></p>\n'


def _left(left: Name | Symbol, printer: _Printer) -> str:
    if isinstance(left, Symbol):
        return str(printer.doprint(left))
    dotted = "<mover><mi>q</mi><mo>˙</mo></mover>"
    letter = {
        "Cqd": f"<mrow><mo>(</mo><mi>C</mi>{dotted}<mo>)</mo></mrow>",
        "field": "<mtext>field</mtext>",
    }.get(left.letter, f"<mi>{left.letter}</mi>")
    if left.above:
        return (
            f"<mmultiscripts>{letter}<mi>{left.place}</mi><none/><mprescripts/><none/>"
            f"<mi>{left.above}</mi></mmultiscripts>"
        )
    return f"<msub>{letter}<mi>{left.place}</mi></msub>" if left.place else letter


_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>
{style}
</style>
</head>
<body>
<h1>{title}</h1>
<nav>{links}</nav>
{sections}
</body>
</html>
"""
