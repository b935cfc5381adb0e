"""Every law on random trees with prismatic joints, rotors and followers, by the interpreter."""

from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mcgee.audit.laws import LAWS
from robots import interpreted, random_state, random_tree

shares = st.sampled_from([0.0, 0.3, 1.0])
trees = st.fixed_dictionaries(
    {
        "seed": st.integers(0, 2**32 - 1),
        "bodies": st.integers(1, 8),
        "branching": shares,
        "prismatic": shares,
        "armature": shares,
        "mimic": st.sampled_from([0.0, 0.3, 0.7]),
        "fixed": st.sampled_from([0.0, 0.5]),
        "aligned": shares,
        "tilted": st.booleans(),
    }
)

SIZES = {"random": 3.0, "near zero": 1e-8, "large": 1e4}
"""Of the positions [rad | m]."""


@lru_cache(200)
def tree(**knobs):
    return interpreted(random_tree(**knobs))


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
@given(knobs=trees)
def test_law(law, knobs):
    robot = tree(**knobs)
    for where, size in SIZES.items():
        state = random_state(robot, np.random.default_rng(knobs["seed"]), 2, size)
        residual = np.max(law.residual(robot, *state))
        assert residual <= law.tolerance, (law.statement, where, repr(robot))
