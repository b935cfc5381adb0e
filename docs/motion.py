"""Writes the tables and the figure of docs/simulate.md: what integrators lose in free motion.

python docs/motion.py  (with matplotlib)
"""

from __future__ import annotations

import time
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
from curves import panels, save
from tables import fill

import mcgee

PAGE = Path(__file__).parent / "simulate.md"
ARMS = ("planar_2r", "puma560", "panda")
METHODS: dict[str, dict[str, float]] = {
    "DOP853": {},
    "RK45": {},
    "Radau": {"rtol": 1e-8, "atol": 1e-9},
    "rk4": {"dt": 1e-3},
    "midpoint": {"dt": 1e-3},
}
DURATION = 100.0
PANDA = Path(mcgee.__file__).parent / "robots" / "panda.urdf"


def start(name: str) -> tuple[mcgee.Robot, np.ndarray]:
    arm = mcgee.load(name)
    return arm, np.linspace(0.3, 0.6, arm.n)


def drift() -> str:
    """|E(t) − E(0)| over the largest kinetic energy: at the end, and its largest."""
    rows = ""
    for method, more in METHODS.items():
        cells = []
        for name in ARMS:
            arm, q = start(name)
            begin = time.perf_counter()
            run = mcgee.simulate(arm, q, 0 * q, DURATION, method=method, step=0.1, **more)
            size = run.kinetic.max()
            error = abs(run.residual) / size
            cells.append(f"{error[-1]:.0e} ({error.max():.0e})")
            print(method, name, cells[-1], f"{time.perf_counter() - begin:.1f} s", flush=True)
        rows += f"| `{method}` | {' | '.join(cells)} |\n"
    return rows


def theorem() -> str:
    """Without gravity T is constant; with it the momentum about a vertical first axis is."""
    rows = ""
    for name in ARMS:
        arm, q = start(name)
        qd = np.linspace(1.0, -1.0, arm.n)
        free = arm.replace(gravity_vector=(0, 0, 0))
        run = mcgee.simulate(free, q, qd, 20.0, rtol=1e-12, atol=1e-12)
        swing = abs(run.kinetic / run.kinetic[0] - 1).max()
        # what the inertia that joint 1 feels does meanwhile
        felt = run.robot.mass_matrix(run.q)[:, 0, 0]
        cells = [f"{swing:.0e}", f"{felt.min():.2f} to {felt.max():.2f}"]
        if name == "planar_2r":
            cells.append("–")
        else:
            run = mcgee.simulate(arm, q, qd, 20.0, method="midpoint", dt=1e-3)
            p = (arm.mass_matrix(run.q) @ run.qd[..., None])[:, 0, 0]
            cells.append(f"{abs(p / p[0] - 1).max():.0e}")
        rows += f"| {name} | {' | '.join(cells)} |\n"
        print(rows.splitlines()[-1], flush=True)
    return rows


def exchange() -> None:
    """Draws what a planar 2R arm's kinetic energy is made of while nothing works on it."""
    arm = mcgee.arms.planar_2r(g0=0)
    run = mcgee.simulate(arm, [0.0, 2.6], [0.3, 3.0], 8.0, rtol=1e-12, atol=1e-12)
    M, (v1, v2) = arm.mass_matrix(run.q), run.qd.T
    figure, (energies, inertia) = panels(
        ["Without gravity the kinetic energy stays [J] …", "… and the inertia changes [kg·m²]"], 5
    )
    shares = {
        "½ M11 qd1²": M[:, 0, 0] * v1**2 / 2,
        "M12 qd1 qd2": M[:, 0, 1] * v1 * v2,
        "½ M22 qd2²": M[:, 1, 1] * v2**2 / 2,
    }
    for name, share in shares.items():
        energies.plot(run.t, share, label=name)
    energies.plot(run.t, run.kinetic, "k", lw=2, label="T, their sum")
    inertia.plot(run.t, M[:, 0, 0], label="M11")
    inertia.plot(run.t, M[:, 0, 1], label="M12")
    inertia.plot(run.t, M[:, 1, 1], label="M22")
    inertia.set_xlabel("t [s]")
    for ax in (energies, inertia):
        ax.legend(loc="upper right", ncols=4)
        ax.set_ylim(top=ax.get_ylim()[1] * 1.2)
    save(figure, "theorem")


TIMES = (0.5, 1.0, 1.5, 2.0, 3.0)
STEP, STEPS = 1e-3, 500
"""Seconds a step, and steps from one time to the next that may be looked at."""
AT = [round(t / STEP / STEPS) for t in TIMES]


def others() -> str:
    """How far off the motions of Pinocchio and MuJoCo are, and one of a nudged arm."""
    arm, q = start("panda")
    motions = {
        "Pinocchio's `aba`": pinocchio_motion(q),
        "MuJoCo's RK4": mujoco_motion(q),
        "mcgee, q1 and q2 nudged by 1e-15": ours(arm, q + 1e-15 * (np.arange(7) < 2)),
    }
    here, rows = ours(arm, q), ""
    for name, there in motions.items():
        cells = [f"{abs(here[k] - there[k]).max():.0e}" for k in AT]
        rows += f"| {name} | {' | '.join(cells)} |\n"
        print(rows.splitlines()[-1], flush=True)
    return rows


def ours(arm: mcgee.Robot, q: np.ndarray) -> np.ndarray:
    """q at every half second."""
    return mcgee.simulate(arm, q, 0 * q, TIMES[-1], method="rk4", dt=STEP, step=STEP * STEPS).q


def pinocchio_motion(q: np.ndarray) -> np.ndarray:
    model = pinocchio.buildModelFromUrdf(str(PANDA))
    data, tau, found = model.createData(), np.zeros(7), [q]

    def slope(x: np.ndarray) -> np.ndarray:
        return np.concatenate([x[7:], pinocchio.aba(model, data, x[:7], x[7:], tau)])

    x, h = np.concatenate([q, 0 * q]), STEP
    for k in range(AT[-1] * STEPS):
        k1 = slope(x)
        k2 = slope(x + h / 2 * k1)
        k3 = slope(x + h / 2 * k2)
        k4 = slope(x + h * k3)
        x = x + h / 6 * (k1 + 2 * (k2 + k3) + k4)
        if (k + 1) % STEPS == 0:
            found.append(x[:7])
    return np.array(found)


def mujoco_motion(q: np.ndarray) -> np.ndarray:
    model = mujoco.MjModel.from_xml_string(PANDA.read_text())
    model.opt.timestep, model.opt.integrator = STEP, mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.dof_damping[:] = model.dof_frictionloss[:] = 0
    data, found = mujoco.MjData(model), [q]
    data.qpos[:] = q
    for _ in range(AT[-1]):
        for _ in range(STEPS):
            mujoco.mj_step(model, data)
        found.append(data.qpos.copy())
    return np.array(found)


DRIFT = "| drift over 100 s, at the end (largest) | planar_2r | puma560 | panda |\n"
THEOREM = "| 20 s | T off by | joint 1 feels [kg·m²] | momentum off by |\n"
OTHERS = f"| largest difference of q after … s | {' | '.join(f'{t:g}' for t in TIMES)} |\n"
TABLES = {
    f"{head}|---{'|--:' * columns}|\n": make
    for head, columns, make in ((DRIFT, 3, drift), (THEOREM, 3, theorem), (OTHERS, 5, others))
}

if __name__ == "__main__":
    exchange()
    for head, table in TABLES.items():
        fill(PAGE, head, table())
