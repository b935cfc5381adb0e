"""Which turns of bodies' frames about their joints' axes leave few numbers between the frames.

A turn t takes x and y to c x + s y and c y − s x in the frame turned by it. Quarter turns only
rename axes, so every turn here is within 45 degrees of none.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from types import MappingProxyType

from mcgee.algorithms.regroup import regrouped
from mcgee.mechanism import GROUND, Body, Mechanism
from mcgee.model import Mat3, Pose, Vec3
from mcgee.scalar import Scalar, Turn

NOTHING = 8 * 2.0**-52
"""Of numbers of size 1, what is left of zeros and ones by rounding alone."""

BITS = 128
"""Of the cosines and sines of exact turns."""

NONE = Turn(1, 0)

OFFSET = 6
"""Operations that turn (cos q, sin q) by an offset."""


@dataclass(frozen=True)
class Costs:
    """What a quantity's algorithm spends on a body, near enough to tell which turns save."""

    vectors: int
    """Turned by the constant rotation between two frames."""
    length: int
    """Operations on a coordinate of the displacement between two frames."""
    moment: int = 0
    """Operations on a coordinate of the first moment."""
    product: int = 0
    """Operations on a product of inertia."""


NEWTON_EULER = Costs(vectors=4, length=10, moment=10, product=6)
COMPOSITES = Costs(vectors=8, length=10)
STATICS = Costs(vectors=2, length=6, moment=10)


class Choice:
    """The turns of a whole tree that leave the cheapest numbers, none where others are no better.

    Between two axes lies a rotation Rz(a) Rx(alpha) Rz(b). A turn of the parent's frame takes up
    a, an offset of the joint's position b, and of nine numbers four are left. What a body costs
    depends on its own turn and on its parent's: dynamic programming from the leaves.

    Source: Denavit & Hartenberg 1955, for the numbers that are left.
    """

    def __init__(self, mechanism: Mechanism, costs: Costs):
        self.bodies, self.gravity, self.costs = mechanism.bodies, mechanism.gravity, costs
        self.light = regrouped(mechanism).bodies
        self.children = _children(mechanism)
        self.candidates = [
            {_by_quarters(*way): k for k, way in reversed(list(enumerate(_ways(mechanism, i))))}
            for i in range(len(self.bodies))
        ]
        self.chosen = self._chosen()

    def applied(self, mechanism: Mechanism) -> Mechanism:
        """The same mechanism, exactly: in fractions, the turns to `BITS` bits."""
        turns: list[Turn] = []
        for i, (body, k) in enumerate(zip(mechanism.bodies, self.chosen, strict=True)):
            if k is None:
                up = turns[body.parent] if body.parent != GROUND else NONE
                turns.append(_straightening(_rotated(body.pose.rotation, up)))
            else:
                turns.append(_by_quarters(*_ways(mechanism, i)[k]) if k else NONE)
        return _seen_turned(mechanism, turns, self.costs)

    def _chosen(self) -> list[int | None]:
        """Of each body, which of its ways; None: the turn that straightens its rotation."""
        # for each turn of the parent: the operations of the subtree, and the body's own turn
        best: list[dict[Turn, tuple[int, Turn]]] = [{} for _ in self.bodies]
        for i, body in reversed(list(enumerate(self.bodies))):
            beyond = {
                t: self._own(i, t) + sum(best[child][t][0] for child in self.children[i])
                for t in self.candidates[i]
            }
            for up in self.candidates[body.parent] if body.parent != GROUND else [NONE]:
                costs = {t: cost + self._between(i, up, t) for t, cost in beyond.items()}
                if not self.children[i]:
                    last = _straightening(_rotated(body.pose.rotation, up))
                    costs.setdefault(last, self._own(i, last) + self._between(i, up, last))
                t = min(costs, key=lambda t: (costs[t], t != NONE))
                best[i][up] = costs[t], t
        turns: list[Turn] = []
        for body, ways in zip(self.bodies, best, strict=True):
            turns.append(ways[turns[body.parent] if body.parent != GROUND else NONE][1])
        return [ways.get(t) for ways, t in zip(self.candidates, turns, strict=True)]

    def _own(self, i: int, t: Turn) -> int:
        """What the body's own numbers cost; of a regrouped root's inertia its own axis is left."""
        if self.bodies[i].parent == GROUND:
            return 0
        h, (_, xy, xz, _, yz, _) = _inertia(self.light[i], t)
        return self.costs.moment * _count(h[:2]) + self.costs.product * _count((xy, xz, yz))

    def _between(self, i: int, up: Turn, t: Turn) -> int:
        """What passing the joint costs."""
        body = self.bodies[i]
        if body.parent == GROUND:
            x, y, _ = Pose(_rotated(body.pose.rotation, own=t)).inverse().turn(self.gravity)
            return 0 if body.prismatic or 0 in (x, y) else 4
        R, offset = _split(body, up, t, self.costs)
        lengths = self.costs.length * _count(_vector(body.pose.translation, up))
        return self.costs.vectors * _operations(R) + lengths + (0 if offset == NONE else OFFSET)


def _children(mechanism: Mechanism) -> list[list[int]]:
    children: list[list[int]] = [[] for _ in mechanism.bodies]
    for i, body in enumerate(mechanism.bodies):
        if body.parent != GROUND:
            children[body.parent].append(i)
    return children


def _ways(mechanism: Mechanism, i: int) -> list[tuple[Scalar, Scalar]]:
    """Where x may point, in a body's frame, so that something becomes zero; as it is first."""
    body = mechanism.bodies[i]
    x, y, _ = body.pose.rotation[2]
    found = [(1, 0), (x, y)]  # the latter takes up b without an offset
    children = [child for child in mechanism.bodies if child.parent == i]
    for child in children:
        (xx, _, xz), (yx, _, yz), _ = child.pose.rotation
        found.append((xx, yx) if math.hypot(xz, yz) <= NOTHING else (xz, yz))
        found.append(child.pose.translation[:2])
    if not children:
        found.append(body.first_moment[:2])
    return found


def _seen_turned(mechanism: Mechanism, turns: Sequence[Turn], costs: Costs) -> Mechanism:
    back = [Pose(((t.c, t.s, 0), (-t.s, t.c, 0), (0, 0, 1)), (0, 0, 0)) for t in turns]
    bodies = []
    for body, t in zip(mechanism.bodies, turns, strict=True):
        up = turns[body.parent] if body.parent != GROUND else NONE
        R, offset = _split(body, up, t, costs)
        h, inertia = _inertia(body, t)
        pose = Pose(R, _vector(body.pose.translation, up))
        held = None if offset == NONE else offset
        bodies.append(replace(body, pose=pose, first_moment=h, inertia=inertia, offset=held))
    masses = (replace(m, inertia=m.inertia.seen_from(back[m.body])) for m in mechanism.masses)
    frames = {
        name: (i, pose if i == GROUND else back[i] @ pose)
        for name, (i, pose) in mechanism.frames.items()
    }
    return replace(
        mechanism, bodies=tuple(bodies), masses=tuple(masses), frames=MappingProxyType(frames)
    )


def _split(body: Body, up: Turn, t: Turn, costs: Costs) -> tuple[Mat3, Turn]:
    """(R, offset) with R Rz(offset) the rotation between the frames while the joint is at zero.

    There is an offset where R becomes cheaper than without, by more than the offset takes.
    """
    R = _rotated(body.pose.rotation, up, t)
    if body.prismatic or body.parent == GROUND:
        return R, NONE
    last = _straightening(R)
    straight = _rotated(R, own=last)
    if costs.vectors * (_operations(R) - _operations(straight)) <= OFFSET:
        return R, NONE
    return straight, -last


def _operations(R: Mat3) -> int:
    """Of turning one vector."""
    left = [x for row in R for x in row if x != 0]
    return sum(abs(x) != 1 for x in left) + len(left) - 3


def _count(numbers: Iterable[Scalar]) -> int:
    return sum(x != 0 for x in numbers)


# -- turns, on floats and on fractions ------------------------------------------------------------


def _by_quarters(x: Scalar, y: Scalar) -> Turn:
    """The direction of (x, y), less the nearest quarter turns."""
    if abs(y) > abs(x):
        x, y = y, -x
    if x < 0:
        x, y = -x, -y
    if abs(y) <= NOTHING * x:
        return NONE
    if not isinstance(x, Fraction):
        size = math.hypot(x, y)
        return Turn(x / size, y / size)
    slope = y / x
    c = Fraction(1 << 2 * BITS, math.isqrt(int((1 + slope * slope) * (1 << 4 * BITS))))
    c, s = (Fraction(round(v * (1 << BITS)), 1 << BITS) for v in (c, c * slope))
    return Turn(c, s)


def _straightening(R: Mat3) -> Turn:
    """The turn about z to follow R that makes zeros in it.

    All there can be where R's z lies square to the parent's x or y; else one, in the last row.
    """
    x, y, _ = next((row for row in R[:2] if abs(row[2]) <= NOTHING), R[2])
    return _by_quarters(x, y)


def _rotated(R: Mat3, up: Turn = NONE, own: Turn = NONE) -> Mat3:
    """R between a parent's frame turned by up and an own frame turned by own."""
    if up == own == NONE:
        return R
    columns = [(*_xy(x, y, up), z) for x, y, z in zip(*R, strict=True)]
    x, y, z = (_clean((*_xy(x, y, own), z)) for x, y, z in zip(*columns, strict=True))
    return x, y, z


def _clean(row: Sequence[Scalar]) -> Vec3:
    """A row of a rotation, exact where it has zeros and ones."""
    x, y, z = (type(e)(round(e)) if abs(e - round(e)) <= NOTHING else e for e in row)
    return x, y, z


def _xy(x: Scalar, y: Scalar, t: Turn) -> tuple[Scalar, Scalar]:
    """Two coordinates in a frame turned by t; exactly zero where rounding alone is left."""
    if t == NONE:
        return x, y
    least = NOTHING * max(abs(x), abs(y))
    a, b = (v if abs(v) > least else v * 0 for v in (t.c * x + t.s * y, t.c * y - t.s * x))
    return a, b


def _vector(v: Sequence[Scalar], t: Turn) -> Vec3:
    return (*_xy(v[0], v[1], t), v[2])


def _inertia(body: Body, t: Turn) -> tuple[Vec3, tuple[Scalar, ...]]:
    """First moment and inertia in a frame turned by t."""
    if t == NONE:
        return body.first_moment, body.inertia
    xx, xy, xz, yy, yz, zz = body.inertia
    middle, (half, product) = (xx + yy) / 2, _xy((xx - yy) / 2, xy, t + t)
    xz, yz = _xy(xz, yz, t)
    return _vector(body.first_moment, t), (middle + half, product, xz, middle - half, yz, zz)
