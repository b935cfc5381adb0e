"""What every recursion starts from: the joint transforms and inertias of a mechanism."""

from collections.abc import Sequence

from mcgee.algorithms.spatial import (
    SLIDE,
    TURN,
    Inertia,
    JointTransform,
    Motion,
    Symmetric,
    Vector,
)
from mcgee.mechanism import Body, Mechanism
from mcgee.scalar import Scalar


def transforms(mechanism: Mechanism, q: Sequence[Scalar]) -> list[JointTransform]:
    """X of each body at the joint positions q."""
    return [
        JointTransform(b.pose, b.prismatic, b.position(q_i))
        for b, q_i in zip(mechanism.bodies, q, strict=True)
    ]


def axes(mechanism: Mechanism) -> list[Motion]:
    """S of each joint, in its own body's frame."""
    return [SLIDE if b.prismatic else TURN for b in mechanism.bodies]


def inertias(mechanism: Mechanism) -> list[Inertia]:
    return [inertia(b) for b in mechanism.bodies]


def inertia(body: Body) -> Inertia:
    return Inertia(body.mass, Vector(*body.first_moment), Symmetric(*body.inertia))
