"""Thousands of motions at once: the whole loop of fixed steps compiled."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mcgee import kernels
from mcgee.robot import Robot
from mcgee.simulate.run import state


class Rollout(NamedTuple):
    """Positions and velocities after each row of tau, (..., steps, n)."""

    q: np.ndarray
    qd: np.ndarray


def rollout(
    robot: Robot,
    q0: Any,
    qd0: Any,
    tau: Any = None,
    *,
    dt: float = 1e-3,
    steps: int | None = None,
    substeps: int = 1,
    viscous: bool = False,
) -> Rollout:
    """The motions of many states by the classical Runge-Kutta method, in one compiled loop.

    Args:
        q0, qd0: (..., n) [rad | m], [rad/s | m/s]
        tau: efforts (..., steps, n), each held for substeps; none by default [N·m | N]
        dt: seconds of a step, a number or (...)
        steps: how many states are wanted, where tau does not say
        substeps: steps of dt between the states
        viscous: with the viscous friction of the description
    Returns: (q, qd) after substeps dt, 2 substeps dt, …, (..., steps, n) each. What is no number
        any more is NaN, in its row alone
    Raises: ValueError: wrong shapes, no positive numbers, no number of steps
    Source: Kutta 1901. A row's bits do not depend on the others
    """
    q, qd = state(robot, q0, qd0, finite=False)
    efforts = _efforts(robot, tau, steps)
    if not (isinstance(substeps, (int, np.integer)) and substeps > 0):
        raise ValueError(f"substeps is {substeps!r}, expected a whole number from 1.")
    h = np.asarray(dt, float)
    if not (np.isfinite(h).all() and (h > 0).all()):
        raise ValueError(f"dt is {dt!r}, expected more than 0 s.")
    return Rollout(*kernels.rollout(robot, (q, qd), efforts, h, int(substeps), bool(viscous)))


def _efforts(robot: Robot, tau: Any, steps: int | None) -> np.ndarray:
    if tau is None:
        if not (isinstance(steps, (int, np.integer)) and steps > 0):
            raise ValueError(f"steps is {steps!r}, expected a whole number from 1, or give tau.")
        return np.broadcast_to(0.0, (int(steps), robot.n))
    efforts = np.asarray(tau, float)
    if efforts.ndim < 2 or efforts.shape[-1] != robot.n:
        raise ValueError(
            f"tau has shape {efforts.shape}, expected (..., steps, {robot.n}) for robot "
            f"'{robot.name}'. Joints: {', '.join(robot.joint_names)}."
        )
    if steps is not None and steps != efforts.shape[-2]:
        raise ValueError(f"steps is {steps}, and tau has rows for {efforts.shape[-2]}.")
    return efforts
