"""The gravity vector from the first moments of subtrees."""

from collections.abc import Sequence

from mcgee.algorithms.spatial import Vector
from mcgee.algorithms.tree import transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def gravity_force(mechanism: Mechanism, q: Sequence[Scalar]) -> list[Scalar]:
    """g_i = ∂P/∂q_i: what joint i holds of its subtree's weight.

    One vector goes out (the field, in each body's axes), one comes in (the first moment of each
    subtree), where Newton-Euler would carry four.
    """
    X = transforms(mechanism, q)
    field: list[Vector] = []
    for i, body in enumerate(mechanism.bodies):
        field.append(
            X[i].down(field[body.parent] if body.parent >= 0 else Vector(*mechanism.gravity))
        )
    m = [body.mass for body in mechanism.bodies]
    h = [Vector(*body.first_moment) for body in mechanism.bodies]
    g: list[Scalar] = [0] * len(m)
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        g[i] = -(m[i] * field[i].z) if body.prismatic else -h[i].cross(field[i]).z
        if body.parent >= 0:
            h[body.parent] = h[body.parent] + X[i].first_moment(m[i], h[i])
            m[body.parent] = m[body.parent] + m[i]
    return g
