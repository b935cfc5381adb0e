"""An explanation's numbers as HTML tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from mcgee.explain.sentences import inertia_unit
from mcgee.typeset import aligned, number, percent

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation

WRITTEN = 12
"""Joints up to which M is also written out."""


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """The first column names the rows; the texts are escaped here."""
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in columns)
    body = "".join(
        f'<tr><th scope="row">{escape(first)}</th>'
        + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        + "</tr>"
        for first, *cells in rows
    )
    return (
        f'<div class="scroll" role="region" tabindex="0" aria-label="{escape(title)}">'
        f"<table><caption>{escape(title)}</caption>"
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def small(x: float, largest: float) -> str:
    """Three digits; what is only rounding is 0."""
    return "0" if abs(x) <= 1e-12 * largest else number(x)


def state(e: Explanation) -> str:
    rows = []
    for i, joint in enumerate(e.conventions.joints):
        axis = ", ".join(number(round(x, 12) + 0.0) for x in joint.axis)
        q, qd, qdd = (number(x[i]) for x in (e.q, e.qd, e.qdd))
        rows.append((joint.name, joint.kind, q, qd, qdd, joint.unit, f"({axis})"))
    columns = ("joint", "kind", "q", "qd [/s]", "qdd [/s²]", "unit", "axis at q = 0")
    return table("The state explained", columns, rows)


def inertia(e: Explanation) -> str:
    f, joints, rows = e.inertia, e.conventions.joints, []
    for i, joint in enumerate(joints):
        others = abs(f.coupling[i]).copy()
        others[i] = 0
        k, m = int(others.argmax()), int(f.fastest[i, i])
        partner = f"{joints[k].name} {f.coupling[i, k]:+.2f}".replace("-", "−")
        changed = f"{joints[m].name} {number(f.slope[i, i, m])} /{joints[m].unit}"
        unit = inertia_unit(joint.effort_unit, joint.effort_unit)
        rows.append(
            (
                joint.name,
                number(f.locked[i]),
                number(f.free[i]),
                percent(max(f.hidden[i], 0)) if f.hidden[i] > 1e-9 else "0",
                unit,
                partner if others[k] > 5e-3 else "none",
                changed if m >= 0 and abs(f.slope[i, i, m]) > 1e-9 * f.locked[i] else "nothing",
            )
        )
    columns = (
        "joint",
        "others locked",
        "others free",
        "hidden",
        "unit",
        "most coupled to",
        "changed fastest by",
    )
    return table("What each joint feels", columns, rows)


def mass_matrix(e: Explanation) -> str:
    names, M = e.robot.joint_names, e.inertia.M
    rows = ((name, *aligned(M[i], abs(M).max())) for i, name in enumerate(names))
    title = "M: column j is the efforts [N·m | N] if joint j alone accelerates by 1"
    return table(title, ("", *names), ([cell.replace("-", "−") for cell in row] for row in rows))


def principal(e: Explanation) -> str:
    f, names, rows = e.inertia, e.robot.joint_names, []
    for k in range(e.robot.n):
        v = f.directions[:, k]
        order = [int(i) for i in np.argsort(-abs(v), kind="stable")[:3] if abs(v[i]) > 0.05]
        v = v * np.sign(v[order[0]])
        mix = ", ".join(f"{names[i]} {v[i]:+.2f}".replace("-", "−") for i in order)
        rows.append((str(k + 1), number(f.principal[k]), mix))
    unit = "SI, mixed" if f.mixed_units else _own_unit(e)
    title = f"Principal inertias, cheapest acceleration first; condition {number(f.condition)}"
    return table(title, ("", f"inertia [{unit}]", "joint accelerations, the largest parts"), rows)


def _own_unit(e: Explanation) -> str:
    unit = e.conventions.joints[0].effort_unit
    return inertia_unit(unit, unit)


def task(e: Explanation) -> str:
    t = e.task
    rows = []
    for k, mass in enumerate(t.masses):
        u = t.directions[:, k]
        u = u * (1 if u[abs(u).argmax()] > 0 else -1)
        along = ", ".join(number(round(x, 3) + 0.0) for x in u)
        rows.append((f"({along})", number(mass) if np.isfinite(mass) else "cannot yield"))
    title = f"Effective mass of a push on '{t.frame}' at the explained pose"
    return table(title, ("direction", "effective mass [kg]"), rows)


def velocity(e: Explanation) -> str:
    v, rows = e.velocity, []
    largest = max(abs(v.centrifugal).max(), abs(v.coriolis).max())
    for i, joint in enumerate(e.conventions.joints):
        parts = v.centrifugal[i].sum(), v.coriolis[i].sum(), v.Cqd[i]
        power = small(v.power[i], abs(v.power).max())
        unit = joint.effort_unit
        rows.append((joint.name, number(e.qd[i]), *(small(x, largest) for x in parts), unit, power))
    columns = ("joint", "qd", "centrifugal", "Coriolis", "C qd", "unit", "power taken [W]")
    return table("Velocity terms", columns, rows)


def kinetic(e: Explanation) -> str:
    v = e.velocity
    rows = [
        (link, *(small(x, v.kinetic_energy) for x in (a, b, a + b)))
        for link, a, b in zip(v.links, v.translation, v.rotation, strict=True)
    ]
    if v.rotors:
        rows.append(("rotors", "", number(v.rotors), number(v.rotors)))
    rows.append(("all", *(number(x.sum()) for x in (v.translation, v.rotation)), ""))
    rows[-1] = (*rows[-1][:-1], number(v.kinetic_energy))
    return table("Kinetic energy [J]", ("link", "translation", "rotation", "sum"), rows)


def energy(e: Explanation) -> str:
    f = e.energy
    parts = (f.through, f.actuator, f.gravity, f.rate)
    largest = max(abs(part).max() for part in parts)
    rows = ((name, *(small(part[i], largest) for part in parts)) for i, name in enumerate(f.joints))
    columns = ("body moved by", "from the body before", "actuator", "own weight", "dT/dt")
    return table("Power budget of each body [W]", columns, rows)


def gravity(e: Explanation) -> str:
    f, rows = e.gravity, []
    for i, joint in enumerate(e.conventions.joints):
        k = int(abs(f.parts[:, i]).argmax())
        limited = np.isfinite(f.effort[i]) and f.effort[i] > 0
        held = abs(f.g[i]) > 1e-9 * max(float(f.weight.sum()), 1e-300)
        rows.append(
            (
                joint.name,
                small(f.g[i], abs(f.g).max()),
                joint.effort_unit,
                number(f.effort[i]) if limited else "none",
                f"{number(f.margin[i])} %" if limited else "",
                f"{f.links[k]}, {number(f.weight[k])} N" if held else "nothing",
                f"{number(f.lever[k, i])} m" if held and joint.unit == "rad" else "",
            )
        )
    columns = ("joint", "g", "unit", "limit", "margin", "hangs on it most", "lever arm")
    return table("Holding efforts", columns, rows)


def worst(e: Explanation) -> str:
    rows = []
    for joint, w in zip(e.conventions.joints, e.worst, strict=True):
        nothing = w.effort <= 1e-9
        few = ", ".join(number(round(x, 3) + 0.0) for x in w.q)
        where = few if e.robot.n <= 8 else "in the JSON report"
        limited = np.isfinite(w.limit) and w.limit > 0
        rows.append(
            (
                w.joint,
                "0" if nothing else number(w.effort),
                joint.effort_unit,
                percent(w.share) if limited else "no limit",
                "" if nothing else f"{w.agreeing} of {w.starts}",
                "" if nothing else where,
            )
        )
    columns = ("joint", "worst", "unit", "of the limit", "searches that agree", "at q")
    return table("The worst holding effort over the joint ranges", columns, rows)
