"""The regressor: inverse dynamics as a matrix times the inertial parameters."""

from collections.abc import Sequence

from mcgee.algorithms.motion import acceleration_at, accelerations, velocities
from mcgee.algorithms.parameters import TEN, link_pose
from mcgee.algorithms.spatial import ZERO, JointTransform, Matrix, Motion, Vector
from mcgee.algorithms.tree import axes, transforms
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def regressor(
    mechanism: Mechanism, q: Sequence[Scalar], qd: Sequence[Scalar], qdd: Sequence[Scalar]
) -> list[list[Scalar]]:
    """Y (bodies, 10 bodies), tau = Y p without the armatures' part.

    The motions of the joints go out to each link that they move and meet the ten unit forces
    there: three numbers a motion for most of them, where forces on their way in would be six.

    Source: Atkeson, An & Hollerbach 1986. Cost: O(n²)
    """
    X, S = transforms(mechanism, q), axes(mechanism)
    v = velocities(mechanism, X, qd)
    a = accelerations(mechanism, X, v, qd, qdd, Motion(ZERO, -Vector(*mechanism.gravity)))
    n = len(X)
    Y: list[list[Scalar]] = [[0] * (TEN * n) for _ in range(n)]
    carried: list[dict[int, Motion]] = []  # carried[k][i]: S of joint i in k's frame
    for k, body in enumerate(mechanism.bodies):
        above = carried[body.parent] if body.parent >= 0 else {}
        carried.append({i: X[k].motion(S_i) for i, S_i in above.items()} | {k: S[k]})
        to_link = JointTransform(link_pose(mechanism, body), True, 0)
        unit_forces = _UnitForces(to_link.motion(v[k]), to_link.motion(a[k]))
        for i, S_i in carried[k].items():
            Y[i][TEN * k : TEN * (k + 1)] = unit_forces.dot(to_link.motion(S_i))
    return Y


class _UnitForces:
    """What it takes to move a body as v and a say, for each of its ten parameters at 1."""

    def __init__(self, v: Motion, a: Motion):
        self.alpha = a.w
        self.origin = acceleration_at(v, a, ZERO)
        x, y, z = v.w
        self.yz, self.xz, self.xy = y * z, x * z, x * y
        self.xx_yy, self.xx_zz, self.yy_zz = x * x - y * y, x * x - z * z, y * y - z * z
        # α× + ω×ω×: the acceleration that grows with the distance from the origin
        p, q, r = a.w
        self.spread = Matrix(
            Vector(-(y * y + z * z), self.xy - r, self.xz + q),
            Vector(self.xy + r, -(x * x + z * z), self.yz - p),
            Vector(self.xz - q, self.yz + p, -(x * x + y * y)),
        )

    def dot(self, S: Motion) -> list[Scalar]:
        """The effort of each at a joint that moves the body by S."""
        (x, y, z), (p, q, r) = S.w, self.alpha
        first = self.spread.T @ S.u + self.origin.cross(S.w)
        a, b, c = x * self.yz, y * self.xz, z * self.xy
        return [
            S.u.dot(self.origin),
            *first,
            p * x + (b - c),
            x * (q - self.xz) + y * (p + self.yz) + z * self.xx_yy,
            q * y + (c - a),
            x * (r + self.xy) - y * self.xx_zz + z * (p - self.yz),
            x * self.yy_zz + y * (r - self.xy) + z * (q + self.xz),
            r * z + (a - b),
        ]
