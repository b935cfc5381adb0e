"""What C says in a state: which pair of velocities pulls at which joint, and where energy goes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mcgee.explain.inertia import Array, link_inertias, link_masses, rotors
from mcgee.mechanism import coordinate_of
from mcgee.robot import Robot


@dataclass(frozen=True, eq=False)
class VelocityFigures:
    """Efforts in N·m | N, powers in W, energies in J."""

    centrifugal: Array
    """[i, j]: the effort on joint i that qd_j² asks for (n, n)."""
    coriolis: Array
    """[i, j, k], j < k: the effort on joint i that qd_j qd_k asks for; zero elsewhere (n, n, n)."""
    Cqd: Array
    """C(q, qd) qd, what they sum to (n,)."""
    residual: float
    """How far the sum is from it."""
    power: Array
    """[i]: qd_i [(½Ṁ − C) qd]_i: the energy per second that joint i gets from the others; the sum
    is zero (n,)."""
    flow: Array
    """[i, j]: of that, what comes from joint j; antisymmetric (n, n)."""
    half_Mdot_power: float
    """½ qdᵀ Ṁ qd"""
    C_power: float
    """qdᵀ C qd, equal to it: what the actuators would spend on C qd, as M changes under them"""
    skew_residual: float
    """The largest entry of (Ṁ − 2C) + (Ṁ − 2C)ᵀ."""
    moving: bool
    """Whether any joint has a velocity."""
    kinetic_energy: float
    links: tuple[str, ...]
    translation: Array
    """½ m |v|² of each link (links,)."""
    rotation: Array
    """½ ωᵀ I ω of each link (links,)."""
    rotors: float
    """Energy in the rotors, ½ armature qd²."""


def velocity_figures(robot: Robot, q: Array, qd: Array) -> VelocityFigures:
    c, C, Cqd = robot.christoffel(q), robot.coriolis_matrix(q, qd), robot.coriolis(q, qd)
    efforts = c * np.multiply.outer(qd, qd)  # [i, j, k]
    pairs = np.triu(efforts + efforts.swapaxes(-1, -2), 1)
    centrifugal = np.einsum("ijj->ij", efforts).copy()
    Mdot = (c + c.swapaxes(-2, -3)) @ qd
    flow = qd[:, None] * (0.5 * Mdot - C) * qd[None, :]
    N = Mdot - 2 * C
    translation, rotation = link_inertias(robot, q)
    return VelocityFigures(
        centrifugal=centrifugal,
        coriolis=pairs,
        Cqd=Cqd,
        residual=float(abs(centrifugal.sum(-1) + pairs.sum((-1, -2)) - Cqd).max()),
        power=flow.sum(-1),
        flow=flow,
        half_Mdot_power=float(0.5 * qd @ Mdot @ qd),
        C_power=float(qd @ C @ qd),
        skew_residual=float(abs(N + N.T).max()),
        moving=bool(qd.any()),
        kinetic_energy=float(robot.kinetic_energy(q, qd)),
        links=robot.moving_links,
        translation=0.5 * (translation @ qd) @ qd,
        rotation=0.5 * (rotation @ qd) @ qd,
        rotors=float(0.5 * qd @ rotors(robot) @ qd),
    )


@dataclass(frozen=True, eq=False)
class EnergyFlow:
    """The power budget of each body that a joint moves, in W.

    What comes through its joint from the body before it, what the joint's actuator adds and what
    gravity gives, less what goes on to the bodies beyond it, is the rate of its kinetic energy.
    """

    joints: tuple[str, ...]
    """Of every moving joint, mimics included, in the order of `robot.mechanism.bodies`."""
    parents: tuple[int, ...]
    """The body before each, −1 for the ground."""
    through: Array
    """From the parent, across the joint; what the joint itself adds is apart."""
    actuator: Array
    """tau qd of the joint: efforts that produce the given accelerations."""
    gravity: Array
    """Power of the body's own weight."""
    rate: Array
    """dT/dt of the body, its rotor included."""
    residual: float
    """How far the budgets are from balance."""


def energy_flow(robot: Robot, q: Array, qd: Array, qdd: Array) -> EnergyFlow:
    bodies = robot.mechanism.bodies
    m, I = link_masses(robot)
    J, a = robot.link_jacobians(q), robot.link_accelerations(q, qd, qdd)
    R = robot.link_poses(q)[:, :3, :3]
    v = J @ qd
    alpha = np.einsum("kij,kjl,kml,km->ki", R, I, R, a[:, 3:])
    rates = m * (v[:, :3] * a[:, :3]).sum(-1) + (v[:, 3:] * alpha).sum(-1)
    weights = m * (v[:, :3] @ np.array(robot.gravity_vector, float))
    rate, gravity = np.zeros(len(bodies)), np.zeros(len(bodies))
    for k, mass in enumerate(robot.mechanism.masses):
        rate[mass.body] += rates[k]
        gravity[mass.body] += weights[k]
    speed = np.array([qd[b.coordinate] * b.multiplier for b in bodies])
    speedup = np.array([qdd[b.coordinate] * b.multiplier for b in bodies])
    rate += np.array([b.armature for b in bodies]) * speed * speedup
    actuator = _joint_efforts(robot, q, qd, qdd) * speed
    into = rate - gravity  # what a body takes in at its joint, for itself and to hand on
    for i in reversed(range(len(bodies))):
        if bodies[i].parent >= 0:
            into[bodies[i].parent] += into[i] - actuator[i]
    total = float(qd @ robot.inverse_dynamics(q, qd, qdd))
    return EnergyFlow(
        joints=tuple(b.name for b in bodies),
        parents=tuple(b.parent for b in bodies),
        through=into - actuator,
        actuator=actuator,
        gravity=gravity,
        rate=rate,
        residual=abs(total - float((rate - gravity).sum())),
    )


def _joint_efforts(robot: Robot, q: Array, qd: Array, qdd: Array) -> Array:
    """The effort of every moving joint, a mimic's own as if it had an actuator (bodies,)."""
    bodies = robot.mechanism.bodies
    if not robot.mechanism.coupled:
        return robot.inverse_dynamics(q, qd, qdd)
    alone = replace(robot, joints=tuple(replace(joint, mimic=None) for joint in robot.joints))
    by_name = {joint.name: joint for joint in robot.joints}
    offset = np.array([coordinate_of(by_name[b.name], by_name)[2] for b in bodies])
    factor = np.array([b.multiplier for b in bodies])
    of = [b.coordinate for b in bodies]
    return alone.inverse_dynamics(q[of] * factor + offset, qd[of] * factor, qdd[of] * factor)
