"""One clear sentence for each thing that a law cannot be given."""

import dataclasses

import numpy as np
import pytest

import mcgee
from mcgee import control
from mcgee.control import (
    LQR,
    AdaptiveComputedTorque,
    AdaptiveSlotineLi,
    CartPoleIDAPBC,
    ComputedTorque,
    Constant,
    EnergySwingUp,
    Fourier,
    HybridForcePosition,
    InertiaWheelIDAPBC,
    OperationalSpace,
    PDGravity,
    Quintic,
    Reference,
    SlotineLi,
    Wall,
    excitation_gains,
    swing_up,
)
from mcgee.simulate import simulate

TWO = mcgee.arms.planar_2r()
CART = mcgee.arms.cart_pole()
WHEEL = mcgee.arms.inertia_wheel_pendulum()
X, Z = [1.2, 0.3, 0.0], [0.0, 1.0, 0.0]


def nothing(q, qd):
    return np.zeros(3)


def cart_without_gravity():
    return CART.replace(gravity_vector=(0, 0, 0))


def loose() -> mcgee.Robot:
    joints = tuple(dataclasses.replace(j, effort=0.0) for j in TWO.joints)
    return dataclasses.replace(TWO, joints=joints)


def pushed(*args, **options):
    return HybridForcePosition(TWO, X, Z, 5.0, nothing, *args, **options)


def posed(rotation):
    T = np.eye(4)
    T[:3, :3] = rotation
    return T


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (
            lambda: PDGravity(TWO, [1, 2, 3], 1, 1),
            r"target has shape \(3,\), expected \(..., 2\) for robot 'planar_2r'. Joints: joint1, ",
        ),
        (lambda: PDGravity(TWO, [1, np.nan], 1, 1), "target holds nan, expected finite numbers"),
        (lambda: PDGravity(TWO, "up", 1, 1), "target is 'up', expected numbers"),
        (
            lambda: PDGravity(TWO, [0, 0], [1, 2, 3], 1),
            r"kp has shape \(3,\), expected a number or \(2,\) for robot 'planar_2r'. Joints: join",
        ),
        (
            lambda: PDGravity(TWO, [0, 0], 1, [1, -2]),
            "kd of joint 'joint2' is -2, expected zero or more",
        ),
        (lambda: ComputedTorque(TWO, [0, 0], np.inf, 1), "kp of joint 'joint1' is inf, expected"),
        (
            lambda: ComputedTorque(TWO, lambda t: [0, 0], 1, 1),
            r"reference is .*, expected a function t -> \(q, qd, qdd\) or a position; at t = 0: ",
        ),
        (
            lambda: ComputedTorque(TWO, Constant([0, 0, 0]), 1, 1),
            r"q of the reference has shape \(3,\), expected \(..., 2\)",
        ),
        (
            lambda: ComputedTorque(TWO, lambda t: ([0, 0], [0, 0], [0]), 1, 1),
            r"qdd of the reference has shape \(1,\)",
        ),
        (
            lambda: SlotineLi(TWO, [0, 0], 1, 1, period=0),
            "period is 0, expected a number above",
        ),
        (
            lambda: AdaptiveSlotineLi(TWO, [0, 0], 1, 1, np.ones(20)),
            r"gains has shape \(20,\), expected a number or \(24,\) for .*Parameters: 24 of them",
        ),
        (
            lambda: AdaptiveSlotineLi(TWO, [0, 0], 1, 1, 0.0),
            "gains of parameter 'm of link1' is 0, expected more than 0",
        ),
        (
            lambda: AdaptiveSlotineLi(TWO, [0, 0], 1, 1, np.ones((24, 20))),
            r"gains has shape \(24, 20\), expected a number, \(24,\) or \(24, 24\) for robot",
        ),
        (
            lambda: AdaptiveSlotineLi(TWO, [0, 0], 1, 1, np.ones((24, 24))),
            "gains is a matrix with an eigenvalue .*, expected one symmetric, positive definite",
        ),
        (
            lambda: AdaptiveSlotineLi(TWO, [0, 0], 1, 1, np.triu(np.ones((24, 24)))),
            "gains is a matrix not symmetric, or not finite",
        ),
        (
            lambda: excitation_gains(TWO, Constant([0, 0]), [0.0], 1, 0.0),
            "rate is 0.0, expected a number above 0 1/s",
        ),
        (
            lambda: excitation_gains(TWO, Constant([0, 0, 0]), [0.0], 1, 1.0),
            r"reference has shape \(1, 3\)",
        ),
        (
            lambda: AdaptiveSlotineLi(TWO, [0, 0], 1, 1, 1.0, true_parameters=np.ones(20)),
            r"true_parameters has shape \(20,\), expected 24 finite numbers, the inertial",
        ),
        (
            lambda: AdaptiveSlotineLi(TWO, [0, 0], 1, 1, 1.0, friction_speed=0),
            "friction_speed is 0, expected a number above 0 rad/s",
        ),
        (
            lambda: AdaptiveComputedTorque(TWO, [0, 0], 1, [2.0, 1.0], 1.0, psi=1.5),
            "psi of joint 'joint2' is 1.5, expected less than kd, which is 1",
        ),
        (
            lambda: AdaptiveComputedTorque(TWO, [0, 0], 1, 1, 1.0, bounds=(0.5, 0.9)),
            "bounds of 'm of link1' are 0.5 and 0.9, expected to hold the first estimate, 1",
        ),
        (
            lambda: AdaptiveComputedTorque(TWO, [0, 0], 1, 1, 1.0, bounds="x"),
            r"bounds are 'x', expected \(lower, upper\), a number or \(24,\) each",
        ),
        (lambda: Quintic([0, 0], [1, 1], "x"), "the time of a point is 'x', expected numbers"),
        (lambda: Quintic([0, 0], [1, 1], 1, qd0=[1, 2, 3]), "velocities of the points have shapes"),
        (lambda: Quintic([0, 0], [1, 1], 1, via=[(0.5, [0, 0])]), r"expected \(t, q, qd\)"),
        (lambda: Fourier([0, np.nan], [[1, 1]], [[1, 1]], 1), "numbers that are not finite"),
        (lambda: Constant([0, np.nan]), "expected finite numbers, one for each joint"),
        (lambda: Constant([0, 0, 0]).check(TWO.limits), "of 3 joints, and the limits are of 2"),
        (lambda: excitation_gains(TWO, Constant([0, 0]), [], 1, 1.0), r"times have shape \(0,\)"),
        (lambda: excitation_gains(TWO, [0, 0], [0.0], 1, 1.0), "expected one or more times and a"),
        (
            lambda: OperationalSpace(TWO, np.diag([1.0, 1, -1, 1]), 1, 1),
            "a rotation that is none: R Rᵀ = 1 and det R = 1 are expected",
        ),
        (
            lambda: OperationalSpace(TWO, np.diag([1.0, 1, 1, 5]), 1, 1),
            r"the last row \[0. 0. 0. 5.\], expected 0, 0, 0, 1",
        ),
        (
            lambda: OperationalSpace(TWO, lambda t: (X, X), 1, 1),
            r"gives no \(position, velocity, acceleration\) at t = 0 s: not enough values",
        ),
        (
            lambda: OperationalSpace(TWO, lambda t: (np.add(X, np.nan), X, X), 1, 1),
            "that are not finite",
        ),
        (
            lambda: AdaptiveComputedTorque(TWO, [0, 0], 100, 20, 1.0, period=0.012),
            "bandwidth is 200 1/s, expected at most one in a period, 83.3333 1/s",
        ),
        (
            lambda: OperationalSpace(TWO, X, 1, 1, "hand"),
            "frame is 'hand', which robot 'planar_2r' has not",
        ),
        (
            lambda: OperationalSpace(TWO, X, 1, 1, "base"),
            "frame 'base' of robot 'planar_2r' does not move",
        ),
        (
            lambda: OperationalSpace(TWO, [1, 2], 1, 1),
            r"target has shape \(2,\), expected a position \(3,\) \[m\] or a pose \(4, 4\)",
        ),
        (
            lambda: OperationalSpace(TWO, lambda t: (X, X, [0]), 1, 1),
            r"the reference gives shapes \(3,\), \(3,\), \(1,\), expected \(3,\), \(3,\), \(3,\) f",
        ),
        (
            lambda: OperationalSpace(TWO, posed(np.ones((3, 3))), 1, 1),
            "the reference's pose has a rotation that is none",
        ),
        (
            lambda: OperationalSpace(TWO, np.eye(4), [1, 1, 1, 1, 1, 2], 1),
            r"kp of the turns is \[1. 1. 2.\], expected three alike",
        ),
        (
            lambda: OperationalSpace(TWO, X, [1, 2], 1),
            r"kp has shape \(2,\), expected a number or \(3,\) for the position of frame 'tip'",
        ),
        (
            lambda: OperationalSpace(TWO, X, 1, 1, singular=0),
            "singular is 0, expected a number abo",
        ),
        (
            lambda: HybridForcePosition(TWO, X, [0, 0, 0], 1.0, nothing, 1, 1),
            r"normal is \[0, 0, 0\], expected 3 numbers that are not all 0",
        ),
        (
            lambda: HybridForcePosition(TWO, X, Z, -1.0, nothing, 1, 1),
            "force is -1.0, expected a number above 0 N",
        ),
        (
            lambda: pushed(1, 1, ki=30.0),
            r"ki is 30 1/s, expected less than \(1 \+ kf\) damping_normal = 20 1/s",
        ),
        (lambda: pushed(1, 1, kf=-1), "kf is -1, expected a number, 0 or more"),
        (lambda: Wall(TWO, [0, 0], Z), r"point is \[0, 0\], expected 3 numbers \[m\]"),
        (lambda: Wall(TWO, X, Z, stiffness=0), "stiffness is 0, expected a number above 0 N/m"),
        (lambda: Wall(TWO, X, Z, damping=-1), "damping is -1, expected a number, 0 or more s/m"),
        (lambda: LQR(CART, [[0, 0]]), r"q has shape \(1, 2\), expected \(2,\)"),
        (
            lambda: LQR(CART, [0, 0.3]),
            r"q is no equilibrium of robot 'cart_pole': joint 'pole' needs -0\.14.* and is passive",
        ),
        (
            lambda: LQR(TWO, [0, 0], tau=[0, 0]),
            r"joint 'joint1' needs 19\.62 N·m or N and gets 0",
        ),
        (lambda: LQR(CART, [0, 0], Q=[1, 2]), r"Q has shape \(2,\), expected a number, \(4,\) or "),
        (lambda: LQR(CART, [0, 0], R=0), "R is not a symmetric positive definite matrix"),
        (lambda: LQR(CART, [0, 0], Q=-1), "Q is not a symmetric positive semidefinite matrix"),
        (lambda: LQR(CART, [0, 0], level=0), "level is 0, expected a number above 0"),
        (
            lambda: LQR(cart_without_gravity(), [0, np.pi / 2]),
            "robot 'cart_pole' cannot be stabilised at q: no actuated joint acts on the mode of "
            "eigenvalue .* in which joint 'pole' has the largest part",
        ),
        (
            lambda: EnergySwingUp(LQR(TWO, [np.pi / 2, 0]), 1, 1, 1, 1, 1),
            "robot 'planar_2r' has 2 actuated and 0 passive joints, expected both",
        ),
        (
            lambda: swing_up(TWO),
            "no gains for kind 'planar_2r', only for: acrobot, pendubot, cart_pole",
        ),
        (lambda: swing_up(CART, push=[1, 2]), r"push is \[1, 2\], expected a finite number"),
        (lambda: swing_up(CART, extra=-1), "extra is -1, expected a number, 0 or more J"),
        (lambda: swing_up(CART, energy=0.0), "energy is 0.0, expected a number above 0 J"),
        (
            lambda: InertiaWheelIDAPBC(WHEEL, a=(1, -2, 3)),
            r"a is \(1, -2, 3\), expected a1 > 0, a1 a3 > a2² and a1 \+ a2 < 0",
        ),
        (lambda: InertiaWheelIDAPBC(CART), "robot 'cart_pole' is no inertia-wheel pendulum"),
        (
            lambda: InertiaWheelIDAPBC(mcgee.arms.inertia_wheel_pendulum(angle_from="down")),
            "is no inertia-wheel pendulum with a passive pivot and its angle from the upward",
        ),
        (lambda: CartPoleIDAPBC(WHEEL), "robot 'inertia_wheel_pendulum' is no cart-pole"),
        (lambda: CartPoleIDAPBC(mcgee.arms.cart_pole(angle_from="down")), "is no cart-pole with a"),
        (lambda: CartPoleIDAPBC(CART, k=0), "k is 0, expected a number above 0"),
    ],
)
def test_bad_arguments_are_refused(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()


def test_an_arm_without_motors_has_no_regulator():
    with pytest.raises(ValueError, match="cannot be stabilised at q: no actuated joint acts on"):
        LQR(loose(), [np.pi / 2, 0])


def test_a_mode_without_weight_has_no_regulator():
    """The undamped hanging pole is seen by no weight, so nothing decides how it shall decay."""
    with pytest.raises(ValueError, match=r"stabilising solution: .*Give Q weight on every"):
        LQR(mcgee.arms.cart_pole(angle_from="down"), [0, 0], Q=0.0)


def test_parts_that_must_be_filled_in_say_so():
    reference = Reference()
    with pytest.raises(NotImplementedError, match="Reference gives no"):
        reference(0.0)
    with pytest.raises(NotImplementedError, match="Reference does not know its extremes"):
        reference.candidates(0)
    with pytest.raises(NotImplementedError, match=r"IDAPBC has no H_d"):
        control.IDAPBC().energy(np.zeros(2), np.zeros(2))
    assert reference.duration == np.inf


def test_symbols_are_refused():
    import sympy

    arm = mcgee.arms.planar_2r(m1=sympy.Symbol("m1"))
    with pytest.raises(ValueError, match="still has the symbols m1"):
        simulate(arm, [0, 0], [0, 0], 1.0, PDGravity(arm, [0, 0], 1, 1))


def test_everything_named_exists():
    assert all(hasattr(control, name) for name in control.__all__)


def test_a_mass_matrix_that_is_not_definite_does_not_run_away():
    """M̂⁻¹ is cut off where estimates leave what bounds should have kept them from."""
    law = AdaptiveComputedTorque(
        TWO, [0.3, 0.2], 100, 20, 1.0, False, bounds=(-np.inf, np.inf), acceleration=lambda *a: a[1]
    )
    q, qd = np.array([0.1, 0.2]), np.array([1.0, -1.0])
    z = law.start(q, qd)
    z[13] = -9.0  # a first moment that no such body has
    z[19] = -2.0
    assert law.log(0.0, q, qd, z)["least_inertia"] < 0
    change = law.slope(0.0, q, qd, z)
    assert np.isfinite(change).all()
    assert abs(change).max() < 1e3 / law.floor
