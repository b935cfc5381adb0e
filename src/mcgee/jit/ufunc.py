"""A NumPy gufunc from the address of a compiled loop, through NumPy's public C API."""

from __future__ import annotations

import ctypes
import importlib
from collections.abc import Callable
from functools import cache

import numpy as np

from mcgee.graph.program import Array, Program
from mcgee.jit.compile import compiled, compiled_rollout

FROM_SIGNATURE = 31  # PyUFunc_FromFuncAndDataAndSignature in NumPy's __ufunc_api.h
NPY_FLOAT, NPY_DOUBLE = 11, 12
_kept: list = []  # NumPy keeps the pointers, not what they point to


def gufunc(program: Program, doc: str = "", *, single: bool = False) -> np.ufunc:
    """The program as a gufunc of float64 or float32 arrays with fixed core sizes."""
    loop = compiled(program, single=single)
    counts = len(program.inputs), len(program.outputs)
    return _made(loop, program.name, doc, signature(program), counts, single)


def rollout(program: Program) -> np.ufunc:
    """Many steps of a program of two states, an input and a number, see `rollout_ir`.

    (n), (n), (steps, n), (), () -> (steps, n), (steps, n)
    """
    n = program.inputs[0].size
    core = f"({n}),({n}),(s,{n}),(),()->(s,{n}),(s,{n})"
    return _made(compiled_rollout(program), program.name, "", core, (5, 2), False)


def _made(
    loop: int, title: str, doc: str, core_sizes: str, counts: tuple[int, int], single: bool
) -> np.ufunc:
    nin, nout = counts
    loops = (ctypes.c_void_p * 1)(loop)
    data = (ctypes.c_void_p * 1)(None)
    types = ctypes.create_string_buffer(bytes([NPY_FLOAT if single else NPY_DOUBLE] * (nin + nout)))
    texts = [ctypes.create_string_buffer(text.encode()) for text in (title, doc, core_sizes)]
    name, doc_text, core = (ctypes.addressof(text) for text in texts)
    address = ctypes.addressof
    function = _constructor()(
        address(loops), address(data), address(types), 1, nin, nout, -1, name, doc_text, 0, core
    )
    _kept.append((loops, data, types, texts, function))
    return function


def signature(program: Program) -> str:
    def sizes(arrays: tuple[Array, ...]) -> str:
        return ",".join("(" + ",".join(map(str, array.shape)) + ")" for array in arrays)

    return f"{sizes(program.inputs)}->{sizes(program.outputs)}"


@cache
def _constructor() -> Callable[..., np.ufunc]:
    core = "numpy._core" if int(np.__version__.split(".")[0]) > 1 else "numpy.core"
    umath = importlib.import_module(f"{core}._multiarray_umath")
    prototype = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)
    table = prototype(("PyCapsule_GetPointer", ctypes.pythonapi))(umath._UFUNC_API, None)
    api = (ctypes.c_void_p * (FROM_SIGNATURE + 1)).from_address(table)
    constructor: int = api[FROM_SIGNATURE] or 0
    p, i = ctypes.c_void_p, ctypes.c_int
    return ctypes.PYFUNCTYPE(ctypes.py_object, p, p, p, i, i, i, i, p, p, i, p)(constructor)
