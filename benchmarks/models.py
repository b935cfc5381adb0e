"""The robots that are measured, each as one URDF file that every library reads."""

from __future__ import annotations

import site
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mcgee import formats

REAL = {
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "talos": "talos_data/robots/talos_reduced.urdf",
}
CHAINS = (2, 4, 8, 16, 32, 64, 100, 200, 500)


def file(name: str, folder: Path) -> Path:
    """The robot's URDF file, written into the folder where no package has it."""
    if name == "panda":
        return Path(formats.__file__).parents[1] / "robots" / "panda.urdf"
    if name in REAL:
        for packages in site.getsitepackages():
            for path in Path(packages).glob(f"cmeel.prefix/share/*/robots/{REAL[name]}"):
                return path
        raise FileNotFoundError(f"{name} needs the package example-robot-data")
    path = folder / f"{name}.urdf"
    links = planar_2r() if name == "planar_2r" else chain(int(name.removeprefix("chain")))
    path.write_text(f'<robot name="{name}">\n<link name="base"/>\n{"".join(links)}</robot>\n')
    return path


def planar_2r() -> Iterator[str]:
    for i in (1, 2):
        yield joint(i, (1.0 if i > 1 else 0.0, 0, 0), (0, 0, 0), "0 -1 0")
        yield link(i, 1.0, (0.5, 0, 0), np.diag([0.05, 0.1, 0.1]))


def chain(n: int) -> Iterator[str]:
    """Revolute joints and bodies in general position."""
    random = np.random.default_rng(n)
    for i in range(1, n + 1):
        yield joint(i, random.uniform(-0.5, 0.5, 3), random.uniform(-3, 3, 3), "0 0 1")
        points = random.uniform(-0.1, 0.1, (8, 3))
        I = np.trace(points.T @ points) * np.eye(3) - points.T @ points
        yield link(i, random.uniform(0.5, 2), random.uniform(-0.1, 0.1, 3), I)


def joint(i: int, xyz, rpy, axis: str) -> str:
    parent = f"l{i - 1}" if i > 1 else "base"
    place = " ".join(map(repr, map(float, xyz))), " ".join(map(repr, map(float, rpy)))
    return (
        f'<joint name="j{i}" type="revolute"><parent link="{parent}"/><child link="l{i}"/>'
        f'<origin xyz="{place[0]}" rpy="{place[1]}"/><axis xyz="{axis}"/>'
        '<limit lower="-9" upper="9" effort="99" velocity="99"/></joint>\n'
    )


def link(i: int, mass: float, com, I: np.ndarray) -> str:
    names = {
        "ixx": (0, 0),
        "ixy": (0, 1),
        "ixz": (0, 2),
        "iyy": (1, 1),
        "iyz": (1, 2),
        "izz": (2, 2),
    }
    inertia = " ".join(f'{name}="{float(I[at])!r}"' for name, at in names.items())
    return (
        f'<link name="l{i}"><inertial><origin xyz="{" ".join(map(repr, map(float, com)))}"/>'
        f'<mass value="{float(mass)!r}"/><inertia {inertia}/></inertial></link>\n'
    )
