"""The whole of a simulation: what is asked for, the march through time, what came of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, TypeVar

import numpy as np

from mcgee.control.controller import Array, Controller, as_controller
from mcgee.control.gains import numbers, positive
from mcgee.kernels import refuse_symbols
from mcgee.robot import Robot
from mcgee.simulate.flow import BOOKS, Flow
from mcgee.simulate.plant import Disturbance, EffortError, Efforts, Friction, Plant, Stops
from mcgee.simulate.progress import progress as shown
from mcgee.simulate.steps import (
    ADAPTIVE,
    METHODS,
    StepError,
    adaptive,
    check_speed,
    fixed,
    singular,
)
from mcgee.simulate.trajectory import Trajectory

MOST_TIMES = 50_000_000
"""Numbers in a trajectory, and samples, beyond which it is refused."""

Kind = TypeVar("Kind", Friction, Stops)


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
            batch, whose members move each on its own; where one fails the motion ends there
        duration: [s]
        controller: one of mcgee.control, a function tau(t, q, qd), or None for free motion
        method: one of SciPy's (DOP853, RK45, RK23, Radau, BDF, LSODA), 'rk4' with fixed steps, or
            'midpoint': fixed steps that keep the structure of mechanics, so that energy errs by a
            bounded amount however long the run
        step: seconds between the times of the result, or a little less, so that the duration is a
            multiple; a five-hundredth of it by default
        dt: longest step of the fixed methods [s]
        rtol, atol: tolerances of SciPy's methods
        friction: Friction(), or True for it; none by default
        stops: Stops() beyond the joints' limits, or True for them; none by default
        effort_limits: actuators give no more than the description's effort
        disturbance: efforts f(t, q, qd) -> (..., n) besides the controller's
        progress: whether to show how far it is; None: on a terminal, when it takes long
    Returns: a Trajectory; after Ctrl-C what there is of it, its status 'interrupted'. Where a batch
        ends early, the members that moved until then stand in a row, cut to the shortest
    Raises:
        ValueError: wrong shapes, numbers that are not finite, unknown names, no start for a motion
        SimulationError: the motion runs away or has no next state, or a controller raises later
            than at the start; its .trajectory is kept
        ModuleNotFoundError: SciPy is not installed (mcgee[sim])
    """
    refuse_symbols(robot, "simulations")
    q, qd = state(robot, q0, qd0)
    times = grid(duration, step, q.size)
    _check(method, dt, rtol, atol)
    rubbing, stopping = _chosen("friction", Friction, friction), _chosen("stops", Stops, stops)
    plant = Plant(robot, rubbing, stopping, effort_limits, disturbance)
    law = as_controller(controller)
    _check_samples(law, duration)
    many = q.ndim > 1 and method in ADAPTIVE
    runs: list[_Run] = []
    for k in np.ndindex(q.shape[:-1]) if many else [()]:
        runs.append(_Run(plant, law, q[k], qd[k], times, progress))
        failed = runs[-1].march(method, dt, rtol, atol)
        if failed or runs[-1].interrupted:
            break
    whole = _together(runs, q.shape[:-1], failed) if many else runs[0].trajectory(failed)
    if failed:
        raise SimulationError(f"robot '{robot.name}': {failed}", whole) from runs[-1].cause
    return whole


def state(robot: Robot, q0: Any, qd0: Any, finite: bool = True) -> tuple[Array, Array]:
    """
    Raises: ValueError: a wrong shape, or numbers that are not finite though they should be
    """
    found = []
    for name, given in (("q0", q0), ("qd0", qd0)):
        array = numbers(name, given)
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
    if finite and not q.size:
        raise ValueError(f"q0 and qd0 have shape {q.shape}: there is no state to start from.")
    return q.copy(), qd.copy()


def grid(duration: float, step: float | None, size: int) -> Array:
    """The times of the result.

    Raises: ValueError: no positive finite number, or far too many times
    """
    positive("duration", duration, "s")
    positive("step", duration if step is None else step, "s")
    count = 500 if step is None else max(1, int(np.ceil(duration / step * (1 - 1e-9))))
    if count * size > MOST_TIMES:
        raise ValueError(
            f"{duration:g} s in steps of {step} s are {count:,} times of {size} numbers each; give "
            f"a longer step."
        )
    return np.linspace(0.0, duration, count + 1)


def _chosen(name: str, kind: type[Kind], given: Any) -> Kind | None:
    if given is None or given is False:
        return None
    if given is True:
        return kind()
    if not isinstance(given, kind):
        raise ValueError(f"{name} is {given!r}, expected True, False or {kind.__name__}(…).")
    return given


def _check_samples(law: Controller | None, duration: float) -> None:
    """Raises: ValueError: a period that is none, or far too short"""
    if law is None or law.period is None:
        return
    period = positive("the controller's period", law.period, "s")
    if duration / period > MOST_TIMES:
        raise ValueError(
            f"the controller's period is {period:g} s, expected at least {duration / MOST_TIMES:g} "
            f"s for {duration:g} s."
        )


def _check(method: str, dt: float, rtol: float, atol: float) -> None:
    if method not in METHODS:
        raise ValueError(f"method is {method!r}, expected one of: {', '.join(METHODS)}.")
    for name, value in (("dt", dt), ("rtol", rtol), ("atol", atol)):
        positive(name, value, "")
    if method in ADAPTIVE:
        try:
            import scipy.integrate  # noqa: F401
        except ModuleNotFoundError as missing:
            raise ModuleNotFoundError(
                f"Method {method} needs SciPy: install mcgee[sim], or take 'rk4' or 'midpoint'.",
                name=missing.name,
            ) from missing


class _Run:
    """One march through time, and what it keeps."""

    def __init__(
        self,
        plant: Plant,
        law: Controller | None,
        q: Array,
        qd: Array,
        times: Array,
        show: bool | None,
    ):
        z = np.zeros((*q.shape[:-1], 0)) if law is None else numbers("start", law.start(q, qd))
        if z.shape[:-1] != q.shape[:-1] or z.ndim != q.ndim:
            raise ValueError(
                f"controller {type(law).__name__} starts with a state of shape {z.shape}, expected "
                f"{(*q.shape[:-1], 'm')}."
            )
        self.flow = Flow(plant, law, z.shape[-1])
        self.times, self.show = times, show
        self.first = self.flow.begin(q, qd, z)
        self.states: list[Array] = []
        self.efforts: list[Efforts] = []
        self.logs: list[dict[str, Array]] = []
        self.interrupted = False
        self.cause: Exception | None = None

    def march(self, method: str, dt: float, rtol: float, atol: float) -> str:
        """Until the end, or what stops it; why, or nothing.

        Raises: ValueError: no motion goes on from the start; and what the controller raises there
        """
        self._start()
        steps: Iterator[Array]
        if method in ADAPTIVE:
            steps = adaptive(self.flow, self.first, self.times, method, rtol, atol)
        else:
            steps = fixed(self.flow, self.first, self.times, method, dt)
        try:
            with shown(self.show, self.times) as at:
                for y in steps:
                    self._keep(y)
                    at(len(self.states) - 1)
        except KeyboardInterrupt:
            self.interrupted = True
        except StepError as error:
            return str(error)
        except Exception as error:  # a controller's or a disturbance's own
            self.cause = error
            after = self.times[len(self.states) - 1]
            kind = f"{type(error).__name__} after t = {after:.6g} s: "
            return str(error) if isinstance(error, EffortError) else f"{kind}{error}"
        return ""

    def _start(self) -> None:
        flow, y = self.flow, self.first
        try:
            check_speed(flow, 0.0, y)
        except StepError as error:
            raise ValueError(f"robot '{flow.plant.robot.name}': {error}") from None
        flow.sample(0.0, y)
        self._keep(y)
        with np.errstate(all="ignore"):
            slope = flow(0.0, y)
        if not np.isfinite(slope).all():
            raise ValueError(
                f"robot '{flow.plant.robot.name}' has no accelerations at the start, or the "
                f"controller's state has no slope.{singular(flow, y)}"
            )

    def _keep(self, y: Array) -> None:
        """A state, with the efforts that act there and what the controller says of itself."""
        flow, t = self.flow, float(self.times[len(self.states)])
        q, qd, z, _ = flow.apart(y)
        efforts = flow.efforts(t, q, qd, z)
        log = {} if flow.controller is None else self._logged(flow.controller, t, (q, qd, z))
        self.states.append(y)
        self.efforts.append(efforts)
        self.logs.append(log)

    def _logged(
        self, law: Controller, t: float, state: tuple[Array, Array, Array]
    ) -> dict[str, Array]:
        log = {name: np.asarray(value) for name, value in dict(law.log(t, *state)).items()}
        first = self.logs[0] if self.logs else log
        if {k: v.shape for k, v in log.items()} != {k: v.shape for k, v in first.items()}:
            raise ValueError(
                f"controller {type(law).__name__} logs other names or shapes at t = {t:.6g} s than "
                f"at the start."
            )
        return log

    def trajectory(self, failed: str = "") -> Trajectory:
        flow, robot = self.flow, self.flow.plant.robot
        y = np.stack(self.states, axis=-2)
        q, qd, _, books = flow.apart(y)
        applied, friction, stops, disturbance = (
            np.stack(x, axis=-2) for x in zip(*self.efforts, strict=True)
        )
        total = applied - friction + stops + disturbance
        work, dissipated, stopped, disturbed = (books[..., i, :] for i in range(len(BOOKS)))
        lead, logs = q.ndim - 2, self.logs
        return Trajectory(
            robot=robot,
            t=self.times[: len(self.states)],
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


def _together(runs: list[_Run], lead: tuple[int, ...], failed: str) -> Trajectory:
    """The members of a batch in one; cut to the shortest where one ended early."""
    made = [run.trajectory() for run in runs[:-1]] + [runs[-1].trajectory(failed)]
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
    arrays = {name: joined(name) for name in names}
    return Trajectory(first.robot, first.t[:shortest], **arrays, log=log, status=made[-1].status)
