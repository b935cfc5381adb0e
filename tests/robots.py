"""Robots to test on: random trees, real URDFs, and the same robots as others see them."""

from __future__ import annotations

import dataclasses
import itertools
import math
import sys
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import mcgee
from mcgee import build
from mcgee.errors import ModelWarning
from mcgee.graph.program import evaluate
from mcgee.kernels import Quantity
from mcgee.model import Frame, Inertia, Joint, Link, Mimic, Pose
from mcgee.parametric import Parametric
from mcgee.robot import Robot

AXES = [tuple(sign * e for e in row) for row in np.eye(3).tolist() for sign in (1.0, -1.0)]


# -- random trees ---------------------------------------------------------------------------------


def random_tree(
    seed: int,
    *,
    bodies: int = 6,
    branching: float = 0.3,
    prismatic: float = 0.3,
    armature: float = 0.5,
    mimic: float = 0.0,
    fixed: float = 0.4,
    aligned: float = 0.4,
    tilted: bool = True,
    exact: bool = False,
) -> Robot:
    """A robot with physical inertias.

    Args:
        bodies: joints that move, followers among them
        branching: share of joints that leave an arbitrary earlier link, not the last one
        prismatic, armature, mimic: shares of the moving joints
        fixed: chance of a fixed joint behind each link; either side may carry the inertia
        aligned: share of the axes along x, y or z, either way
        tilted: gravity in any direction, else down
        exact: poses are quarter turns, and lengths and inertias short binary fractions, so that
            merging links rounds nothing
    """
    return (_Exact if exact else _Draw)(np.random.default_rng(seed)).tree(
        bodies, branching, prismatic, armature, mimic, fixed, aligned, tilted
    )


class _Draw:
    """Real numbers."""

    def __init__(self, rng: np.random.Generator):
        self.rng = rng

    def tree(self, bodies, branching, prismatic, armature, mimic, fixed, aligned, tilted) -> Robot:
        names = map("j{}".format, itertools.count())
        links, joints = [Link("base", self.inertia())], []

        def grow(kind: str, parent: str, inertia: Inertia | None, **details: Any) -> None:
            links.append(Link(f"l{len(links)}", inertia))
            posed = {"pose": self.pose(), "child_pose": self.pose() if self.chance(0.3) else Pose()}
            joints.append(Joint(next(names), kind, parent, links[-1].name, **posed, **details))

        def weld(chance: float, parent: str) -> None:
            while self.chance(chance):
                grow("fixed", parent, self.inertia() if self.chance(0.7) else None)
                parent = links[-1].name if self.chance(0.5) else parent

        weld(fixed, "base")
        for _ in range(bodies):
            parent = links[-1].name
            if self.chance(branching):
                parent = links[self.rng.integers(len(links))].name
            kind = "revolute" if self.chance(0.5) else "continuous"
            kind = "prismatic" if self.chance(prismatic) else kind
            rotor = abs(self.number(0.3)) if self.chance(armature) else 0.0
            along = AXES[self.rng.integers(6)] if self.chance(aligned) else self.axis()
            # now and then all the mass is behind a fixed joint
            hollow = self.chance(fixed / 3)
            grow(kind, parent, None if hollow else self.inertia(), axis=along, armature=rotor)
            if hollow:
                grow("fixed", links[-1].name, self.inertia())
            weld(fixed, links[-1].name)
        joints = self.with_followers(joints, mimic)
        frames = (
            Frame("tool", links[-1].name, self.pose()),
            Frame("camera", links[self.rng.integers(len(links))].name, self.pose()),
        )
        self.rng.shuffle(links)
        self.rng.shuffle(joints)
        field = self.point(9.0) if tilted else (0.0, 0.0, -9.81)
        return Robot("random", tuple(links), tuple(joints), frames, field)

    def with_followers(self, joints: list[Joint], share: float) -> list[Joint]:
        """Some joints follow others, before or after them in the tree, in chains too."""
        movers = [joint for joint in joints if joint.moves]
        self.rng.shuffle(movers)
        mimics: dict[str, Mimic] = {}
        for i, joint in enumerate(movers):
            leaders = [other for other in movers[:i] if self.may_follow(joint, other)]
            if leaders and self.chance(share):
                leader = leaders[self.rng.integers(len(leaders))].name
                mimics[joint.name] = Mimic(leader, *self.gear(joint))
        return [dataclasses.replace(joint, mimic=mimics.get(joint.name)) for joint in joints]

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def number(self, size: float) -> float:
        return float(self.rng.uniform(-size, size))

    def may_follow(self, joint: Joint, leader: Joint) -> bool:
        return True

    def gear(self, joint: Joint) -> tuple[float, float]:
        multiplier = self.rng.choice([1.0, -1.0, 0.5, 1.5, -0.7, self.number(1.5)])
        return float(multiplier), self.number(1.0) if self.chance(0.5) else 0.0

    def axis(self) -> tuple[float, ...]:
        v = self.rng.normal(size=3)
        return tuple((v / np.linalg.norm(v)).tolist())

    def point(self, size: float) -> tuple[float, ...]:
        return tuple(self.number(size) for _ in range(3))

    def rotation(self) -> np.ndarray:
        """Any, or a quarter turn."""
        if self.chance(0.3):
            return self.quarter_turn()
        w, x, y, z = (q := self.rng.normal(size=4)) / np.linalg.norm(q)
        return np.array(
            [
                [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
            ]
        )

    def quarter_turn(self) -> np.ndarray:
        turn = np.eye(3)[self.rng.permutation(3)] * self.rng.choice([-1.0, 1.0], 3)[:, None]
        return turn * np.linalg.det(turn).round()

    def pose(self) -> Pose:
        return Pose(tuple(map(tuple, self.rotation().tolist())), self.point(0.5))

    def inertia(self) -> Inertia:
        """Of a solid box, turned."""
        m, (a, b, c) = self.rng.uniform(0.2, 4.0), self.rng.uniform(0.02, 0.3, 3) ** 2
        R = self.rotation()
        I = R @ np.diag([b + c, a + c, a + b]) @ R.T * (m / 3)
        upper = (I[0, 0], I[0, 1], I[0, 2], I[1, 1], I[1, 2], I[2, 2])
        return Inertia(float(m), self.point(0.2), tuple(float(v) for v in upper))


class _Exact(_Draw):
    """Short binary fractions, quarter turns."""

    def number(self, size: float) -> float:
        return float(self.rng.integers(-16, 17)) / 16 * 2.0 ** math.ceil(math.log2(size))

    def axis(self) -> tuple[float, ...]:
        return AXES[self.rng.integers(6)]

    def rotation(self) -> np.ndarray:
        return self.quarter_turn()

    def may_follow(self, joint: Joint, leader: Joint) -> bool:
        return (joint.kind == "prismatic") == (leader.kind == "prismatic")

    def gear(self, joint: Joint) -> tuple[float, float]:
        multiplier = float(self.rng.choice([1, -1, 2, -2]))
        if joint.kind == "prismatic":
            return multiplier, self.number(1.0)
        return multiplier, math.pi / 2 * float(self.rng.integers(-1, 2))

    def inertia(self) -> Inertia:
        xx, yy, zz = (float(v) / 8 for v in self.rng.integers(8, 12, 3))
        xy, xz, yz = (float(v) / 16 for v in self.rng.integers(-3, 4, 3))
        mass = float(self.rng.integers(1, 33)) / 8
        return Inertia(mass, self.point(0.25), (xx, xy, xz, yy, yz, zz))


def random_state(robot: Robot, rng: np.random.Generator, rows: int = 4, size: float = 3.0) -> tuple:
    """q, qd, qdd (rows, n) each; q up to the size."""
    q, qd, qdd = rng.uniform(-1, 1, (3, rows, robot.n)) * np.array([size, 2.0, 5.0])[:, None, None]
    return q, qd, qdd


# -- the reference interpreter --------------------------------------------------------------------


def interpreted(robot: Robot) -> Robot:
    """The same robot, its quantities evaluated by the reference interpreter, nothing compiled."""
    copy = dataclasses.replace(robot)
    copy.__dict__["with_parameters"] = lambda: parametric
    parametric = _uncompiled(Parametric(copy))
    return _uncompiled(copy)


def _uncompiled(owner: Any) -> Any:
    owner.__dict__["_calls"] = calls = _Calls(owner)
    for name, method in vars(type(owner)).items():
        if isinstance(method, Quantity):
            owner.__dict__[name] = calls.get((name, ()))
    return owner


class _Calls(dict):
    """Stands where a robot keeps its bound kernels; traces each on its first call."""

    def __init__(self, owner: Any):
        self.owner = owner

    def get(self, key: tuple[str, tuple[str, ...]], default: Any = None) -> Callable:
        if key not in self:
            self[key] = self._call(*key)
        return self[key]

    def _call(self, name: str, options: tuple[str, ...]) -> Callable:
        @cache
        def program():
            owner = self.owner
            return build.trace(owner.mechanism, name, *options, parametric=owner.parametric)

        def call(*arrays: Any) -> Any:
            results = evaluate(program(), *arrays)
            return results[0] if len(results) == 1 else tuple(results)

        return call


# -- real robots ----------------------------------------------------------------------------------

URDFS = {
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "talos": "talos_data/robots/talos_reduced.urdf",
    "double_pendulum": "double_pendulum_description/urdf/double_pendulum.urdf",
    "double_pendulum_continuous": (
        "double_pendulum_description/urdf/double_pendulum_continuous.urdf"
    ),
    "kinova": "kinova_description/robots/kinova.urdf",
}
"""Of the PyPI package example-robot-data."""


def urdf(name: str) -> Path:
    import pytest

    for folder in (*sys.path, sys.prefix):
        for above in ("cmeel.prefix/share", "share"):
            path = Path(folder) / above / "example-robot-data" / "robots" / URDFS[name]
            if path.is_file():
                return path
    pytest.skip("needs the package example-robot-data")


@cache
def loaded(name: str, mimic: bool = True) -> Robot:
    """A real robot; its files' oddities are not what is tested here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        return mcgee.load(urdf(name), mimic=mimic)


@cache
def built_in(name: str) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        return mcgee.arms.BUILTIN[name]()


# -- how far apart --------------------------------------------------------------------------------


def apart(got: Any, want: Any, size: float = 0.0) -> float:
    """The largest |got − want| over the largest |want|, or over the size if that is larger."""
    got, want = np.asarray(got), np.asarray(want)
    assert got.shape == want.shape
    scale = max(abs(want).max(initial=0), size)
    return float(abs(got - want).max(initial=0) / (scale or 1.0))
