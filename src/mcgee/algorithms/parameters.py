"""The ten inertial parameters of each body, as regressors and identification know them.

m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz: about the origin and in the axes of the link
that the body's joint moves, one set for each body, with all links that are fixed to it.
"""

from collections.abc import Sequence
from dataclasses import replace

from mcgee.algorithms.spatial import Inertia, JointTransform, Symmetric, Vector
from mcgee.algorithms.tree import inertias
from mcgee.mechanism import Body, Mechanism
from mcgee.model import Pose
from mcgee.scalar import Scalar

TEN = 10


def link_pose(mechanism: Mechanism, body: Body) -> Pose:
    """Of the frame of the link that the body's joint moves, in the body's frame."""
    return mechanism.frames[body.link][1]


def inertial_parameters(mechanism: Mechanism) -> list[Scalar]:
    """(10 bodies,), in the order of the bodies."""
    parameters: list[Scalar] = []
    for body, own in zip(mechanism.bodies, inertias(mechanism), strict=True):
        m, h, I = _seen_from(own, link_pose(mechanism, body).inverse())
        parameters += [m, *h, I.xx, I.xy, I.yy, I.xz, I.yz, I.zz]
    return parameters


def with_parameters(mechanism: Mechanism, parameters: Sequence[Scalar]) -> Mechanism:
    """The mechanism whose bodies have these parameters (10 bodies,); its `masses` stay."""
    bodies = []
    for i, body in enumerate(mechanism.bodies):
        m, x, y, z, xx, xy, yy, xz, yz, zz = parameters[TEN * i : TEN * (i + 1)]
        given = Inertia(m, Vector(x, y, z), Symmetric(xx, xy, xz, yy, yz, zz))
        m, h, I = _seen_from(given, link_pose(mechanism, body))
        inertia = (I.xx, I.xy, I.xz, I.yy, I.yz, I.zz)
        bodies.append(replace(body, mass=m, first_moment=tuple(h), inertia=inertia))
    return replace(mechanism, bodies=tuple(bodies))


def _seen_from(inertia: Inertia, pose: Pose) -> tuple[Scalar, Vector, Symmetric]:
    """The same body in frame A, pose being T_AB and the inertia in B."""
    seen = JointTransform(pose, True, 0).inertia(inertia)
    return seen.m, seen.h, seen.I
