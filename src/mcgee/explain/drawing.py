"""Where the lines and dots of a drawn arm are, in one pose or in many."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from mcgee.explain.inertia import Array
from mcgee.mechanism import GROUND, Body
from mcgee.robot import Robot

Line = list["int | None"]
"""Indices of points; None lifts the pen."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """What is drawn of a robot: names of points, and which of them are joined.

    The points are the root's origin, each body's joint, each link's centre of mass, the two ends
    of each joint's axis, the tip of each last body, and the frame of interest.
    """

    robot: Robot
    frame: str

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        return self.robot.mechanism.bodies

    @cached_property
    def ends(self) -> tuple[tuple[int, Any], ...]:
        """(body, point in it) of the farthest thing known on each last body."""
        mechanism = self.robot.mechanism
        parents = {body.parent for body in self.bodies}
        known = [(i, pose.translation) for i, pose in mechanism.frames.values()]
        known += [(m.body, m.inertia.com) for m in mechanism.masses]
        return tuple(
            (i, max((p for k, p in known if k == i), key=lambda p: float(np.linalg.norm(p))))
            for i in range(len(self.bodies))
            if i not in parents
        )

    def poses(self, q: Array) -> Array:
        """Each body's frame in the root frame, q (..., n): (..., bodies, 4, 4)."""
        found = np.empty((*q.shape[:-1], len(self.bodies), 4, 4))
        for i, body in enumerate(self.bodies):
            seat = _matrix(body.pose)
            before = found[..., body.parent, :, :] @ seat if body.parent != GROUND else seat
            moved = q[..., body.coordinate] * float(body.multiplier)
            found[..., i, :, :] = before @ _moved(moved, body.prismatic)
        return found

    def points(self, q: Array) -> Array:
        """The points in the root frame, q (..., n): (..., points, 3) [m]."""
        mechanism, poses = self.robot.mechanism, self.poses(q)

        def seen(body: int, point: Any) -> Array:
            p = np.array(point, float)
            if body == GROUND:
                return np.broadcast_to(p, (*q.shape[:-1], 3))
            return poses[..., body, :3, :3] @ p + poses[..., body, :3, 3]

        count, half = len(self.bodies), self.reach * 0.04
        found = [seen(GROUND, (0, 0, 0)), *(seen(i, (0, 0, 0)) for i in range(count))]
        found += [seen(m.body, m.inertia.com) for m in mechanism.masses]
        found += [seen(i, (0, 0, s * half)) for i in range(count) for s in (-1, 1)]
        found += [seen(i, point) for i, point in self.ends]
        body, pose = mechanism.frames[self.frame]
        found.append(seen(body, pose.translation))
        return np.stack(found, -2)

    @cached_property
    def reach(self) -> float:
        """From the root along the longest limb [m]."""
        far: list[float] = []
        for body in self.bodies:
            step = float(np.linalg.norm(np.array(body.pose.translation, float)))
            far.append(step + (far[body.parent] if body.parent != GROUND else 0.0))
        beyond = (far[i] + float(np.linalg.norm(np.array(p, float))) for i, p in self.ends)
        return max(beyond) or 1.0

    # -- which points make what -------------------------------------------------------------------

    @property
    def joints(self) -> list[int]:
        return list(range(1, 1 + len(self.bodies)))

    @property
    def centres(self) -> list[int]:
        first = 1 + len(self.bodies)
        return list(range(first, first + len(self.robot.mechanism.masses)))

    @property
    def axes(self) -> tuple[Line, Line]:
        """Along the turning joints, and along the sliding ones."""
        first = 1 + len(self.bodies) + len(self.robot.mechanism.masses)
        lines: tuple[Line, Line] = ([], [])
        for i, body in enumerate(self.bodies):
            lines[body.prismatic].extend([first + 2 * i, first + 2 * i + 1, None])
        return lines

    @property
    def tip(self) -> int:
        """The frame of interest."""
        return self.centres[-1] + 1 + 2 * len(self.bodies) + len(self.ends)

    @property
    def links(self) -> Line:
        """From each joint to the joint before it, and on to the ends and the frame."""
        line: Line = []
        for i, body in enumerate(self.bodies):
            line.extend([body.parent + 1, i + 1, None])
        first = self.tip - len(self.ends)
        for k, (i, _) in enumerate(self.ends):
            line.extend([i + 1, first + k, None])
        return [*line, self.robot.mechanism.frames[self.frame][0] + 1, self.tip, None]


@dataclass(frozen=True, eq=False)
class View:
    """The plane a planar arm moves in, as it is looked at."""

    axes: Array
    """(2, 3): to the right, and up on the page."""
    labels: tuple[str, str]
    gravity: Array
    """Its direction on the page (2,); zero where it points into the page or is none."""


def view_of(drawing: Drawing, q: Array) -> View | None:
    """The plane of a planar arm; None for arms that move in space."""
    poses = drawing.poses(q)
    sliding = np.array([body.prismatic for body in drawing.bodies])
    turning, slides = poses[~sliding, :3, 2], poses[sliding, :3, 2]
    if not len(turning):
        return None
    normal = turning[0]
    if abs(np.cross(turning, normal)).max() > 1e-6 or abs(slides @ normal).max(initial=0) > 1e-6:
        return None
    field = np.array(drawing.robot.gravity_vector, float)
    inside = field - (field @ normal) * normal
    strength, whole = float(np.linalg.norm(inside)), float(np.linalg.norm(field))
    falls = strength > 1e-9 * whole > 0
    up = -inside / strength if falls else _least_along(normal)
    right = np.cross(up, normal)
    if right[abs(right).argmax()] < 0:  # look from the side where the root's axis points right
        right = -right
    labels = _name(right, "horizontal"), _name(up, "up" if falls else "up the page")
    return View(np.stack([right, up]), labels, np.array([0.0, -1.0]) if falls else np.zeros(2))


def _least_along(normal: Array) -> Array:
    """y, or the root axis that lies best in the plane."""
    for axis in np.eye(3)[[1, 2, 0]]:
        inside = axis - (axis @ normal) * normal
        if np.linalg.norm(inside) > 0.7:
            return inside / np.linalg.norm(inside)
    raise AssertionError("three axes cannot all stand on one plane")


def _name(v: Array, otherwise: str) -> str:
    for i, name in enumerate("xyz"):
        if abs(abs(v[i]) - 1) < 1e-9:
            return f"{'' if v[i] > 0 else '−'}{name} [m]"
    return f"{otherwise} [m]"


def mobility_axes(robot: Robot, q: Array, frame: str) -> Array:
    """Semi-axes of the ellipsoid of accelerations that a push of 1 N on the frame causes.

    Returns: (..., 3, 3), one axis a row, shortest first, root axes [1/kg]
    """
    J = robot.jacobian(q, frame)[..., :3, :]
    yielding, directions = np.linalg.eigh(J @ robot.mass_matrix_inverse(q) @ J.swapaxes(-1, -2))
    return np.maximum(yielding, 0)[..., :, None] * directions.swapaxes(-1, -2)


def _matrix(pose: Any) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = np.array(pose.rotation, float), np.array(pose.translation, float)
    return T


def _moved(x: Array, prismatic: bool) -> Array:
    """Along or about z."""
    T = np.zeros((*np.shape(x), 4, 4))
    T[..., range(4), range(4)] = 1
    if prismatic:
        T[..., 2, 3] = x
        return T
    T[..., 0, 0] = T[..., 1, 1] = np.cos(x)
    T[..., 1, 0] = np.sin(x)
    T[..., 0, 1] = -T[..., 1, 0]
    return T
