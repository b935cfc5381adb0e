"""The inertia matrix by its definition: slow, and nobody's recursion."""

from collections.abc import Sequence

from mcgee.algorithms.kinematics import body_poses, point_jacobian
from mcgee.algorithms.spatial import Matrix, Vector
from mcgee.mechanism import Mechanism
from mcgee.scalar import Scalar


def definition(mechanism: Mechanism, q: Sequence[Scalar]) -> list[list[Scalar]]:
    """M = Σ_k (m_k Jv_kᵀ Jv_k + Jω_kᵀ I_k Jω_k), link by link, Jv at the centre of mass."""
    poses, n = body_poses(mechanism, q), len(mechanism.bodies)
    M = [
        [body.armature if i == j else 0 for j in range(n)]
        for i, body in enumerate(mechanism.bodies)
    ]
    for link in mechanism.masses:
        pose = poses[link.body]
        com = Vector(*pose.apply(link.inertia.com))
        R = Matrix(*(Vector(*row) for row in pose.rotation))
        I = R * Matrix(*(Vector(*row) for row in link.inertia.matrix)) * R.T
        J = point_jacobian(mechanism, poses, link.body, com)
        for i in range(n):
            for j in range(n):
                translation = J[i].u.dot(J[j].u) * link.inertia.mass
                M[i][j] = M[i][j] + translation + J[i].w.dot(I @ J[j].w)
    return M
