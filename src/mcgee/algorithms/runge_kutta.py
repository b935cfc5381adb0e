"""One step of motion by the classical Runge-Kutta method of order four, over any scalar."""

from collections.abc import Callable, Sequence

from mcgee.scalar import Scalar

Vector = list[Scalar]


def runge_kutta(
    acceleration: Callable[..., Vector],
    q: Vector,
    qd: Vector,
    tau: Vector,
    h: Scalar,
    viscous: Sequence[float],
) -> tuple[Vector, Vector]:
    """(q, qd) after h seconds under the efforts tau.

    Args:
        acceleration: qdd of (q, qd, efforts)
        viscous: friction coefficients (n,)
    Source: Kutta 1901
    """

    def slope(x: Vector, v: Vector) -> Vector:
        return acceleration(x, v, [t - b * s for t, b, s in zip(tau, viscous, v, strict=True)])

    half = h * 0.5
    a1 = slope(q, qd)
    v2 = _moved(qd, half, a1)
    a2 = slope(_moved(q, half, qd), v2)
    v3 = _moved(qd, half, a2)
    a3 = slope(_moved(q, half, v2), v3)
    v4 = _moved(qd, h, a3)
    a4 = slope(_moved(q, h, v3), v4)
    sixth = h * (1 / 6)
    return _moved(q, sixth, _mean(qd, v2, v3, v4)), _moved(qd, sixth, _mean(a1, a2, a3, a4))


def _moved(x: Vector, h: Scalar, rate: Vector) -> Vector:
    return [a + h * b for a, b in zip(x, rate, strict=True)]


def _mean(k1: Vector, k2: Vector, k3: Vector, k4: Vector) -> Vector:
    """Six times the weighted mean of four slopes."""
    return [a + 2 * (b + c) + d for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
