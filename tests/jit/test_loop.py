"""Compiled gufuncs against the reference interpreter: every size, shape, layout and target.

On a target without multiply-add a program without cosines gives the interpreter's very bits, which
tells a wrong element from a rounding; with cosines or multiply-add it agrees to rounding.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from programs import (
    compiled_for,
    of_robot,
    program,
    random_program,
    same_bits,
    target,
    targets,
)

from mcgee import arms
from mcgee.graph.program import Program, evaluate
from mcgee.jit import kernel, loop
from mcgee.jit.target import host
from mcgee.jit.ufunc import gufunc, signature
from robots import random_tree

ROUNDING = 1e-12
"""Of the largest output: some tens of operations on numbers near one."""

SHAPES = {
    "scalar": ((1,), ()),
    "one": ((1,), (1,)),
    "pair": ((2,), (2, 2), ()),
    "three arrays": ((3, 3, 3), (3,), (3, 3)),
    "cube": ((5,), (5, 5, 5)),
    "many": ((9, 17), (17,), (), (2, 3, 4), (1, 1, 1)),
    "wide": ((16,), (16,), (4, 4)),
    "flat cube": ((7,), (1, 7, 1), (2, 1, 3)),
}
LANES = (2, 4, 8)


def exact(p: Program, lanes: int = host().lanes) -> np.ufunc:
    return compiled_for(target(lanes, fma=False), p)


def tuple_of(results) -> tuple:
    return results if isinstance(results, tuple) else (results,)


def agree(got, wanted, *, bits: bool) -> None:
    got, wanted = tuple_of(got), tuple_of(wanted)
    assert len(got) == len(wanted)
    for a, b in zip(got, wanted, strict=True):
        assert a.shape == b.shape
        if bits:
            assert np.array_equal(a, b, equal_nan=True)
        else:
            assert np.abs(a - b).max(initial=0) <= ROUNDING * max(1, np.abs(b).max(initial=0))


def arrays(p: Program, *lead: int, seed: int = 0) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [rng.uniform(-2, 2, (*lead, array.size)) for array in p.inputs]


@pytest.fixture(scope="module", params=SHAPES)
def shaped(request):
    """A program without cosines, and its gufuncs for each number of lanes."""
    inputs, *outputs = SHAPES[request.param]
    p = random_program(len(request.param), inputs, *outputs, trigonometry=False)
    return p, {lanes: exact(p, lanes) for lanes in LANES}


# -- sizes ----------------------------------------------------------------------------------------


def test_every_batch_size(shaped):
    p, functions = shaped
    for lanes, function in functions.items():
        for rows in range(3 * lanes + 2):
            x = arrays(p, rows, seed=rows)
            agree(function(*x), tuple(evaluate(p, *x)), bits=True)
        x = arrays(p)
        agree(tuple(map(np.asarray, tuple_of(function(*x)))), tuple(evaluate(p, *x)), bits=True)


@pytest.mark.parametrize("size", range(1, 18))
def test_every_size(size):
    """Smaller and larger than a register, and no power of two."""
    p = random_program(size, (size,), (size,), (size + 1,), trigonometry=False)
    for lanes in LANES:
        function = exact(p, lanes)
        for rows in (1, lanes - 1, lanes, 2 * lanes, 2 * lanes + 1):
            x = arrays(p, rows, seed=rows)
            agree(function(*x), tuple(evaluate(p, *x)), bits=True)


def test_many_rows_and_many_dimensions(shaped):
    p, functions = shaped
    for lead in ((10_007,), (3, 1, 5, 2, 7), (2, 0, 3), (1, 1, 1)):
        x = arrays(p, *lead)
        agree(functions[max(LANES)](*x), tuple(evaluate(p, *x)), bits=True)


def test_leading_dimensions_broadcast():
    p = random_program(5, (3, 4), (4,), (2, 3), trigonometry=False)
    function = exact(p)
    for left, right in [
        ((), (20,)),
        ((20,), ()),
        ((13, 1), (1, 17)),
        ((17,), (3, 1)),
        ((2, 1, 9), (4, 1)),
        ((1,), (0,)),
    ]:
        a, b = arrays(p, *left)[0], arrays(p, *right)[1]
        agree(function(a, b), tuple(evaluate(p, a, b)), bits=True)
    with pytest.raises(ValueError, match="broadcast"):
        function(np.zeros((2, 3)), np.zeros((3, 4)))
    with pytest.raises(ValueError, match="mismatch in its core dimension"):
        function(np.zeros((2, 4)), np.zeros((2, 4)))


# -- layouts --------------------------------------------------------------------------------------


def layouts(a: np.ndarray) -> dict[str, np.ndarray]:
    """Arrays equal to a (rows, n), laid out in other ways."""
    rows, n = a.shape
    spread = np.full((2 * rows + 1, 3 * n + 2), 777.0)
    spread[1::2, 1:-1:3] = a
    bytes_ = np.zeros(a.nbytes + 1, np.uint8)
    unaligned = bytes_[1:].view(np.float64).reshape(a.shape)
    unaligned[...] = a
    frozen = a.copy()
    frozen.flags.writeable = False
    padded = np.zeros((rows, n, 3))
    padded[..., 2] = a
    return {
        "contiguous": a.copy(),
        "rows backwards": a[::-1].copy()[::-1],
        "columns backwards": a[:, ::-1].copy()[:, ::-1],
        "both backwards": a[::-1, ::-1].copy()[::-1, ::-1],
        "Fortran": np.asfortranarray(a),
        "strided": spread[1::2, 1:-1:3],
        "strided columns": padded[..., 2],
        "rows apart": np.concatenate([a, a], axis=1)[:, :n],
        "unaligned": unaligned,
        "read-only": frozen,
        "other endian": a.astype(a.dtype.newbyteorder()),
        "list": a.tolist(),
    }


def test_layouts_of_inputs(shaped):
    p, functions = shaped
    for lanes, function in functions.items():
        x = arrays(p, 2 * lanes + 1)
        wanted = tuple(evaluate(p, *x))
        for name in layouts(x[0]):
            agree(function(*(layouts(a)[name] for a in x)), wanted, bits=True)


def test_stride_zero():
    p = random_program(8, (5, 5), (5,), trigonometry=False)
    function = exact(p)
    a, b = arrays(p, 21)
    same_row = np.broadcast_to(a[0], (21, 5))
    same_column = np.broadcast_to(b[:, :1], (21, 5))
    assert 0 in same_row.strides
    assert 0 in same_column.strides
    agree(function(same_row, same_column), evaluate(p, same_row, same_column)[0], bits=True)


def test_dtypes_cast_as_numpy_casts():
    p = random_program(9, (3, 3), (3,), trigonometry=False)
    function = exact(p)
    x, y = arrays(p, 19)
    for dtype in (np.float32, np.float16, np.int64, np.int8, np.uint16, bool):
        a, b = x.astype(dtype), (y * 2).astype(dtype)
        got = function(a, b)
        assert got.dtype == np.float64
        agree(got, evaluate(p, a.astype(float), b.astype(float))[0], bits=True)
    single = np.zeros((19, 3), np.float32)
    assert function(x, y, out=single) is single
    assert np.array_equal(single, evaluate(p, x, y)[0].astype(np.float32))
    for wrong in (x.astype(complex), x.astype(object), np.full(x.shape, "a")):
        with pytest.raises(TypeError):
            function(wrong, y)


def test_layouts_of_outputs(shaped):
    """What lies between and around the elements of out= stays as it was."""
    p, functions = shaped
    for lanes, function in functions.items():
        rows = 2 * lanes + 1
        x = arrays(p, rows)
        wanted = evaluate(p, *x)
        for step in (1, -1, 2, -3):
            for axis in range(-1, 3):
                held, outs = [], []
                for array in wanted:
                    # the batch axis anywhere, one axis backwards or spread
                    place = min(max(axis, 0), array.ndim - 1)
                    moved = np.moveaxis(array, 0, place)
                    shape = [abs(step) * size + 2 for size in moved.shape]
                    buffer = np.full(shape, 777.0)
                    inner = buffer[tuple(slice(1, -1) for _ in shape)]
                    view = np.moveaxis(inner[(slice(None, None, step),) * moved.ndim], place, 0)
                    held.append(buffer)
                    outs.append(view)
                got = tuple_of(function(*x, out=tuple(outs)))
                for buffer, out, result, want in zip(held, outs, got, wanted, strict=True):
                    assert result is out
                    assert np.array_equal(out, want)
                    out[...] = 777.0
                    assert (buffer == 777.0).all()


def test_output_over_input():
    p = random_program(3, (6,), (6,), trigonometry=False)
    function = exact(p)
    for rows in (1, 5, 8, 9, 33):
        (x,) = arrays(p, rows + 1)
        for source, sink in [
            (np.s_[:rows], np.s_[:rows]),
            (np.s_[:rows], np.s_[1:]),
            (np.s_[1:], np.s_[:rows]),
            (np.s_[:rows], np.s_[rows - 1 :: -1]),
            (np.s_[:rows, ::-1], np.s_[:rows]),
        ]:
            buffer = x.copy()
            wanted = evaluate(p, buffer[source].copy())[0]
            function(buffer[source], out=buffer[sink])
            assert np.array_equal(buffer[sink], wanted)


def test_output_over_a_broadcast_input():
    p = random_program(4, (4,), (4, 4), trigonometry=False)
    function = exact(p)
    buffer = np.random.default_rng(0).uniform(-1, 1, (11, 4, 4))
    row = buffer[5, 2]
    wanted = evaluate(p, np.broadcast_to(row.copy(), (11, 4)))[0]
    function(np.broadcast_to(row, (11, 4)), out=buffer)
    assert np.array_equal(buffer, wanted)


def test_ufunc_keywords():
    p = random_program(2, (3,), (3, 3), trigonometry=False)
    function = exact(p)
    (x,) = arrays(p, 12)
    wanted = evaluate(p, x)[0]
    assert np.array_equal(function(x.T, axes=[0, (0, 1)]), np.moveaxis(wanted, 0, -1))
    assert function(x, dtype=float).shape == (12, 3, 3)
    assert np.array_equal(function(x, order="F"), wanted)
    assert function.signature == signature(p) == "(3)->(3,3)"
    assert (function.nin, function.nout, function.types) == (1, 1, ["d->d"])
    with pytest.raises(ValueError, match=r"mismatch in its core|broadcast"):
        function(x, out=np.zeros((11, 3, 3)))
    locked = np.zeros((12, 3, 3))
    locked.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        function(x, out=locked)


# -- special values -------------------------------------------------------------------------------


def test_nan_rows_poison_exactly_their_own_row():
    p = random_program(11, (3, 4), (5,), (), (2, 3))
    assert any(not hasattr(root, "op") for root in p.roots)  # constants among the outputs
    for t in targets().values():
        function = compiled_for(t, p)
        for rows in range(1, 3 * t.lanes + 2):
            clean = arrays(p, rows, seed=rows)
            wanted = function(*clean)
            rng = np.random.default_rng(rows)
            bad = rng.random(rows) < 0.3
            bad[rng.integers(rows)] = True
            x = [a.copy() for a in clean]
            for row in np.flatnonzero(bad):
                array = x[rng.integers(2)]
                array[row, rng.integers(array.shape[1])] = rng.choice([np.nan, -np.nan])
            for got, want in zip(function(*x), wanted, strict=True):
                assert np.isnan(got[bad]).all()
                assert same_bits(got[~bad], want[~bad])


def test_an_input_that_nothing_reads_still_poisons():
    p = program(lambda x, y: (x[0], 2.0), (1, 1))
    got = gufunc(p)(np.ones((3, 1)), [[0.0], [math.nan], [0.0]])
    assert np.array_equal(got, [[1, 2], [math.nan, math.nan], [1, 2]], equal_nan=True)


def test_nan_strikes_in_every_layout_of_outputs():
    p = random_program(12, (2,), (3, 2), trigonometry=False)
    function = exact(p)
    (x,) = arrays(p, 19)
    wanted = evaluate(p, x)[0]
    x[[0, 7, 8, 18], 1] = math.nan
    wanted[[0, 7, 8, 18]] = math.nan
    buffer = np.full((2, 8, 40), 777.0)
    out = np.moveaxis(buffer[:, 1:7:2, 1:39:2], -1, 0)[::-1].swapaxes(1, 2)
    function(x[::-1], out=out[::-1])
    assert np.array_equal(out[::-1], wanted[::-1], equal_nan=True)
    out[...] = 777.0
    assert (buffer == 777.0).all()


def test_infinities_and_denormals_are_ordinary_numbers():
    p = program(lambda x: (x[0] + 1, x[1] * 2, 5.0, x[0] - x[1], x[1] / 3), (2,))
    function = exact(p)
    x = np.array([[np.inf, 1e-310], [-np.inf, 5e-324], [1e308, -1e-320], [1.0, -0.0]] * 5)
    assert np.array_equal(function(x), evaluate(p, x)[0])
    assert np.signbit(function(x)[3, [1, 4]]).all()


def test_programs_without_operations():
    p = program(lambda x: (x[1], 2.0, x[0], x[1], -0.5, math.inf), (2,), (2, 3))
    for t in targets().values():
        function = compiled_for(t, p)
        for rows in range(2 * t.lanes + 2):
            x = arrays(p, rows)
            agree(function(*x), evaluate(p, *x)[0], bits=True)


def test_constants_alone():
    p = program(lambda x: (1.0, 0.0, -2.0, 1.0), (3,), (2, 2))
    got = gufunc(p)(np.zeros((9, 3)))
    assert np.array_equal(got, np.broadcast_to([[1.0, 0.0], [-2.0, 1.0]], (9, 2, 2)))


def test_signs_of_constant_zeros():
    p = program(lambda x: (0.0, -0.0, x[0], 0.0), (1,))
    assert np.signbit(gufunc(p)([1.0])).tolist() == [False, True, False, False]


def test_the_same_root_twice_and_inputs_among_the_roots():
    p = program(lambda x, y: (s := x[0] * y[1], x[1], s, y[0], s, x[1]), (2, 2), (3, 2))
    x = arrays(p, 21)
    agree(gufunc(p)(*x), evaluate(p, *x)[0], bits=True)


# -- determinism ----------------------------------------------------------------------------------


def test_a_row_has_the_same_bits_alone_and_anywhere():
    p = of_robot(arms.ur5e(), "terms")
    function = gufunc(p)
    lanes = host().lanes
    x = arrays(p, 3 * lanes + 1)
    alone = [np.stack(column) for column in zip(*map(function, *x), strict=True)]
    for got, want in zip(function(*x), alone, strict=True):
        assert same_bits(got, want)
    for place in range(3 * lanes + 1):  # row 0 at every place, among other neighbours
        moved = [np.roll(a, place, axis=0) for a in x]
        for got, want in zip(function(*moved), alone, strict=True):
            assert same_bits(got[place], want[0])
    for name in layouts(x[0]):
        for got, want in zip(function(*(layouts(a)[name] for a in x)), alone, strict=True):
            assert same_bits(got, want)
    for place in range(1, 3 * lanes):
        head, tail = function(*(a[:place] for a in x)), function(*(a[place:] for a in x))
        for first, second, want in zip(head, tail, alone, strict=True):
            assert same_bits(np.concatenate([first, second]), want)


def test_threads_share_a_gufunc():
    p = of_robot(arms.puma560(), "terms")
    function = gufunc(p)
    x = arrays(p, 4001)
    wanted = function(*x)
    with ThreadPoolExecutor(8) as pool:
        for results in pool.map(lambda _: function(*x), range(40)):
            assert all(same_bits(a, b) for a, b in zip(results, wanted, strict=True))
        pieces = list(pool.map(lambda i: function(*(a[i : i + 37] for a in x)), range(0, 4001, 37)))
    for k, want in enumerate(wanted):
        assert same_bits(np.concatenate([piece[k] for piece in pieces]), want)


# -- parts and tiles ------------------------------------------------------------------------------


@pytest.mark.parametrize("part", [1, 2, 7])
def test_parts_change_no_bit(part, monkeypatch):
    p = random_program(21, (3, 2), (4,), (2, 2), (), operations=60)
    whole = gufunc(p)
    monkeypatch.setattr(kernel, "PART", part)
    ir = kernel.kernel_ir(p, host())
    assert ir.text.count("define") > 60 / part / 3
    assert ir.work > 0
    x = arrays(p, 33)
    for got, want in zip(gufunc(p)(*x), whole(*x), strict=True):
        assert same_bits(got, want)


def test_a_program_of_many_parts(monkeypatch):
    p = random_program(22, (4,), (6,), operations=3 * kernel.PART)
    assert len(p.nodes) > 2 * kernel.PART
    split = gufunc(p)
    monkeypatch.setattr(kernel, "PART", 10**9)
    x = arrays(p, 19)
    assert same_bits(split(*x), gufunc(p)(*x))
    agree(split(*x), evaluate(p, *x)[0], bits=False)


def test_parts_of_a_robot(monkeypatch):
    p = of_robot(arms.scara(), "coriolis_matrix")
    whole = gufunc(p)
    monkeypatch.setattr(kernel, "PART", 11)
    x = arrays(p, 25)
    assert same_bits(gufunc(p)(*x), whole(*x))


def test_tiles_on_the_heap_change_no_bit(monkeypatch):
    p = random_program(23, (3, 2), (4,), (2, 2))
    small = gufunc(p)
    monkeypatch.setattr(loop, "STACK", 0)
    heap = gufunc(p)
    for rows in (0, 1, 7, 8, 33):
        x = arrays(p, rows)
        for got, want in zip(heap(*x), small(*x), strict=True):
            assert same_bits(got, want)


def test_a_tile_too_large_for_the_stack():
    size = loop.STACK // (8 * host().lanes) + 3
    p = program(lambda x: (x[0] + x[size - 1], x[size // 2], *x[5:20]), (size,))
    assert "PyMem_RawMalloc" in loop.loop_ir(p, kernel.kernel_ir(p, host()), host())
    x = arrays(p, 2 * host().lanes + 1)
    agree(gufunc(p)(*x), evaluate(p, *x)[0], bits=True)


# -- robots and targets ---------------------------------------------------------------------------

ROBOTS = {
    "ur5e": arms.ur5e,
    "cart_pole": arms.cart_pole,
    "tree": lambda: random_tree(4, bodies=7, mimic=0.3),
}


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize(
    "quantity", ["terms", "inverse_dynamics", "christoffel", "forward_dynamics", "jacobian"]
)
def test_robots_agree_with_the_interpreter(name, quantity):
    p = of_robot(ROBOTS[name](), quantity)
    function = gufunc(p)
    for rows in (1, host().lanes, 3 * host().lanes + 1):
        x = arrays(p, rows)
        wanted = tuple(evaluate(p, *x))
        scale = max(np.abs(w).max() for w in wanted)
        for got, want in zip(tuple_of(function(*x)), wanted, strict=True):
            assert np.abs(got - want).max() <= 1e-10 * max(scale, 1)


@pytest.mark.parametrize("name", targets())
def test_every_target_agrees_with_the_interpreter(name):
    t = targets()[name]
    for p in (
        random_program(31, (3, 4), (5,), (2, 3), (), operations=80),
        of_robot(arms.ur5e(), "terms"),
    ):
        function = compiled_for(t, p)
        for rows in (1, t.lanes - 1, t.lanes, 3 * t.lanes + 1):
            x = arrays(p, rows)
            agree(function(*x), tuple(evaluate(p, *x)), bits=False)


def test_multiply_add_is_used_where_it_is_there_and_only_there():
    p = program(lambda x: (x[0] * x[1] + x[2], x[0] - x[1] * x[2], x[0] * x[1] - x[2]), (3,))
    x = np.array([1 + 2**-30, 1 - 2**-30, -1.0])
    for t in targets().values():
        text = kernel.kernel_ir(p, t).text
        assert text.count("@llvm.fma") == 3 * t.fma
        assert (compiled_for(t, p)(x)[0] != 0) == t.fma  # the product's last bits survive
