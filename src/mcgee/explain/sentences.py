"""Short exact sentences, made of the figures and of nothing else."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mcgee.explain.conventions import Conventions
from mcgee.explain.gravity import GravityFigures, WorstGravity
from mcgee.explain.inertia import InertiaFigures, TaskFigures
from mcgee.explain.velocity import VelocityFigures
from mcgee.explain.workspace import Extremes
from mcgee.typeset import number, percent

FEW = 8
"""Joints up to which a sentence says a whole pose."""

NEGLIGIBLE = 1e-9
"""Of the largest figure of its kind: below it a sentence speaks of zero."""


def inertia_unit(a: str, b: str) -> str:
    """Of M_ij, from the joints' effort units."""
    slides = (a == "N") + (b == "N")
    return ("kg·m²", "kg·m", "kg")[slides]


def inertia_sentences(c: Conventions, f: InertiaFigures) -> Iterator[str]:
    names = [joint.name for joint in c.joints]
    units = [joint.effort_unit for joint in c.joints]
    for i, name in enumerate(names):
        unit = inertia_unit(units[i], units[i])
        felt = f"With the other joints locked, {name} feels {number(f.locked[i])} {unit}"
        if f.hidden[i] <= NEGLIGIBLE:
            yield f"{felt}; left free, the same: nothing couples to it at this pose."
            continue
        others = abs(f.coupling[i]).copy()
        others[i] = 0
        partner = names[int(others.argmax())]
        whom = f"to {partner}" if len(names) == 2 else f"to the others, most to {partner},"
        yield (
            f"{felt}; left free, {number(f.free[i])}: its coupling {whom} hides "
            f"{percent(f.hidden[i])}."
        )
    yield from _coupling_sentence(names, units, f)
    if len(names) > 1 and not f.mixed_units:
        cheap, dear = (names[int(abs(f.directions[:, k]).argmax())] for k in (0, -1))
        yield (
            f"The cheapest direction of acceleration (mostly {cheap}) has inertia "
            f"{number(f.principal[0])} {inertia_unit(units[0], units[0])}, the dearest (mostly "
            f"{dear}) {number(f.principal[-1])}: {number(f.condition)} times as much."
        )
    yield from _slope_sentence(names, units, f)


def _coupling_sentence(names: list[str], units: list[str], f: InertiaFigures) -> Iterator[str]:
    """The strongest push that one joint's acceleration gives another."""
    off = abs(np.triu(f.coupling, 1))
    if len(names) < 2 or off.max() <= NEGLIGIBLE:
        return
    i, j = np.unravel_index(off.argmax(), off.shape)
    rate = "m/s²" if units[j] == "N" else "rad/s²"
    yield (
        f"Accelerating {names[j]} alone by 1 {rate} takes {number(f.M[j, j])} {units[j]} there and "
        f"{number(f.M[i, j])} {units[i]} at {names[i]}, only to keep it still."
    )


def _slope_sentence(names: list[str], units: list[str], f: InertiaFigures) -> Iterator[str]:
    slopes = abs(np.einsum("iik->ik", f.slope)) * _alike(units)[:, None] * _alike(units)
    if slopes.max() <= NEGLIGIBLE * f.locked.max():
        yield "To first order no motion from this pose changes what any joint feels."
        return
    i, k = np.unravel_index(slopes.argmax(), slopes.shape)
    per = "m" if units[k] == "N" else "rad"
    yield (
        f"What {names[i]} feels changes fastest with {names[k]}: by {number(f.slope[i, i, k])} "
        f"{inertia_unit(units[i], units[i])} per {per}."
    )


def _alike(units: list[str]) -> np.ndarray:
    """1 for the joints of the commoner kind, 0 for the others: N and N·m have no order."""
    common = "N" if units.count("N") > len(units) / 2 else "N·m"
    return np.array([unit == common for unit in units], float)


def task_sentences(t: TaskFigures) -> Iterator[str]:
    finite = t.masses[np.isfinite(t.masses)]
    if not len(finite):
        yield f"No joint shifts the origin of frame '{t.frame}' at this pose."
        return
    yield (
        f"A push on frame '{t.frame}' feels {number(finite[0])} kg in its lightest direction"
        + (f" and {number(finite[-1])} kg in its heaviest" if len(finite) > 1 else "")
        + ("." if len(finite) == 3 else f"; it can yield in {len(finite)} of 3 directions.")
    )


def velocity_sentences(c: Conventions, v: VelocityFigures) -> Iterator[str]:
    names = [joint.name for joint in c.joints]
    units = [joint.effort_unit for joint in c.joints]
    if not v.moving:
        yield "At rest: no velocity terms."
        return
    centrifugal = abs(v.centrifugal) * _alike(units)[:, None]
    coriolis = abs(v.coriolis) * _alike(units)[:, None, None]
    if max(centrifugal.max(), coriolis.max()) <= NEGLIGIBLE * v.kinetic_energy:
        yield "The arm moves, and at this pose its velocities ask for no efforts: C qd = 0."
    elif centrifugal.max() >= coriolis.max():
        i, j = np.unravel_index(centrifugal.argmax(), centrifugal.shape)
        yield (
            f"The largest velocity term is centrifugal: the speed of {names[j]} asks for "
            f"{number(v.centrifugal[i, j])} {units[i]} at {names[i]}."
        )
    else:
        i, j, k = np.unravel_index(coriolis.argmax(), coriolis.shape)
        yield (
            f"The largest velocity term is Coriolis: {names[j]} and {names[k]} moving together ask "
            f"for {number(v.coriolis[i, j, k])} {units[i]} at {names[i]}."
        )
    yield _flow_sentence(names, v)
    if abs(v.C_power) > NEGLIGIBLE * v.kinetic_energy:
        yield f"As M changes with the pose, qdᵀ C qd = ½ qdᵀ Ṁ qd = {number(v.C_power)} W."
    if v.kinetic_energy > 0:  # a creeping arm's is below the least float
        share = percent(v.translation.sum() / v.kinetic_energy)
        yield (
            f"Kinetic energy is {number(v.kinetic_energy)} J, {share} of it in the links' "
            f"translation."
        )


def _flow_sentence(names: list[str], v: VelocityFigures) -> str:
    if abs(v.flow).max() <= NEGLIGIBLE * v.kinetic_energy:
        return "The skew part, (½Ṁ − C) qd, moves no energy between the joints now."
    i, j = np.unravel_index(v.flow.argmax(), v.flow.shape)
    return (
        f"The skew part, (½Ṁ − C) qd, carries {number(v.flow[i, j])} W of kinetic energy from "
        f"{names[j]} to {names[i]}; over all joints its powers sum to zero."
    )


def gravity_sentences(c: Conventions, g: GravityFigures) -> Iterator[str]:
    names = [joint.name for joint in c.joints]
    units = [joint.effort_unit for joint in c.joints]
    heavy = g.weight.sum()
    if abs(g.g).max() <= NEGLIGIBLE * max(heavy, np.finfo(float).tiny):
        yield "No joint holds any weight at this pose: g = 0."
        return
    for i, name in enumerate(names):
        if abs(g.g[i]) <= NEGLIGIBLE * heavy:
            continue
        k = int(abs(g.parts[:, i]).argmax())
        of = f", {percent(g.share[i])} of its limit" if np.isfinite(g.effort[i]) else ""
        if units[i] == "N":
            how = (
                f"{percent(abs(g.lever[k, i]))} of its {number(g.weight[k])} N lie along the joint"
            )
        else:
            how = f"{number(g.weight[k])} N at a lever arm of {number(abs(g.lever[k, i]))} m"
            if g.level[k, i] < 0.995:
                how += f", about an axis that is {percent(g.level[k, i])} level"
        yield (
            f"Holding {name} still takes {number(g.g[i])} {units[i]}{of}; the largest part, "
            f"{number(g.parts[k, i])} {units[i]}, is {g.links[k]}: {how}."
        )


def worst_sentences(c: Conventions, worst: tuple[WorstGravity, ...]) -> Iterator[str]:
    for joint, w in zip(c.joints, worst, strict=True):
        if w.effort <= 1e-9:
            yield f"{w.joint} never holds weight anywhere in the ranges."
            continue
        of = f", {percent(w.share)} of its limit" if w.share else ""
        where = ", ".join(number(round(x, 3) + 0.0) for x in w.q)
        at = f" at q = ({where})" if len(w.q) <= FEW else ""
        yield (
            f"Over the joint ranges {w.joint} holds at most {number(w.effort)} "
            f"{joint.effort_unit}{at}{of}, as far as {w.starts} climbs from the best of "
            f"{w.samples} random poses can tell: {w.agreeing} of them ended there."
        )


def skater_sentence(c: Conventions, s: Extremes) -> str:
    """What the first joint feels while another joint moves."""
    first, moved = c.joints[0], next(j for j in c.joints if j.name == s.joint)
    unit = inertia_unit(first.effort_unit, first.effort_unit)
    return (
        f"Like a skater's arms, {s.joint} sets what {first.name} feels: from {number(s.least)} "
        f"{unit} at {s.joint} = {number(s.at_least)} {moved.unit} to {number(s.most)} at "
        f"{s.joint} = {number(s.at_most)} {moved.unit}."
    )
