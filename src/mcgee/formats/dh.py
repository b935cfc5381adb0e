"""Denavit-Hartenberg tables, standard and modified, to Robot.

standard:  T_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)    Denavit & Hartenberg 1955; Paul 1981
modified:  T_i = Rx(alpha) Tx(a) Rz(theta) Tz(d)    Khalil & Kleinfinger 1986; Craig 1986

T_i is the pose of frame i in frame i-1. In both conventions link i carries frame i, and r and I are
given in it. alpha and a of row i are those of the transform T_i as written above: where a modified
table numbers them i-1, as Craig does, they are the ones printed in its row i.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from numbers import Real
from typing import Any

import numpy as np

from mcgee.errors import ModelError
from mcgee.formats.described import described
from mcgee.model import ORIGIN, Frame, Inertia, Joint, Link, Pose, Vec3, is_number
from mcgee.robot import EARTH, Robot
from mcgee.scalar import Scalar, read_angle

UNITS = {
    "theta": "[rad]",
    "d": "[m]",
    "a": "[m]",
    "alpha": "[rad]",
    "offset": "[rad | m]",
    "sigma": "",
    "m": "[kg]",
    "r": "[m]",
    "I": "[kg·m²]",
    "armature": "[kg·m² | kg]",
    "viscous": "[N·m·s/rad | N·s/m]",
    "coulomb": "[N·m | N]",
    "name": "",
    "lower": "[rad | m]",
    "upper": "[rad | m]",
    "velocity": "[rad/s | m/s]",
    "effort": "[N·m | N]",
}
LIMITS = {"lower": -math.inf, "upper": math.inf, "velocity": math.inf, "effort": math.inf}
CONVENTIONS = ("standard", "modified")

# how far a tensor may be from symmetric, relative to its largest entry, and a pose from a rigid one
SYMMETRY_ROUNDING = 1e-9
RIGID_ROUNDING = 1e-6
# an entry of a rotation this close to -1, 0 or 1 is meant to be it
CLEAN_ROUNDING = 1e-15

Row = Mapping[str, Any] | Sequence[Any]
Matrix = Iterable[Iterable[Scalar]]


def from_dh(
    rows: Iterable[Row],
    convention: str = "standard",
    base: Matrix | None = None,
    tool: Matrix | None = None,
    *,
    name: str = "dh",
    gravity_vector: Iterable[Scalar] = EARTH,
) -> Robot:
    """The serial arm of a Denavit-Hartenberg table.

    The joint variable adds to theta (revolute: theta + offset + q) or to d (prismatic:
    d + offset + q). Links are 'base', 'link1', …; joints 'joint1', … or their row's name; the last
    DH frame with the tool is the frame 'tip'. Any number may be a SymPy expression.

    Args:
        rows: one mapping a joint, or the four numbers (theta, d, a, alpha). Keys, all optional:
            theta, alpha: angles [rad]; a decimal that rounds a multiple of pi/12 to eight digits
                or more is taken as that multiple
            d, a: lengths [m]
            offset: of the joint variable [rad | m]
            sigma: 0 revolute, 1 prismatic
            m: mass [kg]; without it the link weighs nothing, which is warned of where it leaves
                a joint with nothing to move
            r: centre of mass in frame i (3,) [m]
            I: inertia about the centre of mass in the axes of frame i, (3, 3) or its diagonal
                (3,) [kg·m²]
            armature: rotor inertia reflected to the joint [kg·m² | kg]
            viscous, coulomb: friction at the joint [N·m·s/rad | N·s/m], [N·m | N]
            name: of the joint
            lower, upper, velocity, effort: limits [rad | m], [rad/s | m/s], [N·m | N]
        convention: 'standard' or 'modified'
        base: pose of DH frame 0 in the world (4, 4)
        tool: pose of the tip in the last DH frame (4, 4)
        name: of the robot
        gravity_vector: the field in the world (3,) [m/s²]
    Raises: ModelError: the table is not one; the sentence names the row, the key and the value
    Source: Corke 2017, Robotics, Vision and Control, sec. 7.1 (both conventions)
    """
    if convention not in CONVENTIONS:
        raise ModelError(f"convention is {convention!r}, expected 'standard' or 'modified'.")
    table = list(rows) if isinstance(rows, Iterable) else []
    if not table:
        raise ModelError(f"rows is {rows!r}, expected at least one row, one a joint.")
    remarks: list[str] = []
    links, joints = [Link("base")], []
    for k, row in enumerate(table, 1):
        cells = _cells(row, k)
        links.append(Link(f"link{k}", _inertia(cells, k, remarks), f"row {k}: "))
        joints.append(_joint(cells, k, convention, remarks))
    if base is not None:
        first = joints[0]
        joints[0] = replace(first, pose=read_pose(base, "base") @ first.pose)
    tip = Frame("tip", links[-1].name, Pose() if tool is None else read_pose(tool, "tool"))
    gravity = read_vector(gravity_vector, "gravity_vector", "[m/s²]")
    return described(name, tuple(links), tuple(joints), (tip,), gravity, tuple(remarks))


# -- one row --------------------------------------------------------------------------------------


def _cells(row: Row, k: int) -> Mapping[str, Any]:
    """The row as a mapping with known keys."""
    if isinstance(row, Mapping):
        unknown = [key for key in row if key not in UNITS]
        if unknown:
            raise ModelError(f"row {k}: unknown key {unknown[0]!r}. Keys: {', '.join(UNITS)}.")
        return row
    if isinstance(row, str) or not isinstance(row, (Sequence, np.ndarray)):
        raise ModelError(
            f"row {k}: is {row!r}, expected a mapping such as {{'d': 0.4, 'alpha': pi/2}} or the "
            f"four numbers theta, d, a, alpha."
        )
    if len(row) != 4:
        raise ModelError(
            f"row {k}: has {len(row)} values, expected the four numbers theta, d, a, alpha. "
            f"Write a mapping for more."
        )
    return dict(zip(("theta", "d", "a", "alpha"), row, strict=True))


def _joint(cells: Mapping[str, Any], k: int, convention: str, remarks: list[str]) -> Joint:
    prismatic = _sigma(cells, k)
    theta, alpha = (_angle(cells, key, k, remarks) for key in ("theta", "alpha"))
    offset = _number(cells, "offset", k) if prismatic else _angle(cells, "offset", k, remarks)
    d, a = (_number(cells, key, k) for key in ("d", "a"))
    theta, d = (theta, d + offset) if prismatic else (theta + offset, d)
    along_z = Pose.about("z", theta) @ Pose.at(z=d)
    along_x = Pose.at(x=a) @ Pose.about("x", alpha)
    poses = (along_z, along_x) if convention == "standard" else (along_x @ along_z, Pose())
    name = cells.get("name", f"joint{k}")
    if not isinstance(name, str) or not name:
        raise ModelError(f"row {k}: name is {name!r}, expected a text that is not empty.")
    limits: dict[str, Any] = {key: _limit(cells, key, k) for key in LIMITS}
    return Joint(
        name,
        "prismatic" if prismatic else "revolute",
        "base" if k == 1 else f"link{k - 1}",
        f"link{k}",
        pose=poses[0],
        child_pose=poses[1],
        armature=_not_negative(cells, "armature", k),
        viscous=_number(cells, "viscous", k),
        coulomb=_number(cells, "coulomb", k),
        place=f"row {k}: ",
        **limits,
    )


def _sigma(cells: Mapping[str, Any], k: int) -> bool:
    sigma = cells.get("sigma", 0)
    if not isinstance(sigma, Real) or sigma not in (0, 1):
        raise ModelError(f"row {k}: sigma is {sigma!r}, expected 0 (revolute) or 1 (prismatic).")
    return sigma == 1


def _inertia(cells: Mapping[str, Any], k: int, remarks: list[str]) -> Inertia:
    mass = _not_negative(cells, "m", k)
    com = read_vector(cells["r"], f"row {k}: r", UNITS["r"]) if "r" in cells else ORIGIN
    about_com = _tensor(cells["I"], k) if "I" in cells else (0.0,) * 6
    if "m" not in cells and "r" in cells:
        remarks.append(f"row {k}: r is given without m, so the link weighs nothing.")
    return Inertia(mass, com, about_com)


def _tensor(value: Any, k: int) -> tuple[Scalar, ...]:
    """Ixx, Ixy, Ixz, Iyy, Iyz, Izz of a (3, 3) matrix or of its diagonal."""
    what, unit = f"row {k}: I", UNITS["I"]
    array = _array(value, what)
    if array.shape == (3,):
        x, y, z = read_vector(array, what, unit)
        return x, 0.0, 0.0, y, 0.0, z
    if array.shape != (3, 3):
        raise ModelError(
            f"{what} has shape {array.shape}, expected (3, 3) or the diagonal (3,) {unit}. "
            f"Write products of inertia in their places of the matrix."
        )
    a = [read_vector(line, what, unit) for line in array]
    largest = max((abs(v) for line in a for v in line if is_number(v)), default=0.0)
    for i, j, one, other in ((0, 1, "Ixy", "Iyx"), (0, 2, "Ixz", "Izx"), (1, 2, "Iyz", "Izy")):
        if not _same(a[i][j], a[j][i], SYMMETRY_ROUNDING * largest):
            raise ModelError(
                f"{what} is not symmetric: {one} is {_shown(a[i][j])} and {other} is "
                f"{_shown(a[j][i])}, expected the same {unit}."
            )
    return a[0][0], a[0][1], a[0][2], a[1][1], a[1][2], a[2][2]


def _same(a: Scalar, b: Scalar, allowed: float) -> bool:
    return abs(a - b) <= allowed if is_number(a) and is_number(b) else bool(a == b)


# -- numbers --------------------------------------------------------------------------------------


def read_number(value: Any, what: str, unit: str = "") -> Scalar:
    """A plain float, or a SymPy expression as it is where it has free symbols."""
    try:
        if isinstance(value, (bool, str, bytes)) or np.shape(value) != ():
            raise TypeError
        if getattr(value, "free_symbols", None):
            return value
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise ModelError(f"{what} is {value!r}, expected a finite number{unit and ' ' + unit}.")
    return number


def read_vector(value: Any, what: str, unit: str = "") -> Vec3:
    """Three numbers."""
    array = _array(value, what)
    if array.shape != (3,):
        raise ModelError(f"{what} has shape {array.shape}, expected (3,){unit and ' ' + unit}.")
    x, y, z = (read_number(v, what, unit) for v in array)
    return x, y, z


def _number(cells: Mapping[str, Any], key: str, k: int) -> Scalar:
    return read_number(cells.get(key, 0.0), f"row {k}: {key}", UNITS[key])


def _not_negative(cells: Mapping[str, Any], key: str, k: int) -> Scalar:
    value = _number(cells, key, k)
    if is_number(value) and value < 0:
        raise ModelError(f"row {k}: {key} is {value:g}, expected zero or more {UNITS[key]}.")
    return value


def _angle(cells: Mapping[str, Any], key: str, k: int, remarks: list[str]) -> Scalar:
    value = _number(cells, key, k)
    if not is_number(value):
        return value
    value, remark = read_angle(repr(value))
    if remark is not None:
        remarks.append(f"row {k}: {key}: {remark}")
    return value


def _limit(cells: Mapping[str, Any], key: str, k: int) -> float:
    value = cells.get(key, LIMITS[key])
    if isinstance(value, Real) and not isinstance(value, bool) and not math.isnan(value):
        return float(value)
    raise ModelError(f"row {k}: {key} is {value!r}, expected a number {UNITS[key]}.")


def _array(value: Any, what: str) -> np.ndarray:
    try:
        return np.array(value, dtype=object)
    except ValueError:
        raise ModelError(f"{what} is no array of numbers: {value!r}.") from None


def _shown(value: Scalar) -> str:
    return f"{value:g}" if is_number(value) else str(value)


# -- poses ----------------------------------------------------------------------------------------


def read_pose(matrix: Matrix, what: str) -> Pose:
    """A pose from a homogeneous matrix (4, 4); entries a rounding away from -1, 0, 1 are those.

    Raises: ModelError: the matrix is not that of a rigid displacement
    """
    array = _array(matrix, what)
    if array.shape != (4, 4):
        raise ModelError(f"{what} has shape {array.shape}, expected (4, 4).")
    rows = [[read_number(v, what) for v in row] for row in array]
    if rows[3] != [0, 0, 0, 1]:
        raise ModelError(f"{what} has the last row {rows[3]}, expected [0, 0, 0, 1].")
    a, b, c = ([_clean(v) for v in row[:3]] for row in rows[:3])
    _check_rotation([a, b, c], what)
    return Pose.from_matrix([[*a, rows[0][3]], [*b, rows[1][3]], [*c, rows[2][3]], rows[3]])


def _clean(v: Scalar) -> Scalar:
    return float(round(v)) if is_number(v) and abs(v - round(v)) < CLEAN_ROUNDING else v


def _check_rotation(rotation: list[list[Scalar]], what: str) -> None:
    if not all(is_number(v) for row in rotation for v in row):
        return
    R: np.ndarray = np.array(rotation)
    if abs(R @ R.T - np.eye(3)).max() > RIGID_ROUNDING or np.linalg.det(R) < 0:
        raise ModelError(
            f"{what} has a left upper block that is no rotation: its rows must be orthogonal unit "
            f"vectors with determinant 1."
        )
