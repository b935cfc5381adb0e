"""The frames of bodies placed so that few of the numbers between them are not zero."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType

from mcgee.algorithms.spatial import Vector, shifted
from mcgee.algorithms.tree import inertia
from mcgee.algorithms.turns import NEWTON_EULER, Choice, Costs
from mcgee.mechanism import GROUND, Body, Mechanism
from mcgee.model import Pose, Vec3
from mcgee.scalar import Scalar

NOTHING = 4 * 2.0**-52
"""Of the lengths in a sum, what is left of it by rounding alone."""


def canonical(mechanism: Mechanism, costs: Costs = NEWTON_EULER) -> Mechanism:
    """The same mechanism with its joints' frames where few numbers lie between them.

    Origins slide along the joints' axes and frames turn about them. Slid first, so that the choice
    of turns sees which lengths are left; and again, for turned frames let more of them vanish.
    Where frames turn, each number of the result is computed exactly and rounded once.
    """
    slides = _slides(mechanism)
    first = _slid(mechanism, slides)
    choice = Choice(first, costs)
    if not any(k != 0 for k in choice.chosen):
        return first
    exact = choice.applied(_slid(mechanism.map(Fraction), list(map(Fraction, slides))))
    again = _slides(exact.map(float))
    return _slid(exact, list(map(Fraction, again))).map(float)


def slid(mechanism: Mechanism) -> Mechanism:
    """The same mechanism with the origins of its revolute joints' frames slid along their axes."""
    return _slid(mechanism, _slides(mechanism))


def _slides(mechanism: Mechanism) -> list[float]:
    """How far each origin slides.

    Where along its axis a joint's frame lies is free: Denavit and Hartenberg put it at common
    normals. Here each origin in turn, alone or with those of the parallel axes it carries, goes
    where the offsets between frames have the most zeros, until nothing gets better: parallel axes
    lose their displacement along themselves, intersecting axes meet in one origin.
    """
    bodies = mechanism.bodies
    reach = max(
        (abs(x) for b in bodies if b.parent != GROUND for x in b.pose.translation), default=0
    )
    slides = [0.0] * len(bodies)
    better = True
    while better:
        better = False
        for i, body in enumerate(bodies):
            if body.prismatic:
                continue
            for moving in ({i: 1.0}, _parallel(bodies, i)):
                found = _best(bodies, moving, slides, reach)
                if found != slides:
                    slides, better = found, True
    return slides


def _parallel(bodies: Sequence[Body], i: int) -> dict[int, float]:
    """Body i and those whose axes are parallel to its own all the way; −1 for the other sense."""
    senses = {i: 1.0}
    for j, body in enumerate(bodies):
        if body.parent in senses and not body.prismatic and abs(body.pose.rotation[2][2]) == 1:
            senses[j] = senses[body.parent] * body.pose.rotation[2][2]
    return senses


def _best(
    bodies: Sequence[Body], moving: dict[int, float], slides: list[float], reach: float
) -> list[float]:
    """The slides with the fewest lengths when some origins move together by one more number.

    None slides farther than the reach: what cancels in far origins' inertias leaves rounding.
    """
    near = [i for i, body in enumerate(bodies) if i in moving or body.parent in moving]
    fewest = _lengths(bodies, near, slides)
    best = slides
    for step in _steps(bodies, moving, near, slides):
        tried = [s + step * moving.get(i, 0.0) for i, s in enumerate(slides)]
        tried = [0.0 if abs(t) <= NOTHING * abs(step) else t for t in tried]
        lengths = _lengths(bodies, near, tried)
        if lengths < fewest and max(map(abs, tried)) <= reach:
            fewest, best = lengths, tried
    return best


def _offset(bodies: Sequence[Body], i: int, slides: Sequence[Scalar]) -> Vec3:
    """Where body i's origin is in its parent's frame, both slid."""
    body = bodies[i]
    up = slides[body.parent] if body.parent != GROUND else 0
    parts = [
        (r, row[2] * slides[i], -up if axis == 2 else 0)
        for axis, (r, row) in enumerate(zip(body.pose.translation, body.pose.rotation, strict=True))
    ]
    scale = max(abs(x) for part in parts for x in part)
    x, y, z = (s if abs(s := sum(part)) > NOTHING * scale else s * 0 for part in parts)
    return x, y, z


def _lengths(bodies: Sequence[Body], near: Sequence[int], slides: Sequence[float]) -> int:
    """How many of the offsets' coordinates are not zero, those from the ground not counted."""
    return sum(
        x != 0 for i in near if bodies[i].parent != GROUND for x in _offset(bodies, i, slides)
    )


def _steps(
    bodies: Sequence[Body], moving: dict[int, float], near: Sequence[int], slides: list[float]
) -> list[float]:
    """Moves that make some coordinate of an offset zero."""
    found = []
    for i in near:
        if bodies[i].parent == GROUND:
            continue
        own, up = moving.get(i, 0.0), moving.get(bodies[i].parent, 0.0)
        along = [row[2] for row in bodies[i].pose.rotation]
        x, y, z = _offset(bodies, i, slides)
        for length, rate in ((x, along[0] * own), (y, along[1] * own), (z, along[2] * own - up)):
            if length != 0 and abs(rate) > NOTHING:
                found.append(-length / rate)
        # or the child's own slide can undo the rest: where its axis crosses or meets this one
        for across, rate in ((x, along[0]), (y, along[1])):
            if own == 0 and abs(rate) > NOTHING:
                found.append((z - across / rate * along[2]) * up)
    return found


def _slid(mechanism: Mechanism, slides: Sequence[Scalar]) -> Mechanism:
    back = [Pose(((1, 0, 0), (0, 1, 0), (0, 0, 1)), (0, 0, -slide)) for slide in slides]
    bodies = []
    for i, body in enumerate(mechanism.bodies):
        own = shifted(inertia(body), Vector(0, 0, -slides[i]))
        bodies.append(
            replace(
                body,
                pose=Pose(body.pose.rotation, _offset(mechanism.bodies, i, slides)),
                first_moment=tuple(own.h),
                inertia=(own.I.xx, own.I.xy, own.I.xz, own.I.yy, own.I.yz, own.I.zz),
            )
        )
    masses = tuple(
        replace(m, inertia=replace(m.inertia, com=back[m.body].apply(m.inertia.com)))
        for m in mechanism.masses
    )
    frames = {
        name: (i, pose if i == GROUND else back[i] @ pose)
        for name, (i, pose) in mechanism.frames.items()
    }
    return replace(mechanism, bodies=tuple(bodies), masses=masses, frames=MappingProxyType(frames))
