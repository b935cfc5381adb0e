"""Slid and turned frames: the same arm, fewer lengths and fewer operations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import mcgee
from mcgee import build, quantities
from mcgee.algorithms.frames import canonical, slid
from mcgee.algorithms.turns import COMPOSITES, NEWTON_EULER, STATICS
from mcgee.graph.program import evaluate
from mcgee.mechanism import GROUND, Mechanism
from mcgee.model import Pose
from robots import built_in, loaded, random_tree


def lengths(m: Mechanism) -> list[tuple[float, ...]]:
    return [b.pose.translation for b in m.bodies if b.parent != GROUND]


def zeros(m: Mechanism) -> int:
    return sum(x == 0 for offset in lengths(m) for x in offset)


QUANTITIES = {
    "mass_matrix": ("q",),
    "inverse_dynamics": ("q", "qd", "qdd"),
    "coriolis_matrix": ("q", "qd"),
    "christoffel": ("q",),
    "gravity": ("q",),
    "gravity_gradient": ("q",),
    "potential_energy": ("q",),
    "kinetic_energy": ("q", "qd"),
    "forward_kinematics": ("q", "tool"),
    "jacobian": ("q", "camera"),
    "link_jacobians": ("q",),
    "link_accelerations": ("q", "qd", "qdd"),
}


def compare(m: Mechanism, other: Mechanism, seed: int) -> None:
    q, qd, qdd = np.random.default_rng(seed).normal(size=(3, m.n)).tolist()
    for name, arguments in QUANTITIES.items():
        function = getattr(quantities, name)
        given = [{"q": q, "qd": qd, "qdd": qdd}.get(a, a) for a in arguments]
        mine, own = (np.array(function(x, *given), float) for x in (other, m))
        assert np.abs(mine - own).max() <= 1e-13 * max(np.abs(own).max(), 1.0), name


@pytest.mark.parametrize("costs", [NEWTON_EULER, COMPOSITES, STATICS])
@pytest.mark.parametrize("aligned", [0.0, 0.8])
@pytest.mark.parametrize("seed", range(15))
def test_nothing_a_user_sees_changes(seed, aligned, costs):
    m = random_tree(seed, bodies=7, aligned=aligned, mimic=0.2 * (seed % 3)).mechanism
    compare(m, slid(m), seed)
    compare(m, canonical(m, costs), seed)


def test_the_random_trees_have_every_kind_of_turn():
    found = [canonical(random_tree(s, bodies=7, mimic=0.2 * (s % 3)).mechanism) for s in range(15)]
    bodies = [body for m in found for body in m.bodies]
    assert any(b.offset is not None and b.multiplier != 1 for b in bodies)
    assert any(b.offset is None for b in bodies if not b.prismatic)
    assert all(b.offset is None for b in bodies if b.prismatic or b.parent == GROUND)


@pytest.mark.parametrize("seed", range(5))
def test_one_turn_about_x_is_left_between_arbitrary_axes(seed):
    """Denavit and Hartenberg's rotation, up to quarter turns, and two lengths at most joints."""
    m = canonical(general(seed, bodies=6))
    for body in m.bodies[1:]:
        kinds = sorted(abs(x) for row in body.pose.rotation for x in row)
        assert kinds[:4] == [0] * 4
        assert kinds[-1] == 1
        turn = np.array(body.pose.rotation)
        assert np.abs(turn @ turn.T - np.eye(3)).max() < 2e-15  # as the description
    assert zeros(m) >= 4  # one a joint, but where an origin would go farther than the arm reaches
    # the first joint needs no offset, nor the last where nothing is gained from its first moment
    assert m.bodies[0].offset is None
    assert canonical(general(seed, bodies=6), COMPOSITES).bodies[-1].offset is None


def general(seed: int, bodies: int) -> Mechanism:
    nothing = dict.fromkeys(("branching", "prismatic", "armature", "fixed", "aligned"), 0.0)
    m = random_tree(seed, bodies=bodies, **nothing).mechanism
    field = (np.array(m.bodies[0].pose.rotation).T[2] * -9.81).tolist()
    turned = []
    for i, body in enumerate(m.bodies):  # a random pose may be a quarter turn: tilt it
        tilt = Pose.from_rpy((0.3 + 0.01 * i, -0.4, 0.7 - 0.01 * i))
        turned.append(replace(body, pose=body.pose @ tilt if i else body.pose))
    return replace(m, bodies=tuple(turned), gravity=tuple(field))


@pytest.mark.parametrize("n", [5, 6, 7])
def test_fewer_operations_than_published_for_general_arms(n):
    """Khalil & Kleinfinger 1987: 92 n − 127 products and 81 n − 117 sums, frames and base
    parameters chosen as here; the first axis is vertical."""
    for seed in range(4):
        counts = build.trace(general(seed, n), "inverse_dynamics").operation_counts()
        assert counts["mul"] < 92 * n - 127
        assert counts["add"] < 81 * n - 117
        assert counts["sincos"] == n


def counted(m: Mechanism, name: str, monkeypatch: pytest.MonkeyPatch) -> tuple[int, int]:
    """Operations with frames slid, and slid and turned."""
    options = (list(m.frames)[-1],) if name in build.OF_A_FRAME else ()
    turned = build.trace(m, name, *options).arithmetic()
    with monkeypatch.context() as patch:
        patch.setattr(build, "_with_frames", lambda model, *_, **__: slid(model))
        return build.trace(m, name, *options).arithmetic(), turned


COUNTED = (
    *("inverse_dynamics", "mass_matrix", "forward_dynamics", "coriolis_matrix", "gravity"),
    *("inverse_dynamics_derivatives", "christoffel"),
)


@pytest.mark.parametrize("name", COUNTED)
def test_arbitrary_axes_save_operations(name, monkeypatch):
    least = {"christoffel": 0.08}.get(name, 0.15)
    for seed in range(3):
        slid_, turned = counted(general(seed, 6), name, monkeypatch)
        assert turned <= (1 - least) * slid_


@pytest.mark.parametrize("name", COUNTED)
def test_no_robot_pays_for_turns(name, monkeypatch):
    robots = [built_in(arm) for arm in ("panda", "puma560", "stanford", "scara")]
    robots += [loaded("ur5"), *(random_tree(s, aligned=1.0, exact=True) for s in range(4))]
    for robot in robots:
        slid_, turned = counted(robot.mechanism, name, monkeypatch)
        assert turned <= slid_, robot.name


@pytest.mark.parametrize("name", ["ur5", "puma560", "ur5e", "scara", "planar_3r"])
def test_aligned_arms_stay_as_they_are(name):
    m = (loaded if name == "ur5" else mcgee.load)(name).mechanism
    assert canonical(m) == slid(m)


def test_poses_and_parameters_of_links_keep_their_axes():
    """`link_poses` and the regressor speak of axes that users know."""
    m = general(0, 3)
    q, qd, qdd = np.random.default_rng(0).normal(size=(3, 3))
    for name, given in {"link_poses": (q,), "regressor": (q, qd, qdd)}.items():
        want = np.array(getattr(quantities, name)(m, *(list(x) for x in given)), float)
        got = evaluate(build.trace(m, name), *given)[0]
        assert np.abs(got - want).max() <= 1e-13 * np.abs(want).max()


@pytest.mark.parametrize("seed", range(30))
def test_never_more_lengths(seed):
    m = random_tree(seed, bodies=8, aligned=0.9).mechanism
    assert zeros(canonical(m)) >= zeros(m)


def test_parallel_axes_lose_their_displacement_and_crossing_axes_meet():
    """Of the UR5's joints 2, 3 and 4 are parallel, 1 and 2 meet; d4, d5 and d6 are left."""
    slid = canonical(loaded("ur5").mechanism)
    sizes = [tuple(round(abs(x), 5) for x in offset) for offset in lengths(slid)]
    assert sizes == [
        (0, 0, 0),
        (0, 0.425, 0),
        (0, 0.39225, 0),
        (0, 0, 0.10915),
        (0, 0, 0.09465),
    ]


def test_origins_stay_within_the_arms_own_size():
    """Nearly parallel axes cross far away: no origin goes there."""
    for seed in range(20):
        m = random_tree(seed, bodies=8, aligned=0.0).mechanism
        size = max(abs(x) for offset in lengths(m) for x in offset)
        own = [np.array(b.pose.translation) for b in m.bodies]
        moved = [np.array(b.pose.translation) for b in canonical(m).bodies]
        assert max(np.abs(a - b).max() for a, b in zip(own, moved, strict=True)) <= 2 * size


def test_prismatic_joints_stay():
    m = mcgee.load("cart_pole").mechanism
    assert lengths(canonical(m)) == lengths(m)
