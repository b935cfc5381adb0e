"""Where frames are and how they move."""

from collections.abc import Sequence

from mcgee.algorithms.spatial import Matrix, Motion, Vector
from mcgee.mechanism import GROUND, Mechanism
from mcgee.model import Pose
from mcgee.scalar import Scalar, cos_sin


def body_poses(mechanism: Mechanism, q: Sequence[Scalar]) -> list[Pose]:
    """The pose of each body's frame in the root frame."""
    poses: list[Pose] = []
    for body, q_i in zip(mechanism.bodies, q, strict=True):
        pose = poses[body.parent] @ body.pose if body.parent >= 0 else body.pose
        if body.prismatic:
            poses.append(pose @ Pose(((1, 0, 0), (0, 1, 0), (0, 0, 1)), (0, 0, q_i)))
        else:
            c, s = cos_sin(body.position(q_i))
            poses.append(pose @ Pose(((c, -s, 0), (s, c, 0), (0, 0, 1)), (0, 0, 0)))
    return poses


def frame_pose(mechanism: Mechanism, q: Sequence[Scalar], frame: str) -> Pose:
    """The pose of a named frame in the root frame."""
    body, seat = mechanism.frames[frame]
    return seat if body == GROUND else body_poses(mechanism, q)[body] @ seat


def point_jacobian(
    mechanism: Mechanism, poses: Sequence[Pose], body: int, point: Vector
) -> list[Motion]:
    """Each joint's part in the motion of a point of a body: (w, velocity), in root axes."""
    columns = [Motion(Vector(0, 0, 0), Vector(0, 0, 0))] * len(mechanism.bodies)
    while body != GROUND:
        z = Matrix(*(Vector(*row) for row in poses[body].rotation)).T.z
        if mechanism.bodies[body].prismatic:
            columns[body] = Motion(Vector(0, 0, 0), z)
        else:
            columns[body] = Motion(z, z.cross(point - Vector(*poses[body].translation)))
        body = mechanism.bodies[body].parent
    return columns


def frame_jacobian(mechanism: Mechanism, q: Sequence[Scalar], frame: str) -> list[list[Scalar]]:
    """J (6, n): linear rows first, then angular; root axes, at the frame's origin."""
    poses = body_poses(mechanism, q)
    body, seat = mechanism.frames[frame]
    at = Vector(*(poses[body] @ seat if body != GROUND else seat).translation)
    columns = point_jacobian(mechanism, poses, body, at)
    return [list(row) for row in zip(*([*c.u, *c.w] for c in columns), strict=True)]
