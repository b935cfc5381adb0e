"""Pinocchio from C++: its headers and library are in the `pin` wheel."""

import ctypes
from pathlib import Path

import numpy as np
import pinocchio as pin

from peers import AbsentError, compiler
from peers.pinocchio_python import order

NAME = "Pinocchio C++"
HERE = Path(__file__).parent
BUILD = HERE.parent / ".build"
# what Pinocchio's own CMake package defines
DEFINITIONS = (
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
)
WIDTHS = {
    "inverse_dynamics": lambda n: n,
    "forward_dynamics": lambda n: n,
    "gravity": lambda n: n,
    "mass_matrix": lambda n: n * n,
    "mass_matrix_inverse": lambda n: n * n,
    "coriolis_matrix": lambda n: n * n,
    "inverse_dynamics_derivatives": lambda n: 3 * n * n,
    "forward_dynamics_derivatives": lambda n: 3 * n * n,
    "regressor": lambda n: 10 * n * n,
}


def eigen() -> Path:
    """Eigen's headers: Debian's, or those in CasADi's wheel."""
    places = [Path("/usr/include/eigen3")]
    try:
        import casadi

        places.insert(0, Path(casadi.__file__).parent / "include" / "eigen3")
    except ImportError:
        pass
    for place in places:
        if (place / "Eigen" / "Core").exists():
            return place
    raise AbsentError("Eigen's headers are not here (libeigen3-dev, or the casadi wheel)")


def library() -> ctypes.CDLL:
    prefix = next(p for p in Path(pin.__file__).parents if (p / "include").is_dir())
    path = compiler.built(
        compiler.cpp(),
        HERE / "pinocchio_loop.cpp",
        BUILD / f"pinocchio-{pin.__version__}.so",
        "-std=c++17",
        *DEFINITIONS,
        f"-I{prefix / 'include'}",
        f"-I{eigen()}",
        f"-L{prefix / 'lib'}",
        f"-Wl,-rpath,{prefix / 'lib'}",
        "-lpinocchio_default",
        "-lboost_serialization",
    )
    return ctypes.CDLL(str(path))


def functions(arm, file: Path) -> dict:
    model = pin.buildModelFromUrdf(str(file))
    text = BUILD / "model.txt"
    loops = library()
    model.saveToText(str(text))
    loops.load(str(text).encode())

    def bind(name: str):
        loop, width = getattr(loops, name), WIDTHS[name](arm.n)

        def batch(*arrays: np.ndarray, keep: bool = False) -> np.ndarray:
            given = [a.ctypes.data for a in arrays]
            given += given[:1] * (3 - len(given))
            if batch.out is None or len(batch.out) != len(arrays[0]):
                batch.out = np.empty((len(arrays[0]), width))
            loop(
                *map(ctypes.c_void_p, (*given, batch.out.ctypes.data)),
                ctypes.c_long(len(arrays[0])),
            )
            return batch.out

        batch.out = None
        return batch

    return {name: bind(name) for name in WIDTHS} | {"order": order(arm, file)}
