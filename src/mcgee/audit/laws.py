"""The laws that M, C and g obey, for every robot in every state, each as a figure.

A law's residual is how far a robot breaks it, as a fraction of the largest term involved: zero but
for rounding where the law holds. Derivatives are taken numerically here, from the robot's own
methods, so that no law is true by construction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mcgee.audit.numerics import Array, apart, dot, gradient, slope, times
from mcgee.robot import Robot

ROUNDING = 1e-12
"""For sums of products: a thousand roundings of 1e-16 each, and some cancellation."""

DIFFERENCE = 1e-9
"""For numerical derivatives: 1e-16 over a step of 0.02, and the ninth derivative times 0.02^8."""


@dataclass(frozen=True)
class Law:
    """residual(robot, q, qd, qdd) takes (..., n) each and gives (...)."""

    name: str
    statement: str
    residual: Callable[[Robot, Array, Array, Array], Array]
    tolerance: float


@dataclass(frozen=True)
class Verdict:
    """A law on given states: the largest residual, and where in the batch it is."""

    law: Law
    residual: float
    worst: tuple[int, ...]

    @property
    def holds(self) -> bool:
        return self.residual <= self.law.tolerance  # a NaN does not


LAWS: list[Law] = []


def law(statement: str, tolerance: float) -> Callable:
    """Add a function to LAWS under its own name."""

    def add(residual: Callable[[Robot, Array, Array, Array], Array]) -> Callable:
        LAWS.append(Law(residual.__name__, statement, residual, tolerance))
        return residual

    return add


def check(robot: Robot, q: Any, qd: Any, qdd: Any) -> list[Verdict]:
    """Every law on a batch of states.

    Args:
        q, qd, qdd: joint positions, velocities, accelerations (..., n), one state at least
    Raises: ValueError: no state
    """
    if not all(np.size(x) for x in (q, qd, qdd)):
        raise ValueError("laws.check got an empty batch, expected one state at least.")
    return list(_verdicts(robot, *(np.asarray(x, float) for x in (q, qd, qdd))))


def _verdicts(robot: Robot, q: Array, qd: Array, qdd: Array) -> Iterator[Verdict]:
    for each in LAWS:
        residual = np.asarray(each.residual(robot, q, qd, qdd))
        worst = np.unravel_index(np.argmax(residual), residual.shape)  # the first NaN, if any
        yield Verdict(each, float(residual[worst]), tuple(int(i) for i in worst))


# -- the inertia matrix ---------------------------------------------------------------------------


@law("M is symmetric", 0.0)
def inertia_symmetric(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    M = robot.mass_matrix(q)
    return apart(M, M.swapaxes(-1, -2), axes=2)


@law("M is positive definite when the links are physical", 0.0)
def inertia_positive(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    """Zero where the smallest eigenvalue is positive, else its share of the largest."""
    M = robot.mass_matrix(q)
    finite = np.isfinite(M).all((-1, -2))
    moments = np.linalg.eigvalsh(np.where(finite[..., None, None], M, 1.0))  # it refuses NaN
    share = np.where(finite, moments[..., 0] / moments[..., -1], np.nan)
    return np.where(share > 0, 0.0, np.maximum(-share, np.finfo(float).tiny))


@law("M = Σ (m Jvᵀ Jv + Jωᵀ I Jω), link by link", ROUNDING)
def inertia_by_definition(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    M = robot.mass_matrix(q)
    total = np.zeros_like(M)
    for link in robot.links:
        if link.inertia is None:
            continue
        R = robot.forward_kinematics(q, link.name)[..., :3, :3]
        J = robot.jacobian(q, link.name)
        Jv, Jw = J[..., :3, :], J[..., 3:, :]
        arm = R @ np.array(link.inertia.com, float)
        Jc = Jv + np.cross(Jw, arm[..., None], axisa=-2, axisb=-2, axisc=-2)
        I = R @ np.array(link.inertia.matrix, float) @ R.swapaxes(-1, -2)
        total += link.inertia.mass * Jc.swapaxes(-1, -2) @ Jc + Jw.swapaxes(-1, -2) @ I @ Jw
    return apart(M, total + _armature(robot), axes=2)


def _armature(robot: Robot) -> Array:
    """What rotors add to M: each joint's armature on the coordinate that turns it."""
    added = np.zeros((robot.n, robot.n))
    for body in robot.mechanism.bodies:
        added[body.coordinate, body.coordinate] += body.armature * body.multiplier**2
    return added


@law("T = ½ qdᵀ M qd", ROUNDING)
def kinetic_energy_is_half_qd_M_qd(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    T = robot.kinetic_energy(q, qd)
    return apart(T[..., None], 0.5 * dot(qd, times(robot.mass_matrix(q), qd))[..., None])


@law("M = ∂²T/∂qd∂qdᵀ", ROUNDING)
def inertia_is_curvature_of_energy(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    M, n = robot.mass_matrix(q), robot.n
    e, at = np.eye(n), q[..., None, None, :]
    pair = robot.kinetic_energy(at, e[:, None, :] + e[None, :, :])
    single = robot.kinetic_energy(at[..., 0, :], e)
    curvature = pair - single[..., :, None] - single[..., None, :]
    return apart(M, curvature, axes=2)


@law("T > 0 for qd ≠ 0 when the links are physical", 0.0)
def kinetic_energy_positive(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    T = robot.kinetic_energy(q, qd)
    moving = abs(qd).max(-1) > 0
    return np.where((T > 0) | ~moving, 0.0, np.maximum(-T, np.finfo(float).tiny))


@law("M⁻¹ M = 1", ROUNDING)
def inertia_inverse(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    M, inverse = robot.mass_matrix(q), robot.mass_matrix_inverse(q)
    size = abs(M).sum(-1).max(-1) * abs(inverse).sum(-1).max(-1)
    return apart(inverse @ M, np.broadcast_to(np.eye(robot.n), M.shape), size, axes=2)


# -- velocities -----------------------------------------------------------------------------------


@law("c_ijk = ½(∂M_ij/∂q_k + ∂M_ik/∂q_j − ∂M_jk/∂q_i)", DIFFERENCE)
def christoffel_symbols(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    D = gradient(robot.mass_matrix, q)  # D_ijk = ∂M_ij/∂q_k
    c = 0.5 * (D + D.swapaxes(-1, -2) - np.moveaxis(D, -1, -3))
    return apart(robot.christoffel(q), c, abs(robot.mass_matrix(q)).max((-1, -2)), axes=3)


@law("C_ij = Σ_k c_ijk qd_k", ROUNDING)
def coriolis_from_christoffel(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    c, C = robot.christoffel(q), robot.coriolis_matrix(q, qd)
    return apart(C, times(c, qd[..., None, :]), _inertial_size(robot, q, qd), axes=2)


@law("Ṁ − 2C is skew-symmetric", DIFFERENCE)
def coriolis_skew(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    N = _rate_of_inertia(robot, q, qd) - 2 * robot.coriolis_matrix(q, qd)
    return apart(N, -N.swapaxes(-1, -2), _inertial_size(robot, q, qd), axes=2)


@law("½ qdᵀ (Ṁ − 2C) qd = 0: Coriolis forces move energy and never make it", DIFFERENCE)
def coriolis_powerless(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    N = 0.5 * _rate_of_inertia(robot, q, qd) - robot.coriolis_matrix(q, qd)
    power = dot(qd, times(N, qd))
    size = _inertial_size(robot, q, qd) * abs(qd).max(-1) ** 2
    return apart(power[..., None], np.zeros_like(power)[..., None], size)


def _rate_of_inertia(robot: Robot, q: Array, qd: Array) -> Array:
    """Ṁ along qd."""
    return times(gradient(robot.mass_matrix, q), qd[..., None, :])


def _inertial_size(robot: Robot, q: Array, qd: Array) -> Array:
    """What Ṁ and C are compared with: they vanish together at singular poses."""
    return abs(robot.mass_matrix(q)).max((-1, -2)) * abs(qd).max(-1)


@law("C(q, qd) qd is the velocity part of tau", ROUNDING)
def coriolis_is_C_qd(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    C, Cqd = robot.coriolis_matrix(q, qd), robot.coriolis(q, qd)
    return apart(Cqd, times(C, qd), _inertial_size(robot, q, qd) * abs(qd).max(-1))


@law("C(q, qd) v = C(q, v) qd", ROUNDING)
def coriolis_product_symmetric(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    C, v = robot.coriolis_matrix(q, qd), qdd
    one, other = robot.coriolis_product(q, qd, v), robot.coriolis_product(q, v, qd)
    size = _inertial_size(robot, q, qd) * abs(v).max(-1)
    return np.maximum(apart(one, other, size), apart(one, times(C, v), size))


# -- gravity, and the whole equation --------------------------------------------------------------


@law("g_i = ∂P/∂q_i", DIFFERENCE)
def gravity_is_slope_of_energy(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    return apart(robot.gravity(q), gradient(robot.potential_energy, q), _weight(robot))


@law("∂g/∂q is the slope of g, and symmetric", DIFFERENCE)
def gravity_gradient_is_slope(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    slope = robot.gravity_gradient(q)
    return np.maximum(
        apart(slope, gradient(robot.gravity, q), _weight(robot), axes=2),
        apart(slope, slope.swapaxes(-1, -2), axes=2),
    )


def _weight(robot: Robot) -> Array:
    """The weight of the links at one metre [N·m]: what a torque of gravity is compared with."""
    mass = sum(link.inertia.mass for link in robot.links if link.inertia is not None)
    return np.asarray(mass * np.linalg.norm(np.array(robot.gravity_vector, float)))


@law("at rest tau = g(q) holds the arm still", ROUNDING)
def gravity_holds(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    rest = np.zeros_like(q)
    g = robot.gravity(q)
    return apart(robot.inverse_dynamics(q, rest, rest), g, _weight(robot))


@law("tau = M qdd + C qd + g", ROUNDING)
def equation_of_motion(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    M, Cqd, g = robot.terms(q, qd)
    parts = times(M, qdd), Cqd, g
    size = sum(abs(part).max(-1) for part in parts)
    total = parts[0] + parts[1] + parts[2]
    return apart(robot.inverse_dynamics(q, qd, qdd), total, np.asarray(size))


@law("forward dynamics undoes inverse dynamics", ROUNDING)
def forward_undoes_inverse(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    tau = robot.inverse_dynamics(q, qd, qdd)
    size = abs(robot.mass_matrix_inverse(q)).sum(-1).max(-1) * abs(tau).max(-1)
    return apart(robot.forward_dynamics(q, qd, tau), qdd, size)


@law("terms gives what mass_matrix, coriolis and gravity give", ROUNDING)
def terms_are_the_parts(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    M, Cqd, g = robot.terms(q, qd)
    size = _inertial_size(robot, q, qd) * abs(qd).max(-1)
    return np.maximum.reduce(
        [
            apart(M, robot.mass_matrix(q), axes=2),
            apart(Cqd, robot.coriolis(q, qd), size),
            apart(g, robot.gravity(q), _weight(robot)),
        ]
    )


@law("d(T + P)/dt = qdᵀ tau", DIFFERENCE)
def energy_balance(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    tau = robot.inverse_dynamics(q, qd, qdd)
    # so much time that the fastest joint moves by about one step
    pace = np.maximum(abs(qd).max(-1), np.sqrt(abs(qdd).max(-1)))[..., None]
    pace = np.where(pace > 0, pace, 1.0)
    scaled = slope(lambda t: _energy_at(robot, q, qd, qdd, t / pace))
    power = scaled * pace[..., 0]
    speed = abs(qd).max(-1)
    size = (abs(qd) * abs(tau)).sum(-1) + _weight(robot) * speed
    size = size + _inertial_size(robot, q, qd) * speed**2
    return apart(dot(qd, tau)[..., None], power[..., None], size)


def _energy_at(robot: Robot, q: Array, qd: Array, qdd: Array, t: Array) -> Array:
    """T + P a time t later, with constant acceleration."""
    at, speed = q + t * qd + 0.5 * t * t * qdd, qd + t * qdd
    return robot.kinetic_energy(at, speed) + robot.potential_energy(at)


# -- derivatives and parameters -------------------------------------------------------------------


@law("∂tau/∂q, ∂tau/∂qd and ∂tau/∂qdd are the slopes of tau", DIFFERENCE)
def derivatives_are_slopes_of_inverse(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    by_q, by_qd, by_qdd = robot.inverse_dynamics_derivatives(q, qd, qdd)
    tau, size = robot.inverse_dynamics, _effort(robot, q, qd, qdd)
    return np.maximum.reduce(
        [
            apart(by_q, gradient(lambda x: tau(x, qd, qdd), q), size, axes=2),
            apart(by_qd, gradient(lambda x: tau(q, x, qdd), qd), size, axes=2),
            apart(by_qdd, gradient(lambda x: tau(q, qd, x), qdd), size, axes=2),
        ]
    )


@law("∂tau/∂qd = 2 C and ∂tau/∂qdd = M", ROUNDING)
def derivatives_are_coriolis_and_inertia(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    _, by_qd, by_qdd = robot.inverse_dynamics_derivatives(q, qd, qdd)
    C, size = robot.coriolis_matrix(q, qd), _inertial_size(robot, q, qd)
    M = robot.mass_matrix(q)
    return np.maximum(apart(by_qd, 2 * C, size, axes=2), apart(by_qdd, M, axes=2))


@law("∂qdd/∂x = −M⁻¹ ∂tau/∂x for x = q, qd, and ∂qdd/∂tau = M⁻¹", ROUNDING)
def forward_derivatives_undo_inverse(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    ours = robot.forward_dynamics_derivatives(q, qd, robot.inverse_dynamics(q, qd, qdd))
    by_q, by_qd, M = robot.inverse_dynamics_derivatives(q, qd, qdd)
    inverse = robot.mass_matrix_inverse(q)
    # the rounding of tau as M⁻¹ passes it on to qdd, and qdd to the slopes
    passed, size = abs(inverse).sum(-1).max(-1), _effort(robot, q, qd, qdd)
    size = passed * (1 + passed * abs(M).sum(-1).max(-1)) * size
    size = np.maximum(size, passed**2 * abs(M).sum(-1).max(-1))
    theirs = -inverse @ by_q, -inverse @ by_qd, inverse
    pairs = zip(ours, theirs, strict=True)
    return np.maximum.reduce([apart(a, b, size, axes=2) for a, b in pairs])


def _effort(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    """The size of what adds up to tau, and of how it changes."""
    speed, m = abs(qd).max(-1), abs(robot.mass_matrix(q)).max((-1, -2))
    return m * (1 + speed + speed**2 + abs(qdd).max(-1)) + _weight(robot)


@law("tau = Y p + armature qdd", ROUNDING)
def regressor_times_parameters(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    return _linear_in(robot.inertial_parameters, robot, robot.inverse_dynamics, q, qd, qdd)


@law("tau = Y p + armature qdd whatever the parameters p", ROUNDING)
def inverse_linear_in_parameters(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    p, tau = robot.inertial_parameters, robot.with_parameters().inverse_dynamics
    other = np.cos(np.arange(p.size)) * abs(p).max()
    return _linear_in(other, robot, lambda a, b, c: tau(a, b, c, other), q, qd, qdd)


def _linear_in(p: Array, robot: Robot, effort: Callable, q: Array, qd: Array, qdd: Array) -> Array:
    Y, rotors = robot.regressor(q, qd, qdd), times(_armature(robot), qdd)
    # terms of Y may cancel; at one metre they are what the motion is
    motion = abs(qd).max(-1) ** 2 + abs(qdd).max(-1)
    size = np.maximum(abs(Y).max((-1, -2)), motion) * abs(p).sum()
    return apart(effort(q, qd, qdd), Y @ p + rotors, size)


@law("the robot's own parameters give its own M, C qd and g", ROUNDING)
def parameters_stand_for_links(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    M, Cqd, g = robot.with_parameters().terms(q, qd, robot.inertial_parameters)
    size = _inertial_size(robot, q, qd) * abs(qd).max(-1)
    ours = zip((M, Cqd, g), robot.terms(q, qd), (0.0, size, _weight(robot)), (2, 1, 1), strict=True)
    return np.maximum.reduce([apart(a, b, np.asarray(s), axes=k) for a, b, s, k in ours])


# -- kinematics -----------------------------------------------------------------------------------


@law("the Jacobian is the rate of the frame's pose", DIFFERENCE)
def jacobian_is_rate_of_pose(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    T = robot.forward_kinematics(q)
    D = np.moveaxis(gradient(robot.forward_kinematics, q), -1, -3)  # (..., n, 4, 4)
    W = D[..., :3, :3] @ T[..., None, :3, :3].swapaxes(-1, -2)  # each column's ω×
    rate = np.stack(
        [D[..., 0, 3], D[..., 1, 3], D[..., 2, 3], W[..., 2, 1], W[..., 0, 2], W[..., 1, 0]], -2
    )
    return apart(robot.jacobian(q), rate, np.asarray(1.0), axes=2)
