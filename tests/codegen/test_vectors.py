"""Vectors are exact, deterministic, and measure errors by what a result can say."""

from __future__ import annotations

from importlib import resources

import mpmath
import numpy as np
import pytest
from units import arm, made

import mcgee
from mcgee import quantities
from mcgee.codegen.common import layout
from mcgee.codegen.vectors import STATES


def columns(unit, k: int = 0):
    f = unit.functions[k]
    rows, row = np.array(f.vectors.rows), layout(f)
    taken = {a.name: rows[:, at : at + a.size] for a, at in row.inputs}
    given = {
        a.name: rows[:, at : at + a.size].reshape(len(rows), *a.shape) for a, at, _ in row.outputs
    }
    scales = {a.name: rows[:, s] for a, _, s in row.outputs}
    return taken, given, scales


@pytest.mark.parametrize("name", ["planar_2r", "puma560", "panda"])
def test_results_are_those_of_pinocchio_like_kernels(name):
    unit = made(name, ("terms", "forward_dynamics"))
    taken, given, scales = columns(unit)
    for got, key in zip(arm(name).terms(taken["q"], taken["qdot"]), given, strict=True):
        axes = tuple(range(1, got.ndim))
        assert (abs(got - given[key]).max(axes) <= 4 * 2.0**-52 * scales[key]).all()
    taken, given, scales = columns(unit, 1)
    got = arm(name).forward_dynamics(*taken.values())
    assert (abs(got - given["qddot"]).max(1) <= 16 * 2.0**-52 * scales["qddot"]).all()


def test_results_are_rounded_once():
    unit = made("planar_2r")
    row = unit.functions[0].vectors.rows[8]
    with mpmath.workdps(40):
        q, qd = ([mpmath.mpf(x) for x in row[i : i + 2]] for i in (0, 2))
        M, Cqd, g = quantities.terms(arm("planar_2r").mechanism.map(mpmath.mpf), q, qd)
    want = [float(x) for x in (*M[0], *M[1], *Cqd, *g)]
    assert list(row[4:12]) == want


def test_hard_states_are_among_them():
    taken, _, _ = columns(made("puma560", ("inverse_dynamics",)))
    q, qdot = taken["q"], taken["qdot"]
    assert len(q) == STATES
    assert (q == 0).all(1).any()
    assert (abs(q) == np.pi).all(1).any()
    assert (abs(q).max(1) > 100).any()
    assert (abs(qdot).max(1) > 30).any()
    assert (qdot == 0).all(1).any()
    assert ((abs(q) < 1e-8) & (q != 0)).all(1).any()


def test_parameters_change_from_some_state_on():
    taken, _, _ = columns(made("planar_2r", params=True))
    same = (taken["params"] == taken["params"][0]).all(1)
    assert same[:12].all()
    assert not same[12:].any()


def test_inertias_of_a_body_stay_those_of_a_body():
    taken, _, _ = columns(made("panda", params=True))
    default = np.array(list(made("panda", params=True).model.defaults.values())).reshape(7, 10)
    for row in taken["params"]:
        mine = row.reshape(7, 10)
        used = default != 0
        factor = np.where(used, mine / np.where(used, default, 1), np.nan)
        assert np.nanmax(factor, 1) == pytest.approx(np.nanmin(factor, 1), rel=1e-14)


def test_scales_are_never_zero():
    unit = made("planar_2r", ("gravity", "coriolis", "christoffel"))
    for k in range(3):
        _, _, scales = columns(unit, k)
        for scale in scales.values():
            assert (scale > 0).all()


def test_a_far_state_has_a_larger_scale():
    """Where q is 300 rad its last digit alone moves the result by hundreds of last places."""
    taken, _, scales = columns(made("planar_2r"))
    far = abs(taken["q"]).max(1) > 50
    near = ~far & (abs(taken["qdot"]).max(1) < 10)
    assert scales["g"][far].min() > 3 * scales["g"][near].max()


def test_single_states_are_floats():
    unit = made("planar_2r", single=True)
    taken, _, _ = columns(unit)
    for values in taken.values():
        assert np.array_equal(values, values.astype(np.float32))


def test_the_same_twice():
    from mcgee.codegen.unit import unit

    robot = arm("puma560")
    first, second = (unit(robot, ["terms"], False, {}, robot.end_frame, False) for _ in range(2))
    assert first.functions[0].vectors == second.functions[0].vectors
    assert first.fingerprint == second.fingerprint
    fresh = first.fresh_vectors(first.functions[0])
    assert fresh != first.functions[0].vectors
    assert fresh == second.fresh_vectors(second.functions[0])


def test_fingerprints_tell_descriptions_apart():
    heavy = arm("planar_2r").replace(gravity_vector=(0, -9.82, 0))
    from mcgee.codegen.unit import unit

    other = unit(heavy, ["gravity"], False, {}, heavy.end_frame, False)
    assert other.fingerprint != made("planar_2r", ("gravity",)).fingerprint


def test_fingerprints_do_not_know_where_a_file_lies(tmp_path):
    from mcgee.codegen.unit import unit

    text = (resources.files("mcgee") / "robots" / "panda.urdf").read_text()
    found = []
    for name in ("a.urdf", "b.urdf"):
        (tmp_path / name).write_text(text)
        robot = mcgee.load(tmp_path / name)
        found.append(unit(robot, ["gravity"], False, {}, robot.end_frame, False).fingerprint)
    assert found[0] == found[1] == made("panda", ("gravity",)).fingerprint
