"""What M says at a pose: how heavy each joint feels, and how joints pull at each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mcgee.robot import Robot

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class InertiaFigures:
    """Units: kg·m² between revolute joints, kg between prismatic ones, kg·m where they mix."""

    M: Array
    """(n, n)"""
    locked: Array
    """M_ii: what joint i feels when every other joint is locked (n,)."""
    free: Array
    """1/(M⁻¹)_ii: what it feels when the others are free to give way (n,)."""
    ratio: Array
    """free/locked (n,)."""
    hidden: Array
    """1 − ratio: the share that coupling hides from a joint among free ones (n,)."""
    coupling: Array
    """M_ij/√(M_ii M_jj), between −1 and 1 (n, n)."""
    principal: Array
    """Eigenvalues of M, smallest first (n,)."""
    directions: Array
    """Their eigenvectors, as columns: the cheapest acceleration first (n, n)."""
    condition: float
    """Largest over smallest principal inertia."""
    mixed_units: bool
    """Whether M mixes kg·m² and kg, so that principal inertias depend on the unit of length."""
    links: tuple[str, ...]
    translation: Array
    """m Jvᵀ Jv of each link (links, n, n)."""
    rotation: Array
    """Jωᵀ I Jω of each link (links, n, n)."""
    armature: Array
    """What rotors add (n, n)."""
    slope: Array
    """∂M_ij/∂q_k (n, n, n)."""
    fastest: Array
    """The joint k that changes M_ij fastest, −1 where none does (n, n)."""

    def torque_columns(self, accelerations: Array) -> Array:
        """Column j: the efforts on all joints that accelerating joint j alone takes (n, n)."""
        return self.M * np.asarray(accelerations, float)


def inertia_figures(robot: Robot, q: Array) -> InertiaFigures:
    M = robot.mass_matrix(q)
    locked = np.diag(M).copy()
    with np.errstate(divide="ignore"):
        free = 1 / np.diag(robot.mass_matrix_inverse(q))
    principal, directions = np.linalg.eigh(M)
    translation, rotation = link_inertias(robot, q)
    c = robot.christoffel(q)
    slope = c + c.swapaxes(-2, -3)
    changes = abs(slope).max(-1) > 1e-12 * abs(M).max()
    kinds = {joint.kind == "prismatic" for joint in robot.independent_joints}
    return InertiaFigures(
        M=M,
        locked=locked,
        free=free,
        ratio=free / locked,
        hidden=1 - free / locked,
        coupling=M / np.sqrt(np.outer(locked, locked)),
        principal=principal,
        directions=directions,
        condition=float(principal[-1] / principal[0]),
        mixed_units=len(kinds) == 2,
        links=robot.moving_links,
        translation=translation,
        rotation=rotation,
        armature=rotors(robot),
        slope=slope,
        fastest=np.where(changes, abs(slope).argmax(-1), -1),
    )


def link_inertias(robot: Robot, q: Array) -> tuple[Array, Array]:
    """m Jvᵀ Jv and Jωᵀ I Jω of each moving link, (links, n, n) each."""
    J, R = robot.link_jacobians(q), robot.link_poses(q)[..., :3, :3]
    Jv, Jw = J[..., :3, :], J[..., 3:, :]
    m, I = link_masses(robot)
    about_root = R @ I @ R.swapaxes(-1, -2)
    return m[:, None, None] * (_t(Jv) @ Jv), _t(Jw) @ about_root @ Jw


def link_masses(robot: Robot) -> tuple[Array, Array]:
    """Masses (links,) and inertias about them (links, 3, 3), in the axes of `link_poses`."""
    inertias = [mass.inertia for mass in robot.mechanism.masses]
    return np.array([i.mass for i in inertias]), np.array([i.matrix for i in inertias])


def rotors(robot: Robot) -> Array:
    """What armature adds to M (n, n)."""
    added = np.zeros(robot.n)
    for body in robot.mechanism.bodies:
        added[body.coordinate] += body.armature * body.multiplier**2
    return np.diag(added)


def _t(a: Array) -> Array:
    return a.swapaxes(-1, -2)


@dataclass(frozen=True, eq=False)
class TaskFigures:
    """Inertia as a hand on a frame would feel it."""

    frame: str
    J: Array
    """(6, n), linear rows first, root axes."""
    mobility: Array
    """J M⁻¹ Jᵀ: the acceleration that a unit force causes (6, 6)."""
    operational_inertia: Array
    """Λ = (J M⁻¹ Jᵀ)⁻¹, the pseudo-inverse where some motions cannot be made (6, 6)."""
    inertia: Array
    """The same of the translations alone: what a push feels when the frame may turn (3, 3)."""
    masses: Array
    """Effective masses along the principal directions, lightest first [kg]; infinite where the
    frame cannot move (3,)."""
    directions: Array
    """The directions, as columns, in root axes (3, 3)."""
    manipulability: float
    """Volume of the ellipsoid of accelerations that unit efforts reach, over the directions that
    can move at all (Yoshikawa 1985)."""
    dimensions: int
    """How many translations the frame can make at this pose."""

    def effective_mass(self, direction: Array) -> float:
        """What a push along a direction (3,) feels [kg]; infinite where the frame cannot yield."""
        u = np.asarray(direction, float)
        if u.shape != (3,) or not np.isfinite(u).all() or not u.any():
            raise ValueError(f"direction is {direction!r}, expected 3 numbers, not all zero.")
        u = u / np.linalg.norm(u)
        yielding = u @ self.mobility[:3, :3] @ u
        return float(1 / yielding) if yielding > 1e-12 * abs(self.mobility).max() else np.inf


def task_figures(robot: Robot, q: Array, frame: str) -> TaskFigures:
    J, inverse = robot.jacobian(q, frame), robot.mass_matrix_inverse(q)
    mobility = J @ inverse @ J.T
    yielding, directions = np.linalg.eigh(mobility[:3, :3])
    moves = yielding > 1e-10 * max(yielding[-1], np.finfo(float).tiny)
    masses = np.full(3, np.inf)
    masses[moves] = 1 / yielding[moves]
    reach = np.linalg.svd(J[:3] @ inverse, compute_uv=False)
    dimensions = int(moves.sum())
    return TaskFigures(
        frame=frame,
        J=J,
        mobility=mobility,
        operational_inertia=np.linalg.pinv(mobility, rcond=1e-10, hermitian=True),
        inertia=np.linalg.pinv(mobility[:3, :3], rcond=1e-10, hermitian=True),
        masses=masses[::-1],
        directions=directions[:, ::-1],
        manipulability=float(np.prod(reach[:dimensions])) if dimensions else 0.0,
        dimensions=dimensions,
    )
