"""The C that `mcgee codegen` writes, a call a row, with the loop in a file of its own."""

import ctypes
from pathlib import Path

import numpy as np

from mcgee import build
from mcgee.codegen import c
from mcgee.codegen.unit import Function, unit
from peers import compiler

NAME = "generated C"
BUILD = Path(__file__).parent.parent / ".build"
FUNCTIONS = (
    *("inverse_dynamics", "forward_dynamics", "gravity", "mass_matrix", "mass_matrix_inverse"),
    *("coriolis_matrix", "inverse_dynamics_derivatives", "forward_dynamics_derivatives"),
    "regressor",
)
LOOP = """
void batch(const double *x0, const double *x1, const double *x2, double *y, long rows) {{
  (void)x1; (void)x2;
  for (long i = 0; i < rows; ++i) {call}
}}
"""


def loop(function: Function, symbol: str) -> str:
    """Over rows in memory; results follow each other."""
    given = [f"x{k} + i * {array.size}" for k, array in enumerate(function.inputs)]
    size, at = sum(a.size for a in function.outputs), 0
    for array in function.outputs:
        given.append(f"y + i * {size} + {at}")
        at += array.size
    return LOOP.format(call=f"{symbol}({', '.join(given)});")


def generated(arm, name: str, build_with: str) -> tuple[ctypes.CDLL, int]:
    made = unit(arm, [name], False, {}, arm.end_frame, False)
    folder = BUILD / f"c-{made.fingerprint[:12]}-{name}"
    folder.mkdir(parents=True, exist_ok=True)
    for path, text in c.files(made).items():
        if path.endswith((".c", ".h")):
            (folder / path).write_text(text)
    (function,) = made.functions
    source = folder / "batch.c"
    text = f'#include "{made.name}.h"\n' + loop(function, c.symbol(made, function))
    source.write_text(text)
    library = folder / f"{build_with}.so"
    library.unlink(missing_ok=True)
    compiler.built(build_with, source, library, str(folder / f"{made.name}.c"), "-lm")
    return ctypes.CDLL(str(library)), sum(a.size for a in function.outputs)


def bound(load):
    def batch(*arrays: np.ndarray, keep: bool = False) -> np.ndarray:
        if batch.library is None:
            batch.library, batch.size = load()
        if batch.out is None or len(batch.out) != len(arrays[0]):
            batch.out = np.empty((len(arrays[0]), batch.size))
        given = [a.ctypes.data for a in arrays]
        given += given[:1] * (3 - len(given))
        rows = ctypes.c_long(len(batch.out))
        batch.library.batch(*map(ctypes.c_void_p, (*given, batch.out.ctypes.data)), rows)
        return batch.out

    batch.library = batch.out = None
    return batch


def functions(arm, file: Path, build_with: str | None = None) -> dict:
    made_by = build_with or compiler.c()
    return {
        name: bound(lambda name=name: generated(arm, name, made_by))
        for name in FUNCTIONS
        if name in build.SIGNATURES
    }
