"""Closed forms beside SymPy's mechanics module and skidy, in one run: `make bench-closed-forms`.

Each subject runs in a process of its own and is stopped after a while. Times are what a user waits
for once the library is imported: from the robot to the exact objects, and to the first printed
formula; of mcgee medians over rounds. Writes CLOSED_FORMS.md.
"""

from __future__ import annotations

import argparse
import json
import platform
import statistics
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
PATIENCE = 120.0
"""Seconds after which a subject is stopped."""

PLANAR = {f"planar_{n}r": n for n in (2, 3, 4, 6)}
ARMS = ("scara", "stanford", "puma560", "ur5e", "panda")
SUBJECTS = (
    *((name, "symbols") for name in PLANAR),
    *((name, "symbolic inertias") for name in ARMS),
    ("puma560", "all symbols"),
    ("panda", "all symbols"),
    ("panda", "numbers"),
)
LENGTHS = {
    "puma560": (
        *({"alpha": 90}, {"a": "a2"}, {"a": "a3", "d": "d3", "alpha": -90}),
        *({"d": "d4", "alpha": 90}, {"alpha": -90}, {}),
    ),
    "panda": (
        *({"d": "d1", "alpha": -90}, {"alpha": 90}, {"d": "d3", "a": "a4", "alpha": 90}),
        *(
            {"a": "-a4", "alpha": -90},
            {"d": "d5", "alpha": 90},
            {"a": "a7", "alpha": 90},
            {"d": "d7"},
        ),
    ),
}
"""Standard Denavit-Hartenberg rows, angles in degrees."""
PLANAR_ONLY = ("sympy", "skidy")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--patience", type=float, default=PATIENCE)
    parser.add_argument("--subject", help="run one in this process: library,robot,kind")
    options = parser.parse_args()
    if options.subject:
        library, robot, kind = options.subject.split(",")
        print(json.dumps(RUNS[library](robot, kind, options.rounds)))
        return
    rows = [measured(library, *subject, options) for library, subject in _all()]
    text = as_markdown(rows)
    (HERE / "CLOSED_FORMS.md").write_text(text)
    print(text)


def _all() -> Iterator[tuple[str, tuple[str, str]]]:
    for subject in SUBJECTS:
        yield "mcgee", subject
        if subject[0] in PLANAR:
            yield from ((library, subject) for library in PLANAR_ONLY)


def measured(library: str, robot: str, kind: str, options: argparse.Namespace) -> dict[str, Any]:
    row = {"library": library, "robot": robot, "kind": kind}
    rounds = options.rounds if library == "mcgee" else 1
    command = [sys.executable, "-W", "ignore", __file__, "--rounds", str(rounds)]
    command += ["--subject", f"{library},{robot},{kind}"]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=options.patience)
    except subprocess.TimeoutExpired:
        return row | {"failed": f"stopped after {options.patience:.0f} s"}
    if run.returncode:
        return row | {"failed": run.stderr.strip().splitlines()[-1]}
    return row | json.loads(run.stdout.splitlines()[-1])


def timed(rounds: int, *steps: Callable[[Any], Any]) -> list[float]:
    """Medians of the seconds of each step, which takes what the one before it gave."""
    times: list[list[float]] = [[] for _ in steps]
    for _ in range(rounds):
        given = None
        for step, took in zip(steps, times, strict=True):
            start = time.perf_counter()
            given = step(given)
            took.append(time.perf_counter() - start)
    return [statistics.median(took) for took in times]


# -- mcgee ----------------------------------------------------------------------------------------


def mcgee(robot: str, kind: str, rounds: int) -> dict[str, Any]:
    import mcgee

    warnings.simplefilter("ignore")
    symbolic = kind in ("symbolic inertias", "all symbols")
    if robot in PLANAR:
        arm = planar(PLANAR[robot])
    else:
        arm = of_lengths(LENGTHS[robot]) if kind == "all symbols" else mcgee.load(robot)
    arm.closed_form(symbolic_inertias=symbolic)  # what is imported at first use

    def derive(_: None) -> Any:
        form = arm.closed_form(symbolic_inertias=symbolic)
        form.exact.christoffel, form.exact.Cqd  # noqa: B018
        return form

    def show(form: Any) -> Any:
        str(form.M[0, 0])
        return form

    exact, first = timed(rounds, derive, show)
    form = derive(None)
    prove, base = timed(1, lambda _: form.prove(), lambda _: form.base_parameters())
    return {
        "exact": exact,
        "first": first,
        "prove": prove,
        "base": base,
        "M11": len(form.exact.M[0][0]),
        "M": form.terms("M"),
        "c": form.terms("christoffel"),
    }


def planar(n: int) -> Any:
    """n links in a vertical plane, every parameter a symbol."""
    import sympy

    import mcgee

    g0 = sympy.Symbol("g0", positive=True)
    rows = []
    for i in range(1, n + 1):
        m, l, lc, I = sympy.symbols(f"m{i} l{i} lc{i} I{i}", positive=True)
        rows.append({"a": l, "m": m, "r": (lc - l, 0, 0), "I": (0, 0, I)})
    return mcgee.from_dh(rows).replace(gravity_vector=(0, -g0, 0))


def of_lengths(rows: tuple[dict[str, Any], ...]) -> Any:
    import math

    import sympy

    import mcgee

    def row(given: dict[str, Any]) -> dict[str, Any]:
        lengths = {key: sympy.sympify(x) for key, x in given.items() if key != "alpha"}
        body = {"m": 1, "r": (0, 0, 0), "I": (1, 1, 1)}  # symbols take the place of these
        return lengths | {"alpha": math.radians(given.get("alpha", 0))} | body

    return mcgee.from_dh([row(given) for given in rows])


# -- SymPy ----------------------------------------------------------------------------------------


def sympy(robot: str, kind: str, rounds: int) -> dict[str, Any]:
    """LagrangesMethod of its mechanics module: mass matrix and forcing vector."""
    from sympy import Matrix, symbols
    from sympy.physics.mechanics import (
        LagrangesMethod,
        Lagrangian,
        Particle,
        Point,
        ReferenceFrame,
        RigidBody,
        dynamicsymbols,
        inertia,
    )

    assert Particle  # named for those who look for it; links are bodies
    n = PLANAR[robot]

    def derive(_: None) -> Any:
        q, g0 = dynamicsymbols(f"q1:{n + 1}"), symbols("g0")
        N = ReferenceFrame("N")
        O = Point("O")
        O.set_vel(N, 0)
        bodies, joint, angle = [], O, 0
        for i in range(1, n + 1):
            m, l, lc, I = symbols(f"m{i} l{i} lc{i} I{i}")
            angle = angle + q[i - 1]
            A = N.orientnew(f"A{i}", "Axis", [angle, N.z])
            com = joint.locatenew(f"C{i}", lc * A.x)
            end = joint.locatenew(f"E{i}", l * A.x)
            com.v2pt_theory(joint, N, A)
            end.v2pt_theory(joint, N, A)
            body = RigidBody(f"B{i}", com, A, m, (inertia(A, 0, 0, I), com))
            body.potential_energy = m * g0 * com.pos_from(O).dot(N.y)
            bodies.append(body)
            joint = end
        method = LagrangesMethod(Lagrangian(N, *bodies), q, bodies=bodies, frame=N)
        method.form_lagranges_equations()
        return method

    def show(method: Any) -> Any:
        M = Matrix(method.mass_matrix).applyfunc(lambda e: e.expand().trigsimp())
        str(M[0, 0])
        str(method.forcing[0])
        return method

    exact, first = timed(rounds, derive, show)
    return {"exact": exact, "first": first}


# -- skidy ----------------------------------------------------------------------------------------


def skidy(robot: str, kind: str, rounds: int) -> dict[str, Any]:
    """Its closed-form kinematics and inverse dynamics, simplified as its examples do."""
    from skidy import SymbolicKinDyn, joint_screw, mass_matrix_mixed_data, transformation_matrix
    from sympy import Matrix, symbols

    n = PLANAR[robot]
    q, qd, q2d = ([symbols(f"{x}{i}") for i in range(1, n + 1)] for x in ("q", "dq", "ddq"))

    def derive(_: None) -> Any:
        screws, poses, masses, reach = [], [], [], 0
        for i in range(1, n + 1):
            m, l, lc, I = symbols(f"m{i} l{i} lc{i} I{i}")
            screws.append(joint_screw([0, 0, 1], [reach, 0, 0]))
            poses.append(transformation_matrix(t=[reach, 0, 0]))
            mass = mass_matrix_mixed_data(m, Matrix([[0, 0, 0], [0, 0, 0], [0, 0, I]]), [lc, 0, 0])
            masses.append(mass)
            reach = reach + l
        robot = SymbolicKinDyn(
            gravity_vector=Matrix([0, -symbols("g0"), 0]),
            ee=transformation_matrix(t=[reach, 0, 0]),
            body_ref_config=poses,
            joint_screw_coord=screws,
            Mb=masses,
            q=Matrix(q),
            qd=Matrix(qd),
            q2d=Matrix(q2d),
            config_representation="spatial",
        )
        robot.closed_form_kinematics_body_fixed(simplify=True, parallel=False)
        robot.closed_form_inv_dyn_body_fixed(simplify=True, parallel=False)
        return robot

    def show(robot: Any) -> Any:
        str(robot.M[0, 0])
        return robot

    exact, first = timed(rounds, derive, show)
    return {"exact": exact, "first": first}


RUNS = {"mcgee": mcgee, "sympy": sympy, "skidy": skidy}
NAMES = {"mcgee": "mcgee", "sympy": "SymPy mechanics", "skidy": "skidy"}


# -- the table ------------------------------------------------------------------------------------


def as_markdown(rows: list[dict[str, Any]]) -> str:
    lines = [
        "# Closed forms, measured",
        "",
        f"{date.today()}, {platform.machine()}, Python {platform.python_version()}, "
        + ", ".join(f"{name} {_version(name)}" for name in ("python-flint", "sympy", "skidy")),
        "",
        "From the robot to the exact objects (for mcgee M, C, C qd, g, T, P and all Christoffel",
        "symbols; for the others, which were given planar arms alone, M and the equations of",
        "motion), then to the first printed formula, M11;",
        "proofs and base parameters on top; terms of M11, M and all Christoffel symbols together.",
        "",
        "| robot | parameters | by | exact | first formula | proofs | base | M11 | M | c |",
        "|---|---|---|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for row in rows:
        cells = [row["robot"], row["kind"], NAMES[row["library"]]]
        if "failed" in row:
            cells += [row["failed"], *[""] * 6]
        else:
            cells += [_seconds(row.get(key)) for key in ("exact", "first", "prove", "base")]
            cells += [f"{row[key]:,}" if key in row else "" for key in ("M11", "M", "c")]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "absent"


def _seconds(x: float | None) -> str:
    if x is None:
        return ""
    return f"{x * 1e3:.0f} ms" if x < 1 else f"{x:.1f} s"


if __name__ == "__main__":
    main()
