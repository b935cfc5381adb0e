"""References: consistent derivatives, exact extremes, what happens at the ends."""

import numpy as np
import pytest
from steering import panda

import mcgee
from mcgee.control import ComputedTorque, Constant, Fourier, Quintic, Reference, Trapezoidal
from mcgee.simulate import simulate

A, B = np.array([0.0, 1.0, -2.0]), np.array([1.0, -0.5, -2.0])
RNG = np.random.default_rng(3)
REFERENCES = {
    "constant": Constant(A),
    "quintic": Quintic(A, B, 2.0),
    "quintic that arrives moving": Quintic(A, B, 2.0, qd0=0.3, qd1=[0.1, -1.0, 0.0]),
    "quintic through points": Quintic(
        A, B, 3.0, via=[(1.0, B, [1.0, 0.0, -2.0]), (1.5, 2 * B, 0.0)]
    ),
    "trapezoidal": Trapezoidal(A, B, 0.8, 2.0),
    "triangular": Trapezoidal(A, B, [9.0, 5.0, 1.0], [1.0, 2.0, 1.0]),
    "fourier": Fourier(A, *RNG.normal(size=(2, 3, 3)), frequency=0.4),
    "fourier from rest": Fourier(A, *RNG.normal(size=(2, 2, 3)), frequency=0.5, ramp=1.7),
}


def inside(reference: Reference) -> np.ndarray:
    """Times away from knots, where accelerations may jump."""
    t = RNG.uniform(0, min(reference.duration, 5.0), 200)
    knots = getattr(reference, "knots", np.zeros(1))
    return t[abs(t[:, None] - knots).min(axis=1) > 1e-4]


@pytest.mark.parametrize("name", REFERENCES)
def test_velocities_and_accelerations_are_derivatives(name):
    reference, h = REFERENCES[name], 1e-5
    t = inside(reference)
    now, after, before = reference(t), reference(t + h), reference(t - h)
    assert now.qd == pytest.approx((after.q - before.q) / (2 * h), abs=2e-7)
    assert now.qdd == pytest.approx((after.qd - before.qd) / (2 * h), abs=2e-6)


@pytest.mark.parametrize("name", REFERENCES)
def test_times_broadcast(name):
    reference = REFERENCES[name]
    t = RNG.uniform(0, 2, (4, 2))
    whole, one = reference(t), reference(t[3, 1])
    for many, single in zip(whole, one, strict=True):
        assert many.shape == (4, 2, 3)
        assert single.shape == (3,)
        assert many[3, 1] == pytest.approx(single, abs=1e-13)


@pytest.mark.parametrize("name", [n for n in REFERENCES if "quintic" in n or "angular" in n])
def test_ends_are_held(name):
    reference = REFERENCES[name]
    end = reference.duration
    assert reference(0.0).q == pytest.approx(A)
    assert reference(end).q == pytest.approx(B)
    for t in (-1.0, end + 1e-9, 100.0):
        q, qd, qdd = reference(t)
        assert q == pytest.approx(A if t < 0 else B)
        assert not qd.any()
        assert not qdd.any()


def test_a_quintic_passes_its_points():
    reference = REFERENCES["quintic through points"]
    q, qd, qdd = reference(np.array([1.0, 1.5]))
    assert q == pytest.approx(np.array([B, 2 * B]))
    assert qd == pytest.approx(np.array([[1, 0, -2], [0, 0, 0]]), abs=1e-12)
    assert abs(qdd).max() < 1e-10
    start = REFERENCES["quintic that arrives moving"](0.0)
    assert start.qd == pytest.approx([0.3] * 3)


def test_a_trapezoid_keeps_its_limits_and_one_joint_reaches_them():
    reference = REFERENCES["trapezoidal"]
    assert reference.extremes(1).lowest == pytest.approx([0, -0.8, 0], abs=1e-12)
    assert reference.duration == pytest.approx(1.5 / 0.8 + 0.8 / 2.0)
    assert abs(reference(np.linspace(0, 3, 500)).qdd).max() == pytest.approx(2.0)
    short = REFERENCES["triangular"]
    assert short.duration == pytest.approx(2.0)  # 1 rad at 1 rad/s²
    assert short.extremes(1).highest[0] == pytest.approx(1.0)


def test_no_way_takes_no_time():
    reference = Trapezoidal(A, A, 1.0, 1.0)
    assert reference.duration == 0
    for t in (0.0, 1.0):
        assert reference(t).q == pytest.approx(A)
        assert not reference(t).qd.any()


def test_a_ramp_starts_at_rest():
    q, qd, qdd = REFERENCES["fourier from rest"](0.0)
    assert q == pytest.approx(A)
    assert abs(qd).max() < 1e-12
    assert abs(qdd).max() < 1e-12


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("name", REFERENCES)
def test_extremes_are_exact(name, order):
    """No sample is beyond them, and they are values of the motion."""
    reference = REFERENCES[name]
    t = np.linspace(0, min(reference.duration, 8.0), 20001)
    samples, found = reference(t)[order], reference.extremes(order)
    assert (found.lowest <= samples.min(0) + 1e-12).all()
    assert (found.highest >= samples.max(0) - 1e-12).all()
    assert found.highest == pytest.approx(samples.max(0), abs=1e-5)
    assert found.lowest == pytest.approx(samples.min(0), abs=1e-5)
    at = reference(found.t_highest)[order]
    assert np.diagonal(at) == pytest.approx(found.highest, abs=1e-12)


def test_limits_are_checked():
    arm = panda()
    q0 = np.array([0, 0, 0, -1.5, 0, 1.5, 0])
    q1 = np.array([0, 0, 0, -1.5, 1.5, 1.5, 0])
    slow, fast = Quintic(q0, q1, 2.0), Quintic(q0, q1, 1.0)
    slow.check(arm.limits, arm.joint_names)
    sentence = (
        r"takes joint 'panda_joint5' to 2\.8125 at t = 0\.5 s, beyond its velocity limit 2\.61\. "
        r"Slow the motion down"
    )
    with pytest.raises(ValueError, match=sentence):
        fast.check(arm.limits, arm.joint_names)
    with pytest.raises(ValueError, match=r"takes joint 5 to -2\.8125 at .* velocity limit"):
        Quintic(q1, q0, 1.0).check(arm.limits)


def test_positions_are_checked_between_the_points():
    """Both ends are within the limits, what is between is not."""
    arm = panda()
    q0 = np.array([0, 1.7, 0, -1.5, 0, 1.5, 0])
    over = Quintic(q0, q0, 1.0, qd0=0.5, qd1=-0.5)
    with pytest.raises(ValueError, match=r"joint2' to 1\.8.* upper limit 1\.7628"):
        over.check(arm.limits, arm.joint_names)
    with pytest.raises(ValueError, match=r"joint4' to -3\.1 at t = 0 s, beyond its lower limit"):
        Constant([0, 0, 0, -3.1, 0, 1, 0]).check(arm.limits, arm.joint_names)
    swing = np.zeros((1, 7))
    swing[0, 0] = 3.0
    with pytest.raises(ValueError, match=r"joint1' to -3 at t = 15 s, .* limit -2\.8973"):
        Fourier(q0 * 0.5, swing, 0 * swing, 0.05).check(arm.limits, arm.joint_names)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Quintic([0], [1], 0.0), "times of the points are 0, 0 s, expected growing ones"),
        (lambda: Quintic([0], [1], 1, via=[(2, [0], 0)]), "are 0, 2, 1 s, expected growing"),
        (lambda: Quintic([0, 1], [1], 1.0), r"positions of the points have shapes \(2,\), \(1,\)"),
        (lambda: Quintic([0, np.nan], [1, 2], 1.0), "hold numbers that are not finite"),
        (lambda: Trapezoidal([0, 1], [1, 1], 0.0, 1.0), r"velocity is 0.0, expected 2 above 0"),
        (lambda: Trapezoidal([0], [1], 1.0, np.inf), "acceleration is inf, expected finite"),
        (lambda: Fourier([0, 1], [[1]], [[1]], 1.0), r"shapes \(2,\), \(1, 1\) and \(1, 1\)"),
        (lambda: Fourier([0], [[1]], [[1]], 0.0), "frequency is 0.0, expected a number above 0 Hz"),
        (lambda: Fourier([0], [[1]], [[1]], 1.0, -1), "ramp is -1, expected a number, 0 or more s"),
    ],
)
def test_bad_references_are_refused(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()


def test_an_arm_follows_a_trapezoid():
    arm = mcgee.arms.planar_2r()
    reference = Trapezoidal([0, 0], [1.0, -0.5], 1.0, 3.0)
    law = ComputedTorque(arm, reference, 100, 20)
    found = simulate(arm, [0, 0], [0, 0], 2.0, law)
    assert abs(found.log["error"]).max() < 1e-7
    assert found.q[-1] == pytest.approx([1.0, -0.5], abs=1e-7)
