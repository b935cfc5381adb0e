"""What g says at a pose: whose weight hangs on which joint, at what arm, how bad it gets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mcgee.explain.inertia import Array, link_masses
from mcgee.robot import Robot


@dataclass(frozen=True, eq=False)
class GravityFigures:
    g: Array
    """The holding efforts (n,) [N·m | N]."""
    potential_energy: float
    slope: Array
    """∂g_i/∂q_j: how fast they change (n, n)."""
    links: tuple[str, ...]
    weight: Array
    """Of each link (links,) [N]."""
    height: Array
    """Of each link's centre of mass above the root frame's origin, against gravity (links,) [m]."""
    parts: Array
    """[k, i]: what link k adds to g_i; a column sums to g_i (links, n)."""
    lever: Array
    """[k, i]: the horizontal lever arm of link k's weight about joint i [m], signed as the effort;
    for a prismatic joint the share of the weight along it (links, n)."""
    level: Array
    """[k, i]: the horizontal part of a revolute joint's axis as link k turns about it, 1 where the
    axis is level; parts = weight * level * lever (links, n)."""
    effort: Array
    """The limits of effort, infinite where none is set or it is zero (n,)."""
    share: Array
    """|g_i| over the limit; 0 where none is set (n,)."""

    @property
    def margin(self) -> Array:
        """What is left of the limit, in percent; negative where the joint cannot hold (n,)."""
        return 100 * (1 - self.share)


def gravity_figures(robot: Robot, q: Array) -> GravityFigures:
    g, field = robot.gravity(q), np.array(robot.gravity_vector, float)
    strength = float(np.linalg.norm(field))
    m, _ = link_masses(robot)
    up = -field / strength if strength else np.zeros(3)
    J = robot.link_jacobians(q)
    directions = up @ J[:, :3]
    axes = J[:, 3:]
    flat = np.linalg.norm(axes - up[:, None] * (up @ axes)[:, None, :], axis=1)
    level = np.where(abs(axes).max(1) > 0, flat, 1.0)  # a slide has no axis to tilt
    lever = np.divide(directions, level, out=np.zeros_like(level), where=level > 1e-12)
    weight, effort = m * strength, robot.limits.effort
    effort = np.where(effort > 0, effort, np.inf)
    return GravityFigures(
        g=g,
        potential_energy=float(robot.potential_energy(q)),
        slope=robot.gravity_gradient(q),
        links=robot.moving_links,
        weight=weight,
        height=robot.link_poses(q)[:, :3, 3] @ up,
        parts=weight[:, None] * directions,
        lever=lever,
        level=level,
        effort=effort,
        share=abs(g) / effort,
    )


@dataclass(frozen=True, eq=False)
class WorstGravity:
    """The largest holding effort of one joint over the joint ranges, and how it was found."""

    joint: str
    effort: float
    """|g_i| at its largest [N·m | N]."""
    q: Array
    """Where (n,)."""
    limit: float
    samples: int
    """Random poses looked at first."""
    best_sample: float
    starts: int
    """Descents begun, from the best of them."""
    agreeing: int
    """Descents that ended at this value, to one part in 10⁶."""
    converged: int
    """Descents whose gradient, projected on the ranges, came to rest."""

    @property
    def share(self) -> float:
        """Of the limit; zero where none is set."""
        return self.effort / self.limit if np.isfinite(self.limit) and self.limit > 0 else 0.0


def ranges(robot: Robot, q: Array) -> tuple[Array, Array]:
    """Where each joint may go: its limits; a whole turn where it has none; a slide without limits
    stays where it is (n,), (n,)."""
    lower, upper = robot.limits.lower.copy(), robot.limits.upper.copy()
    for i, joint in enumerate(robot.independent_joints):
        if not (np.isfinite(lower[i]) and np.isfinite(upper[i])):
            turns = joint.kind != "prismatic"
            lower[i], upper[i] = (-np.pi, np.pi) if turns else (q[i], q[i])
    return lower, upper


def worst_gravity(
    robot: Robot, q: Array, *, samples: int = 4096, starts: int = 24, seed: int = 0
) -> tuple[WorstGravity, ...]:
    """The largest |g_i| of every joint over its robot's joint ranges.

    Many random poses are evaluated in one batch; from the best of them, for each sign, L-BFGS-B
    climbs along the analytic gradient ∂g_i/∂q within the ranges. Several climbs to the same value
    make it likely, and never certain, that it is the largest.

    Raises: ModuleNotFoundError: SciPy is not installed (mcgee[plot])
    """
    try:
        import scipy.optimize  # noqa: F401
        from threadpoolctl import threadpool_limits
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(
            "The search for the worst holding effort needs SciPy: install mcgee[plot].",
            name=missing.name,
        ) from missing

    lower, upper = ranges(robot, q)
    rng = np.random.default_rng(seed)
    poses = np.concatenate([q[None], rng.uniform(lower, upper, size=(samples - 1, robot.n))])
    poses = np.clip(poses, lower, upper)
    efforts = robot.gravity(poses)
    # L-BFGS-B's matrices are tiny: BLAS threads would wait for each other most of the time
    with threadpool_limits(1, "blas"):
        return tuple(
            _worst(robot, i, poses, efforts[:, i], np.stack([lower, upper], -1), starts)
            for i in range(robot.n)
        )


def _worst(
    robot: Robot, i: int, poses: Array, efforts: Array, bounds: Array, starts: int
) -> WorstGravity:
    from scipy.optimize import minimize

    # slides are in metres and turns in radians, and both ranges become 0 … 1
    span = bounds[:, 1] - bounds[:, 0]
    found = []
    for sign in (1.0, -1.0):

        def fall(x: Array, sign: float = sign) -> tuple[float, Array]:
            pose = bounds[:, 0] + span * x
            slope = robot.gravity_gradient(pose)[i]
            return -sign * float(robot.gravity(pose)[i]), -sign * slope * span

        for k in np.argsort(-sign * efforts)[: starts // 2]:
            x = np.divide(poses[k] - bounds[:, 0], span, out=np.zeros_like(span), where=span > 0)
            climb = minimize(
                fall,
                x,
                jac=True,
                method="L-BFGS-B",
                bounds=[(0, 1)] * robot.n,
                options={"ftol": 1e-15, "gtol": 1e-10},
            )
            found.append((-sign * climb.fun * sign, bounds[:, 0] + span * climb.x, climb.success))
    values = np.array([abs(value) for value, _, _ in found])
    best = int(values.argmax())
    return WorstGravity(
        joint=robot.joint_names[i],
        effort=float(values[best]),
        q=found[best][1],
        limit=float(robot.limits.effort[i]),
        samples=len(poses),
        best_sample=float(abs(efforts).max()),
        starts=len(found),
        agreeing=int((values >= values[best] * (1 - 1e-6)).sum()),
        converged=sum(bool(success) for _, _, success in found),
    )
