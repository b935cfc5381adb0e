"""FMUs of both versions: what they hold, their simulations, and broken ones."""

from __future__ import annotations

import ctypes
import dataclasses
import re
import subprocess
import zipfile
from itertools import pairwise
from pathlib import Path

import fmpy
import numpy as np
import pytest
import sympy
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu
from units import made

import mcgee
from mcgee.codegen import VerificationError, c, fmu
from mcgee.codegen.fmu import FMU, VERSIONS
from mcgee.codegen.language import Tool
from mcgee.codegen.names import stem
from mcgee.codegen.package import put
from mcgee.codegen.unit import Unit, unit
from mcgee.codegen.verify import verify

ULP = 4.0
"""Units in the last place of a result's scale, against 60 digits."""

START = {"q[1]": -1.0, "q[2]": 0.6}
"""A swing of planar_2r that passes its lowest point several times in ten seconds."""

STATES = ("q[1]", "q[2]", "qd[1]", "qd[2]")

SAME = 1e-9
"""Of trajectories by one method with one step, which differ by accumulated rounding alone."""


def arm_unit(name: str) -> Unit:
    return made(name, FMU.functions, params=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Packages by the arms' names."""
    whole = tmp_path_factory.mktemp("fmus")
    for name in ("planar_2r", "cart_pole", "panda"):
        put(whole / name, FMU.files(arm_unit(name)))
    return whole


def path(folder: Path, version: int, name: str = "planar_2r") -> str:
    return str(folder / name / f"{name}_fmi{version}.fmu")


def simulated(folder: Path, version: int, kind: str = "CoSimulation", **options):
    options = {"start_values": START, "stop_time": 10.0, "output_interval": 0.01} | options
    return fmpy.simulate_fmu(path(folder, version), fmi_type=kind, **options)


def states(result) -> np.ndarray:
    return np.stack([result[name] for name in STATES], axis=1)


def runge_kutta(arm, h: float, steps: int, every: int, tau=lambda t: (0.0, 0.0)) -> np.ndarray:
    """By the kernels, from START."""

    def slope(x, effort):
        return np.concatenate([x[2:], arm.forward_dynamics(x[:2], x[2:], np.array(effort))])

    x = np.array([START["q[1]"], START["q[2]"], 0.0, 0.0])
    found = [x]
    for k in range(steps):
        held = tau(k // every * every * h)
        a = slope(x, held)
        b = slope(x + h / 2 * a, held)
        c = slope(x + h / 2 * b, held)
        d = slope(x + h * c, held)
        x = x + h / 6 * (a + 2 * b + 2 * c + d)
        if (k + 1) % every == 0:
            found.append(x)
    return np.array(found)


# -- what is written ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["planar_2r", "cart_pole", "panda"])
@pytest.mark.parametrize("version", VERSIONS)
def test_importers_find_no_fault(folder, version, name):
    assert validate_fmu(path(folder, version, name)) == []


@pytest.mark.parametrize("name", ["planar_2r", "puma560", "panda"])
def test_numbers_hold_through_the_interface(name):
    done = verify(FMU, arm_unit(name), FMU.files(arm_unit(name)))
    assert done.done
    assert done.tools[1].startswith("fmpy ")
    assert [a.function for a in done.agreements] == list(FMU.functions)
    for a in done.agreements:
        assert a.states == a.kernel_states == 20
        assert a.exact <= ULP
        assert a.kernel <= 2 * ULP


def test_the_same_input_gives_the_same_bytes(folder):
    again = FMU.files(arm_unit("planar_2r"))
    for name, content in again.items():
        kept = (folder / "planar_2r" / name).read_bytes()
        assert kept == (content if isinstance(content, bytes) else content.encode())


def test_what_an_fmu_holds(folder):
    both = {"modelDescription.xml", "documentation/index.html", "sources/planar_2r.c"}
    both |= {f"sources/{x}" for x in ("planar_2r.h", "fmu.h", "fmu_motion.h", "fmu_model.h")}
    for version, own in ((2, set()), (3, {"sources/buildDescription.xml"})):
        with zipfile.ZipFile(path(folder, version)) as whole:
            names = set(whole.namelist())
            assert {entry.date_time for entry in whole.infolist()} == {fmu.EPOCH}
            page = whole.read("documentation/index.html").decode()
        binary = f"binaries/{fmu.places()[version]}/planar_2r{fmu.SUFFIX}"
        assert names == both | own | {f"sources/fmi{version}.c", binary}
        assert "joint friction is left out" in page
        assert "Runge-Kutta" in page


def test_a_binary_shows_the_standard_and_no_path(folder, tmp_path):
    header = (folder / "planar_2r/sources/fmi3Functions.h").read_text()
    names = set(re.findall(r"^FMI3_Export\s+\w+\s+(\w+);", header, re.MULTILINE))
    assert len(names) == 75
    unpacked = fmpy.extract(path(folder, 3), str(tmp_path))
    (library,) = Path(unpacked).glob("binaries/*/planar_2r.*")
    loaded = ctypes.CDLL(str(library))
    assert all(hasattr(loaded, name) for name in names)
    assert not hasattr(loaded, "planar_2r_forward_dynamics")
    assert b"mcgee-fmu-" not in library.read_bytes()


def test_units_are_those_of_the_joints(folder):
    found = {
        v.name: v.unit
        for v in fmpy.read_model_description(path(folder, 3, "cart_pole")).modelVariables
    }
    assert [found[f"{x}[1]"] for x in ("tau", "q", "qd", "qdd")] == ["N", "m", "m/s", "m/s2"]
    assert [found[f"{x}[2]"] for x in ("tau", "q", "qd", "qdd")] == [
        *("N.m", "rad", "rad/s", "rad/s2")
    ]
    inertial = {
        v.name: v for v in fmpy.read_model_description(path(folder, 2, "panda")).modelVariables
    }
    assert [inertial[x].unit for x in ("m2", "hx2", "Ixy2")] == ["kg", "kg.m", "kg.m2"]
    assert inertial["m2"].description == "m2, mass of body 2, panda_link2"


def test_hostile_names_arrive_whole(tmp_path):
    """Joints' are printable; a symbol's may be anything, of which XML lacks some."""
    symbol = sympy.Symbol("m \n\t\x01<'&amp;\">")
    plain = mcgee.arms.planar_2r(m1=symbol)
    wild = ["a \"<b>&amp;'", "épaule 关节 ]]>"]
    joints = tuple(dataclasses.replace(j, name=x) for j, x in zip(plain.joints, wild, strict=True))
    arm = dataclasses.replace(plain, name="<&\"'>", joints=joints)
    values = {symbol: 1.0}
    put(tmp_path, FMU.files(unit(arm, FMU.functions, True, values, arm.end_frame, False)))
    for version in VERSIONS:
        file = tmp_path / f"arm_fmi{version}.fmu"
        assert validate_fmu(str(file)) == []
        described = fmpy.read_model_description(str(file))
        assert described.modelName == "<&\"'>"
        says = {v.name: v.description for v in described.modelVariables}
        assert says["q[1]"] == f"position of {wild[0]}"
        assert says["qd[2]"] == f"velocity of {wild[1]}"
        assert says["m_amp"] == "m \n\t_<'&amp;\"> of the description, in SI units"


def test_parameters_do_not_take_the_names_of_variables(tmp_path):
    m, length = sympy.symbols("qd max_step", positive=True)
    arm = mcgee.arms.pendulum(m=m, lc=length)
    values = {"qd": 1.0, "max_step": 0.5}
    put(tmp_path, FMU.files(unit(arm, FMU.functions, True, values, arm.end_frame, False)))
    for version in VERSIONS:
        file = str(tmp_path / f"pendulum_fmi{version}.fmu")
        assert validate_fmu(file) == []
        variables = fmpy.read_model_description(file).modelVariables
        tunable = [v.name for v in variables if v.causality == "parameter"]
        assert sorted(tunable) == ["max_step", "max_step_2", "qd_2"]


def test_no_arm_has_the_name_of_a_file_of_the_fmu():
    for name in (*fmu.GLUE, *fmu.STANDARD[2], *fmu.STANDARD[3], "fmu_model.h"):
        assert stem(Path(name).stem) == f"{Path(name).stem}_arm"
    arm = dataclasses.replace(mcgee.arms.planar_2r(), name="FMI2", made_by=None)
    made = FMU.files(unit(arm, FMU.functions, True, {}, arm.end_frame, False))
    assert "sources/FMI2_arm.c" in made


# -- simulations ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("version", "events"), [(2, False), (3, False), (3, True)])
def test_co_simulation_is_runge_kutta(folder, version, events):
    result = simulated(folder, version, use_event_mode=events)
    want = runge_kutta(mcgee.arms.planar_2r(), 1e-3, 10_000, 10)
    np.testing.assert_allclose(states(result), want, rtol=0, atol=SAME)
    np.testing.assert_array_equal(result["E"], result["T"] + result["P"])


@pytest.mark.parametrize("version", VERSIONS)
def test_drift_falls_with_the_fifth_power_of_the_step(folder, version):
    """The local error of the method; no other error is in it."""
    drift = []
    for step in (0.02, 0.01, 0.005):
        energy = simulated(
            folder, version, start_values=START | {"max_step": step}, output_interval=0.02
        )["E"]
        drift.append(abs(energy[-1] - energy[0]))
    assert drift[0] < 1e-4
    for longer, shorter in pairwise(drift):
        assert longer / shorter == pytest.approx(32, rel=0.1)


@pytest.mark.parametrize("version", VERSIONS)
def test_drift_of_model_exchange_is_the_solvers(folder, version):
    drift = []
    for tolerance in (1e-5, 1e-7, 1e-9):
        result = simulated(folder, version, "ModelExchange", relative_tolerance=tolerance)
        drift.append(np.abs(result["E"] - result["E"][0]).max())
    assert drift[0] > 10 * drift[1] > 100 * drift[2]
    assert drift[2] < 1e-6
    np.testing.assert_allclose(states(result), states(simulated(folder, version)), atol=1e-5)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_both_versions_give_the_same_numbers(folder, kind):
    two, three = (simulated(folder, version, kind) for version in VERSIONS)
    assert two.dtype == three.dtype
    assert two.tobytes() == three.tobytes()


@pytest.mark.parametrize("version", VERSIONS)
def test_parameters_and_inputs_take_effect(folder, version):
    """A load at the elbow and held efforts that change from step to step."""
    times = np.arange(0, 2.001, 0.01)
    tau = np.stack([3 * np.sin(times), np.cos(2 * times)], axis=1)
    signals = np.array(
        [(t, *e) for t, e in zip(times, tau, strict=True)],
        dtype=[("time", float), ("tau[1]", float), ("tau[2]", float)],
    )
    result = simulated(
        folder, version, start_values=START | {"m2": 2.5}, stop_time=2.0, input=signals
    )
    want = runge_kutta(mcgee.arms.planar_2r(m2=2.5), 1e-3, 2000, 10, lambda t: tau[round(t / 0.01)])
    np.testing.assert_allclose(states(result), want, rtol=0, atol=SAME)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_parameters_are_tunable(folder, version, kind, capsys):
    """A mass that grows on the way: between steps, and at an event."""
    signals = np.array(
        [(0.0, 0.0, 0.0, 1.0), (0.5, 0.0, 0.0, 3.0), (1.0, 0.0, 0.0, 3.0)],
        dtype=[("time", float), ("tau[1]", float), ("tau[2]", float), ("m2", float)],
    )
    result = simulated(folder, version, kind, stop_time=1.0, input=signals)
    for part, m2 in ((result[result["time"] < 0.5], 1.0), (result[result["time"] > 0.5], 3.0)):
        x, arm = states(part), mcgee.arms.planar_2r(m2=m2)
        want = arm.kinetic_energy(x[:, :2], x[:, 2:])
        np.testing.assert_allclose(part["T"], want, rtol=1e-12, atol=1e-15)
        got = np.stack([part["qdd[1]"], part["qdd[2]"]], axis=1)
        np.testing.assert_allclose(got, arm.forward_dynamics(x[:, :2], x[:, 2:], 0 * x[:, :2]))


# -- sources --------------------------------------------------------------------------------------


def test_without_a_compiler_the_importer_compiles(tmp_path, monkeypatch):
    monkeypatch.setattr(fmu, "COMPILER", Tool(("mcgee-cc",)))
    files = FMU.files(arm_unit("planar_2r"))
    assert "a binary (left out, for no C compiler here could make it)" in str(files["README.md"])
    put(tmp_path, files)
    results = []
    for version in VERSIONS:
        file = str(tmp_path / f"planar_2r_fmi{version}.fmu")
        assert validate_fmu(file) == []
        assert fmpy.supported_platforms(file) == ["c-code"]
        whole = fmpy.extract(file, str(tmp_path / str(version)))
        build = tmp_path / f"build{version}"
        build.mkdir()
        with monkeypatch.context() as quiet:
            quiet.setattr(subprocess, "check_call", silently)
            build_platform_binary(whole, build)
        results.append(fmpy.simulate_fmu(whole, start_values=START, output_interval=0.01))
    want = runge_kutta(mcgee.arms.planar_2r(), 1e-3, 1000, 10)
    for result in results:
        np.testing.assert_allclose(states(result)[:101], want[: len(result)], rtol=0, atol=SAME)


def silently(command: list[str]) -> None:
    subprocess.run(command, check=True, capture_output=True)


def test_compilers_take_the_sources_without_a_warning(folder, tmp_path):
    """For a shared library, and with the prefix that FMI wants where many are linked at once."""
    clang = ("clang", *(f"clang-{version}" for version in range(22, 13, -1)))
    sources = folder / "planar_2r" / "sources"
    for compiler in filter(None, (Tool(("gcc", "cc")).found(), Tool(clang).found())):
        for version in VERSIONS:
            for define in (f"-DFMI{version}_OVERRIDE_FUNCTION_PREFIX", "-DNOTHING"):
                target = tmp_path / "glue.o"
                command = [compiler, *c.WARNINGS, define, "-c", str(sources / f"fmi{version}.c")]
                silently([*command, "-o", str(target)])
                silently([*command, "-std=gnu11", "-o", str(target)])
    shown = subprocess.run(["nm", str(target)], capture_output=True, text=True, check=True).stdout
    external = [line.split()[-1] for line in shown.splitlines() if " T " in line]
    assert len(external) == 75
    assert all(name.startswith("planar_2r_fmi3") for name in external)


BREAKS = {
    "wrong": ("qddot[0] = ", "qddot[0] = 1e-9 + "),
    "nan": ("qddot[0] = ", "qddot[0] = (q[0] - q[0])/(q[0] - q[0]) + "),
    "no C": ("qddot[0] = ", "qddot[0] == "),
}


@pytest.mark.parametrize("kind", BREAKS)
def test_broken_code_is_found(monkeypatch, kind):
    right = c.source
    monkeypatch.setattr(c, "source", lambda unit: right(unit).replace(*BREAKS[kind], 1))
    found = arm_unit("planar_2r")
    with pytest.raises(VerificationError):
        verify(FMU, found, FMU.files(found))


def test_wrong_defaults_are_found(monkeypatch):
    right = c.source
    monkeypatch.setattr(c, "source", lambda unit: right(unit).replace("9.81", "9.82"))
    found = arm_unit("planar_2r")
    with pytest.raises(VerificationError, match="do not start with the values of the description"):
        verify(FMU, found, FMU.files(found))


@pytest.mark.parametrize(
    "before", ["{0.0, 0.5, 0.5, 1.0}", "h*share[stage]", "v + TAU, &p, h/steps"]
)
def test_wrong_steps_of_co_simulation_are_found(monkeypatch, before):
    after = {"{": "{0.0, 0.25, 0.5, 1.0}", "h": "0.99*h*share[stage]", "v": "v + TAU, &p, h"}
    right = fmu.text
    monkeypatch.setattr(fmu, "text", lambda name: right(name).replace(before, after[before[0]]))
    found = arm_unit("planar_2r")
    with pytest.raises(VerificationError, match="off its Runge-Kutta method"):
        verify(FMU, found, FMU.files(found))


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("sources/fmu_motion.h", "/* hm */\n", "fmu_motion.h is not what lies in this folder"),
        ("vectors/kinetic_energy.txt", "1.0 " * 15 + "\n", "kinetic_energy: 1 states"),
        ("vectors/kinetic_energy.txt", "", "kinetic_energy: 0 states"),
        ("sources/fmi3.c", "int unused(void) { int x; return 0; }\n", "unused"),
    ],
)
def test_packages_that_do_not_fit_are_found(name, content, says):
    found = arm_unit("planar_2r")
    files = FMU.files(found)
    files[name] = content if name.startswith("vectors") else str(files[name]) + content
    with pytest.raises(VerificationError, match=says):
        verify(FMU, found, files)


def test_fmpy_is_asked_for_where_it_is_missing(monkeypatch):
    monkeypatch.setattr(fmu.importlib.util, "find_spec", lambda name: None)
    done = verify(FMU, arm_unit("planar_2r"), {})
    assert done.missing == "fmpy (pip install fmpy)"
