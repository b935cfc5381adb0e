"""A row alone has the bits it has in a batch."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from programs import compiling_for, of_robot, program, random_program, same_bits, targets

import mcgee
from mcgee import build
from mcgee.graph.program import Program
from mcgee.jit.compile import compiled_row
from mcgee.jit.ufunc import gufunc
from robots import loaded, random_tree


def computed(p: Program, *rows: np.ndarray) -> tuple[int, list[np.ndarray]]:
    """What the compiled function returns and leaves in its outputs."""
    outputs = [np.full(o.shape, 7.0) for o in p.outputs]
    ins = (ctypes.c_void_p * len(rows))(*(row.ctypes.data for row in rows))
    outs = (ctypes.c_void_p * len(outputs))(*(o.ctypes.data for o in outputs))
    function = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)(compiled_row(p))
    return function(ctypes.addressof(ins), ctypes.addressof(outs)), outputs


def assert_same_bits(p: Program, *arrays: np.ndarray) -> None:
    batch = gufunc(p)(*arrays)
    batch = batch if isinstance(batch, tuple) else (batch,)
    for i in range(len(arrays[0])):
        failed, row = computed(p, *(np.ascontiguousarray(a[i]) for a in arrays))
        assert failed == 0
        assert all(same_bits(got, whole[i]) for got, whole in zip(row, batch, strict=True))


@pytest.mark.parametrize("quantity", list(build.SIGNATURES))
@pytest.mark.parametrize("name", ["ur5", "panda", "tree"])
def test_a_row_alone_has_the_bits_it_has_in_a_batch(name, quantity):
    robot = random_tree(5, mimic=0.3) if name == "tree" else loaded(name)
    p = of_robot(robot, quantity)
    rng = np.random.default_rng(len(quantity))
    arrays = [rng.normal(size=(19, a.size)) * 3 for a in p.inputs]
    arrays[0][3] *= 1e5  # beyond the reach of our own sine
    assert_same_bits(p, *arrays)


@pytest.mark.parametrize("seed", range(20))
def test_random_programs(seed):
    p = random_program(seed, (3, 2), (2, 2), (), operations=60)
    rng = np.random.default_rng(seed)
    assert_same_bits(p, rng.normal(size=(9, 3)), rng.normal(size=(9, 2)))


@pytest.mark.parametrize("name", targets())
@pytest.mark.parametrize("quantity", ["inverse_dynamics", "forward_dynamics", "terms"])
def test_with_other_registers(name, quantity):
    p = of_robot(random_tree(5, mimic=0.3), quantity)
    with compiling_for(targets()[name]):
        assert_same_bits(p, *(np.random.default_rng(1).normal(size=(7, a.size)) for a in p.inputs))


@pytest.mark.parametrize("name", targets())
@pytest.mark.parametrize("quantity", ["mass_matrix", "inverse_dynamics", "forward_dynamics"])
def test_float32_with_other_registers(name, quantity):
    p = of_robot(loaded("ur5"), quantity)
    arrays = [np.random.default_rng(k).normal(size=(37, a.size)) for k, a in enumerate(p.inputs)]
    singles = [array.astype(np.float32) for array in arrays]
    with compiling_for(targets()[name]):
        got = gufunc(p, single=True)(*singles)
        want = gufunc(p)(*(single.astype(float) for single in singles))
    assert got.dtype == np.float32
    assert 0 < np.abs(got - want).max() <= 40 * 2.0**-24 * np.abs(want).max()


def test_scratch_that_no_stack_should_hold():
    robot = loaded("talos")
    p = of_robot(robot, "mass_matrix_inverse")
    assert_same_bits(p, np.random.default_rng(0).normal(size=(3, robot.n)))


def test_more_angles_than_lanes():
    p = program(lambda q: [s for x in q for s in x.cos_sin()], (21,))
    assert_same_bits(p, np.random.default_rng(0).normal(size=(4, 21)) * 10)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1.1e60, -1e300])
def test_what_could_overflow_is_left_to_numpy(bad):
    p = program(lambda x, y: [x[0] * y[0], x[1] + y[2]], (3, 3))
    for k in range(3):
        y = np.ones(3)
        y[k] = bad
        assert computed(p, np.ones(3), y)[0] == 1


def test_a_result_that_is_not_finite_is_left_to_numpy():
    p = program(lambda x: [1 / x[0], x[1]], (2,))
    assert computed(p, np.array([0.0, 1.0]))[0] == 1
    assert computed(p, np.array([2.0, 1.0]))[0] == 0


def test_the_largest_legal_inputs():
    arm = mcgee.load("planar_2r")
    p = of_robot(arm, "inverse_dynamics")
    assert_same_bits(p, np.ones((2, 2)), np.full((2, 2), 1e60), np.full((2, 2), -1e60))
