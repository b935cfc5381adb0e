"""What a report's numbers are measured against: where zero is, which way is up, which units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mcgee import quantities
from mcgee.explain.inertia import Array
from mcgee.robot import Robot

MANY = 8
"""Joints whose axes a report's opening names; JSON has them all."""


@dataclass(frozen=True, eq=False)
class JointConvention:
    name: str
    kind: str
    unit: str
    """Of its position: rad or m."""
    effort_unit: str
    axis: Array
    """At q = 0, in the root frame (3,)."""


@dataclass(frozen=True, eq=False)
class Conventions:
    robot: str
    root: str
    """The link whose frame everything is seen from."""
    gravity_vector: Array
    joints: tuple[JointConvention, ...]
    frame: str
    """The frame whose place tells what q = 0 looks like."""
    at_zero: Array
    """Its origin at q = 0 (3,) [m]."""

    def lines(self) -> tuple[str, ...]:
        """What every report opens with."""
        turning = ", ".join(f"{j.name} {_direction(j.axis)}" for j in self.joints[:MANY])
        if len(self.joints) > MANY:
            turning += f" and {len(self.joints) - MANY} more"
        strength = float(np.linalg.norm(self.gravity_vector))
        gravity = "Gravity: none."
        if strength:
            along = self.gravity_vector / strength
            gravity = f"Gravity: {strength:.4g} m/s² along {_direction(along)}; up is "
            gravity += f"{_direction(-along)}."
        return (
            f"q = 0: frame '{self.frame}' stands at {_point(self.at_zero)} m.",
            f"Positive: about or along {turning}, at q = 0.",
            gravity,
            f"Frame: all vectors in the axes of '{self.root}'. Units: SI, angles in rad.",
            "Signs: tau = M qdd + C qd + g is what the actuators add; tau = g holds still.",
        )


def conventions(robot: Robot, frame: str) -> Conventions:
    zero = np.zeros(robot.n)
    joints = []
    for i, joint in enumerate(robot.independent_joints):
        slides = joint.kind == "prismatic"
        J = np.array(quantities.jacobian(robot.mechanism, list(zero), joint.child), float)
        axis = J[:3, i] if slides else J[3:, i]
        joints.append(
            JointConvention(
                joint.name,
                joint.kind,
                "m" if slides else "rad",
                "N" if slides else "N·m",
                axis,
            )
        )
    return Conventions(
        robot=robot.name,
        root=robot.root,
        gravity_vector=np.array(robot.gravity_vector, float),
        joints=tuple(joints),
        frame=frame,
        at_zero=robot.forward_kinematics(zero, frame)[:3, 3],
    )


def _direction(v: Array) -> str:
    """+x, −z, or the components."""
    for i, name in enumerate("xyz"):
        if abs(abs(v[i]) - 1) < 1e-9:
            return ("+" if v[i] > 0 else "−") + name
    return _point(v)


def _point(v: Array) -> str:
    return "(" + ", ".join(f"{x:.4g}" if abs(x) > 1e-12 else "0" for x in v) + ")"
