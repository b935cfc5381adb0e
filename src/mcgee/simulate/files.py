"""Trajectories in files: NumPy's, tables of text, Parquet."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.writing import write_whole

if TYPE_CHECKING:
    from types import ModuleType

    import pandas

    from mcgee.simulate.trajectory import Trajectory

JOINTWISE = (
    *("q", "qd", "qdd", "tau", "friction", "stops", "disturbance"),
    *("work", "dissipated", "stopped", "disturbed"),
)


def columns(trajectory: Trajectory) -> dict[str, np.ndarray]:
    """A table: t, q_JOINT, …, T, P, residual, and the log.

    Raises: ValueError: a batch
    """
    if trajectory.q.ndim != 2:
        raise ValueError(
            f"a batch of shape {trajectory.q.shape[:-2]} is no table; write it as .npz, or one "
            f"member of it."
        )
    found = {"t": trajectory.t}
    for name in JOINTWISE:
        array = getattr(trajectory, name)
        for k, joint in enumerate(trajectory.robot.joint_names):
            found[f"{name}_{joint}"] = array[:, k]
    found |= {"T": trajectory.kinetic, "P": trajectory.potential, "residual": trajectory.residual}
    for name, array in trajectory.log.items():
        flat = array.reshape(len(trajectory.t), -1)
        for k in range(flat.shape[1]):
            column = name if array.ndim == 1 else f"{name}_{k + 1}"
            found[f"log_{column}" if column in found else column] = flat[:, k]
    return found


def dataframe(trajectory: Trajectory) -> pandas.DataFrame:
    table = columns(trajectory)
    try:
        import pandas as pd
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(
            "Data frames need pandas: install mcgee[table].", name=missing.name
        ) from missing
    return pd.DataFrame(table)


def save(trajectory: Trajectory, path: Path) -> Path:
    make = maker(path)
    return write_whole(path, "the trajectory", lambda: make(trajectory))


def maker(path: Path) -> Callable[[Trajectory], bytes]:
    """What makes the file's content.

    Raises: ValueError: its name has another ending
    """
    makers: dict[str, Callable[[Trajectory], bytes]] = {
        ".npz": _npz,
        ".csv": _csv,
        ".parquet": _parquet,
    }
    if path.suffix not in makers:
        raise ValueError(
            f"cannot write a trajectory to '{path}': its name ends in '{path.suffix}', expected "
            f"one of: {', '.join(makers)}."
        )
    return makers[path.suffix]


def _npz(trajectory: Trajectory) -> bytes:
    from mcgee.simulate.trajectory import ARRAYS

    arrays: dict[str, Any] = {name: getattr(trajectory, name) for name in ARRAYS}
    arrays |= {f"log_{name}": value for name, value in trajectory.log.items()}
    arrays["joints"] = np.array(trajectory.robot.joint_names)
    arrays |= {"robot": np.array(trajectory.robot.name), "status": np.array(trajectory.status)}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def _csv(trajectory: Trajectory) -> bytes:
    table = columns(trajectory)
    rows = [",".join('"' + name.replace('"', '""') + '"' for name in table)]
    rows += [",".join(map(repr, map(float, row))) for row in zip(*table.values(), strict=True)]
    return ("\n".join(rows) + "\n").encode()


def _parquet(trajectory: Trajectory) -> bytes:
    table = columns(trajectory)
    pa, buffer = pyarrow(), io.BytesIO()
    pa.parquet.write_table(pa.table(table), buffer)
    return buffer.getvalue()


def pyarrow() -> ModuleType:
    """Loaded when the first Parquet file is asked for."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(
            "Parquet needs pyarrow: install mcgee[table].", name=missing.name
        ) from missing
    return pyarrow
