"""Instances of FMUs under the calls of the standard: right ones, and wrong ones."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from ctypes import Array, byref, c_bool, c_double, c_int, c_uint32

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from units import made

import mcgee
from mcgee.codegen.fmu import FMU, VERSIONS
from mcgee.codegen.package import put

DISCARD, ERROR = 2, 3

START = {"q[1]": -1.0, "q[2]": 0.6}

STATES = ("q[1]", "q[2]", "qd[1]", "qd[2]")

ME, CS = "ModelExchange", "CoSimulation"


class Block:
    """An instance of either version under the same calls."""

    def __init__(self, folder: str, kind: str, events: bool):
        described = fmpy.read_model_description(folder)
        self.places = {v.name: v.valueReference for v in described.modelVariables}
        self.version = 2 if described.fmiVersion == "2.0" else 3
        self.real = "Real" if self.version == 2 else "Float64"
        self.fmu = fmpy.instantiate_fmu(
            folder, described, kind, debug_logging=True, event_mode_used=events
        )

    def status(self, name: str, *arguments) -> int:
        """What a function of the standard returns, by its name without the version."""
        try:
            getattr(self.fmu, f"fmi{self.version}{name}")(self.fmu.component, *arguments)
        except FMICallException as refusal:
            return refusal.status
        return 0

    def access(self, verb: str, names: list[str | int], values: Array | None, count: int) -> int:
        """Get or set by names or value references."""
        places = (c_uint32 * len(names))(*(self.places.get(x, x) for x in names))
        counts = (count,) if self.version == 3 else ()
        return self.status(f"{verb}{self.real}", places, len(names), values, *counts)

    def set(self, values: dict[str | int, float]) -> int:
        numbers = (c_double * len(values))(*values.values())
        return self.access("Set", list(values), numbers, len(values))

    def get(self, *names: str | int) -> list[float]:
        numbers = (c_double * len(names))()
        assert self.access("Get", list(names), numbers, len(names)) == 0
        return list(numbers)

    def initialized(self, values: dict[str | int, float] = START) -> Block:
        assert self.set(values) == 0
        if self.version == 2:
            self.fmu.setupExperiment()
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def step(self, time: float, length: float) -> int:
        flags = [byref(c_bool()) for _ in range(3)] + [byref(c_double())]
        return self.status("DoStep", time, length, True, *(flags if self.version == 3 else ()))

    def run(self, first: int, last: int) -> list[list[float]]:
        found = []
        for k in range(first, last):
            assert self.step(k * 0.01, 0.01) == 0
            found.append(self.get("time", *STATES, "E"))
        return found


@pytest.fixture(scope="module", params=VERSIONS, ids=["fmi2", "fmi3"])
def folder(request, tmp_path_factory) -> str:
    """planar_2r's FMU, unpacked."""
    package, unpacked = tmp_path_factory.mktemp("package"), tmp_path_factory.mktemp("unpacked")
    put(package, FMU.files(made("planar_2r", FMU.functions, params=True)))
    return fmpy.extract(str(package / f"planar_2r_fmi{request.param}.fmu"), str(unpacked))


@pytest.fixture
def block(folder) -> Iterator[Callable[..., Block]]:
    """Makes instances, which are freed in the end."""
    found = []

    def make(kind: str = CS, events: bool = False) -> Block:
        found.append(Block(folder, kind, events))
        return found[-1]

    yield make
    for one in found:
        one.fmu.freeInstance()


# -- right ones -----------------------------------------------------------------------------------


def test_a_saved_state_comes_back_to_the_last_bit(block):
    one = block().initialized()
    one.run(0, 30)
    state = one.fmu.getFMUState()
    once = one.run(30, 60)
    one.set({"m1": 2.0, "tau[1]": 5.0})
    one.fmu.setFMUState(state)
    assert one.get("time", "m1", "tau[1]") == [pytest.approx(0.3), 1.0, 0.0]
    assert one.run(30, 60) == once
    one.fmu.freeFMUState(state)


def test_a_serialized_state_continues_in_another_instance(block):
    one, other = block().initialized(), block()
    one.run(0, 30)
    state = one.fmu.getFMUState()
    kept = one.fmu.serializeFMUState(state)
    again = other.fmu.deserializeFMUState(kept)
    other.fmu.setFMUState(again)
    assert other.run(30, 60) == one.run(30, 60)
    assert other.fmu.serializeFMUState(again) == kept
    one.fmu.freeFMUState(state)
    other.fmu.freeFMUState(again)


def test_instances_know_nothing_of_each_other(block):
    alone = block().initialized().run(0, 20)
    one, other = block().initialized(), block().initialized(START | {"m2": 3.0})
    together, others = [], []
    for k in range(20):
        together += one.run(k, k + 1)
        others += other.run(k, k + 1)
    assert together == alone
    assert others[-1] != alone[-1]


def test_reset_takes_everything_back(block):
    one = block().initialized(START | {"m1": 2.0, "max_step": 0.01})
    first = one.get("time", "m1", "max_step", *STATES, "E")
    one.run(0, 5)
    one.fmu.reset()
    one.initialized(START)
    assert one.get("time", "m1", "max_step", *STATES) == [0.0, 1.0, 0.001, -1.0, 0.6, 0.0, 0.0]
    one.fmu.reset()
    one.initialized(START | {"m1": 2.0, "max_step": 0.01})
    assert one.get("time", "m1", "max_step", *STATES, "E") == first


def test_steps_are_no_longer_than_max_step(block):
    """One step of 0.05 is five of 0.01; of 0.0123 it is one, for it may be shorter."""
    whole, parts = (block().initialized(START | {"max_step": 0.01}) for _ in range(2))
    whole.step(0.0, 0.05)
    for k in range(5):
        parts.step(k * 0.01, 0.01)
    np.testing.assert_allclose(whole.get(*STATES), parts.get(*STATES), rtol=1e-14)
    short, own = block().initialized(), block().initialized(START | {"max_step": 0.00041})
    short.set({"max_step": 0.0123})
    short.step(0.0, 0.00123)
    own.step(0.0, 0.00123)
    assert short.get(*STATES) != own.get(*STATES)


def test_the_numbers_of_an_event_are_the_kernels(block):
    one = block(ME).initialized(START | {"tau[1]": 2.0, "tau[2]": -1.0, "qd[1]": 0.5})
    arm = mcgee.arms.planar_2r()
    q, qd, tau = np.array([-1.0, 0.6]), np.array([0.5, 0.0]), np.array([2.0, -1.0])
    assert one.get("der(q[1])", "der(q[2])") == [0.5, 0.0]
    np.testing.assert_allclose(one.get("qdd[1]", "qdd[2]"), arm.forward_dynamics(q, qd, tau))
    energies = [arm.kinetic_energy(q, qd), arm.potential_energy(q)]
    np.testing.assert_allclose(one.get("T", "P"), energies, rtol=1e-14)


# -- wrong ones -----------------------------------------------------------------------------------


def refusal(capsys) -> str:
    """The one message since last asked."""
    (line,) = capsys.readouterr().out.splitlines()
    return line


@pytest.mark.parametrize("verb", ["Get", "Set"])
def test_value_references_and_pointers_are_checked(block, capsys, verb):
    one = block().initialized()
    number = (c_double * 1)()
    for wrong in (len(one.places), 2**32 - 1):
        assert one.access(verb, [wrong], number, 1) == ERROR
        assert f"value reference {wrong} is unknown" in refusal(capsys)
    assert one.access(verb, ["q[1]"], None, 1) == ERROR
    assert "a pointer is null" in refusal(capsys)
    assert one.access(verb, [], None, 0) == 0
    if one.version == 3:
        assert one.access(verb, ["q[1]", "q[2]"], number, 1) == ERROR
        assert "the array has 1 elements, expected 2" in refusal(capsys)


@pytest.mark.parametrize("name", ["time", "E", "qdd[1]", "der(q[1])", "q[1]", "qd[2]"])
def test_what_is_not_settable_stays(block, capsys, name):
    one = block().initialized()
    before = one.get("tau[1]", name)
    assert one.set({"tau[1]": 4.0, name: 7.0}) == ERROR
    assert f"value reference {one.places[name]} cannot be set in step mode" in refusal(capsys)
    assert one.get("tau[1]", name) == before


@pytest.mark.parametrize("step", [0.0, -1.0, math.nan, math.inf])
def test_steps_are_positive(block, capsys, step):
    one = block()
    assert one.set({"max_step": step}) == ERROR
    assert "max_step is" in refusal(capsys)
    one.initialized()
    assert one.step(0.0, step) == ERROR
    assert "expected more than 0" in refusal(capsys)


def test_steps_begin_where_the_last_ended(block, capsys):
    one = block().initialized()
    one.run(0, 2)
    assert one.step(0.0, 0.01) == ERROR
    assert "the step begins at 0 s, expected 0.02" in refusal(capsys)
    assert one.step(0.02, 1e9) == ERROR
    assert "a step of 1e+09 s takes 1e+12 steps of max_step" in refusal(capsys)
    one.run(2, 3)


def test_a_step_into_the_infinite_is_discarded(block, capsys):
    one = block().initialized()
    one.run(0, 2)
    before = one.get("time", *STATES)
    one.set({"tau[1]": 1e308})
    assert one.step(0.02, 0.01) == DISCARD
    assert "from 0.02 s on the state becomes infinite or NaN" in refusal(capsys)
    assert one.get("time", *STATES) == before
    if one.version == 2:
        assert one.fmu.getBooleanStatus(3)  # the simulation cannot go on
        assert one.fmu.getRealStatus(2) == before[0]
    one.set({"tau[1]": 0.0})
    one.run(2, 3)


def test_infinite_derivatives_are_discarded(block, capsys):
    one = block(ME).initialized(START | {"m1": 0.0, "m2": 0.0, "I1": 0.0, "I2": 0.0})
    name = "GetDerivatives" if one.version == 2 else "GetContinuousStateDerivatives"
    assert one.status(name, (c_double * 4)(), 4) == DISCARD
    assert "infinite or NaN" in refusal(capsys)
    assert one.status(name, (c_double * 4)(), 3) == ERROR
    assert "the array has 3 elements, expected 4" in refusal(capsys)


def test_calls_out_of_turn_are_refused(block, capsys):
    one, flags = block(), [byref(c_bool()) for _ in range(5)]

    def refused(name: str, where: str, *arguments) -> None:
        assert one.status(name, *arguments) == ERROR
        assert refusal(capsys).endswith(f"fmi{one.version}{name}: must not be called {where}")

    refused("ExitInitializationMode", "before initialization")
    refused("Terminate", "before initialization")
    assert one.step(0.0, 0.1) == ERROR
    assert "DoStep: must not be called before initialization" in refusal(capsys)
    one.initialized()
    refused("ExitInitializationMode", "in step mode")
    if one.version == 3:
        refused("UpdateDiscreteStates", "in step mode", *flags, byref(c_double()))
        assert one.status("EnterEventMode") == ERROR
        assert "made without event mode" in refusal(capsys)
    one.fmu.terminate()
    refused("Terminate", "after the end")
    assert one.set({"tau[1]": 1.0}) == ERROR
    assert "cannot be set after the end" in refusal(capsys)
    assert one.get("time") == [0.0]


def test_model_exchange_has_its_own_turns(block, capsys):
    one = block(ME).initialized()
    states = (c_double * 4)()
    assert one.status("SetContinuousStates", states, 4) == ERROR
    assert "must not be called in event mode" in refusal(capsys)
    one.fmu.enterContinuousTimeMode()
    assert one.status("SetContinuousStates", states, 4) == 0
    assert one.status("SetContinuousStates", None, 4) == ERROR
    assert "a pointer is null" in refusal(capsys)
    assert one.set({"tau[1]": 1.0}) == 0
    assert one.set({"m1": 1.0}) == ERROR
    assert "cannot be set in continuous-time mode" in refusal(capsys)
    assert one.status("EnterEventMode") == 0
    assert one.set({"m1": 2.0}) == 0
    assert one.status("GetEventIndicators", None, 0) == 0
    assert one.status("GetEventIndicators", states, 1) == ERROR
    assert "the array has 1 elements, expected 0" in refusal(capsys)


def test_types_without_variables_are_refused(block, capsys):
    one = block().initialized()
    place = (c_uint32 * 1)(one.places["q[1]"])
    types = (
        ["Integer", "Boolean", "String"]
        if one.version == 2
        else ["Float32", "Boolean", "String", *(f"{u}Int{b}" for u in ("", "U") for b in (8, 64))]
    )
    counts = (1,) if one.version == 3 else ()
    for verb in ("Get", "Set"):
        for name in types:
            assert one.status(f"{verb}{name}", place, 1, None, *counts) == ERROR
            assert "there are no variables of this type" in refusal(capsys)


def test_what_is_not_offered_is_refused(block, capsys):
    one = block().initialized()
    calls = {
        2: {
            "CancelStep": (),
            "GetStatus": (0, byref(c_int())),
            "GetDirectionalDerivative": (None, 0, None, 0, None, None),
        },
        3: {
            "EnterConfigurationMode": (),
            "EvaluateDiscreteStates": (),
            "GetDirectionalDerivative": (None, 0, None, 0, None, 0, None, 0),
        },
    }[one.version]
    for name, arguments in calls.items():
        assert one.status(name, *arguments) == ERROR
        assert f"{name}: this FMU does not offer that" in refusal(capsys)


def test_states_of_others_are_refused(block, capsys):
    one, other = block().initialized(), block(ME).initialized()
    state = other.fmu.getFMUState()
    name = "FMUstate" if one.version == 2 else "FMUState"
    assert one.status(f"Set{name}", state) == ERROR
    assert "the state is of another model or interface" in refusal(capsys)
    assert one.status(f"Set{name}", None) == ERROR
    assert "a pointer is null" in refusal(capsys)
    kept = other.fmu.serializeFMUState(state)
    other.fmu.freeFMUState(state)
    verb = "DeSerialize" if one.version == 2 else "Deserialize"
    for wrong, says in ((kept, "are no state of this model"), (kept[:-1], "elements, expected")):
        with pytest.raises(FMICallException, match=f"fmi{one.version}{verb}{name}"):
            one.fmu.deserializeFMUState(wrong)
        assert says in refusal(capsys)


@pytest.mark.parametrize("kind", [ME, CS])
def test_another_models_token_makes_no_instance(folder, capsys, kind):
    described = fmpy.read_model_description(folder)
    described.guid = "{0}"
    with pytest.raises(Exception, match="Failed to instantiate"):
        fmpy.instantiate_fmu(folder, described, kind, debug_logging=True)
    assert "the token is not the one of modelDescription.xml" in refusal(capsys)


def test_messages_can_be_chosen(block, capsys):
    one = block().initialized()
    for on, categories, told in (
        (True, ["logStatusDiscard"], 0),
        (True, ["logStatusDiscard", "logStatusError"], 1),
        (False, [], 0),
        (True, [], 1),
    ):
        one.fmu.setDebugLogging(on, categories)
        assert one.set({"T": 1.0}) == ERROR
        assert len(capsys.readouterr().out.splitlines()) == told
    with pytest.raises(FMICallException):
        one.fmu.setDebugLogging(True, ["logNothing"])
    assert "a log category is unknown" in refusal(capsys)
