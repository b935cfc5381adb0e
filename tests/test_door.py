"""The compiled front door: quick for plain rows, NumPy's own answer for everything else."""

from __future__ import annotations

import copy
import dataclasses
import gc
import inspect
import os
import pickle
import pydoc
import subprocess
import sys
import threading
import tracemalloc
import warnings
import weakref
from concurrent.futures import ThreadPoolExecutor
from unittest import mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mcgee
from mcgee import kernels
from mcgee.jit import door
from mcgee.kernels import Bound, compiled
from mcgee.robot import Robot
from robots import random_tree

ARM = mcgee.load("planar_3r")
Q, QD, QDD = np.random.default_rng(0).normal(size=(3, 3))


def is_quick(method) -> bool:
    return type(method) is not Bound and door.is_open(method)


def outcome(function, *args, **kwargs):
    """(type, dtype, shape, bytes) of a result, or the error's type and text."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            result = function(*args, **kwargs)
        except Exception as error:
            return type(error), str(error)
    parts = result if isinstance(result, tuple) else (result,)
    told = [(w.category, str(w.message)) for w in said]
    return told, type(result), [(type(p), p.dtype, p.shape, p.tobytes()) for p in parts]


@pytest.fixture(autouse=True)
def opened():
    for method in (ARM.mass_matrix, ARM.kinetic_energy, ARM.inverse_dynamics, ARM.terms):
        takes = len(method.inputs)
        method(*(Q, QD, QDD)[:takes])
        assert is_quick(method)


def plain(name: str) -> Bound:
    """The same quantity without a door."""
    return Bound(ARM, name, gives=getattr(ARM, name).gives)


class Sub(np.ndarray):
    pass


class Overriding(np.ndarray):
    def __array_ufunc__(self, ufunc, method, *inputs, **kwargs):
        return "mine"


class Prioritised(np.ndarray):
    __array_priority__ = 100.0


def misaligned(values: np.ndarray) -> np.ndarray:
    held = np.zeros(8 * len(values) + 1, np.uint8)[1:].view(np.float64)
    held[:] = values
    assert not held.flags.aligned
    return held


def read_only(values: np.ndarray) -> np.ndarray:
    copied = values.copy()
    copied.flags.writeable = False
    return copied


STRANGE = {
    "list": lambda q: q.tolist(),
    "tuple": lambda q: tuple(q),
    "integers": lambda q: [1, 2, 3],
    "integer array": lambda q: np.arange(3),
    "booleans": lambda q: np.array([True, False, True]),
    "float32": lambda q: q.astype(np.float32),
    "float16": lambda q: q.astype(np.float16),
    "long double": lambda q: q.astype(np.longdouble),
    "complex": lambda q: q.astype(complex),
    "objects": lambda q: q.astype(object),
    "texts": lambda q: q.astype(str),
    "big-endian": lambda q: q.astype(">f8"),
    "own descriptor": lambda q: q.astype(np.dtype("f8", metadata={"unit": "rad"})),
    "strided": lambda q: np.repeat(q, 2)[::2],
    "reversed": lambda q: q[::-1].copy()[::-1],
    "broadcast": lambda q: np.broadcast_to(q[:1], 3),
    "misaligned": misaligned,
    "read-only": read_only,
    "one row": lambda q: q[None],
    "no rows": lambda q: np.empty((0, 3)),
    "many axes": lambda q: np.zeros((2, 1, 3)),
    "Fortran": lambda q: np.asfortranarray(np.stack([q, q])),
    "scalar": lambda q: 1.0,
    "numpy scalar": lambda q: np.float64(1.0),
    "0-d": lambda q: np.array(1.0),
    "empty": lambda q: np.empty(0),
    "short": lambda q: q[:2],
    "long": lambda q: np.ones(4),
    "ragged": lambda q: [[1.0, 2.0], [3.0]],
    "matrix": lambda q: np.asmatrix(q),
    "masked": lambda q: np.ma.masked_array(q, [False, True, False]),
    "subclass": lambda q: q.view(Sub),
    "prioritised": lambda q: q.view(Prioritised),
    "record": lambda q: q.view([("x", float)]),
    "none": lambda q: None,
    "text": lambda q: "abc",
    "dict": lambda q: {"q": 1},
    "nan": lambda q: np.array([0.0, np.nan, 1.0]),
    "infinite": lambda q: np.array([0.0, np.inf, 1.0]),
    "huge": lambda q: np.full(3, 1e200),
    "denormal": lambda q: np.full(3, 5e-324),
    "negative zero": lambda q: np.full(3, -0.0),
    "far": lambda q: q * 1e8,
}


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
@pytest.mark.parametrize("kind", STRANGE)
@pytest.mark.parametrize("place", range(3))
def test_any_argument_gets_what_numpy_gives(kind, place):
    args = [Q, QD, QDD]
    args[place] = STRANGE[kind](args[place].copy())
    assert outcome(ARM.inverse_dynamics, *args) == outcome(plain("inverse_dynamics"), *args)


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
@pytest.mark.parametrize("kind", STRANGE)
@pytest.mark.parametrize("name", ["mass_matrix", "potential_energy"])
def test_the_lone_argument_too(name, kind):
    arg = STRANGE[kind](Q.copy())
    getattr(ARM, name)(Q)
    assert outcome(getattr(ARM, name), arg) == outcome(plain(name), arg)


def test_an_override_is_asked():
    assert ARM.mass_matrix(Q.view(Overriding)) == "mine"


KEYWORDS = {
    "out": lambda: {"out": np.empty((3, 3))},
    "out in a tuple": lambda: {"out": (np.empty((3, 3)),)},
    "out of float32": lambda: {"out": np.empty((3, 3), np.float32)},
    "out too small": lambda: {"out": np.empty((2, 3))},
    "casting": lambda: {"casting": "no"},
    "dtype": lambda: {"dtype": float},
    "order": lambda: {"order": "F"},
    "axes": lambda: {"axes": [(0,), (1, 0)]},
    "subok": lambda: {"subok": False},
    "signature": lambda: {"signature": "d->d"},
    "where": lambda: {"where": True},
    "unknown": lambda: {"speed": 3},
}


@pytest.mark.parametrize("kind", KEYWORDS)
def test_keywords_get_what_numpy_gives(kind):
    assert outcome(ARM.mass_matrix, Q, **KEYWORDS[kind]()) == outcome(
        plain("mass_matrix"), Q, **KEYWORDS[kind]()
    )


@pytest.mark.parametrize("args", [(), (Q, QD, QDD), (Q, None), (Q, QD)])
def test_other_numbers_of_arguments(args):
    assert outcome(ARM.mass_matrix, *args) == outcome(plain("mass_matrix"), *args)


def test_out_given_by_position():
    out = np.empty((3, 3))
    assert ARM.mass_matrix(Q, out) is out
    assert (out == ARM.mass_matrix(Q)).all()


def test_an_earlier_named_tuple_is_filled_again():
    terms = ARM.terms(np.zeros((2, 3)), QD)
    again = ARM.terms(Q[None].repeat(2, 0), QD, out=terms)
    assert again.M is terms.M
    assert (terms.M[0] == ARM.mass_matrix(Q)).all()


def test_inputs_given_by_name():
    assert (ARM.inverse_dynamics(Q, qdd=QDD, qd=QD) == ARM.inverse_dynamics(Q, QD, QDD)).all()


rows = st.one_of(
    st.lists(st.floats(width=64), min_size=2, max_size=4),
    st.lists(st.integers(-5, 5), min_size=3, max_size=3),
    st.lists(st.floats(-4, 4), min_size=3, max_size=3).map(np.array),
    st.sampled_from(sorted(STRANGE)).map(lambda kind: STRANGE[kind](Q.copy())),
    st.none(),
    st.text(max_size=2),
    st.builds(np.zeros, st.tuples(st.integers(0, 3), st.integers(2, 4))),
)


@pytest.mark.filterwarnings("ignore")
@settings(max_examples=400, deadline=None)
@given(st.lists(rows, max_size=4))
def test_fuzz(args):
    for name in ("inverse_dynamics", "terms"):  # arguments beyond the inputs are filled
        mine, numpys = copy.deepcopy(args), copy.deepcopy(args)
        assert outcome(getattr(ARM, name), *mine) == outcome(plain(name), *numpys)


def test_results():
    assert type(ARM.kinetic_energy(Q, QD)) is np.float64
    M = ARM.mass_matrix(Q)
    assert (M.shape, M.dtype, M.flags.owndata, M.flags.writeable) == ((3, 3), float, True, True)
    terms = ARM.terms(Q, QD)
    assert type(terms) is mcgee.Terms
    assert (terms.M == M).all()
    assert terms.g.shape == terms.Cqd.shape == (3,)
    assert type(ARM.terms(Q[None], QD)) is mcgee.Terms


def test_a_reference_taken_before_the_first_call_becomes_quick():
    arm = mcgee.load("planar_2r")
    gravity = arm.gravity
    assert not is_quick(gravity)
    gravity(np.zeros((2, 2)))
    assert not is_quick(gravity)
    gravity(np.zeros(2))
    assert is_quick(gravity)
    assert arm.gravity is gravity


def test_it_presents_itself_as_before():
    method = ARM.inverse_dynamics
    assert isinstance(method, Bound)
    assert method.__name__ == "inverse_dynamics"
    assert "Joint efforts that produce the accelerations" in method.__doc__
    assert str(inspect.signature(method)) == str(
        inspect.signature(type(ARM).inverse_dynamics.stub.__get__(ARM))
    )
    assert repr(method) == f"<inverse_dynamics(q, qd, qdd) of robot '{ARM.name}'>"
    assert method.ufunc is compiled(ARM, "inverse_dynamics")[0]
    assert callable(method)


@pytest.mark.parametrize("again", [copy.copy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies_and_pickles(again):
    for method in (ARM.inverse_dynamics, ARM.terms):
        other = again(method)
        assert isinstance(other, Bound)
        args = (Q, QD, QDD)[: len(method.inputs)]
        assert outcome(other, *args) == outcome(method, *args)


# -- memory ---------------------------------------------------------------------------------------


def failing(*args, **kwargs):
    with pytest.raises((TypeError, ValueError)):
        ARM.inverse_dynamics(*args, **kwargs)


CALLS = {
    "row": lambda: ARM.inverse_dynamics(Q, QD, QDD),
    "scalar": lambda: ARM.kinetic_energy(Q, QD),
    "several": lambda: ARM.terms(Q, QD),
    "list": lambda: ARM.inverse_dynamics(Q.tolist(), QD, QDD),
    "named": lambda: ARM.inverse_dynamics(Q, QD, qdd=QDD),
    "nan": lambda: ARM.inverse_dynamics(Q, QD, np.full(3, np.nan)),
    "wrong type": lambda: failing(Q, QD, None),
    "wrong shape": lambda: failing(Q, QD, QDD[:2]),
    "too few": lambda: failing(Q),
    "unknown keyword": lambda: failing(Q, QD, QDD, speed=1),
}


@pytest.mark.parametrize("kind", CALLS)
def test_nothing_is_kept(kind):
    call = CALLS[kind]
    held = [Q, QD, QDD, ARM.inverse_dynamics, np.dtype(float), mcgee.Terms, np.ndarray]
    times = 2_000
    for _ in range(50):
        call()
    gc.collect()
    before = [sys.getrefcount(x) for x in held]
    tracemalloc.start()
    try:
        call()
        size = tracemalloc.get_traced_memory()[0]
        for _ in range(times):
            call()
        gc.collect()
        grown = tracemalloc.get_traced_memory()[0] - size
    finally:
        tracemalloc.stop()
    after = [sys.getrefcount(x) for x in held]
    assert max(abs(a - b) for a, b in zip(after, before, strict=True)) < times / 20
    assert grown < 20 * times


def test_a_robot_dies_with_its_methods():
    robot = random_tree(3, bodies=2)
    q = np.zeros(robot.n)
    robot.gravity(q), robot.terms(q, q), robot.jacobian(q)
    gone = weakref.ref(robot)
    del robot
    gc.collect()
    assert gone() is None


FUZZ = """
import sys, warnings
import numpy as np
sys.path.insert(0, {folder!r})
warnings.simplefilter("ignore")
import test_door as t
random = np.random.default_rng(int(sys.argv[1]))
kinds = sorted(t.STRANGE)
for i in range(1500):
    args = [t.Q, t.QD, t.QDD]
    for place in range(3):
        if random.random() < 0.3:
            args[place] = t.STRANGE[kinds[random.integers(len(kinds))]](args[place])
    args = args[: 3 - (random.random() < 0.1)] + [None] * (random.random() < 0.1)
    for method in (t.ARM.inverse_dynamics, t.ARM.terms, t.ARM.kinetic_energy):
        try:
            method(*args[: len(method.inputs)])
        except (TypeError, ValueError):
            pass
"""


def test_fuzz_under_a_debug_allocator():
    folder = os.path.dirname(__file__)
    environment = {**os.environ, "PYTHONMALLOC": "debug", "PYTHONFAULTHANDLER": "1"}
    done = subprocess.run(
        [sys.executable, "-c", FUZZ.format(folder=folder), "1"],
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-2000:]


# -- threads, and where there is no door ----------------------------------------------------------


def test_many_threads_open_one_door():
    arm, barrier = random_tree(9, bodies=4), threading.Barrier(8)
    q = np.random.default_rng(0).normal(size=arm.n)
    expected = Bound(arm, "mass_matrix")(q)

    def work(_):
        barrier.wait()
        return [arm.mass_matrix(q) for _ in range(200)]

    with ThreadPoolExecutor(8) as pool:
        for results in pool.map(work, range(8)):
            assert all((expected == M).all() for M in results)


@pytest.fixture
def no_door(monkeypatch):
    door.door_type.cache_clear()
    yield monkeypatch
    monkeypatch.undo()
    door.door_type.cache_clear()
    door._layout_is_known.cache_clear()


@pytest.mark.parametrize("reason", ["free-threaded", "other interpreter", "other ABI", "layout"])
def test_without_a_door_all_still_works(no_door, reason):
    door._layout_is_known.cache_clear()
    if reason == "free-threaded":
        no_door.setattr(door.sysconfig, "get_config_var", lambda name: 1)
    elif reason == "other interpreter":
        no_door.setattr(door.platform, "python_implementation", lambda: "PyPy")
    elif reason == "other ABI":
        no_door.setattr(door, "ABI_VERSIONS", (0x03000000,))
    else:
        no_door.setattr(door, "DATA", 24)
    arm = mcgee.load("planar_3r")
    assert type(arm.mass_matrix) is Bound
    assert outcome(arm.mass_matrix, Q) == outcome(ARM.mass_matrix, Q)
    assert outcome(arm.terms, Q, QD) == outcome(ARM.terms, Q, QD)
    assert outcome(arm.mass_matrix, None)[0] == outcome(ARM.mass_matrix, None)[0]


def test_attribute_access_compiles_no_kernel(monkeypatch):
    monkeypatch.setattr(kernels, "gufunc", None)
    monkeypatch.setattr(kernels, "compiled_row", None)
    arm = mcgee.load("planar_2r")
    assert all(callable(getattr(arm, name)) for name in ("mass_matrix", "terms", "gravity"))


# -- float32 --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["mass_matrix", "inverse_dynamics", "forward_dynamics", "terms"])
def test_float32_on_request(name):
    args = [x.astype(np.float32) for x in np.random.default_rng(1).normal(size=(3, 500, 3))]
    args = args[: len(getattr(ARM, name).inputs)]
    got = getattr(ARM, name)(*args, dtype=np.float32)
    want = getattr(ARM, name)(*args)
    for single, double in zip(
        *((x if name == "terms" else (x,)) for x in (got, want)), strict=True
    ):
        assert single.dtype == np.float32
        assert double.dtype == np.float64
        error = np.abs(single - double).max() / np.abs(double).max()
        assert 0 < error < 40 * 2.0**-24


# -- what a method is -----------------------------------------------------------------------------


class Heavier(Robot):
    def gravity(self, q, **ufunc):
        return super().gravity(q, **ufunc) + 1


class HeavierByName(Robot):
    def gravity(self, q, **ufunc):
        return Robot.gravity(self, q, **ufunc) + 1


@pytest.mark.parametrize("kind", [Heavier, HeavierByName])
def test_a_subclass_may_put_its_own_over_a_quantity(kind):
    arm = mcgee.arms.planar_2r()
    given = {f.name: getattr(arm, f.name) for f in dataclasses.fields(arm) if f.init}
    own, q = kind(**given), np.array([0.3, 0.4])
    for _ in range(3):
        assert np.array_equal(own.gravity(q), arm.gravity(q) + 1)
        assert np.array_equal(own.mass_matrix(q), arm.mass_matrix(q))


def test_help_shows_the_documentation():
    assert "efforts that hold the arm still" in pydoc.render_doc(mcgee.arms.planar_2r().gravity)


def test_rows_of_other_float64_dtypes_enter():
    """Such as those that came through pickle; other byte orders and types do not."""
    arm, entered = mcgee.load("panda"), []
    arm.gravity(np.ones(7))
    foreign = pickle.loads(pickle.dumps(np.ones(7)))
    named = np.ones(7, np.dtype("f8", metadata={"unit": "rad"}))
    general = kernels.Bound.general
    with mock.patch.object(
        kernels.Bound, "general", lambda *a, **k: (entered.append(a), general(*a, **k))[1]
    ):
        for row in (foreign, foreign.copy(), foreign + 0.0, named):
            assert row.dtype is not np.dtype(float)
            arm.gravity(row)
        assert not entered
        for row in (np.ones(7, ">f8"), np.ones(7, "i8"), np.ones(7, "f4"), np.ones(7, "u8")):
            arm.gravity(row)
        assert len(entered) == 4


def test_overflow_is_reported_without_a_division():
    arm = mcgee.arms.planar_2r(m1=1e250, m2=1e250)
    arm.kinetic_energy(np.ones(2), np.ones(2))
    with pytest.warns(RuntimeWarning, match="overflow"):
        assert arm.kinetic_energy(np.ones(2), np.full(2, 1e40)) == np.inf
