"""The whole of a simulation: what is asked for, the march through time, what came of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from mcgee.control.controller import Array, Controller, as_controller
from mcgee.kernels import refuse_symbols
from mcgee.robot import Robot
from mcgee.simulate.flow import BOOKS, Flow
from mcgee.simulate.plant import Disturbance, Friction, Plant, Stops
from mcgee.simulate.progress import progress as shown
from mcgee.simulate.steps import ADAPTIVE, METHODS, StepError, adaptive, fixed
from mcgee.simulate.trajectory import Trajectory

MOST_TIMES = 50_000_000
"""Numbers in a trajectory beyond which it is refused."""


class SimulationError(RuntimeError):
    """A motion cannot go on.

    `trajectory` is what there is up to then.
    """

    def __init__(self, why: str, trajectory: Trajectory):
        super().__init__(why)
        self.trajectory = trajectory


def simulate(
    robot: Robot,
    q0: Any,
    qd0: Any,
    duration: float,
    controller: Any = None,
    *,
    method: str = "DOP853",
    step: float | None = None,
    dt: float = 1e-3,
    rtol: float = 1e-9,
    atol: float = 1e-10,
    friction: Friction | bool | None = None,
    stops: Stops | bool | None = None,
    effort_limits: bool = False,
    disturbance: Disturbance | None = None,
    progress: bool | None = None,
) -> Trajectory:
    """The motion of an arm from a state on, free or controlled, with the ledger of its energy.

    Args:
        q0, qd0: the state at t = 0 (..., n) [rad | m], [rad/s | m/s]; leading dimensions are a
            batch, whose members move each on its own
        duration: [s]
        controller: one of mcgee.control, a function tau(t, q, qd), or None for free motion
        method: one of SciPy's (DOP853, RK45, RK23, Radau, BDF, LSODA), 'rk4' with fixed steps, or
            'midpoint': fixed steps that keep the structure of mechanics, so that energy errs by a
            bounded amount however long the run
        step: seconds between the times of the result; a five-hundredth of the duration by default
        dt: longest step of the fixed methods [s]
        rtol, atol: tolerances of SciPy's methods
        friction: Friction(), or True for it; none by default
        stops: Stops() beyond the joints' limits, or True for them; none by default
        effort_limits: actuators give no more than the description's effort
        disturbance: efforts f(t, q, qd) -> (..., n) besides the controller's
        progress: whether to show how far it is; None: on a terminal, when it takes long
    Returns: a Trajectory; after Ctrl-C what there is of it, its status 'interrupted'
    Raises:
        ValueError: wrong shapes, numbers that are not finite, unknown names
        SimulationError: the motion runs away or has no next state, or a controller raises later
            than at the start; its .trajectory is kept
        ModuleNotFoundError: SciPy is not installed (mcgee[sim])
    """
    refuse_symbols(robot, "simulations")
    q, qd = state(robot, q0, qd0)
    times = grid(duration, step, q.size)
    _check(method, dt, rtol, atol)
    rubbing = Friction() if friction is True else friction or None
    stopping = Stops() if stops is True else stops or None
    plant = Plant(robot, rubbing, stopping, effort_limits, disturbance)
    law = as_controller(controller)
    many = q.ndim > 1 and method in ADAPTIVE
    runs: list[_Run] = []
    for k in np.ndindex(q.shape[:-1]) if many else [()]:
        runs.append(_Run(plant, law, q[k], qd[k], times, progress))
        failed = runs[-1].march(method, dt, rtol, atol)
        if failed or runs[-1].interrupted:
            break
    whole = _together(runs, q.shape[:-1]) if many else runs[0].trajectory(failed)
    if failed:
        raise SimulationError(f"robot '{robot.name}': {failed}", whole) from runs[-1].cause
    return whole


def state(robot: Robot, q0: Any, qd0: Any, finite: bool = True) -> tuple[Array, Array]:
    """
    Raises: ValueError: a wrong shape, or numbers that are not finite though they should be
    """
    found = []
    for name, given in (("q0", q0), ("qd0", qd0)):
        array = np.array(given, float)
        if array.shape[-1:] != (robot.n,):
            raise ValueError(
                f"{name} has shape {array.shape}, expected (..., {robot.n}) for robot "
                f"'{robot.name}'. Joints: {', '.join(robot.joint_names)}."
            )
        if finite and not np.isfinite(array).all():
            raise ValueError(f"{name} holds {array[~np.isfinite(array)][0]}, expected numbers.")
        found.append(array)
    try:
        q, qd = np.broadcast_arrays(*found)
    except ValueError:
        raise ValueError(
            f"q0 has shape {found[0].shape} and qd0 {found[1].shape}: their leading dimensions do "
            f"not broadcast."
        ) from None
    return q.copy(), qd.copy()


def grid(duration: float, step: float | None, size: int) -> Array:
    """The times of the result.

    Raises: ValueError: no positive finite number, or far too many times
    """
    positive("duration", duration)
    positive("step", duration if step is None else step)
    count = 500 if step is None else max(1, int(np.ceil(duration / step * (1 - 1e-9))))
    if count * size > MOST_TIMES:
        raise ValueError(
            f"{duration:g} s in steps of {step} s are {count:,} times of {size} numbers each; give "
            f"a longer step."
        )
    return np.linspace(0.0, duration, count + 1)


def positive(name: str, value: Any) -> None:
    """Raises: ValueError: no finite number above zero"""
    is_number = isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
    if not (is_number and 0 < float(value) < float("inf")):
        raise ValueError(f"{name} is {value!r}, expected a number above 0.")


def _check(method: str, dt: float, rtol: float, atol: float) -> None:
    if method not in METHODS:
        raise ValueError(f"method is {method!r}, expected one of: {', '.join(METHODS)}.")
    for name, value in (("dt", dt), ("rtol", rtol), ("atol", atol)):
        positive(name, value)
    if method in ADAPTIVE:
        try:
            import scipy.integrate  # noqa: F401
        except ModuleNotFoundError as missing:
            raise ModuleNotFoundError(
                f"Method {method} needs SciPy: install mcgee[sim], or take 'rk4' or 'midpoint'.",
                name=missing.name,
            ) from missing


class _Run:
    """One march through time."""

    def __init__(
        self,
        plant: Plant,
        law: Controller | None,
        q: Array,
        qd: Array,
        times: Array,
        show: bool | None,
    ):
        z = law.start(q, qd) if law is not None else np.zeros((*q.shape[:-1], 0))
        self.flow = Flow(plant, law, z.shape[-1])
        self.times, self.show = times, show
        self.states = [self.flow.begin(q, qd, np.asarray(z, float))]
        self.held: list[Any] = []
        self.interrupted = False
        self.cause: Exception | None = None

    def march(self, method: str, dt: float, rtol: float, atol: float) -> str:
        """Until the end, or what stops it; why, or nothing."""
        start = self.states[0]
        steps: Iterator[Array]
        if method in ADAPTIVE:
            steps = adaptive(self.flow, start, self.times, method, rtol, atol)
        else:
            steps = fixed(self.flow, start, self.times, method, dt)
        self.flow.sample(0.0, start)
        self.held.append(self.flow.held)
        try:
            with shown(self.show, self.times) as at:
                for y in steps:
                    self.states.append(y)
                    self.held.append(self.flow.held)
                    at(len(self.states) - 1)
        except KeyboardInterrupt:
            self.interrupted = True
        except StepError as error:
            return str(error)
        except Exception as error:  # a controller's or a disturbance's own
            if len(self.states) == 1:
                raise
            self.cause = error
            after = self.times[len(self.states) - 1]
            return f"{type(error).__name__} after t = {after:.6g} s: {error}"
        return ""

    def trajectory(self, failed: str = "") -> Trajectory:
        flow, robot = self.flow, self.flow.plant.robot
        y = np.stack(self.states, axis=-2)
        times = self.times[: len(self.states)]
        q, qd, _, books = flow.apart(y)
        efforts, logs = [], []
        for k, t in enumerate(times):
            flow.held = self.held[k]
            now = flow.apart(self.states[k])[:3]
            efforts.append(flow.efforts(t, *now))
            logs.append(flow.controller.log(t, *now) if flow.controller is not None else {})
        applied, friction, stops, disturbance = (
            np.stack(x, axis=-2) for x in zip(*efforts, strict=True)
        )
        total = applied - friction + stops + disturbance
        work, dissipated, stopped, disturbed = (books[..., i, :] for i in range(len(BOOKS)))
        lead = q.ndim - 2
        return Trajectory(
            robot=robot,
            t=times,
            q=q,
            qd=qd,
            qdd=robot.forward_dynamics(q, qd, total),
            tau=applied,
            friction=friction,
            stops=stops,
            disturbance=disturbance,
            kinetic=robot.kinetic_energy(q, qd),
            potential=robot.potential_energy(q),
            work=work,
            dissipated=dissipated,
            stopped=stopped,
            disturbed=disturbed,
            log={name: np.stack([log[name] for log in logs], axis=lead) for name in logs[0]},
            status="interrupted" if self.interrupted else failed or "complete",
        )


def _together(runs: list[_Run], lead: tuple[int, ...]) -> Trajectory:
    """The members of a batch in one; cut to the shortest where one ended early."""
    made = [run.trajectory() for run in runs]
    shortest = min(len(one.t) for one in made)
    if len(made) < math.prod(lead):
        lead = (len(made),)

    def joined(name: str) -> Array:
        parts = [np.asarray(getattr(one, name))[:shortest] for one in made]
        stacked = np.stack(parts)
        return stacked.reshape(*lead, *stacked.shape[1:])

    first = made[0]
    names = [f for f in first.__dataclass_fields__ if f not in ("robot", "t", "log", "status")]
    log = {
        key: np.stack([one.log[key][:shortest] for one in made]).reshape(
            *lead, shortest, *first.log[key].shape[1:]
        )
        for key in first.log
    }
    status = "interrupted" if runs[-1].interrupted else made[-1].status
    arrays = {name: joined(name) for name in names}
    return Trajectory(first.robot, first.t[:shortest], **arrays, log=log, status=status)
