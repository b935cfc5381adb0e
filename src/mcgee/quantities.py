"""The quantities a user asks for, over any scalar.

Each takes a mechanism and the coordinates q, qd, … (sequences of n scalars) and returns nested
lists. Where joints mimic others the algorithms run on every joint and the result is projected:
with joint positions A q + b, M = Aᵀ M_joints A, and so on.
"""

from collections.abc import Sequence
from operator import mul
from typing import Any

from mcgee.algorithms.aba import aba
from mcgee.algorithms.coriolis import christoffel as christoffel_symbols
from mcgee.algorithms.coriolis import coriolis_matrix as coriolis_matrix_of_joints
from mcgee.algorithms.coriolis import coriolis_product as coriolis_product_of_joints
from mcgee.algorithms.crba import crba
from mcgee.algorithms.definition import definition
from mcgee.algorithms.derivatives import Linearization
from mcgee.algorithms.energy import kinetic_energy as kinetic_energy_of_joints
from mcgee.algorithms.energy import potential_energy as potential_energy_of_joints
from mcgee.algorithms.gravity import gravity_force, gravity_slope
from mcgee.algorithms.kinematics import (
    body_poses,
    frame_jacobian,
    frame_pose,
    point_jacobian,
)
from mcgee.algorithms.linear import inverse, solve, solve_columns
from mcgee.algorithms.motion import acceleration_at, accelerations, velocities
from mcgee.algorithms.regressor import regressor as regressor_of_joints
from mcgee.algorithms.rnea import rnea
from mcgee.algorithms.spatial import Vector
from mcgee.algorithms.tree import transforms
from mcgee.mechanism import Mechanism
from mcgee.model import Pose
from mcgee.scalar import Scalar

Coordinates = Sequence[Scalar]
Rows = list[list[Scalar]]


def mass_matrix(m: Mechanism, q: Coordinates) -> list[list[Scalar]]:
    return _mirrored(_project(m, crba(m, m.joint_space(q)), 2))


def mass_matrix_by_definition(m: Mechanism, q: Coordinates) -> list[list[Scalar]]:
    return _project(m, definition(m, m.joint_space(q)), 2)


def mass_matrix_inverse(m: Mechanism, q: Coordinates) -> list[list[Scalar]]:
    return inverse(mass_matrix(m, q))


def coriolis(m: Mechanism, q: Coordinates, qd: Coordinates) -> list[Scalar]:
    return inverse_dynamics(_weightless(m), q, qd, [0] * m.n)


def coriolis_matrix(m: Mechanism, q: Coordinates, qd: Coordinates) -> list[list[Scalar]]:
    return _project(m, coriolis_matrix_of_joints(m, m.joint_space(q), m.joint_space(qd)), 2)


def coriolis_product(m: Mechanism, q: Coordinates, qd: Coordinates, v: Coordinates) -> list[Scalar]:
    joints = coriolis_product_of_joints(m, m.joint_space(q), m.joint_space(qd), m.joint_space(v))
    return _project(m, joints, 1)


def christoffel(m: Mechanism, q: Coordinates) -> list[list[list[Scalar]]]:
    return [_mirrored(c) for c in _project(m, christoffel_symbols(m, m.joint_space(q)), 3)]


def gravity(m: Mechanism, q: Coordinates) -> list[Scalar]:
    return _project(m, gravity_force(m, m.joint_space(q)), 1)


def gravity_gradient(m: Mechanism, q: Coordinates) -> list[list[Scalar]]:
    return _mirrored(_project(m, gravity_slope(m, m.joint_space(q)), 2))


def terms(
    m: Mechanism, q: Coordinates, qd: Coordinates
) -> tuple[list[list[Scalar]], list[Scalar], list[Scalar]]:
    return mass_matrix(m, q), coriolis(m, q, qd), gravity(m, q)


def inverse_dynamics(
    m: Mechanism, q: Coordinates, qd: Coordinates, qdd: Coordinates
) -> list[Scalar]:
    return _project(m, rnea(m, m.joint_space(q), m.joint_space(qd), m.joint_space(qdd)), 1)


def forward_dynamics(
    m: Mechanism, q: Coordinates, qd: Coordinates, tau: Coordinates
) -> list[Scalar]:
    """In O(n) where no joint mimics another."""
    if m.coupled:
        return forward_dynamics_by_elimination(m, q, qd, tau)
    return aba(m, q, qd, tau)


def forward_dynamics_by_elimination(
    m: Mechanism, q: Coordinates, qd: Coordinates, tau: Coordinates
) -> list[Scalar]:
    """Through M, in O(n³): fewer operations for short arms."""
    bias = inverse_dynamics(m, q, qd, [0] * m.n)
    return solve(mass_matrix(m, q), [t - b for t, b in zip(tau, bias, strict=True)])


def inverse_dynamics_derivatives(
    m: Mechanism, q: Coordinates, qd: Coordinates, qdd: Coordinates
) -> tuple[Rows, Rows, Rows]:
    at = Linearization(m, m.joint_space(q), m.joint_space(qd))
    dtau_dq = _project(m, at.dtau_dq(m.joint_space(qdd)), 2)
    return dtau_dq, _project(m, at.dtau_dqd, 2), _mirrored(_project(m, at.M, 2))


def forward_dynamics_derivatives(
    m: Mechanism, q: Coordinates, qd: Coordinates, tau: Coordinates
) -> tuple[Rows, Rows, Rows]:
    """From qdd(q, qd, tau(q, qd, qdd)) = qdd: −M⁻¹ times the derivatives of inverse dynamics."""
    at = Linearization(m, m.joint_space(q), m.joint_space(qd))
    M, dtau_dqd = _mirrored(_project(m, at.M, 2)), _project(m, at.dtau_dqd, 2)
    # C qd = ½ ∂tau/∂qd qd
    bias = [sum(map(mul, C2, qd)) / 2 + g for C2, g in zip(dtau_dqd, gravity(m, q), strict=True)]
    qdd = solve(M, [t - b for t, b in zip(tau, bias, strict=True)])
    dtau_dq = _project(m, at.dtau_dq(m.joint_space(qdd)), 2)
    dqdd_dq, dqdd_dqd = (solve_columns(M, _negative(slopes)) for slopes in (dtau_dq, dtau_dqd))
    return dqdd_dq, dqdd_dqd, inverse(M)


def regressor(m: Mechanism, q: Coordinates, qd: Coordinates, qdd: Coordinates) -> Rows:
    return _project(m, regressor_of_joints(m, *(m.joint_space(x) for x in (q, qd, qdd))), 1)


def kinetic_energy(m: Mechanism, q: Coordinates, qd: Coordinates) -> Scalar:
    return kinetic_energy_of_joints(m, m.joint_space(q), m.joint_space(qd))


def potential_energy(m: Mechanism, q: Coordinates) -> Scalar:
    return potential_energy_of_joints(m, m.joint_space(q))


def forward_kinematics(m: Mechanism, q: Coordinates, frame: str) -> list[list[Scalar]]:
    return _homogeneous(frame_pose(m, m.joint_space(q), frame))


def jacobian(m: Mechanism, q: Coordinates, frame: str) -> list[list[Scalar]]:
    return [_project(m, row, 1) for row in frame_jacobian(m, m.joint_space(q), frame)]


def link_poses(m: Mechanism, q: Coordinates) -> list[list[list[Scalar]]]:
    bodies = body_poses(m, m.joint_space(q))
    return [
        _homogeneous(Pose(bodies[link.body].rotation, bodies[link.body].apply(link.inertia.com)))
        for link in m.masses
    ]


def link_jacobians(m: Mechanism, q: Coordinates) -> list[list[list[Scalar]]]:
    bodies = body_poses(m, m.joint_space(q))
    jacobians = []
    for link in m.masses:
        com = Vector(*bodies[link.body].apply(link.inertia.com))
        columns = point_jacobian(m, bodies, link.body, com)
        rows = zip(*([*c.u, *c.w] for c in columns), strict=True)
        jacobians.append([_project(m, list(row), 1) for row in rows])
    return jacobians


def link_accelerations(
    m: Mechanism, q: Coordinates, qd: Coordinates, qdd: Coordinates
) -> list[list[Scalar]]:
    q, qd, qdd = (m.joint_space(x) for x in (q, qd, qdd))
    X, bodies = transforms(m, q), body_poses(m, q)
    v = velocities(m, X, qd)
    a = accelerations(m, X, v, qd, qdd)
    rows = []
    for link in m.masses:
        i = link.body
        linear = acceleration_at(v[i], a[i], Vector(*link.inertia.com))
        rows.append([*bodies[i].turn(tuple(linear)), *bodies[i].turn(tuple(a[i].w))])
    return rows


def _homogeneous(pose: Pose) -> list[list[Scalar]]:
    rows = [[*row, x] for row, x in zip(pose.rotation, pose.translation, strict=True)]
    return [*rows, [0, 0, 0, 1]]


def _weightless(m: Mechanism) -> Mechanism:
    return Mechanism(m.bodies, m.masses, m.frames, (0, 0, 0), m.n)


def _project(m: Mechanism, array: Any, axes: int) -> Any:
    """From joints to coordinates along each of the leading axes: the transpose of joint_space."""
    if not m.coupled:
        return array
    if axes > 1:
        array = [_project(m, row, axes - 1) for row in array]
    rows: list[Any] = [None] * m.n
    for body, row in zip(m.bodies, array, strict=True):
        row, k = _scaled(row, body.multiplier), body.coordinate
        rows[k] = row if rows[k] is None else _sum(rows[k], row)
    return rows


def _mirrored(rows: list[list[Scalar]]) -> list[list[Scalar]]:
    """Symmetric to the last bit: a projection adds up mirrored elements in different orders."""
    return [[rows[max(i, j)][min(i, j)] for j in range(len(rows))] for i in range(len(rows))]


def _negative(rows: Rows) -> Rows:
    return [[-x for x in row] for row in rows]


def _scaled(x: Any, k: Scalar) -> Any:
    if k == 1:
        return x
    return [_scaled(v, k) for v in x] if isinstance(x, list) else x * k


def _sum(a: Any, b: Any) -> Any:
    return [_sum(x, y) for x, y in zip(a, b, strict=True)] if isinstance(a, list) else a + b
