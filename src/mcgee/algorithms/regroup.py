"""Regrouped inertial parameters: the same dynamics from fewer non-zero numbers."""

from dataclasses import replace

from mcgee.algorithms.spatial import NO_INERTIA, ZERO, Inertia, JointTransform, Symmetric, Vector
from mcgee.algorithms.tree import inertias
from mcgee.mechanism import Mechanism
from mcgee.scalar import Turn


def regrouped(mechanism: Mechanism) -> Mechanism:
    """Move to each body's parent what the body's own joint cannot tell from it.

    For a revolute joint that is the mass, the first moment along the axis and diag(Iyy, Iyy, 0);
    for a prismatic joint the whole rotational inertia. M, C and g stay. The energies of single
    bodies do not, and single bodies are no longer physical.

    Source: Gautier & Khalil 1990.
    """
    I = inertias(mechanism)
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        full = I[i]
        if body.prismatic:
            I[i] = Inertia(full.m, full.h, NO_INERTIA)
            given = Inertia(0, ZERO, full.I)
        else:
            a = full.I
            I[i] = Inertia(
                0, Vector(full.h.x, full.h.y, 0), Symmetric(a.xx - a.yy, a.xy, a.xz, 0, a.yz, a.zz)
            )
            given = Inertia(full.m, Vector(0, 0, full.h.z), Symmetric(a.yy, 0, 0, a.yy, 0, 0))
        if body.parent >= 0:
            # a Turn: math's cosine of 0 would make exact scalars floats
            X = JointTransform(body.pose, body.prismatic, 0 if body.prismatic else Turn(1, 0))
            I[body.parent] = I[body.parent] + X.inertia(given)
    bodies = tuple(
        replace(
            body,
            mass=own.m,
            first_moment=tuple(own.h),
            inertia=(own.I.xx, own.I.xy, own.I.xz, own.I.yy, own.I.yz, own.I.zz),
        )
        for body, own in zip(mechanism.bodies, I, strict=True)
    )
    return replace(mechanism, bodies=bodies)
