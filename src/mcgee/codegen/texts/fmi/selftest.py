"""Compares the FMUs of this folder with its vectors; exits non-zero where one is missed."""

import math
import sys
import tempfile
import zipfile
from ctypes import c_double
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model
from fmpy.validation import validate_fmu

FOLDER = Path(__file__).resolve().parent

TOLERANCE = 32
"""Units in the last place of a result's scale."""

END, EVERY = 0.1, 0.01
"""Seconds of a co-simulation, and between its communication points."""

SAME = 1e-9
"""Of motions by one method, which rounding alone sets apart."""

ROWS = {
    "forward_dynamics": (("q", "qd", "tau", "parameters"), "qdd"),
    "kinetic_energy": (("q", "qd", "parameters"), "T"),
    "potential_energy": (("q", "parameters"), "P"),
}
"""What a row of vectors holds before the scale of its result."""


class Arm:
    """A model exchange instance of either version."""

    def __init__(self, version: int, unpacked: str):
        described = fmpy.read_model_description(unpacked)
        variables = described.modelVariables
        self.version = version
        self.places = {v.name: v.valueReference for v in variables}
        self.parameters = [v.name for v in variables if v.causality == "parameter"]
        self.parameters.remove("max_step")
        self.starts = {v.name: float(v.start) for v in variables if v.start is not None}
        self.n = sum(v.causality == "input" for v in variables)
        self.fmu = (FMU2Model if version == 2 else FMU3Model)(
            guid=described.guid,
            unzipDirectory=unpacked,
            modelIdentifier=described.modelExchange.modelIdentifier,
            instanceName="selftest",
        )
        self.fmu.instantiate()

    def names(self, array: str) -> list[str]:
        if array == "parameters":
            return self.parameters
        return [array] if array in "TP" else [f"{array}[{k}]" for k in range(1, self.n + 1)]

    def start(self, values: dict[str, float]) -> None:
        """Begin anew, with these values."""
        fmu = self.fmu
        fmu.reset()
        places = [self.places[name] for name in values]
        (fmu.setReal if self.version == 2 else fmu.setFloat64)(places, list(values.values()))
        if self.version == 2:
            fmu.setupExperiment()
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()

    def standard(self) -> list[float]:
        """The parameters' values at first, if they are those of the model description too."""
        self.start({})
        found = list(self.result("parameters"))
        return found if found == [self.starts[name] for name in self.parameters] else []

    def result(self, array: str) -> list[float]:
        fmu = self.fmu
        if array == "qdd":
            slopes = (c_double * (2 * self.n))()
            get = fmu.getDerivatives if self.version == 2 else fmu.getContinuousStateDerivatives
            get(slopes, len(slopes))
            return list(slopes)[self.n :]
        places = [self.places[name] for name in self.names(array)]
        return (fmu.getReal if self.version == 2 else fmu.getFloat64)(places)


def tried(arm: Arm, function: str) -> bool:
    """Whether all rows of a function hold."""
    inputs, output = ROWS[function]
    given = [name for array in inputs for name in arm.names(array)]
    rows = (FOLDER / "vectors" / f"{function}.txt").read_text().splitlines()
    worst = 0.0
    for k, row in enumerate(rows):
        numbers = [float(word) for word in row.split()]
        values, want, scale = numbers[: len(given)], numbers[len(given) : -1], numbers[-1]
        if k == 0 and arm.standard() != values[len(values) - len(arm.parameters) :]:
            print("parameters do not start with the values of the description")
            worst = math.inf
        arm.start(dict(zip(given, values, strict=True)))
        for got, wanted in zip(arm.result(output), want, strict=True):
            error = abs(got - wanted) / (scale * sys.float_info.epsilon)
            worst = max(worst, math.inf if math.isnan(error) else error)
    print(f"{function}: {len(rows)} states, largest error {worst:.3g} ulp")
    return bool(rows) and worst <= TOLERANCE


def complaints(path: Path) -> list[str]:
    """What is wrong with an FMU, but for its numbers."""
    found = validate_fmu(str(path))
    with zipfile.ZipFile(path) as whole:
        for beside in sorted((FOLDER / "sources").iterdir()):
            name = f"sources/{beside.name}"
            if name in whole.namelist() and beside.read_bytes() != whole.read(name):
                found.append(f"{name} is not what lies in this folder")
    return found


def integrated(arm: Arm, end: float, step: float) -> list[list[float]]:
    """q and qd from the start on, by Runge-Kutta steps with the derivatives of model exchange."""
    names = [*arm.names("q"), *arm.names("qd")]

    def slope(x: list[float]) -> list[float]:
        arm.start(dict(zip(names, x, strict=True)))
        return [*x[arm.n :], *arm.result("qdd")]

    def beside(x: list[float], h: float, k: list[float]) -> list[float]:
        return [a + h * b for a, b in zip(x, k, strict=True)]

    states = [[arm.starts[name] for name in names]]
    for _ in range(round(end / step)):
        x = states[-1]
        k1 = slope(x)
        k2 = slope(beside(x, step / 2, k1))
        k3 = slope(beside(x, step / 2, k2))
        k4 = slope(beside(x, step, k3))
        mean = [(a + 2 * (b + c) + d) / 6 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
        states.append(beside(x, step, mean))
    return states


def moves(path: Path, arm: Arm) -> list[tuple[float, ...]]:
    """All of a tenth of a second of co-simulation; nothing where it is not what it should be."""
    found = fmpy.simulate_fmu(
        str(path), fmi_type="CoSimulation", stop_time=END, output_interval=EVERY
    )
    names, step = [*arm.names("q"), *arm.names("qd")], arm.starts["max_step"]
    wanted = integrated(arm, END, step)[:: round(EVERY / step)]
    off = [abs(found[name][k] - x[i]) for k, x in enumerate(wanted) for i, name in enumerate(names)]
    size = max(1.0, *(abs(v) for x in wanted for v in x))
    if len(found) != len(wanted) or not max(off) <= SAME * size:
        print(f"{path.name}: co-simulation is {max(off):.1e} off its Runge-Kutta method")
        return []
    return [tuple(row) for row in found]


def main() -> int:
    failed, runs = False, []
    for version in (2, 3):
        (path,) = FOLDER.glob(f"*_fmi{version}.fmu")
        for complaint in complaints(path):
            print(f"{path.name}: {complaint}")
            failed = True
        with tempfile.TemporaryDirectory() as unpacked:
            fmpy.extract(str(path), unpacked)
            arm = Arm(version, unpacked)
            for function in ROWS:
                failed |= not tried(arm, function)
            runs.append(moves(path, arm))
            arm.fmu.terminate()
            arm.fmu.freeInstance()
    if runs[0] != runs[1]:
        print("co-simulation by FMI 2 and by FMI 3 differ")
    return int(failed or not runs[0] or runs[0] != runs[1])


if __name__ == "__main__":
    sys.exit(main())
