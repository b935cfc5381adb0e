"""From one state to the next: SciPy's adaptive integrators, and two with fixed steps.

Each gives the states at given times, one after the other, so that whoever stops early keeps what
there is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from mcgee.control.controller import Array
from mcgee.simulate.flow import Flow

ADAPTIVE = ("DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA")
FIXED = ("rk4", "midpoint")
METHODS = (*ADAPTIVE, *FIXED)
EXPLICIT = ("DOP853", "RK45", "RK23")
WITH_JACOBIAN = ("Radau", "BDF")

FASTEST = 1e4
"""Joint speeds that no arm has [rad/s | m/s]."""

SETTLED, CLOSE = 4e-16, 1e-12
"""The relative change of the implicit midpoint's iteration that ends it, and that may end it when
rounding alone is left to change."""

MOST_TURNS = 100

NEARLY = 1e-12
"""Of M's eigenvalues, the smallest over the largest below which M counts as singular."""


class StepError(Exception):
    """An integrator cannot go on; its text says why."""


def adaptive(
    flow: Flow, y: Array, times: Array, method: str, rtol: float, atol: float
) -> Iterator[Array]:
    """States at times[1:] by one of SciPy's methods.

    The explicit ones step onto every time; the others interpolate, which errs by more than a step.
    """
    from scipy import integrate

    first, period = None, flow.period
    more = {"jac": flow.jacobian} if method in WITH_JACOBIAN else {}
    for t0, t1, inside in stretches(period, times):
        flow.sample(t0, y)
        start = None if first is None else min(first, t1 - t0)
        solver: Any = getattr(integrate, method)(
            flow, t0, y, t1, rtol=rtol, atol=atol, first_step=start, **more
        )
        march = _onto if method in EXPLICIT else _across
        yield from march(solver, flow, inside.tolist(), t1)
        y = solver.y
        if period is not None and solver.step_size:
            first = min(solver.step_size, period)


def _onto(solver: Any, flow: Flow, inside: list[float], end: float) -> Iterator[Array]:
    for k, t in enumerate(ends(inside, end)):
        solver.t_bound, solver.status = t, "running"
        while solver.status == "running":
            before = solver.h_abs
            _step(solver, flow)
        solver.h_abs = max(solver.h_abs, before)  # the last step was cut short
        if k < len(inside):
            yield solver.y


def _across(solver: Any, flow: Flow, inside: list[float], end: float) -> Iterator[Array]:
    k = 0
    while solver.status == "running":
        _step(solver, flow)
        while k < len(inside) and inside[k] < solver.t:
            yield solver.dense_output()(inside[k])
            k += 1
        if k < len(inside) and inside[k] == solver.t:
            yield solver.y
            k += 1


def _step(solver: Any, flow: Flow) -> None:
    with np.errstate(all="ignore"):
        said = solver.step()
    if solver.status == "failed" or not np.isfinite(solver.y).all():
        raise StepError(_why(flow, solver.t, solver.y, said))
    check_speed(flow, solver.t, solver.y)


def check_speed(flow: Flow, t: float, y: Array) -> None:
    """Raises: StepError: a joint runs away, where steps would become ever smaller"""
    qd = flow.apart(y)[1]
    if abs(qd).max(initial=0) > FASTEST:
        k = int(abs(qd).reshape(-1, flow.n).max(0).argmax())
        raise StepError(
            f"joint '{flow.plant.robot.joint_names[k]}' runs away: its speed is beyond "
            f"{FASTEST:g} at t = {t:.6g} s."
        )


def _why(flow: Flow, t: float, y: Array, said: str | None) -> str:
    if not np.isfinite(y).all():
        return f"the state is not finite after t = {t:.6g} s."
    largest, reason = float(abs(y).max()), str(said or "no reason given").rstrip(".")
    return (
        f"the integrator cannot go on at t = {t:.6g} s, where the largest number of the state is "
        f"{largest:.3g}: {reason}.{singular(flow, y)}"
    )


def singular(flow: Flow, y: Array) -> str:
    """A sentence where M(q) cannot be inverted, or hardly; else nothing."""
    q = flow.apart(y)[0].reshape(-1, flow.n)
    w = np.linalg.eigvalsh(flow.plant.robot.mass_matrix(q))
    k = int((w[:, 0] / w[:, -1]).argmin())
    if w[k, 0] > NEARLY * w[k, -1]:
        return ""
    listed = ", ".join(f"{x:.4g}" for x in q[k])
    return f" M(q) is singular there, at q = ({listed}): some joint moves no inertia."


def stretches(period: float | None, times: Array) -> Iterator[tuple[float, float, Array]]:
    """From sample to sample, each with the times in it, its end included."""
    start, end = float(times[0]), float(times[-1])
    if period is None:
        yield start, end, times[1:]
        return
    count = max(1, int(np.ceil((end - start) / period * (1 - 1e-12))))
    a, i = start, 1
    for k in range(1, count + 1):
        b = end if k == count else _snapped(start + k * period, times)
        j = int(np.searchsorted(times, b, "right"))
        yield a, b, times[i:j]
        a, i = b, j


def _snapped(edge: float, times: Array) -> float:
    """The time of the grid that an edge is, but for rounding."""
    k = int(np.searchsorted(times, edge))
    near = min(times[max(k - 1, 0)], times[min(k, len(times) - 1)], key=lambda x: abs(x - edge))
    return float(near) if abs(near - edge) <= 1e-9 * max(1.0, abs(edge)) else edge


def ends(inside: list[float], end: float) -> list[float]:
    """The times in a stretch and its end."""
    return inside if inside and inside[-1] == end else [*inside, end]


# -- fixed steps ----------------------------------------------------------------------------------

Advance = Callable[[Flow, float, Array, float], Array]


def fixed(flow: Flow, y: Array, times: Array, method: str, dt: float) -> Iterator[Array]:
    """States at times[1:], by equal steps of at most dt between them and the samples."""
    advance = {"rk4": runge_kutta, "midpoint": midpoint}[method]
    for t0, t1, part in stretches(flow.period, times):
        flow.sample(t0, y)
        inside = part.tolist()
        for i, (a, b) in enumerate(pairwise([t0, *ends(inside, t1)])):
            count = max(1, int(np.ceil((b - a) / dt * (1 - 1e-9))))
            h = (b - a) / count
            for k in range(count):
                with np.errstate(all="ignore"):
                    y = advance(flow, a + k * h, y, h)
            if not np.isfinite(y).all():
                raise StepError(f"the state is not finite after t = {a:.6g} s.")
            check_speed(flow, b, y)
            if i < len(inside):
                yield y


def runge_kutta(flow: Flow, t: float, y: Array, h: float) -> Array:
    """The classical method of order four."""
    k1 = flow(t, y)
    k2 = flow(t + h / 2, y + h / 2 * k1)
    k3 = flow(t + h / 2, y + h / 2 * k2)
    k4 = flow(t + h, y + h * k3)
    return y + h / 6 * (k1 + 2 * (k2 + k3) + k4)


def midpoint(flow: Flow, t: float, y: Array, h: float) -> Array:
    """The implicit midpoint of Hamilton's equations: symplectic, and its energy error bounded.

    With v the velocity at the middle, q1 = q0 + h v, the momentum there is M v =
    p0 + h/2 (½ ∂(vᵀ M v)/∂q − g + efforts), of which ½ ∂(vᵀ M v)/∂q = C(q, v)ᵀ v by Christoffel's
    symbols. Momenta of coordinates that nothing depends on are kept to rounding.

    Source: Hairer, Lubich & Wanner 2006, Geometric Numerical Integration, chapter VI
    """
    robot = flow.plant.robot
    q0, qd0, z0, books = flow.apart(y)
    p0 = _times(robot.mass_matrix(q0), qd0)
    v, z, last = qd0 + h / 2 * flow(t, y)[..., flow.n : 2 * flow.n], z0, np.inf
    for _ in range(MOST_TURNS):
        q = q0 + h / 2 * v
        e = flow.efforts(t + h / 2, q, v, z)
        force = _times(_turned(robot.coriolis_matrix(q, v)), v) - robot.gravity(q) + e.total
        new = _times(robot.mass_matrix_inverse(q), p0 + h / 2 * force)
        z = z0 + h / 2 * flow.controller_slope(t + h / 2, q, v, z)
        if not np.isfinite(new).all():
            raise StepError(f"the state is not finite after t = {t:.6g} s.{singular(flow, y)}")
        size = max(1e-3, abs(new).max(initial=0))
        change, v = abs(new - v).max(initial=0), new
        if change <= SETTLED * size or last <= change <= CLOSE * size:
            break
        last = change
    else:
        raise StepError(
            f"the implicit step of {h:g} s does not settle at t = {t:.6g} s; take a shorter dt."
            f"{singular(flow, y)}"
        )
    q1 = q0 + h * v
    qd1 = _times(robot.mass_matrix_inverse(q1), p0 + h * force)
    powers = np.stack([x * v for x in (e.applied, e.friction, e.stops, e.disturbance)], axis=-2)
    books = books + h * powers
    lead = q1.shape[:-1]
    return np.concatenate([q1, qd1, 2 * z - z0, books.reshape(*lead, -1)], axis=-1)


def _times(M: Array, v: Array) -> Array:
    return (M @ v[..., None])[..., 0]


def _turned(M: Array) -> Array:
    return np.swapaxes(M, -1, -2)
