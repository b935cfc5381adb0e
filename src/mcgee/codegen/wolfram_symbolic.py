"""What a Wolfram package has in symbols: its names, and T and P from which it derives the rest.

T and P are written out where a reader would look at them; else the package holds the bodies and
builds both from their poses.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files as resources
from typing import Any

import sympy
from sympy import Expr, Symbol
from sympy.printing.mathematica import mathematica_code

from mcgee.closed_form import ClosedForm
from mcgee.closed_form.ring import Polynomial
from mcgee.codegen.expression import WIDTH, Syntax, decimal, lines
from mcgee.codegen.names import camel, pascal
from mcgee.codegen.routine import Item
from mcgee.codegen.unit import Function, Unit
from mcgee.mechanism import Body

TERMS = 400
"""Of T and P together up to which they are written out: more nobody reads, and kernels that are
slow take minutes to derive the Christoffel symbols from them."""

DIGITS = 15
"""With more a decimal is a number of higher precision, unless it is marked as a machine's."""

SYMBOLIC = {
    "kinetic_energy": "the kinetic energy T [J]",
    "potential_energy": "the potential energy P [J]",
    "mass_matrix": "the inertia matrix M [kg m^2 | kg m | kg], the second derivatives of T by qdot",
    "christoffel": "the Christoffel symbols c_ijk = (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i)/2",
    "coriolis_matrix": "the Coriolis matrix C, C_ij the sum of c_ijk qdot_k over k",
    "coriolis_forces": "the centrifugal and Coriolis efforts C qdot [N m | N]",
    "gravity_vector": "the gravity efforts g = dP/dq [N m | N]",
}
"""What every package derives from T and P, and these."""


@cache
def template(name: str) -> str:
    return (resources("mcgee.codegen") / "texts" / "wolfram" / f"{name}.wl").read_text("ascii")


@cache
def words_of_templates() -> frozenset[str]:
    """What packages and self-tests call their own."""
    names = ("bodies", "derived", "formulas", "values", "selftest")
    texts = "".join(map(template, names))
    code = re.sub(r"\(\*.*?\*\)|<\w+>", "", texts, flags=re.DOTALL)
    return frozenset({*ARRAYS, *re.findall(r"\b[a-z]\w*", code.replace("_", " "))})


ARRAYS = ("q", "qdot", "qddot", "tau", "v", "params")
"""What functions call their arguments."""


# -- names ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Symbols:
    """The names of a package. Wolfram's have no underscores, and its own begin with capitals."""

    unit: Unit

    @cached_property
    def parameters(self) -> list[str]:
        return [self._parameter(p.identifier) for p in self.unit.parameters]

    def own(self, name: str) -> str:
        """mass_matrix -> planar2rMassMatrix."""
        return f"{camel(self.unit.name)}{pascal(name)}"

    def _parameter(self, identifier: str) -> str:
        first, *others = identifier.rstrip("_").split("_")
        name = first + pascal("_".join(others))
        if not OTHER_THAN_SYSTEM.fullmatch(name):
            name = f"{name[:1].lower()}{name[1:]}"
        public = map(self.own, (*SYMBOLIC, "parameters", *map(numeric, self.unit.functions)))
        return f"${name}" if name in words_of_templates() or name in public else name

    def local(self, name: str) -> str:
        name = name.replace("_", "x")
        return f"${name}" if name in self.parameters else name

    def element(self, i: Item) -> str:
        """Of an input: q1, or a parameter."""
        if i.array == "params":
            return self.parameters[i.index]
        return self.local(f"{i.array}{i.index + 1}")

    def elements(self, array: str) -> list[str]:
        """Of an input with one for each joint."""
        return [self.element(Item(array, i)) for i in range(self.unit.n)]

    def each_of(self, array: str) -> str:
        """A pattern that names the elements."""
        return listed(f"{name}_" for name in self.elements(array))

    def filled(self, text: str, **more: str) -> str:
        """A template with names, patterns of n elements and more for its words in <>."""
        known = {name: self.own(name) for name in (*SYMBOLIC, "parameters")}
        known |= {array: f"{array} : {listed('_' * self.unit.n)}" for array in ("q", "qdot")}
        known |= {"n": str(self.unit.n), "rates": listed(self.elements("qdot")), **more}
        return re.sub(r"<(\w+)>", lambda found: known[found[1]], text)

    @property
    def syntax(self) -> Syntax:
        calls = {"cos": "Cos[", "sin": "Sin["}
        return Syntax(self.element, number, calls, "]", local=self.local)


OTHER_THAN_SYSTEM = re.compile(r"(?![CDEIKNO]$)[A-Z][xyz]{0,2}\d*")
"""Names with a capital that none of Wolfram's own has: I1, Izz2 and M. Others begin small."""


def numeric(f: Function) -> str:
    """Its name, which is another than what derives from T and P has."""
    return f"{f.name}_numeric" if f.name in SYMBOLIC else f.name


# -- lists and numbers ----------------------------------------------------------------------------


def listed(items: Iterable[str]) -> str:
    return f"{{{', '.join(items)}}}"


def enclosed(items: Sequence[str]) -> str:
    """A list on one line, or with a line for each item."""
    line = listed(items)
    if "\n" not in line and len(line) < WIDTH - 8:
        return line
    inside = ",\n".join(items).replace("\n", "\n  ")
    return f"{{\n  {inside}}}"


def called(name: str, *arguments: str) -> str:
    line = f"{name}[{', '.join(arguments)}]"
    return line if len(line) < WIDTH - 8 else f"{name}[\n  " + ",\n  ".join(arguments) + "]"


def number(x: float) -> str:
    """The machine number that is this float: 0.1, 0.30000000000000004`, 1.0*^-9."""
    mantissa, _, exponent = decimal(x).partition("e")
    mantissa = mantissa if "." in mantissa else f"{mantissa}.0"
    mark = "`" if sum(map(str.isdigit, mantissa)) > DIGITS else ""
    return f"{mantissa}{mark}{f'*^{int(exponent)}' if exponent else ''}"


# -- T and P --------------------------------------------------------------------------------------


def energies(unit: Unit, form: ClosedForm | None) -> str:
    """The definitions of T and P, g and the Christoffel symbols."""
    return _of_bodies(unit) if form is None else _formulas(unit, form)


def written_out(unit: Unit) -> ClosedForm | None:
    """The closed form; None where it is none for readers, or cannot be had."""
    if unit.parameters and not unit.model.symbolic:
        return None
    try:
        form = unit.robot.closed_form(simplify="collected")
    except ValueError:
        return None
    return form if form.terms("T") + form.terms("P") <= TERMS else None


def _formulas(unit: Unit, form: ClosedForm) -> str:
    """T by the products of velocities, as its exact polynomial has them."""
    own = Symbols(unit)
    named: dict[Symbol, Expr] = {s: _rational(value) for s, value in form.constants.items()}
    for array, symbols in (("q", form.q), ("qdot", form.qd)):
        named |= zip(symbols, map(Symbol, own.elements(array)), strict=True)

    def text(x: Polynomial, indent: str, end: str) -> str:
        return lines(f"{_text(form.write(x), unit, named)}{end}", indent, own.syntax)

    terms, rates = [], own.elements("qdot")
    for i, a in enumerate(form.qd):
        for j, b in enumerate(form.qd[i:], i):
            inertia = form.exact.T.derivative(a).derivative(b)
            if inertia:
                factor = f"{rates[i]}^2/2" if i == j else f"{rates[i]}*{rates[j]}"
                terms.append(f"{factor}*({text(inertia, '      ', ')').strip()}")
    return own.filled(
        template("formulas"),
        kinetic_energy_of_each=called(own.own("kinetic_energy"), *map(own.each_of, ("q", "qdot"))),
        potential_energy_of_each=called(own.own("potential_energy"), own.each_of("q")),
        T="\n    + ".join(terms) or "0",
        P=text(form.exact.P, "  ", "").strip(),
    )


def _text(x: Expr, unit: Unit, named: Mapping[Symbol, Expr]) -> str:
    names = zip(unit.parameters, Symbols(unit).parameters, strict=True)
    known = {p.name: Symbol(name) for p, name in names}
    put: dict[Expr, Expr] = {s: known[str(s)] for s in x.free_symbols if str(s) in known}
    put |= {f: _rational(float(f)) for f in x.atoms(sympy.Float)}
    return str(mathematica_code(x.xreplace({**put, **named})))


def _rational(x: float) -> Expr:
    return sympy.Rational(repr(x))


# -- the bodies -----------------------------------------------------------------------------------


def _of_bodies(unit: Unit) -> str:
    own, mechanism = Symbols(unit), unit.robot.mechanism
    if unit.parameters and not unit.model.symbolic:
        mechanism = unit.model.put(mechanism, [Symbol(p.name) for p in unit.parameters])
    bodies = enclosed([_body(unit, body) for body in mechanism.bodies])
    field = listed((*(_value(x, unit) for x in mechanism.gravity), "0"))
    return own.filled(template("bodies"), bodies=bodies, field=field)


def _body(unit: Unit, body: Body) -> str:
    def row(values: Iterable[Any]) -> str:
        return enclosed([_value(v, unit) for v in values])

    xx, xy, xz, yy, yz, zz = body.inertia
    pose = zip(body.pose.rotation, body.pose.translation, strict=True)
    moves = (
        str(body.parent + 1),
        "slide" if body.prismatic else "turn",
        str(body.coordinate + 1),
        _value(body.multiplier, unit),
    )
    entries = (
        ", ".join(moves),
        enclosed([*(row((*axes, along)) for axes, along in pose), "{0, 0, 0, 1}"]),
        _value(body.mass, unit),
        row(body.first_moment),
        enclosed([row((xx, xy, xz)), row((xy, yy, yz)), row((xz, yz, zz))]),
        _value(body.armature, unit),
    )
    return enclosed(entries)


def _value(x: Any, unit: Unit) -> str:
    """Whole numbers stay whole, so that no 0.0 is left in formulas."""
    if getattr(x, "free_symbols", None):
        return lines(_text(x, unit, {}), "", Symbols(unit).syntax).rstrip()
    return str(int(x)) if x in (-1, 0, 1) else number(float(x))
