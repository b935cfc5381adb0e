"""What the unknown parameters of an arm are multiplied with in its efforts."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from mcgee.control.controller import Array
from mcgee.control.gains import joint_gain, joint_vector, numbers, positive
from mcgee.robot import Robot

TEN = ("m", "m cx", "m cy", "m cz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")

THIN = 0.01
"""Radius of gyration below which none is taken to be [m]."""


class Unknowns:
    """The parameters p that adaptive laws estimate, and the regressors they enter by.

    First the inertial parameters in the order of `Robot.inertial_parameters`; then, with friction,
    the viscous and after them the Coulomb coefficients of the joints, for efforts
    viscous qd + coulomb tanh(qd / speed), as `mcgee.simulate.Friction` has them. Armature is known
    and no part of p.
    """

    def __init__(self, robot: Robot, friction: bool, speed: float):
        self.robot, self.friction = robot, bool(friction)
        self.speed = positive("friction_speed", speed, "rad/s")
        self.weightless = robot.replace(gravity_vector=(0.0, 0.0, 0.0))
        self.of_parameters = robot.with_parameters()

    @cached_property
    def names(self) -> tuple[str, ...]:
        bodies = [body.link for body in self.robot.mechanism.bodies]
        inertial = [f"{what} of {link}" for link in bodies for what in TEN]
        rubbing = [f"{w} of {j}" for w in ("viscous", "coulomb") for j in self.robot.joint_names]
        return (*inertial, *rubbing) if self.friction else tuple(inertial)

    @cached_property
    def described(self) -> Array:
        """p of the robot as its description has it, friction not counted (m,)."""
        p = np.zeros(len(self.names))
        p[: self.inertial] = self.robot.inertial_parameters
        return p

    @property
    def inertial(self) -> int:
        """How many of p are inertial parameters."""
        return len(self.robot.inertial_parameters)

    @cached_property
    def scales(self) -> Array:
        """How large each of p is likely to be (m,): see `parameter_scales`."""
        links = np.abs(self.robot.inertial_parameters.reshape(-1, 10))
        mass = np.maximum(links[:, :1], 1e-6)
        inertia = np.maximum(links[:, 4:].max(1, keepdims=True), THIN**2 * mass)
        columns = (mass, np.repeat(np.sqrt(mass * inertia), 3, 1), np.repeat(inertia, 6, 1))
        rubbing = np.ones(len(self.names) - self.inertial)
        return np.concatenate([np.concatenate(columns, 1).ravel(), rubbing])

    @cached_property
    def rotors(self) -> Array:
        """The part of M that armature is (n, n), the same everywhere."""
        n = self.robot.n
        return np.array(self.of_parameters.mass_matrix(np.zeros(n), np.zeros(self.inertial)))

    def checked(self, name: str, given: Any) -> Array:
        """
        Raises: ValueError: not one number for each of p, or not finite
        """
        p = numbers(name, given)
        if p.shape[-1:] != (len(self.names),) or not np.isfinite(p).all():
            with_ = "and friction coefficients " if self.friction else ""
            raise ValueError(
                f"{name} has shape {p.shape}, expected {len(self.names)} finite numbers, the "
                f"inertial parameters {with_}of robot '{self.robot.name}'."
            )
        return p

    def regressor(self, q: Array, qd: Array, qdd: Array) -> Array:
        """Y with Y p + rotors qdd = M qdd + C(q, qd) qd + g + friction(qd) (..., n, m)."""
        return self._with_friction(self.robot.regressor(q, qd, qdd), qd)

    def two_velocities(self, q: Array, qd: Array, qd_r: Array, qdd_r: Array) -> Array:
        """Y_r with Y_r p + rotors qdd_r = M qdd_r + C(q, qd) qd_r + g + friction(qd) (..., n, m).

        C(q, a) b is bilinear and, with Christoffel's symbols, symmetric in a and b: with
        h(v) = C(q, v) v it is h((a + b)/2) − h((a − b)/2), exactly. So the regressor at the mean of
        both velocities, less that of a weightless robot at half their difference.
        """
        whole = self.robot.regressor(q, (qd_r + qd) / 2, qdd_r)
        rest = self.weightless.regressor(q, (qd_r - qd) / 2, 0 * qd)
        return self._with_friction(whole - rest, qd)

    def _with_friction(self, Y: Array, qd: Array) -> Array:
        if not self.friction:
            return Y
        one = np.eye(self.robot.n)
        viscous, coulomb = (x[..., None] * one for x in (qd, np.tanh(qd / self.speed)))
        columns = (np.broadcast_to(x, (*Y.shape[:-1], self.robot.n)) for x in (viscous, coulomb))
        return np.concatenate([Y, *columns], axis=-1)


def parameter_scales(robot: Robot, friction: bool = True) -> Array:
    """How large each unknown parameter is likely to be, in the order adaptive laws have them.

    Of a link its mass m, its largest component I of inertia, and √(m I) for first moments; 1 for
    friction coefficients. gains = k * parameter_scales(robot)**2 lets light and heavy links learn
    alike, k [1/J] for AdaptiveSlotineLi.

    Returns: (10 bodies + 2 n,), or (10 bodies,) without friction
    """
    return Unknowns(robot, friction, 1.0).scales.copy()


def excitation_gains(
    robot: Robot,
    reference: Callable[[Any], Any],
    times: Any,
    kd: Any,
    rate: float,
    friction: bool = True,
    *,
    least: float = 1e-8,
    friction_speed: float = 0.01,
) -> Array:
    """Gains under which AdaptiveSlotineLi learns all that a motion shows at one rate.

    rate · (mean of Yᵀ kd⁻¹ Y + rest)⁻¹ over the reference: where errors are small, kd s = Y dp and
    so the mean of dp in time decays by e in 1/rate seconds. What shows less than `least` of what
    shows most is held back by the rest, in units of `parameter_scales`.

    Args:
        reference: t -> (q, qd, qdd), of arrays of times too
        times: at which it is looked at (k,), evenly over one period or the whole motion [s]
        kd: the law's [N·m·s/rad | N·s/m]
        rate: [1/s]; below the law's lam
        friction, friction_speed: as the law has them
        least: share
    Returns: (m, m) [parameter² / J]
    Raises: ValueError: wrong shapes, no positive numbers
    """
    known = Unknowns(robot, friction, friction_speed)
    stiff = joint_gain(robot, "kd", kd, positive=True)
    when = numbers("times", times)
    if when.ndim != 1 or not when.size or not callable(reference):
        raise ValueError(
            f"times have shape {when.shape} and reference is {reference!r}, expected one or more "
            f"times and a reference of mcgee.control."
        )
    found = [np.asarray(x, float) for x in reference(when)]
    q, qd, qdd = (joint_vector(robot, "reference", x) for x in found)
    shown = known.regressor(q, qd, qdd) * known.scales / np.sqrt(stiff)[:, None]
    rows = shown.reshape(-1, len(known.scales))
    mean = rows.T @ rows / max(1, shown[..., 0, 0].size)
    rest = positive("least", least, "") * float(np.linalg.eigvalsh(mean).max())
    even = np.linalg.inv(mean + rest * np.eye(len(mean)))
    matrix = known.scales[:, None] * even * known.scales
    return np.asarray(positive("rate", rate, "1/s") * (matrix + matrix.T) / 2)
