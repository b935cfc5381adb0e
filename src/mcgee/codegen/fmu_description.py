"""What an FMU says of itself: its variables, as the XML of both versions of FMI and as a page.

Names of the description appear as they are: the XML library escapes them, and `said` takes out
what no XML document can hold.
"""

from __future__ import annotations

import re
import uuid
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import mcgee
from mcgee.algorithms.parameters import TEN
from mcgee.codegen.names import Names
from mcgee.codegen.unit import Unit

VERSIONS = (2, 3)
"""Of FMI."""

MAX_STEP = 1e-3
"""Seconds: what the parameter max_step is where nobody sets it."""

TAKEN = ("time", "max_step", "qd", "qdd")
"""Variables of every FMU whose names a parameter could have."""

EFFORT = {"rad": "N.m", "m": "N"}
"""Its unit, by a joint's."""

INERTIAL = {
    "m": ("mass", "kg"),
    "h": ("mass times centre of mass", "kg.m"),
    "I": ("inertia about the link frame's origin", "kg.m2"),
}
"""A body's parameters by their first letter: meaning and unit."""

UNITS = {
    "s": {"s": 1},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "rad/s2": {"rad": 1, "s": -2},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "kg": {"kg": 1},
    "kg.m": {"kg": 1, "m": 1},
    "kg.m2": {"kg": 1, "m": 2},
}
"""Exponents of the base units."""

METHOD = (
    "Here qd and qdd are qdot and qddot. In co-simulation each communication step is divided into "
    "equal steps of at most max_step, taken by the classical Runge-Kutta method of order four with "
    "tau held. A step that would end in a state that is not finite is discarded and changes "
    "nothing."
)
"""What simulations with it rest on."""


@dataclass(frozen=True)
class Variable:
    name: str
    says: str
    causality: str
    unit: str | None
    variability: str = "continuous"
    start: float | None = None
    """None where it is calculated; time has none either."""
    state: str | None = None
    """Whose derivative it is."""
    depends: tuple[str, ...] = ()
    """Inputs and states that an output or derivative depends on."""

    @property
    def calculated(self) -> bool:
        return bool(self.depends) and self.start is None


def variables(unit: Unit) -> list[Variable]:
    """In fmu.h's order; the places are value references."""
    joints = [
        (k, said(joint.name), "m" if joint.kind == "prismatic" else "rad")
        for k, joint in enumerate(unit.robot.independent_joints, 1)
    ]
    tau, q, qd = (tuple(f"{name}[{k}]" for k, *_ in joints) for name in ("tau", "q", "qd"))

    def each(make: Callable[[int, str, str], Variable]) -> list[Variable]:
        return [make(*joint) for joint in joints]

    def state(name: str, says: str, x: str) -> Variable:
        return Variable(name, says, "output", x, start=0.0, depends=(name,))

    def slope(name: str, says: str, causality: str, x: str, of: str, *depends: str) -> Variable:
        return Variable(name, says, causality, x, state=of, depends=depends)

    return [
        Variable("time", "time", "independent", "s"),
        *each(
            lambda k, j, x: Variable(tau[k - 1], f"effort at {j}", "input", EFFORT[x], start=0.0)
        ),
        *each(lambda k, j, x: state(q[k - 1], f"position of {j}", x)),
        *each(lambda k, j, x: state(qd[k - 1], f"velocity of {j}", f"{x}/s")),
        *_parameters(unit),
        *each(
            lambda k, j, x: slope(
                f"der(q[{k}])", f"velocity of {j}", "local", f"{x}/s", q[k - 1], qd[k - 1]
            )
        ),
        *each(
            lambda k, j, x: slope(
                f"qdd[{k}]", f"acceleration of {j}", "output", f"{x}/s2", qd[k - 1], *tau, *q, *qd
            )
        ),
        Variable("T", "kinetic energy", "output", "J", depends=(*q, *qd)),
        Variable("P", "potential energy", "output", "J", depends=q),
        Variable("E", "energy T + P", "output", "J", depends=(*q, *qd)),
    ]


def _parameters(unit: Unit) -> Iterator[Variable]:
    names = Names(TAKEN)
    bodies = [] if unit.model.symbolic else [said(b.link) for b in unit.robot.mechanism.bodies]
    for k, p in enumerate(unit.parameters):
        says, of = f"{said(p.name)} of the description, in SI units", None
        if bodies:
            meaning, of = INERTIAL[p.name[0]]
            says = f"{p.name}, {meaning} of body {k // TEN + 1}, {bodies[k // TEN]}"
        yield Variable(names.of(p.identifier), says, "parameter", of, "tunable", p.value)
    says = "longest step of co-simulation"
    yield Variable("max_step", says, "parameter", "s", "tunable", MAX_STEP)


def said(name: str) -> str:
    """A name without the characters that XML lacks."""
    return re.sub("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "_", name)


def token(unit: Unit) -> str:
    """What binary and description know each other by."""
    return f"{{{uuid.UUID(unit.fingerprint[:32])}}}"


def source_names(unit: Unit, version: int) -> list[str]:
    """What is compiled."""
    return [f"fmi{version}.c", f"{unit.name}.c"]


# -- modelDescription.xml -------------------------------------------------------------------------


def model_description(unit: Unit, version: int) -> str:
    listed = variables(unit)
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{version}.0",
            "modelName": said(unit.robot.name) or unit.name,
            "guid" if version == 2 else "instantiationToken": token(unit),
            "description": f"The dynamics of {said(unit.robot.name)}; joints: {unit.n}",
            "generationTool": f"mcgee {mcgee.__version__}",
            "variableNamingConvention": "structured",
            **({"numberOfEventIndicators": "0"} if version == 2 else {}),
        },
    )
    _interfaces(root, unit, version)
    _units(SubElement(root, "UnitDefinitions"), listed)
    categories = SubElement(root, "LogCategories")
    for name, says in (("Error", "calls that are refused"), ("Discard", "results not finite")):
        SubElement(categories, "Category", name=f"logStatus{name}", description=says)
    SubElement(
        root, "DefaultExperiment", startTime="0", stopTime="10", tolerance="1e-6", stepSize="0.01"
    )
    places = {v.name: k for k, v in enumerate(listed)}
    group = SubElement(root, "ModelVariables")
    for v in listed:
        (_variable_2 if version == 2 else _variable_3)(group, v, places)
    (_structure_2 if version == 2 else _structure_3)(root, listed, places)
    return _text(root)


def _interfaces(root: Element, unit: Unit, version: int) -> None:
    state = "state" if version == 2 else "State"
    both = {
        "modelIdentifier": unit.name,
        f"canGetAndSetFMU{state}": "true",
        f"canSerializeFMU{state}": "true",
    }
    me, cs = {}, {"canHandleVariableCommunicationStepSize": "true"}
    if version == 2:
        both["canNotUseMemoryManagementFunctions"] = "true"
        me["completedIntegratorStepNotNeeded"] = "true"
    else:
        cs["hasEventMode"] = "true"
    for name, own in (("ModelExchange", me), ("CoSimulation", cs)):
        interface = SubElement(root, name, both | own)
        if version == 2:
            sources = SubElement(interface, "SourceFiles")
            for path in source_names(unit, version):
                SubElement(sources, "File", name=path)


def _units(group: Element, listed: Sequence[Variable]) -> None:
    used = {v.unit for v in listed}
    for name, exponents in UNITS.items():
        if name in used:
            unit = SubElement(group, "Unit", name=name)
            SubElement(unit, "BaseUnit", {base: str(e) for base, e in exponents.items()})


def _attributes(v: Variable, place: int) -> dict[str, str]:
    found = {
        "name": v.name,
        "valueReference": str(place),
        "description": v.says,
        "causality": v.causality,
        "variability": v.variability,
    }
    if v.depends:
        found["initial"] = "calculated" if v.calculated else "exact"
    return found


def _numbers(v: Variable, state: int) -> dict[str, str]:
    found = {} if v.unit is None else {"unit": v.unit}
    if v.start is not None:
        found["start"] = repr(v.start)
    if v.state is not None:
        found["derivative"] = str(state)
    return found


def _variable_2(group: Element, v: Variable, places: dict[str, int]) -> None:
    scalar = SubElement(group, "ScalarVariable", _attributes(v, places[v.name]))
    SubElement(scalar, "Real", _numbers(v, places.get(v.state or "", 0) + 1))


def _variable_3(group: Element, v: Variable, places: dict[str, int]) -> None:
    own = _numbers(v, places.get(v.state or "", 0))
    SubElement(group, "Float64", _attributes(v, places[v.name]) | own)


def _structure_2(root: Element, listed: Sequence[Variable], places: dict[str, int]) -> None:
    """By places counted from 1."""
    structure = SubElement(root, "ModelStructure")
    for name, group, known in _groups(listed):
        unknowns = SubElement(structure, f"{name}s")
        for v in group:
            one = SubElement(unknowns, "Unknown", index=str(places[v.name] + 1))
            if known:
                one.set("dependencies", " ".join(str(places[d] + 1) for d in v.depends))


def _structure_3(root: Element, listed: Sequence[Variable], places: dict[str, int]) -> None:
    """By value references."""
    structure = SubElement(root, "ModelStructure")
    for name, group, known in _groups(listed):
        tag = "ContinuousStateDerivative" if name == "Derivative" else name
        for v in group:
            one = SubElement(structure, tag, valueReference=str(places[v.name]))
            if known:
                one.set("dependencies", " ".join(str(places[d]) for d in v.depends))


def _groups(listed: Sequence[Variable]) -> list[tuple[str, list[Variable], bool]]:
    """The parts of a model's structure, and whether dependencies are told; else it is on all."""
    return [
        ("Output", [v for v in listed if v.causality == "output"], True),
        ("Derivative", [v for v in listed if v.state is not None], True),
        ("InitialUnknown", [v for v in listed if v.calculated], False),
    ]


def build_description(unit: Unit) -> str:
    """How the sources of FMI 3 are compiled."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=unit.name)
    files = SubElement(configuration, "SourceFileSet", language="C99")
    for path in source_names(unit, 3):
        SubElement(files, "SourceFile", name=path)
    says = f"for a shared library, whose functions go without the prefix {unit.name}_"
    name = "FMI3_OVERRIDE_FUNCTION_PREFIX"
    SubElement(
        files, "PreprocessorDefinition", name=name, value="1", optional="true", description=says
    )
    return _text(root)


def _text(root: Element) -> str:
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, "unicode")}\n'


# -- documentation/index.html ---------------------------------------------------------------------


def page(unit: Unit) -> str:
    root = Element("html", lang="en")
    head, body = SubElement(root, "head"), SubElement(root, "body")
    SubElement(head, "meta", charset="utf-8")
    SubElement(head, "title").text = SubElement(body, "h1").text = said(unit.robot.name)
    for sentences in (unit.conventions, [METHOD]):
        SubElement(body, "p").text = " ".join(sentences)
    table = SubElement(body, "table")
    for cells in [HEADINGS, *map(_cells, variables(unit))]:
        row = SubElement(table, "tr")
        for cell in cells:
            SubElement(row, "th" if cells is HEADINGS else "td").text = cell
    SubElement(body, "p").text = f"Generated by mcgee {mcgee.__version__}. {OWN}"
    ElementTree.indent(root)
    return f"<!DOCTYPE html>\n{ElementTree.tostring(root, 'unicode', 'html')}\n"


def _cells(v: Variable) -> tuple[str, ...]:
    start = "" if v.start is None else repr(v.start)
    return v.name, v.causality, v.unit or "", start, v.says


HEADINGS = ("variable", "causality", "unit", "start", "meaning")

OWN = "The generated code is your own: use, change and sell it as you like."
