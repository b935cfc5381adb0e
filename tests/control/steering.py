"""What the tests of laws share: arms with wrong masses, motions to follow, derivatives."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np

import mcgee
from mcgee.control import Fourier
from mcgee.robot import Robot

HOME = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
"""A position of the Panda far from its limits."""


@cache
def panda() -> Robot:
    return mcgee.arms.panda()


def heavier(arm: Robot, factor: float) -> Robot:
    """The arm with all masses and inertias times a factor."""

    def scaled(link):
        if link.inertia is None:
            return link
        own = link.inertia
        turning = tuple(factor * x for x in own.about_com)
        inertia = dataclasses.replace(own, mass=factor * own.mass, about_com=turning)
        return dataclasses.replace(link, inertia=inertia)

    return dataclasses.replace(arm, links=tuple(map(scaled, arm.links)))


@cache
def light() -> Robot:
    """What a controller takes the Panda for: 20 % too light."""
    return heavier(panda(), 0.8)


def waves(arm: Robot, size: float = 0.4, ramp: float = 1.0) -> Fourier:
    """A motion that starts at rest; at HOME for the Panda."""
    rng = np.random.default_rng(arm.n)
    mean = HOME if arm.name == "panda" else rng.uniform(-0.5, 0.5, arm.n)
    return Fourier(mean, *rng.uniform(-size, size, (2, 2, arm.n)) / 2, frequency=0.3, ramp=ramp)


def derivative(t: np.ndarray, V: np.ndarray) -> np.ndarray:
    """dV/dt at t[2:-2], by differences of the fourth order."""
    h = t[1] - t[0]
    return (V[:-4] - 8 * V[1:-3] + 8 * V[3:-1] - V[4:]) / (12 * h)


def falls_as_told(motion, tolerance: float = 1e-5) -> bool:
    """Whether the logged dV/dt is what V does, and never positive."""
    V, Vdot = motion.log["V"], motion.log["Vdot"]
    wrong = abs(derivative(motion.t, V) - Vdot[2:-2]).max() / abs(Vdot).max()
    assert wrong < tolerance, wrong
    return bool((Vdot <= 0).all())
