"""What an explanation says: conventions first, figures' own numbers, 80 columns, strict JSON."""

import dataclasses
import json
import re

import numpy as np
import pytest

import mcgee
from mcgee.typeset import number, percent

STATES = {
    "planar_2r": ([0.5, 0.3], [0.1, -0.2]),
    "panda": ([0, -0.8, 0, -2.4, 0, 1.6, 0.8], [0.5, 0, 0, 0.5, 0, 0, 1]),
    "stanford": ([0.1, 0.2, 0.3, 0.4, 0.5, 0.6], [1, -1, 0.5, 0.2, 0.1, 0]),
    "cart_pole": ([0.1, 0.2], [1, 0.3]),
    "pendulum": ([0.4], [0.5]),
}


@pytest.fixture(scope="module", params=STATES)
def explanation(request):
    return mcgee.load(request.param).explain(*STATES[request.param])


def numbers_in(figure, found: set):
    """Every number that the figures hold, as a sentence would write it."""
    if dataclasses.is_dataclass(figure):
        for field in dataclasses.fields(figure):
            numbers_in(getattr(figure, field.name), found)
    elif isinstance(figure, (list, tuple, np.ndarray)):
        for value in np.asarray(figure, dtype=object).ravel():
            numbers_in(value, found)
    elif isinstance(figure, (int, float)):
        found |= {number(figure), percent(figure), number(abs(figure))}
    return found


def test_sentences_say_nothing_that_the_figures_do_not_hold(explanation):
    e = explanation
    held = {"0", "1", "3"}  # zero, a unit acceleration, of 3 directions
    for part in (e.inertia, e.task, e.velocity, e.gravity, e.felt):
        numbers_in(part, held)
    translation = e.velocity.translation.sum() / max(e.velocity.kinetic_energy, 1e-300)
    held |= {percent(translation), str(e.task.dimensions)}
    held |= {number(e.inertia.torque_columns(np.ones(e.robot.n)).max())}
    names = (*e.robot.joint_names, *e.robot.frame_names, *e.robot.moving_links)
    for sentence in e.sentences:
        plain = sentence
        for name in sorted(names, key=len, reverse=True):
            plain = plain.replace(name, "it")
        plain = re.sub(r"(m/s|rad/s|kg·m)[²]?", "unit", plain)
        for text in re.findall(r"−?\d[\d.]*(?:e[−+]?\d+)?(?: %)?", plain):
            assert text.rstrip(".") in held, f"{text} in {sentence!r}"


def test_a_number_that_is_not_a_figure_would_be_found():
    held = numbers_in(mcgee.load("planar_2r").explain([0.5, 0.3]).inertia, set())
    assert number(2.6553364) in held
    assert number(2.5) not in held


def test_reports_open_with_the_conventions_and_fit_80_columns(explanation):
    lines = str(explanation).splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[1].strip().startswith("q = 0:")
    text = " ".join(" ".join(line.split()) for line in lines)
    for convention in explanation.conventions.lines():
        assert convention in text
    for sentence in explanation.sentences:
        assert sentence in text


def test_conventions_of_the_planar_arm_say_which_way_is_up():
    lines = mcgee.arms.planar_2r().explain([0, 0]).conventions.lines()
    assert lines[0] == "q = 0: frame 'tip' stands at (2, 0, 0) m."
    assert lines[2] == "Gravity: 9.81 m/s² along −y; up is +y."
    down = mcgee.arms.planar_2r(angle_from="down").explain([0, 0]).conventions.lines()
    assert down[0] == "q = 0: frame 'tip' stands at (0, -2, 0) m."
    weightless = mcgee.arms.planar_2r().replace(gravity_vector=(0, 0, 0)).explain([0, 0])
    assert "Gravity: none." in weightless.conventions.lines()


def test_json_is_strict_and_complete(explanation):
    report = json.loads(json.dumps(explanation.to_dict(), allow_nan=False))
    assert report["sentences"] == list(explanation.sentences)
    np.testing.assert_array_equal(report["inertia"]["M"], explanation.inertia.M)
    np.testing.assert_array_equal(report["velocity"]["flow"], explanation.velocity.flow)
    assert set(report) == {
        *("robot", "q", "qd", "qdd", "conventions", "inertia", "task"),
        *("velocity", "energy", "gravity", "sentences", "felt_by_first_joint", "worst"),
    }


def test_the_sentences_of_the_lessons_reference_point():
    sentences = mcgee.arms.planar_2r().explain([0.5, 0.3], [0.1, -0.2]).sentences
    assert (
        "With the other joints locked, joint1 feels 2.66 kg·m²; left free, 0.698: its coupling to "
        "joint2 hides 73.7 %."
    ) in sentences
    assert (
        "Like a skater's arms, joint2 sets what joint1 feels: from 0.7 kg·m² at joint2 = −3.14 rad "
        "to 2.7 at joint2 = 0 rad."
    ) in sentences


def test_at_rest_upright_and_uncoupled_it_says_so():
    upright = " ".join(mcgee.arms.planar_2r().explain([np.pi / 2, 0]).sentences)
    assert "At rest: no velocity terms." in upright
    assert "No joint holds any weight at this pose: g = 0." in upright
    stretched = mcgee.arms.planar_2r().explain([0.3, 0], [1, 2]).sentences
    assert any("its velocities ask for no efforts: C qd = 0" in s for s in stretched)
    one = mcgee.arms.pendulum().explain([0.3]).sentences
    assert any("nothing couples to it" in s for s in one)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (([0, 0, 0],), "q has shape (3,), expected (2,) for robot 'planar_2r': one state"),
        (([[0, 0]],), "q has shape (1, 2), expected (2,)"),
        (([0, np.nan],), "q holds [0.0, nan], expected finite numbers."),
        (("ab",), "q is 'ab', expected 2 numbers."),
        (([0, 0], [1]), "qd has shape (1,), expected (2,)"),
        (([0, 0], None, [np.inf, 0]), "qdd holds [inf, 0.0], expected finite numbers."),
    ],
)
def test_bad_states_get_one_sentence(arguments, sentence):
    with pytest.raises(ValueError, match=re.escape(sentence)):
        mcgee.arms.planar_2r().explain(*arguments)


def test_an_unknown_frame_is_named():
    with pytest.raises(ValueError, match="frame is 'hand', which robot 'planar_2r' has not"):
        mcgee.arms.planar_2r().explain([0, 0], frame="hand")


def one_joint(name="j", at=(0.0, 0.0, 0.0)):
    from mcgee.model import Inertia, Joint, Link

    body = Inertia(1.0, (0.1, 0.0, 0.0), (0.01, 0.0, 0.0, 0.02, 0.0, 0.02))
    links = (Link("base"), Link("b", body), Link("c", body))
    second = Joint("second", "revolute", "b", "c", pose=mcgee.model.Pose.at(*at))
    return mcgee.Robot("r", links, (Joint(name, "revolute", "base", "b"), second))


@pytest.mark.parametrize("name", ["a{b}", "a{}", "j {{body}}", "[red]x", "</script>"])
def test_names_are_quoted_as_they_are(name):
    e = one_joint(name, (0.4, 0, 0)).explain([0.3, 0.2], [1, 2])
    assert any(name in sentence for sentence in e.sentences)
    assert name in str(e)


def test_a_frame_that_only_turns_is_not_called_unmoved():
    sentences = one_joint().explain([0.3, 0.2], frame="c").sentences
    assert "No joint shifts the origin of frame 'c' at this pose." in sentences


def test_what_overflows_is_refused_and_what_creeps_moves():
    arm = mcgee.arms.planar_2r()
    with pytest.raises(ValueError, match="beyond float64"):
        arm.explain([0.5, 0.3], [1e200, 1])
    assert "At rest" not in " ".join(arm.explain([0.5, 0.3], [1e-170, 0]).sentences)


def test_the_ledger_is_called_by_its_name_and_balanced_beside_qd_C_qd():
    e = mcgee.arms.planar_2r().explain([0.5, 0.3], [0.1, 0.2])
    assert any(s.startswith("The skew part, (½Ṁ − C) qd, carries") for s in e.sentences)
    qd, C = e.qd, e.robot.coriolis_matrix(e.q, e.qd)
    assert e.velocity.C_power == pytest.approx(qd @ C @ qd)
    assert number(e.velocity.C_power) in str(e)


def test_the_skaters_extremes_are_finer_than_the_sweep():
    e = mcgee.load("panda").explain(np.zeros(7))
    k = e.robot.joint_names.index(e.felt.joint)
    fine = np.zeros((200_001, 7))
    fine[:, k] = np.linspace(e.robot.limits.lower[k], e.robot.limits.upper[k], len(fine))
    felt = e.robot.mass_matrix(fine)[:, 0, 0]
    assert e.felt.least == pytest.approx(felt.min(), rel=1e-9)
    assert e.felt.most == pytest.approx(felt.max(), rel=1e-9)


def test_the_lever_arm_about_a_tilted_axis_is_a_distance():
    e = mcgee.load("panda").explain([0.3, -0.5, 0.2, -1.8, 0.1, 1.5, 0.4])
    k, i = e.gravity.links.index("panda_link6"), 2
    arm = e.robot
    axis_at = arm.forward_kinematics(e.q, "panda_link3")
    com = arm.link_poses(e.q)[arm.moving_links.index("panda_link6"), :3, 3]
    z, p = axis_at[:3, 2], axis_at[:3, 3]
    across = np.cross([0, 0, 1], z)  # level, square to the axis
    distance = (com - p) @ across / np.linalg.norm(across)
    assert abs(e.gravity.lever[k, i]) == pytest.approx(abs(distance), rel=1e-9)
    assert e.gravity.level[k, i] == pytest.approx(np.linalg.norm(z[:2]), rel=1e-9)


def test_worst_cases_are_in_the_report_and_in_json():
    e = mcgee.arms.planar_2r().explain([0.5, 0.3])
    assert "Over the joint ranges joint1 holds at most 19.6 N·m" in " ".join(str(e).split())
    assert e.to_dict()["worst"][0]["effort"] == pytest.approx(19.62)


def test_without_scipy_the_report_says_what_to_install(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    e = mcgee.arms.planar_2r().explain([0.5, 0.3])
    assert "install mcgee[plot]" in " ".join(str(e).split())
    assert e.to_dict()["worst"] is None


@pytest.mark.parametrize("direction", [[0, 0, 0], [1, 0], [np.nan, 0, 0]])
def test_a_push_has_a_direction(direction):
    with pytest.raises(ValueError, match="expected 3 numbers, not all zero"):
        mcgee.arms.planar_2r().explain([0.5, 0.3]).task.effective_mass(direction)
