"""A compiled front door: callables that answer a plain single call without NumPy's machinery.

`door_type(base)` is a subtype of a Python class whose instances are called through one compiled
function. Arguments that are exactly contiguous float64 rows of the right lengths go to the scalar
kernel `single`; everything else, whatever it is, to the instance's method `general`.

It reads NumPy arrays by the public layout of their objects. Where that is not what a probe finds,
or the interpreter has no global lock, there is no door, and `general` is all there is.
"""

from __future__ import annotations

import ctypes
import importlib
import platform
import sys
import sysconfig
from collections.abc import Sequence
from functools import cache

import numpy as np

from mcgee.graph.program import Array

# in the order of NumPy's __multiarray_api.h
GET_VERSION, ARRAY_TYPE, RETURN, NEW = 0, 2, 76, 93
ABI_VERSIONS = (0x01000009, 0x02000000)
"""Of NumPy 1 and 2."""

# where an array object keeps what we read
TYPE, DATA, ND, DIMENSIONS, DESCR, FLAGS = 8, 16, 24, 32, 56, 64
CONTIGUOUS_ALIGNED = 0x101
KIND, KIND_BITS = 24, 0xFFFFFFFF00FFFFFF - 2**64
"""Of a dtype: letters of kind, type and byte order, flags that say nothing here, the number."""
MOST = 8
"""Inputs and outputs a door can pass."""

HAVE_VERSION_TAG, HAVE_VECTORCALL = 1 << 18, 1 << 11
SLOT_CALL, SLOT_MEMBERS = 50, 72  # Py_tp_call and Py_tp_members of typeslots.h
T_PYSSIZET, READONLY = 19, 1
WORDS = 3
"""What an instance holds behind its base: the compiled function, the scalar kernel, the plan."""


class _Member(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("type", ctypes.c_int),
        ("offset", ctypes.c_ssize_t),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


class _Slot(ctypes.Structure):
    _fields_ = (("slot", ctypes.c_int), ("pointer", ctypes.c_void_p))


class _Spec(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("basicsize", ctypes.c_int),
        ("itemsize", ctypes.c_int),
        ("flags", ctypes.c_uint),
        ("slots", ctypes.POINTER(_Slot)),
    )


_kept: list = []  # the type keeps pointers, not what they point to


@cache
def door_type(base: type) -> type:
    """A subtype of the base whose instances can be `open`ed; the base itself where none can be."""
    if not _layout_is_known():
        return base
    place = base.__basicsize__
    members = (_Member * 2)(_Member(b"__vectorcalloffset__", T_PYSSIZET, place, READONLY, None))
    call = ctypes.cast(ctypes.pythonapi.PyVectorcall_Call, ctypes.c_void_p)
    slots = (_Slot * 3)(
        _Slot(SLOT_CALL, call.value),
        _Slot(SLOT_MEMBERS, ctypes.cast(members, ctypes.c_void_p).value),
    )
    name = f"{base.__module__}.{base.__qualname__}".encode()
    flags = HAVE_VERSION_TAG | HAVE_VECTORCALL
    spec = _Spec(name, place + WORDS * 8, 0, flags, slots)
    make = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.py_object)(
        ("PyType_FromSpecWithBases", ctypes.pythonapi)
    )
    _kept.append((members, slots, name, spec))
    door: type = make(ctypes.addressof(spec), (base,))
    door.__doc__ = base.__dict__["__doc__"]  # a type that is made has None, over what its base has
    return door


def hang(
    instance: object, inputs: Sequence[int], outputs: Sequence[Array], gives: type[tuple]
) -> object:
    """Make an instance of a door type callable, closed as yet.

    Args:
        inputs: the lengths of its rows
        outputs: whose shapes its results have
        gives: the kind of tuple that holds several; the instance has to keep it
    Returns: what else the instance has to keep as long as it lives
    """
    shapes = [(len(o.shape), *o.shape, *(0,) * (3 - len(o.shape))) for o in outputs]
    lengths = (*inputs, *(0,) * (MOST - len(inputs)))
    numbers = (len(inputs), len(outputs), id(gives), *lengths, *sum(shapes, ()))
    plan = (ctypes.c_int64 * len(numbers))(*numbers)
    words = _words(instance)
    words[2] = ctypes.addressof(plan)
    words[0] = _compiled_door(type(instance).__basicsize__ - WORDS * 8)
    return plan


def open_(instance: object, single: int) -> None:
    """Let rows in: to the compiled `single` at that address."""
    _words(instance)[1] = single


def is_open(instance: object) -> bool:
    return bool(_words(instance)[1])


def _words(instance: object) -> ctypes.Array:
    place = id(instance) + type(instance).__basicsize__ - WORDS * 8
    return (ctypes.c_int64 * WORDS).from_address(place)


@cache
def _array_api() -> ctypes.Array:
    core = "numpy._core" if int(np.__version__.split(".")[0]) > 1 else "numpy.core"
    umath = importlib.import_module(f"{core}._multiarray_umath")
    prototype = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)
    table = prototype(("PyCapsule_GetPointer", ctypes.pythonapi))(umath._ARRAY_API, None)
    return (ctypes.c_void_p * (NEW + 1)).from_address(table)


@cache
def _layout_is_known() -> bool:
    """Whether arrays are laid out as the door reads them."""
    if platform.python_implementation() != "CPython" or sys.maxsize < 2**32:
        return False
    if sysconfig.get_config_var("Py_GIL_DISABLED") or sysconfig.get_config_var("Py_TRACE_REFS"):
        return False
    try:
        version = ctypes.CFUNCTYPE(ctypes.c_uint)(_array_api()[GET_VERSION])()
    except (AttributeError, ImportError, ValueError):
        return False
    probe = np.arange(5.0)

    def word(place: int, kind: type = ctypes.c_void_p) -> int:
        return kind.from_address(id(probe) + place).value  # type: ignore[attr-defined]

    return (
        version in ABI_VERSIONS
        and _array_api()[ARRAY_TYPE] == id(np.ndarray)
        and word(TYPE) == id(np.ndarray)
        and word(DATA) == probe.ctypes.data
        and word(ND, ctypes.c_int) == 1
        and ctypes.c_int64.from_address(word(DIMENSIONS)).value == 5
        and word(DESCR) == id(np.dtype(np.float64))
        and _kind("f8") == _kind("f8", {"a": 1})
        and _kind("f8") not in (_kind("i8"), _kind("f4"), _kind(_SWAPPED))
        and word(FLAGS, ctypes.c_int) & CONTIGUOUS_ALIGNED == CONTIGUOUS_ALIGNED
    )


_SWAPPED = np.dtype("f8").newbyteorder()


def _kind(of: str | np.dtype, metadata: dict[str, int] | None = None) -> int:
    """What the door compares of a dtype."""
    dtype = np.dtype(of) if metadata is None else np.dtype(of, metadata=metadata)
    return ctypes.c_int64.from_address(id(dtype) + KIND).value & KIND_BITS


@cache
def _compiled_door(place: int) -> int:
    """The address of the function behind all instances whose words are at the place."""
    from mcgee.jit.compile import address

    general = sys.intern("general")
    _kept.append(general)
    symbols = {"array_type": id(np.ndarray), "float64": id(np.dtype(np.float64))}
    symbols |= {"general": id(general)}
    symbols |= {"array_new": _array_api()[NEW], "array_return": _array_api()[RETURN]}
    for name in _PYTHON:
        function = getattr(ctypes.pythonapi, name)
        symbols[name] = ctypes.cast(function, ctypes.c_void_p).value or 0
    return address("door", _DOOR.format(call=place, single=place + 8, plan=place + 16), symbols)


_PYTHON = (
    "PyObject_GetAttr",
    "PyObject_Vectorcall",
    "PyType_GenericAlloc",
    "PyTuple_SetItem",
    "Py_DecRef",
)

# the plan: inputs, outputs, the tuple's type, MOST lengths, then for each output its dimensions and
# three sizes
_DOOR = f"""
@array_type = external global i8
@float64 = external global i8
@general = external global i8
declare ptr @array_new(ptr, i32, ptr, i32, ptr, ptr, i32, i32, ptr)
declare ptr @array_return(ptr)
declare ptr @PyObject_GetAttr(ptr, ptr)
declare ptr @PyObject_Vectorcall(ptr, ptr, i64, ptr)
declare ptr @PyType_GenericAlloc(ptr, i64)
declare i32 @PyTuple_SetItem(ptr, i64, ptr)
declare void @Py_DecRef(ptr)

define ptr @door(ptr %self, ptr %args, i64 %nargsf, ptr %names) nounwind {{{{
  %ins = alloca [{MOST} x ptr]
  %outs = alloca [{MOST} x ptr]
  %made = alloca [{MOST} x ptr]
  %single_at = getelementptr i8, ptr %self, i64 {{single}}
  %single = load ptr, ptr %single_at
  %closed = icmp eq ptr %single, null
  %named = icmp ne ptr %names, null
  %strange = or i1 %closed, %named
  %plan_at = getelementptr i8, ptr %self, i64 {{plan}}
  %plan = load ptr, ptr %plan_at
  %nin = load i64, ptr %plan
  %nout_at = getelementptr i64, ptr %plan, i64 1
  %nout = load i64, ptr %nout_at
  %nargs = and i64 %nargsf, {2**63 - 1}
  %count = icmp ne i64 %nargs, %nin
  %unfit = or i1 %strange, %count
  %float64_at = getelementptr i8, ptr @float64, i64 {KIND}
  %float64 = load i64, ptr %float64_at
  br i1 %unfit, label %general_call, label %argument

argument:
  %i = phi i64 [ 0, %0 ], [ %next, %sized ]
  %a_at = getelementptr ptr, ptr %args, i64 %i
  %a = load ptr, ptr %a_at
  %type_at = getelementptr i8, ptr %a, i64 {TYPE}
  %type = load ptr, ptr %type_at
  %array = icmp eq ptr %type, @array_type
  br i1 %array, label %array_argument, label %general_call
array_argument:
  %nd_at = getelementptr i8, ptr %a, i64 {ND}
  %nd = load i32, ptr %nd_at
  %row = icmp eq i32 %nd, 1
  %descr_at = getelementptr i8, ptr %a, i64 {DESCR}
  %descr = load ptr, ptr %descr_at
  %kind_at = getelementptr i8, ptr %descr, i64 {KIND}
  %kind = load i64, ptr %kind_at
  %other_bits = xor i64 %kind, %float64
  %other_kind = and i64 %other_bits, {KIND_BITS}
  %double = icmp eq i64 %other_kind, 0
  %flags_at = getelementptr i8, ptr %a, i64 {FLAGS}
  %flags = load i32, ptr %flags_at
  %both = and i32 %flags, {CONTIGUOUS_ALIGNED}
  %orderly = icmp eq i32 %both, {CONTIGUOUS_ALIGNED}
  %plain = and i1 %row, %double
  %fine = and i1 %plain, %orderly
  br i1 %fine, label %row_argument, label %general_call
row_argument:
  %dims_at = getelementptr i8, ptr %a, i64 {DIMENSIONS}
  %dims = load ptr, ptr %dims_at
  %length = load i64, ptr %dims
  %place = add i64 %i, 3
  %wanted_at = getelementptr i64, ptr %plan, i64 %place
  %wanted = load i64, ptr %wanted_at
  %fits = icmp eq i64 %length, %wanted
  br i1 %fits, label %sized, label %general_call
sized:
  %data_at = getelementptr i8, ptr %a, i64 {DATA}
  %data = load ptr, ptr %data_at
  %in = getelementptr ptr, ptr %ins, i64 %i
  store ptr %data, ptr %in
  %next = add i64 %i, 1
  %more = icmp ult i64 %next, %nin
  br i1 %more, label %argument, label %allocate

allocate:
  %j = phi i64 [ 0, %sized ], [ %jn, %allocated ]
  %j4 = shl i64 %j, 2
  %shape_place = add i64 %j4, {3 + MOST}
  %shape = getelementptr i64, ptr %plan, i64 %shape_place
  %axes64 = load i64, ptr %shape
  %axes = trunc i64 %axes64 to i32
  %sizes = getelementptr i64, ptr %shape, i64 1
  %new = call ptr @array_new(ptr @array_type, i32 %axes, ptr %sizes, i32 12, ptr null, ptr null,
    i32 0, i32 0, ptr null)
  %slot = getelementptr ptr, ptr %made, i64 %j
  store ptr %new, ptr %slot
  %starved = icmp eq ptr %new, null
  br i1 %starved, label %drop, label %allocated
allocated:
  %result_at = getelementptr i8, ptr %new, i64 {DATA}
  %result = load ptr, ptr %result_at
  %out = getelementptr ptr, ptr %outs, i64 %j
  store ptr %result, ptr %out
  %jn = add i64 %j, 1
  %jmore = icmp ult i64 %jn, %nout
  br i1 %jmore, label %allocate, label %compute

compute:
  %failed = call i64 %single(ptr %ins, ptr %outs)
  %done = icmp eq i64 %failed, 0
  br i1 %done, label %hand_over, label %drop
hand_over:
  %lone = icmp eq i64 %nout, 1
  br i1 %lone, label %one, label %several
one:
  %only = load ptr, ptr %made
  %scalar_at = getelementptr i64, ptr %plan, i64 {3 + MOST}
  %dimensions = load i64, ptr %scalar_at
  %scalar = icmp eq i64 %dimensions, 0
  br i1 %scalar, label %as_scalar, label %as_array
as_scalar:
  %number = call ptr @array_return(ptr %only)
  ret ptr %number
as_array:
  ret ptr %only
several:
  %gives_at = getelementptr i64, ptr %plan, i64 2
  %gives = load ptr, ptr %gives_at
  %tuple = call ptr @PyType_GenericAlloc(ptr %gives, i64 %nout)
  %no_tuple = icmp eq ptr %tuple, null
  br i1 %no_tuple, label %drop, label %fill
fill:
  %k = phi i64 [ 0, %several ], [ %kn, %fill ]
  %item_at = getelementptr ptr, ptr %made, i64 %k
  %item = load ptr, ptr %item_at
  %set = call i32 @PyTuple_SetItem(ptr %tuple, i64 %k, ptr %item)
  %kn = add i64 %k, 1
  %kmore = icmp ult i64 %kn, %nout
  br i1 %kmore, label %fill, label %filled
filled:
  ret ptr %tuple

; what was made for nothing: the first %have arrays
drop:
  %have = phi i64 [ %j, %allocate ], [ %nout, %compute ], [ %nout, %several ]
  %error = phi i1 [ true, %allocate ], [ false, %compute ], [ true, %several ]
  br label %drop_next
drop_next:
  %d = phi i64 [ %have, %drop ], [ %dn, %drop_one ]
  %empty = icmp eq i64 %d, 0
  br i1 %empty, label %dropped, label %drop_one
drop_one:
  %dn = sub i64 %d, 1
  %old_at = getelementptr ptr, ptr %made, i64 %dn
  %old = load ptr, ptr %old_at
  call void @Py_DecRef(ptr %old)
  br label %drop_next
dropped:
  br i1 %error, label %raised, label %general_call
raised:
  ret ptr null

general_call:
  %method = call ptr @PyObject_GetAttr(ptr %self, ptr @general)
  %missing = icmp eq ptr %method, null
  br i1 %missing, label %raised, label %call
call:
  %answer = call ptr @PyObject_Vectorcall(ptr %method, ptr %args, i64 %nargsf, ptr %names)
  call void @Py_DecRef(ptr %method)
  ret ptr %answer
}}}}
"""
