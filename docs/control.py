"""Writes the tables and the figure of docs/control.md: laws that take an arm for a fifth too light.

python docs/control.py  (with matplotlib; some minutes)
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from curves import panels, save
from tables import fill

import mcgee
from mcgee import control

PAGE = Path(__file__).parent / "control.md"
DURATION, LAST = 20.0, 2.0
HOME = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
KD = [20.0] * 4 + [5.0] * 3
BAND = 10.0
"""Of all laws: natural frequencies [rad/s], critically damped where they have second order."""


def lighter(arm: mcgee.Robot, factor: float) -> mcgee.Robot:
    """The arm with masses and inertias times a factor."""
    links = []
    for link in arm.links:
        if link.inertia is not None:
            about_com = tuple(factor * x for x in link.inertia.about_com)
            mass = factor * link.inertia.mass
            inertia = dataclasses.replace(link.inertia, mass=mass, about_com=about_com)
            link = dataclasses.replace(link, inertia=inertia)
        links.append(link)
    return dataclasses.replace(arm, links=tuple(links))


ARM = mcgee.arms.panda()
LIGHT = lighter(ARM, 0.8)
START = ARM.forward_kinematics(HOME)[:3, 3]
WALL = control.Wall(ARM, START - [0, 0, 0.02], [0, 0, 1], 2e4)
_half = np.random.default_rng(7).uniform(-0.2, 0.2, (2, 2, 7))
WAVES = control.Fourier(HOME, *_half, frequency=0.3, ramp=1.0)
GAINS = control.parameter_scales(LIGHT, False) ** 2
EVEN = control.excitation_gains(
    LIGHT, WAVES, np.linspace(1, 1 + 1 / 0.3, 200, endpoint=False), KD, 1.0, friction=False
)


def circle(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A circle of 0.1 m, once in 2π seconds."""
    c, s = np.cos(t), np.sin(t)
    around = np.array([[1 - c, s, 0], [s, c, 0], [c, -s, 0]]) * 0.1
    return START + around[0], around[1], around[2]


def accelerometer(t: float, q: np.ndarray, qd: np.ndarray, tau: np.ndarray) -> np.ndarray:
    return ARM.forward_dynamics(q, qd, tau)


@dataclass(frozen=True)
class Case:
    name: str
    task: str
    """'hold', 'follow' or 'circle'."""
    law: Callable[[mcgee.Robot], control.Controller]
    """From what the law takes the arm for."""
    more: dict[str, Any] = dataclasses.field(default_factory=dict)


def pd(arm: mcgee.Robot) -> control.Controller:
    felt = np.diag(arm.mass_matrix(HOME))
    return control.PDGravity(arm, HOME, BAND**2 * felt, 2 * BAND * felt)


CASES = (
    Case("PDGravity", "hold", pd),
    Case("LQR", "hold", lambda a: control.LQR(a, HOME, Q=[1e3] * 7 + [10.0] * 7, R=0.01)),
    Case("ComputedTorque", "follow", lambda a: control.ComputedTorque(a, WAVES, 100, 20)),
    Case("SlotineLi", "follow", lambda a: control.SlotineLi(a, WAVES, BAND, KD)),
    Case(
        "AdaptiveComputedTorque",
        "follow",
        lambda a: control.AdaptiveComputedTorque(
            a, WAVES, 100, 20, GAINS, False, acceleration=accelerometer
        ),
    ),
    Case(
        "AdaptiveSlotineLi",
        "follow",
        lambda a: control.AdaptiveSlotineLi(
            a, WAVES, BAND, KD, EVEN, False, true_parameters=ARM.inertial_parameters
        ),
    ),
    Case("OperationalSpace", "circle", lambda a: control.OperationalSpace(a, circle, 100, 20)),
    Case(
        "HybridForcePosition",
        "circle",
        lambda a: control.HybridForcePosition(a, circle, [0, 0, 1], 20, WALL.force, 100, 20),
        {"disturbance": WALL},
    ),
)


def motion(case: Case, believed: mcgee.Robot) -> mcgee.Trajectory:
    return mcgee.simulate(
        ARM, HOME, np.zeros(7), DURATION, case.law(believed), rtol=1e-7, atol=1e-9, **case.more
    )


def error(run: mcgee.Trajectory) -> np.ndarray:
    """The largest joint's, or the distance, at each time."""
    e = run.log["error"]
    return np.linalg.norm(e, axis=1) if e.shape[1] == 3 else abs(e).max(1)


def tracking() -> str:
    rows = ""
    figure, axes = panels(
        ["Largest error of a joint [rad]", "Distance from the circle [m]"], 6, (2, 1)
    )
    for case in CASES:
        right, wrong = (motion(case, believed) for believed in (ARM, LIGHT))
        late = right.t > DURATION - LAST
        cells = [f"{error(run)[late].max():.1e}" for run in (right, wrong)]
        unit = "m" if case.task == "circle" else "rad"
        rows += f"| `{case.name}` | {case.task} | {cells[0]} {unit} | {cells[1]} {unit} |\n"
        print(rows.splitlines()[-1], flush=True)
        ax = axes[case.task == "circle"]
        ax.semilogy(wrong.t, _envelope(error(wrong)), label=case.name)
        for name in ("force_error", "prediction"):
            if name in wrong.log:
                size = abs(wrong.log[name].reshape(len(wrong.t), -1)).max(1)
                print(f"  {name}: first {size[:50].max():.2g}, last {size[late].max():.2g}")
        if "prediction" in wrong.log:
            print(learnt(wrong), flush=True)
    for ax in axes:
        ax.legend(loc="upper left", bbox_to_anchor=(1, 1))
    axes[1].set_xlabel("t [s]")
    save(figure, "tracking")
    return rows


def _envelope(e: np.ndarray, width: int = 41) -> np.ndarray:
    """The largest within 0.8 s before and after each time, so that zero crossings do not show."""
    padded = np.pad(e, width // 2, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, width).max(1)


def learnt(run: mcgee.Trajectory) -> str:
    """What is left of the parameters' error where a motion shows it, and where it does not."""
    dp = run.log["estimates"] - ARM.inertial_parameters
    Y = ARM.regressor(run.q, run.qd, run.qdd).reshape(-1, dp.shape[1])
    scaled = Y * control.parameter_scales(ARM, False)
    w, turn = np.linalg.svd(scaled, full_matrices=False)[1:]
    along = (dp[[0, -1]] / control.parameter_scales(ARM, False)) @ turn.T
    rows = ""
    for low, high in ((0.1, 1.1), (0.01, 0.1), (1e-3, 0.01)):
        chosen = (w / w[0] >= low) & (w / w[0] < high)
        left = np.linalg.norm(along[1, chosen]) / np.linalg.norm(along[0, chosen])
        rows += f"  {chosen.sum()} directions of {low} to {high}: {left:.2f} of the error left\n"
    return rows


STARTS = 100
SWINGS = {"acrobot": 40.0, "pendubot": 15.0, "cart_pole": 12.0}


def swings() -> str:
    rows, rng = "", np.random.default_rng(0)
    for name, duration in SWINGS.items():
        arm = mcgee.load(name)
        law = control.swing_up(arm)
        q, qd = rng.uniform(-np.pi, np.pi, (STARTS, 2)), rng.uniform(-1, 1, (STARTS, 2))
        run = mcgee.simulate(arm, q, qd, duration, law, method="rk4", dt=4e-3, step=0.04)
        since = control.upright_since(law, run)
        up = np.isfinite(since)
        median, last = np.median(since[up]), since[up].max()
        rows += f"| {name} | `swing_up` | {up.sum()} of {STARTS} | {median:.1f} | {last:.1f} |\n"
        print(rows.splitlines()[-1], flush=True)
    shaped = (
        ("inertia_wheel_pendulum", control.InertiaWheelIDAPBC, (np.pi, np.pi), 25.0),
        ("cart_pole", control.CartPoleIDAPBC, (1.0, 1.4), 15.0),
    )
    for name, make, reach, duration in shaped:
        arm = mcgee.load(name)
        q = rng.uniform(-1, 1, (STARTS, 2)) * reach
        run = mcgee.simulate(arm, q, 0 * q, duration, make(arm), method="rk4", dt=2e-3, step=0.01)
        off = abs(run.log["error"]).max(-1) < 0.05
        settled = np.array([run.t[np.flatnonzero(~row)[-1] + 1] for row in off if row[-1]])
        median, last = np.median(settled), settled.max()
        rows += (
            f"| {name} | `{make.__name__}` | {len(settled)} of {STARTS} | {median:.1f} | "
            f"{last:.1f} |\n"
        )
        print(rows.splitlines()[-1], flush=True)
    return rows


TABLES = {
    "| law | task | with the true masses | 20 % too light |\n|---|---|--:|--:|\n": tracking,
    "| arm | law | upright | median [s] | last [s] |\n|---|---|--:|--:|--:|\n": swings,
}

if __name__ == "__main__":
    for head, table in TABLES.items():
        fill(PAGE, head, table())
