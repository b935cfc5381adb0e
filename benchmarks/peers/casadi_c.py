"""C code that CasADi generates, looped over rows in memory.

From mcgee's own algorithms on casadi.SX, without regrouped inertias: stronger than what its users
get from other libraries' recursions.
"""

import ctypes
import hashlib
from pathlib import Path

import casadi
import numpy as np

from mcgee import build, quantities
from peers import compiler

NAME = "CasADi C"
BUILD = Path(__file__).parent.parent / ".build"
FUNCTIONS = (
    *("inverse_dynamics", "forward_dynamics", "gravity", "mass_matrix", "mass_matrix_inverse"),
    *("coriolis_matrix", "inverse_dynamics_derivatives", "forward_dynamics_derivatives"),
    "regressor",
)
LOOP = """
void batch(const double* x0, const double* x1, const double* x2, double* y, long rows) {
  static casadi_real w[%(work)d];
  static casadi_int iw[%(integers)d];
  for (long i = 0; i < rows; ++i) {
    const casadi_real* arg[%(args)d] = {x0 + i * %(n)d, x1 + i * %(n)d, x2 + i * %(n)d};
    casadi_real* res[%(results)d] = {y + i * %(size)d};
    f(arg, res, iw, w, 0);
  }
}
"""


def flat(x) -> list:
    return [v for part in x for v in flat(part)] if isinstance(x, (list, tuple)) else [x]


def generated(arm, name: str) -> tuple[ctypes.CDLL, int]:
    inputs = [casadi.SX.sym(i, arm.n) for i in build.SIGNATURES[name].inputs]
    rows = [[x[i] for i in range(arm.n)] for x in inputs]
    result = casadi.vertcat(*flat(getattr(quantities, name)(arm.mechanism, *rows)))
    f = casadi.Function("f", inputs, [casadi.densify(result)], {"cse": True})
    text = f.generate("f.c") and Path("f.c").read_text()
    Path("f.c").unlink()
    size = result.numel()
    text += LOOP % {
        "work": f.sz_w() + 1,
        "integers": f.sz_iw() + 1,
        "args": max(f.sz_arg(), 3),
        "results": f.sz_res() + 1,
        "n": arm.n,
        "size": size,
    }
    key = hashlib.sha256(text.encode()).hexdigest()[:16]
    BUILD.mkdir(exist_ok=True)
    source = BUILD / f"{key}.c"
    if not source.exists():
        source.write_text(text)
    return ctypes.CDLL(str(compiler.built(compiler.c(), source, BUILD / f"{key}.so", "-lm"))), size


def functions(arm, file: Path) -> dict:
    def bind(name: str):
        kept: list = []

        def batch(*arrays: np.ndarray, keep: bool = False) -> np.ndarray:
            if not kept:
                kept.extend(generated(arm, name))
                kept.append(np.empty((len(arrays[0]), kept[1])))
            library, size, out = kept
            if len(out) != len(arrays[0]):
                kept[2] = out = np.empty((len(arrays[0]), size))
            given = [a.ctypes.data for a in arrays]
            given += given[:1] * (3 - len(given))
            library.batch(*map(ctypes.c_void_p, (*given, out.ctypes.data)), ctypes.c_long(len(out)))
            return out

        return batch

    return {name: bind(name) for name in FUNCTIONS}
