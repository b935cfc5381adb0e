"""A motion, and the ledger of its energy."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.control.controller import Array
from mcgee.robot import Robot
from mcgee.simulate import files

if TYPE_CHECKING:
    import pandas

ARRAYS = (
    *("t", "q", "qd", "qdd", "tau", "friction", "stops", "disturbance"),
    *("kinetic", "potential", "work", "dissipated", "stopped", "disturbed"),
)


@dataclass(frozen=True, repr=False)
class Trajectory:
    """What `simulate` gives. Arrays are float64 in SI units; leading dimensions are those of q0.

    The ledger: what T + P gained is what the actuators, the stops and the disturbance worked, less
    what friction dissipated; `residual` is what is missing, the integrator's error.
    """

    robot: Robot
    t: Array
    """(times,) [s]"""
    q: Array
    """(..., times, n) [rad | m]; so qd, qdd and the efforts."""
    qd: Array
    qdd: Array
    tau: Array
    """By the actuators, after their limits [N·m | N]."""
    friction: Array
    """Against the motion [N·m | N]."""
    stops: Array
    disturbance: Array
    kinetic: Array
    """(..., times) [J]"""
    potential: Array
    work: Array
    """Of each actuator since the start (..., times, n) [J]; so the next three."""
    dissipated: Array
    """By friction."""
    stopped: Array
    """By the stops on the arm: negative while they hold or have lost energy."""
    disturbed: Array
    log: Mapping[str, Array] = field(default_factory=dict)
    """What the controller tells of itself (..., times, …)."""
    status: str = "complete"
    """'complete', 'interrupted', or why the motion ends early."""

    @property
    def n(self) -> int:
        return self.robot.n

    @property
    def complete(self) -> bool:
        return self.status == "complete"

    @cached_property
    def energy(self) -> Array:
        """T + P (..., times) [J]."""
        return self.kinetic + self.potential

    @cached_property
    def residual(self) -> Array:
        """Energy that came from nowhere (..., times) [J]."""
        given = (self.work + self.stopped + self.disturbed - self.dissipated).sum(-1)
        return self.energy - self.energy[..., :1] - given

    @property
    def end(self) -> tuple[Array, Array]:
        """The last (q, qd)."""
        return self.q[..., -1, :], self.qd[..., -1, :]

    def __repr__(self) -> str:
        lead = "" if self.q.ndim == 2 else f", batch {self.q.shape[:-2]}"
        return (
            f"Trajectory of '{self.robot.name}': {self.t[-1]:g} s in {len(self.t)} times{lead}, "
            f"{self.status}, energy residual {abs(self.residual).max():.2g} J"
        )

    def to_dict(self) -> dict[str, Any]:
        """Lists of numbers by name, the joints' names among them, ready for JSON."""
        arrays = {name: getattr(self, name).tolist() for name in ARRAYS}
        logged = {name: np.asarray(value).tolist() for name, value in self.log.items()}
        named = {"robot": self.robot.name, "joints": list(self.robot.joint_names)}
        return named | {"status": self.status} | arrays | {"log": logged}

    def to_dataframe(self) -> pandas.DataFrame:
        """A row a time; columns t, q_JOINT, …, T, P, residual and the log's.

        Raises:
            ValueError: a batch
            ModuleNotFoundError: pandas is not installed (mcgee[table])
        """
        return files.dataframe(self)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the arrays: .npz (NumPy), .csv, or .parquet (mcgee[table]).

        Returns: the path, written whole or not at all
        Raises: ValueError: another ending, a batch in a table, a path that cannot be written
        """
        return files.save(self, Path(path))

    def figure(self) -> Any:
        """Positions, velocities, efforts and the ledger over time, as a plotly Figure."""
        from mcgee.simulate.plots import figure_of

        return figure_of(self)

    def to_html(self, path: str | os.PathLike[str]) -> Path:
        """Write a page with the arm in motion and its curves, that needs no network.

        Returns: the path, written whole or not at all
        Raises:
            ValueError: a batch, a path that cannot be written
            ModuleNotFoundError: Plotly is not installed (mcgee[plot])
        """
        from mcgee.simulate.page import page
        from mcgee.writing import write_whole

        return write_whole(Path(path), "the page", lambda: page(self))
