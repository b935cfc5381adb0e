"""That every law can fail: robots broken on purpose, each breaking exactly the laws it should."""

import dataclasses

import numpy as np
import pytest

from mcgee.audit.laws import LAWS, check
from mcgee.robot import Terms
from robots import interpreted, random_state, random_tree

ALL = {law.name for law in LAWS}


class Sabotaged:
    """A robot that answers some questions wrongly."""

    def __init__(self, robot, **wrong):
        self.robot, self.wrong = robot, wrong

    def __getattr__(self, name):
        right = getattr(self.robot, name)
        if name not in self.wrong:
            return right
        wrong = self.wrong[name]
        return (lambda *args: wrong(right, *args)) if callable(right) else wrong


@pytest.fixture(scope="module")
def arm():
    return interpreted(random_tree(3, bodies=4, prismatic=0.3, armature=0.5, branching=0.0))


@pytest.fixture(scope="module")
def states(arm):
    return random_state(arm, np.random.default_rng(1), 5)


def broken(robot, states):
    return {verdict.law.name for verdict in check(robot, *states) if not verdict.holds}


def test_the_arm_itself_breaks_none(arm, states):
    assert broken(arm, states) == set()
    assert arm.n == 4
    assert {joint.kind == "prismatic" for joint in arm.independent_joints} == {True, False}


# -- the ways to be wrong -------------------------------------------------------------------------


def last_bits_apart(right, q):
    M = right(q)
    M[..., 0, 1] *= 1 + 1e-15
    return M


def too_large(factor):
    return lambda right, *args: factor * right(*args)


def scaled_terms(M=1.0, Cqd=1.0, g=1.0):
    def wrong(right, q, qd):
        terms = right(q, qd)
        return Terms(M * terms[0], Cqd * terms[1], g * terms[2])

    return wrong


def with_idle_part(right, q, qd):
    """C + N with N qd = 0: the same C qd, but Ṁ − 2C is not skew."""
    square = (qd * qd).sum(-1)[..., None, None]
    return right(q, qd) + square * np.eye(q.shape[-1]) - qd[..., :, None] * qd[..., None, :]


def with_idle_skew_part(right, q, qd):
    """C + N with N qd = 0, N skew: passive as well, and still not by Christoffel's symbols."""
    N = np.zeros((*q.shape, q.shape[-1]))
    a, b, c = np.moveaxis(qd[..., :3], -1, 0)
    N[..., 0, 1], N[..., 0, 2], N[..., 1, 2] = -c, b, -a
    return right(q, qd) + N - N.swapaxes(-1, -2)


def transposed(right, q, qd):
    return right(q, qd).swapaxes(-1, -2)


def half_the_rate_of_inertia(right, q, qd, robot):
    """½Ṁ: skew, powerless, and not C: it gives the wrong torque."""
    c = robot.christoffel(q)
    return 0.5 * ((c + c.swapaxes(-3, -2)) @ qd[..., None, :, None])[..., 0]


def with_friction(right, q, qd, qdd):
    return right(q, qd, qdd) + 0.3 * qd


def with_a_dead_load(right, q, qd, qdd):
    return right(q, qd, qdd) + 0.3


def cosine_for_sine(right, q):
    """The lesson's slip: every angle a quarter turn off, in P alone."""
    return right(q + np.pi / 2)


def rates_of_an_angle_before_a_position(right, q, frame=None):
    return np.roll(right(q, frame), 3, axis=-2)


def at_the_end_frame(right, q, frame=None):
    return right(q, frame) if frame else rates_of_an_angle_before_a_position(right, q)


def with_one_part(k, factor):
    """A named tuple of which one array is wrong."""

    def wrong(right, *args):
        parts = [*right(*args)]
        parts[k] = factor * parts[k]
        return tuple(parts)

    return wrong


def reparametrised(**wrong):
    return lambda right: Sabotaged(right(), **wrong)


def deaf_to_parameters(right, q, qd, qdd, parameters):
    return right(q, qd, qdd, np.roll(parameters, 1))


SABOTAGE = {
    "M asymmetric in the last bits": (
        {"mass_matrix": last_bits_apart},
        {"inertia_symmetric"},
    ),
    "M two percent too large": (
        {"mass_matrix": too_large(1.02)},
        {
            "inertia_by_definition",
            "kinetic_energy_is_half_qd_M_qd",
            "inertia_is_curvature_of_energy",
            "inertia_inverse",
            "christoffel_symbols",
            "coriolis_skew",
            "coriolis_powerless",
            "terms_are_the_parts",
            "derivatives_are_coriolis_and_inertia",
        },
    ),
    "T halved: the ½ taken twice": (
        {"kinetic_energy": too_large(0.5)},
        {
            "kinetic_energy_is_half_qd_M_qd",
            "inertia_is_curvature_of_energy",
            "energy_balance",
        },
    ),
    "T of the wrong sign": (
        {"kinetic_energy": too_large(-1.0)},
        {
            "kinetic_energy_is_half_qd_M_qd",
            "inertia_is_curvature_of_energy",
            "kinetic_energy_positive",
            "energy_balance",
        },
    ),
    "M⁻¹ a millionth off": (
        {"mass_matrix_inverse": too_large(1 + 1e-6)},
        {
            "inertia_inverse",
            "forward_derivatives_undo_inverse",
        },
    ),
    "symbols a millionth off": (
        {"christoffel": too_large(1 + 1e-6)},
        {"christoffel_symbols", "coriolis_from_christoffel"},
    ),
    "symbols with i and j exchanged": (
        {"christoffel": lambda right, q: right(q).swapaxes(-3, -2)},
        {"christoffel_symbols", "coriolis_from_christoffel"},
    ),
    "C of the wrong sign": (
        {"coriolis_matrix": too_large(-1.0)},
        {
            "coriolis_from_christoffel",
            "coriolis_skew",
            "coriolis_powerless",
            "coriolis_is_C_qd",
            "coriolis_product_symmetric",
            "derivatives_are_coriolis_and_inertia",
        },
    ),
    "C transposed": (
        {"coriolis_matrix": transposed},
        {
            "coriolis_from_christoffel",
            "coriolis_is_C_qd",
            "coriolis_product_symmetric",
            "derivatives_are_coriolis_and_inertia",
        },
    ),
    "C qd right, Ṁ − 2C not skew": (
        {"coriolis_matrix": with_idle_part},
        {
            "coriolis_from_christoffel",
            "coriolis_skew",
            "coriolis_product_symmetric",
            "derivatives_are_coriolis_and_inertia",
        },
    ),
    "C qd right, Ṁ − 2C skew, C not by the symbols": (
        {"coriolis_matrix": with_idle_skew_part},
        {
            "coriolis_from_christoffel",
            "coriolis_product_symmetric",
            "derivatives_are_coriolis_and_inertia",
        },
    ),
    "C qd two percent too large": (
        {"coriolis": too_large(1.02)},
        {"coriolis_is_C_qd", "terms_are_the_parts"},
    ),
    "C v with the velocities' places mixed up": (
        {"coriolis_product": lambda right, q, qd, v: right(q, v, v)},
        {"coriolis_product_symmetric"},
    ),
    "g of the wrong sign": (
        {"gravity": too_large(-1.0)},
        {
            "gravity_is_slope_of_energy",
            "gravity_gradient_is_slope",
            "gravity_holds",
            "terms_are_the_parts",
        },
    ),
    "∂g/∂q a millionth off": (
        {"gravity_gradient": too_large(1 + 1e-6)},
        {"gravity_gradient_is_slope"},
    ),
    "P with cos where sin is needed": (
        {"potential_energy": cosine_for_sine},
        {"gravity_is_slope_of_energy", "energy_balance"},
    ),
    "tau with friction": (
        {"inverse_dynamics": with_friction},
        {
            "equation_of_motion",
            "forward_undoes_inverse",
            "energy_balance",
            "derivatives_are_slopes_of_inverse",
            "forward_derivatives_undo_inverse",
            "regressor_times_parameters",
        },
    ),
    "tau with a dead load": (
        {"inverse_dynamics": with_a_dead_load},
        {
            "gravity_holds",
            "equation_of_motion",
            "forward_undoes_inverse",
            "energy_balance",
            "forward_derivatives_undo_inverse",
            "regressor_times_parameters",
        },
    ),
    "accelerations a millionth off": (
        {"forward_dynamics": too_large(1 + 1e-6)},
        {"forward_undoes_inverse"},
    ),
    "terms with another M": (
        {"terms": scaled_terms(M=1.02)},
        {
            "equation_of_motion",
            "terms_are_the_parts",
            "parameters_stand_for_links",
        },
    ),
    "terms without gravity": (
        {"terms": scaled_terms(g=0.0)},
        {
            "equation_of_motion",
            "terms_are_the_parts",
            "parameters_stand_for_links",
        },
    ),
    "∂tau/∂q a millionth off": (
        {"inverse_dynamics_derivatives": with_one_part(0, 1 + 1e-6)},
        {"derivatives_are_slopes_of_inverse", "forward_derivatives_undo_inverse"},
    ),
    "∂tau/∂qd a hundred-millionth off": (
        {"inverse_dynamics_derivatives": with_one_part(1, 1 + 1e-8)},
        {
            "derivatives_are_slopes_of_inverse",
            "derivatives_are_coriolis_and_inertia",
            "forward_derivatives_undo_inverse",
        },
    ),
    "∂tau/∂qdd without its last digits": (
        {"inverse_dynamics_derivatives": with_one_part(2, 1 + 1e-10)},
        {"derivatives_are_coriolis_and_inertia"},
    ),
    "∂qdd/∂q a millionth off": (
        {"forward_dynamics_derivatives": with_one_part(0, 1 + 1e-6)},
        {"forward_derivatives_undo_inverse"},
    ),
    "∂qdd/∂qd of the wrong sign": (
        {"forward_dynamics_derivatives": with_one_part(1, -1)},
        {"forward_derivatives_undo_inverse"},
    ),
    "∂qdd/∂tau a millionth off": (
        {"forward_dynamics_derivatives": with_one_part(2, 1 + 1e-6)},
        {"forward_derivatives_undo_inverse"},
    ),
    "a regressor whose links are exchanged": (
        {"regressor": lambda right, *state: np.roll(right(*state), 10, axis=-1)},
        {"regressor_times_parameters", "inverse_linear_in_parameters"},
    ),
    "another robot's parameters": (
        {"inertial_parameters": np.linspace(1.0, 2.0, 40)},
        {"regressor_times_parameters", "parameters_stand_for_links"},
    ),
    "tau that takes its parameters in another order": (
        {"with_parameters": reparametrised(inverse_dynamics=deaf_to_parameters)},
        {"inverse_linear_in_parameters"},
    ),
    "terms that take only half of their parameters": (
        {"with_parameters": reparametrised(terms=lambda right, q, qd, p: right(q, qd, p / 2))},
        {"parameters_stand_for_links"},
    ),
    "the Jacobian's angular rows first": (
        {"jacobian": rates_of_an_angle_before_a_position},
        {"jacobian_is_rate_of_pose", "inertia_by_definition"},
    ),
    "the end frame's Jacobian alone": (
        {"jacobian": at_the_end_frame},
        {"jacobian_is_rate_of_pose"},
    ),
}


@pytest.mark.parametrize("how", SABOTAGE)
def test_sabotage_breaks_exactly_the_laws_it_should(how, arm, states):
    wrong, expected = SABOTAGE[how]
    assert broken(Sabotaged(arm, **wrong), states) == expected


def test_links_that_are_not_the_ones_computed_with(arm, states):
    link = max(arm.links, key=lambda link: arm.mechanism.frames[link.name][0])
    lighter = dataclasses.replace(link, inertia=dataclasses.replace(link.inertia, mass=0.1))
    links = tuple(lighter if other is link else other for other in arm.links)
    assert broken(Sabotaged(arm, links=links), states) == {"inertia_by_definition"}


def test_unphysical_links(arm, states):
    """Less inertia than none: every identity still holds, and M and T are not positive."""
    links = tuple(
        dataclasses.replace(
            link, inertia=dataclasses.replace(link.inertia, about_com=(-9, 0, 0, -9, 0, -9))
        )
        for link in arm.links
        if link.inertia is not None
    )
    links += tuple(link for link in arm.links if link.inertia is None)
    unphysical = interpreted(dataclasses.replace(arm, links=links))
    assert broken(unphysical, states) == {"inertia_positive", "kinetic_energy_positive"}


def test_a_matrix_that_is_skew_and_powerless_and_gives_the_wrong_torque(arm, states):
    wrong = Sabotaged(
        arm, coriolis_matrix=lambda right, q, qd: half_the_rate_of_inertia(right, q, qd, arm)
    )
    expected = {
        "coriolis_from_christoffel",
        "coriolis_is_C_qd",
        "coriolis_product_symmetric",
        "derivatives_are_coriolis_and_inertia",
    }
    assert broken(wrong, states) == expected


def test_every_law_is_broken_by_some_sabotage():
    breakable = set().union(*(expected for _, expected in SABOTAGE.values()))
    assert breakable | {"inertia_positive"} == ALL


# -- what is not a number -------------------------------------------------------------------------


def poisoned(right, *args):
    """A NaN in the last row of everything."""
    result = right(*args)
    for array in result if isinstance(result, tuple) else (result,):
        array[(-1,) + (slice(None),) * (array.ndim - 1)] = np.nan
    return result


READS = {
    "mass_matrix": ALL
    - {
        "kinetic_energy_positive",
        "gravity_is_slope_of_energy",
        "gravity_gradient_is_slope",
        "gravity_holds",
        "equation_of_motion",
        "forward_undoes_inverse",
        "regressor_times_parameters",
        "inverse_linear_in_parameters",
        "jacobian_is_rate_of_pose",
    },
    "kinetic_energy": {
        "kinetic_energy_is_half_qd_M_qd",
        "inertia_is_curvature_of_energy",
        "kinetic_energy_positive",
        "energy_balance",
    },
    "gravity": {
        "gravity_is_slope_of_energy",
        "gravity_gradient_is_slope",
        "gravity_holds",
        "terms_are_the_parts",
    },
    "christoffel": {"christoffel_symbols", "coriolis_from_christoffel"},
    "forward_dynamics": {"forward_undoes_inverse"},
    "inverse_dynamics_derivatives": {
        "derivatives_are_slopes_of_inverse",
        "derivatives_are_coriolis_and_inertia",
        "forward_derivatives_undo_inverse",
    },
    "forward_dynamics_derivatives": {"forward_derivatives_undo_inverse"},
    "regressor": {"regressor_times_parameters", "inverse_linear_in_parameters"},
    "forward_kinematics": {"inertia_by_definition", "jacobian_is_rate_of_pose"},
}


@pytest.mark.parametrize("quantity", READS)
def test_a_nan_never_holds(quantity, arm, states):
    verdicts = check(Sabotaged(arm, **{quantity: poisoned}), *states)
    assert {v.law.name for v in verdicts if not v.holds} == READS[quantity]
    for verdict in verdicts:
        if not verdict.holds:
            assert np.isnan(verdict.residual), verdict.law.name
            assert verdict.worst == (4,), verdict.law.name


def test_nothing_but_nan_breaks_every_law(arm, states):
    q, qd, qdd = states
    assert broken(arm, (q * np.nan, qd, qdd)) == ALL


def test_the_worst_row_is_named(arm, states):
    def wrong_in_row_two(right, q):
        g = right(q)
        g[2] *= 1.5
        return g

    verdicts = {v.law.name: v for v in check(Sabotaged(arm, gravity=wrong_in_row_two), *states)}
    assert verdicts["gravity_holds"].worst == (2,)
    assert verdicts["gravity_holds"].residual == pytest.approx(0.3, abs=0.3)
    assert verdicts["equation_of_motion"].holds


def test_states_broadcast_and_may_be_single(arm):
    single = check(arm, *np.full((3, 4), 0.3))
    assert all(v.holds and v.worst == () for v in single)
    crossed = check(arm, np.zeros((2, 1, 4)), np.ones((3, 4)), np.ones(4))
    assert all(v.holds for v in crossed)
    assert {len(v.worst) for v in crossed} <= {1, 2}
