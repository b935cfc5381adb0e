"""The pictures hold the figures, and survive what robots and their files may be."""

import dataclasses
import subprocess
import sys

import numpy as np
import pytest

from mcgee.explain import armplot, forces, maps, plots
from mcgee.explain.drawing import Drawing, mobility_axes, view_of
from mcgee.explain.live import Live, packed
from mcgee.explain.look import PALETTE, cells, most, short_names
from robots import built_in, random_state, random_tree

PICTURES = (
    armplot.arm,
    plots.mass_matrix,
    plots.coupling,
    plots.link_shares,
    forces.velocity_terms,
    forces.power_flow,
    forces.energy_budget,
    forces.gravity,
    forces.effort_shares,
    maps.skater,
)
MOVING = [0.5, 0.3], [0.7, -0.4], [1.0, 2.0]


def moving_2r():
    return built_in("planar_2r").explain(*MOVING)


@pytest.mark.parametrize("seed", range(8))
def test_points_are_where_the_robot_is(seed):
    rng = np.random.default_rng(seed)
    robot = random_tree(seed, mimic=0.3)
    q = random_state(robot, rng)[0]
    for frame in ("tool", robot.root, robot.end_frame):
        drawing = Drawing(robot, frame)
        points = drawing.points(q)
        want = robot.forward_kinematics(q, frame)[:, :3, 3]
        np.testing.assert_allclose(points[:, drawing.tip], want, atol=1e-12)
        coms = robot.link_poses(q)[..., :3, 3]
        np.testing.assert_allclose(points[:, drawing.centres], coms, atol=1e-12)


def test_planar_arms_are_drawn_in_their_plane_with_up_at_the_top():
    for name, labels in (
        ("planar_2r", ("x [m]", "y [m]")),
        ("pendulum", ("x [m]", "y [m]")),
        ("cart_pole", ("x [m]", "y [m]")),
    ):
        robot = built_in(name)
        view = view_of(Drawing(robot, robot.end_frame), np.zeros(robot.n))
        assert view.labels == labels
        np.testing.assert_allclose(view.gravity, [0, -1])
    for name in ("scara", "panda", "stanford"):
        robot = built_in(name)
        assert view_of(Drawing(robot, robot.end_frame), np.full(robot.n, 0.1)) is None


def test_gravity_square_to_the_plane_is_said():
    level = built_in("planar_2r").replace(gravity_vector=(0, 0, -9.81))
    words = [a.text for a in armplot.arm(level.explain([0.1, 0.2])).layout.annotations]
    assert words == ["gravity: square to the page"]
    none = level.replace(gravity_vector=(0, 0, 0))
    assert armplot.arm(none.explain([0.1, 0.2])).layout.annotations[0].text == "no gravity"


def test_ellipse_has_the_effective_masses_for_axes():
    e = built_in("panda").explain([0, -0.8, 0, -2.4, 0, 1.6, 0.8])
    axes = np.linalg.norm(mobility_axes(e.robot, e.q, e.task.frame), axis=-1)
    np.testing.assert_allclose(1 / axes, e.task.masses[::-1], rtol=1e-9)


def summed(bars):
    return np.nansum([np.array(bar.x, float) for bar in bars], 0)


def test_bars_add_up():
    e = moving_2r()
    shares = summed(plots.link_shares(e).data)
    np.testing.assert_allclose(shares, 100, rtol=1e-4)
    parts = summed(plots.entry_by_link(e, 0, 1).data)
    assert parts.sum() == pytest.approx(e.inertia.M[0, 1], rel=1e-4)
    for picture, total in ((forces.gravity, e.gravity.g), (forces.velocity_terms, e.velocity.Cqd)):
        *bars, marks = picture(e).data
        np.testing.assert_allclose(summed(bars), total, rtol=1e-4, atol=1e-9)
        np.testing.assert_allclose(marks.x, total, rtol=1e-4, atol=1e-9)


def test_bars_of_many_links_keep_their_sums():
    robot = random_tree(3, bodies=12, branching=0.1)
    e = robot.explain(np.full(robot.n, 0.3))
    *bars, _ = forces.gravity(e).data
    assert len(bars) == len(PALETTE) < len(robot.moving_links)
    np.testing.assert_allclose(summed(bars), e.gravity.g, atol=1e-4 * abs(e.gravity.g).max())


def test_power_flows_from_givers_to_takers():
    e = moving_2r()
    (flow,) = forces.power_flow(e).data
    i, j = np.unravel_index(e.velocity.flow.argmax(), (2, 2))
    names = e.robot.joint_names
    assert list(flow.node.label) == [f"{names[j]} gives", f"{names[i]} takes"]
    assert flow.link.value[0] == pytest.approx(e.velocity.flow.max(), rel=1e-5)


def test_energy_budget_balances_at_every_body():
    e = built_in("panda").explain(np.full(7, 0.4), np.full(7, 0.5), np.full(7, 0.3))
    (budget,) = forces.energy_budget(e).data
    net = np.zeros(len(budget.node.label))
    for a, b, watts in zip(*(budget.link[k] for k in ("source", "target", "value")), strict=True):
        net[a] -= watts
        net[b] += watts
    bodies = [k for k, name in enumerate(budget.node.label) if name.startswith("joint")]
    assert len(bodies) >= 5
    # what is under 1 % of the largest flow is not drawn
    assert abs(net[bodies]).max() <= 0.03 * max(budget.link.value)


@pytest.mark.parametrize(
    ("picture", "words"),
    [
        (forces.power_flow, "Nothing moves"),
        (forces.energy_budget, "Nothing moves"),
        (forces.velocity_terms, "No velocity terms"),
        (forces.effort_shares, "no margins to show"),
    ],
)
def test_empty_states_say_why(picture, words):
    made = picture(built_in("planar_2r").explain([0.5, 0.3]))
    assert not made.data
    assert words in made.layout.annotations[0].text


def test_no_weight_is_said():
    level = built_in("planar_2r").replace(gravity_vector=(0, 0, -9.81)).explain([0.5, 0.3])
    assert "g = 0" in forces.gravity(level).layout.annotations[0].text


@pytest.mark.parametrize("name", ["pendulum", "cart_pole", "scara", "stanford", "panda"])
def test_every_picture_of_every_kind_of_arm(name):
    robot = built_in(name)
    e = robot.explain(np.full(robot.n, 0.3), np.full(robot.n, 0.2), np.full(robot.n, 0.1))
    for picture in PICTURES:
        assert "NaN" not in picture(e).to_json()


def test_sweep_marks_where_the_lesson_says():
    """M11 is largest stretched, q2 = 0, and smallest folded, q2 = π."""
    marks = next(t for t in maps.skater(moving_2r()).data if "extremes" in (t.meta or {}))
    assert abs(abs(marks.x[0]) - np.pi) < 1e-4
    assert abs(marks.x[1]) < 1e-9


def test_map_marks_the_place_nearest_to_the_pose():
    e = moving_2r()
    live = Live(e)
    s = live.sweep_of(0, 1)
    _, marks, pose = maps.plane(e, s, s.M[..., 0, 0], "kg·m²").data
    step = s.at[0][1] - s.at[0][0]
    assert abs(marks.x[1] - e.q[0]) <= step
    assert abs(marks.y[1]) < 1e-9
    assert (pose.x[0], pose.y[0]) == tuple(e.q)


def test_names_are_not_markup():
    robot = built_in("planar_2r")
    named = {"joint1": "<b>bold</b>", "joint2": "<a href='javascript:x'>%{x}</a>"}
    joints = tuple(dataclasses.replace(j, name=named.get(j.name, j.name)) for j in robot.joints)
    e = dataclasses.replace(robot, joints=joints).explain(*MOVING)
    for picture in PICTURES:
        text = picture(e).to_json()
        assert "<b>bold" not in text
        assert "<a href" not in text


def test_short_names():
    assert short_names(("panda_joint1", "panda_joint2")) == ("joint1", "joint2")
    assert short_names(("leg_1_joint", "arm_1_joint")) == ("leg", "arm")
    assert short_names(("joint1", "joint2")) == ("joint1", "joint2")
    assert short_names(("a", "a_b")) == ("a", "a_b")
    assert short_names(("only_one",)) == ("only_one",)
    assert short_names(("a_x_b", "a_b")) == ("a_x_b", "a_b")


def test_cells_are_short_and_honest():
    texts = cells(np.array([[1.4, -0.0004], [0.005, 0.0]]))
    assert texts == [["1.40", "≈0"], ["0.005", "0"]]
    assert cells(np.array([[250.0, -3.2]])) == [["250", "−3"]]


def test_most_keeps_the_largest():
    kept, rest = most(np.arange(10.0), 4)
    assert kept == [7, 8, 9]
    assert rest == [1, 2, 3, 4, 5, 6]
    assert most(np.array([1.0, 0.0]), 4) == ([0], [])


def test_packed_is_little_endian_single():
    held = packed(np.array([[1.0, -2.0]]))
    assert held == {"shape": [1, 2], "f4": "AACAPwAAAMA="}


def test_sweeps_hold_the_explained_pose():
    live = Live(moving_2r())
    for sweep in live.sweeps():
        at = live.poses[sweep["joint"]][:, sweep["joint"]]
        assert at[sweep["start"]] == live.e.q[sweep["joint"]]
        assert (np.diff(at) >= 0).all()


def test_plotting_waits_until_asked():
    code = "import sys, mcgee.explain; print(*sys.modules)"
    got = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "plotly" not in got


def test_missing_plotly_is_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly", None)
    monkeypatch.setitem(sys.modules, "plotly.graph_objects", None)
    with pytest.raises(ModuleNotFoundError, match=r"^Pictures need Plotly: install mcgee\[plot\]"):
        plots.mass_matrix(moving_2r())
