"""The gravity vector, and its slope, from the first moments of subtrees."""

from collections.abc import Sequence

from mcgee.algorithms.spatial import JointTransform, Vector, Z
from mcgee.algorithms.tree import transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def gravity_force(mechanism: Mechanism, q: Sequence[Scalar]) -> list[Scalar]:
    """g_i = ∂P/∂q_i: what joint i holds of its subtree's weight.

    One vector goes out (the field, in each body's axes), one comes in (the first moment of each
    subtree), where Newton-Euler would carry four.
    """
    X = transforms(mechanism, q)
    field, (m, h) = _fields(mechanism, X), _subtrees(mechanism, X)
    return [_held(body.prismatic, m[i], h[i], field[i]) for i, body in enumerate(mechanism.bodies)]


def gravity_slope(mechanism: Mechanism, q: Sequence[Scalar]) -> list[list[Scalar]]:
    """∂g_i/∂q_j = ∂²P/∂q_i∂q_j.

    Turning joint j turns everything beyond it, which to a joint i beyond it is as if the field
    had turned the other way, by −z_j × field.
    """
    X = transforms(mechanism, q)
    field, (m, h) = _fields(mechanism, X), _subtrees(mechanism, X)
    n = len(X)
    slope: list[list[Scalar]] = [[0] * n for _ in range(n)]
    turned: list[dict[int, Vector]] = []  # turned[i][j]: the change of field that i sees from j
    for i, body in enumerate(mechanism.bodies):
        above = turned[body.parent] if body.parent >= 0 else {}
        turned.append({j: X[i].down(change) for j, change in above.items()})
        if not body.prismatic:
            turned[i][i] = -Z.cross(field[i])
        for j, change in turned[i].items():
            slope[i][j] = slope[j][i] = _held(body.prismatic, m[i], h[i], change)
    return slope


def _held(prismatic: bool, m: Scalar, h: Vector, field: Vector) -> Scalar:
    """What a joint holds of a subtree with mass m and first moment h."""
    return -(m * field.z) if prismatic else -h.cross(field).z


def _fields(mechanism: Mechanism, X: Sequence[JointTransform]) -> list[Vector]:
    """The field in each body's axes."""
    field: list[Vector] = []
    for i, body in enumerate(mechanism.bodies):
        above = field[body.parent] if body.parent >= 0 else Vector(*mechanism.gravity)
        field.append(X[i].down(above))
    return field


def _subtrees(
    mechanism: Mechanism, X: Sequence[JointTransform]
) -> tuple[list[Scalar], list[Vector]]:
    """Mass and first moment of each body with all that it carries, in its own frame."""
    m = [body.mass for body in mechanism.bodies]
    h = [Vector(*body.first_moment) for body in mechanism.bodies]
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        if body.parent >= 0:
            h[body.parent] = h[body.parent] + X[i].first_moment(m[i], h[i])
            m[body.parent] = m[body.parent] + m[i]
    return m, h
