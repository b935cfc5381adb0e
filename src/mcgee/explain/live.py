"""What the page's controls move: poses computed beforehand, packed for the page's script."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.explain.armplot import ball, circle, ellipse_scale
from mcgee.explain.drawing import Drawing, mobility_axes, view_of
from mcgee.explain.gravity import ranges
from mcgee.explain.inertia import Array
from mcgee.explain.look import plain
from mcgee.explain.maps import felt_free
from mcgee.explain.plots import joint_labels
from mcgee.explain.workspace import Sweep, sweep

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation

VALUES = 600_000
"""How many numbers the slider's poses may take in a page; 5⅓ bytes each."""
POINTS, FEWEST = 73, 9
MAPPED, MAP_POINTS = 6, 33
"""Joints whose pairs get a map when there are many, and points of a map a side."""


@dataclass(frozen=True, eq=False)
class Live:
    """The poses behind the controls of one page."""

    e: Explanation

    @cached_property
    def drawing(self) -> Drawing:
        return Drawing(self.e.robot, self.e.task.frame)

    @cached_property
    def movable(self) -> tuple[int, ...]:
        """Joints with a range to sweep."""
        lower, upper = ranges(self.e.robot, self.e.q)
        return tuple(int(i) for i in np.flatnonzero(upper > lower))

    @cached_property
    def points(self) -> int:
        """Positions of each swept joint, so many that the page stays light."""
        n = self.e.robot.n
        one = 3 * (self.drawing.tip + 1) + n * (n + 1) // 2 + 2 * n + 11
        fit = VALUES // (one * max(len(self.movable), 1))
        return int(np.clip(fit // 2 * 2 - 1, FEWEST, POINTS))

    @cached_property
    def poses(self) -> dict[int, Array]:
        """By swept joint: its grid, the explained pose among it (points, n)."""
        found, (lower, upper) = {}, ranges(self.e.robot, self.e.q)
        for i in self.movable:
            at = np.append(np.linspace(lower[i], upper[i], self.points - 1), self.e.q[i])
            found[i] = np.tile(self.e.q, (self.points, 1))
            found[i][:, i] = np.sort(at)
        return found

    @property
    def room(self) -> Array:
        """All poses that the drawn arm may take (..., n)."""
        return np.concatenate([self.e.q[None], *self.poses.values()])

    def sweeps(self) -> list[dict[str, Any]]:
        """Per swept joint: its positions, and M, g, points, … at each."""
        return [self._sweep(i, poses) for i, poses in self.poses.items()]

    def _sweep(self, i: int, poses: Array) -> dict[str, Any]:
        robot, view = self.e.robot, view_of(self.drawing, self.e.q)
        M, upper = robot.mass_matrix(poses), np.triu_indices(robot.n)
        moments = np.linalg.eigvalsh(M)
        points = self.drawing.points(poses)
        axes = mobility_axes(robot, poses, self.e.task.frame)
        axes *= ellipse_scale(self.e, self.drawing)
        if view:
            points, axes = points @ view.axes.T, axes[:, 1:] @ view.axes.T
        return {
            "joint": i,
            "start": int(np.flatnonzero(poses[:, i] == self.e.q[i])[0]),
            "at": packed(poses[:, i]),
            "M": packed(M[:, upper[0], upper[1]]),
            "free": packed(felt_free(robot, poses)),
            "g": packed(robot.gravity(poses)),
            "condition": packed(moments[:, -1] / moments[:, 0]),
            "points": packed(points),
            "axes": packed(axes),
        }

    # -- two joints -------------------------------------------------------------------------------

    @cached_property
    def mapped(self) -> tuple[int, ...]:
        """The joints whose pairs get a map: those that change M and g most."""
        swing = {i: self._swing(poses) for i, poses in self.poses.items()}
        ranked = sorted(swing, key=lambda i: (-swing[i], i))
        return tuple(sorted(ranked[:MAPPED]))

    def _swing(self, poses: Array) -> float:
        """How much what the joints feel and hold changes over a sweep."""
        robot = self.e.robot
        felt, g = np.diagonal(robot.mass_matrix(poses), axis1=-2, axis2=-1), robot.gravity(poses)
        weight = float(self.e.gravity.weight.sum()) * self.drawing.reach or 1.0
        return float(np.ptp(felt, axis=0).max() / felt.max() + np.ptp(g, axis=0).max() / weight)

    def pairs(self) -> list[tuple[int, int]]:
        return list(combinations(self.mapped, 2))

    def most_telling(self) -> tuple[int, int]:
        """The pair to show first, and of the joints shown the one whose inertia both change."""
        robot, shown = self.e.robot, list(self.shown)
        swing = {}
        for i in self.mapped:
            felt = np.diagonal(robot.mass_matrix(self.poses[i]), axis1=-2, axis2=-1)[:, shown]
            swing[i] = np.ptp(felt, axis=0) / felt.max(0)
        scores = [swing[a] + swing[b] + 2 * np.minimum(swing[a], swing[b]) for a, b in self.pairs()]
        pair, looked = np.unravel_index(int(np.argmax(np.round(scores, 9))), np.shape(scores))
        return int(pair), int(looked)

    def sweep_of(self, a: int, b: int) -> Sweep:
        names = self.e.robot.joint_names
        return sweep(self.e.robot, self.e.q, [names[a], names[b]], MAP_POINTS)

    def maps(self) -> list[dict[str, Any]]:
        """Per pair of joints: what each shown joint feels and holds, and M's condition."""
        made = []
        for a, b in self.pairs():
            s = self.sweep_of(a, b)
            shown = list(self.shown)
            felt = np.diagonal(s.M, axis1=-2, axis2=-1)[..., shown]
            made.append(
                {
                    "joints": [a, b],
                    "x": packed(s.at[0]),
                    "y": packed(s.at[1]),
                    "felt": packed(np.moveaxis(felt, -1, 0)),
                    "g": packed(np.moveaxis(s.g[..., shown], -1, 0)),
                    "condition": packed(s.condition),
                }
            )
        return made

    @property
    def shown(self) -> tuple[int, ...]:
        """Joints whose figures the maps hold."""
        return tuple(range(self.e.robot.n)) if self.e.robot.n <= 8 else self.mapped

    # -- all --------------------------------------------------------------------------------------

    def data(self) -> dict[str, Any]:
        e, upper = self.e, np.triu_indices(self.e.robot.n)
        f = e.inertia
        return {
            "n": e.robot.n,
            "names": list(e.robot.joint_names),
            "labels": joint_labels(e),
            "units": [joint.unit for joint in e.conventions.joints],
            "effortUnits": [joint.effort_unit for joint in e.conventions.joints],
            "q": plain(e.q),
            "sweeps": self.sweeps(),
            "maps": self.maps(),
            "shown": list(self.shown),
            "translation": packed(f.translation[:, upper[0], upper[1]]),
            "rotation": packed(f.rotation[:, upper[0], upper[1]]),
            "armature": packed(np.diag(f.armature)),
            "circle": packed(circle()),
            "ball": packed(ball()),
        }


def packed(values: Array) -> dict[str, Any]:
    """An array as little-endian single precision in base64."""
    array = np.ascontiguousarray(values, "<f4")
    return {"shape": list(array.shape), "f4": base64.b64encode(array.tobytes()).decode()}
