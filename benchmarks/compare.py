"""mcgee beside its peers in one run: `make bench`, or this file with --quick, --robots ….

Every round measures every library once on the same states, so that noise meets all alike; medians
over rounds. A peer whose results are wrong is not timed. Writes RESULTS.md and results.json.
"""

from __future__ import annotations

import argparse
import datetime
import importlib
import importlib.metadata
import json
import platform
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import mcgee
from mcgee import build
from mcgee.jit.target import host

sys.path.insert(0, str(Path(__file__).parent))
import models
import peak
from peers import AbsentError

HERE = Path(__file__).parent
ROBOTS = ("planar_2r", "ur5", "panda", "talos")
FUNCTIONS = (
    *("inverse_dynamics", "mass_matrix", "forward_dynamics", "coriolis_matrix", "gravity"),
    *("mass_matrix_inverse", "inverse_dynamics_derivatives", "forward_dynamics_derivatives"),
    "regressor",
)
PEERS = {
    "pinocchio_cpp": "Pinocchio C++",
    "casadi_c": "CasADi C",
    "pinocchio_python": "Pinocchio Python",
    "mujoco_python": "MuJoCo Python",
    "drake_python": "Drake Python",
    "adam_casadi": "adam CasADi",
    "frax_jax": "frax (JAX)",
    "roboticstoolbox_python": "Robotics Toolbox",
}
SINCOS = 44
"""Instructions of a sine and cosine of a vector."""
TOLERANCE = 1e-7
"""Of the largest result: peers take a file's rounded right angles as written."""
LONG = 100
"""Joints up to which C code is generated."""
COLUMNS_FIRST = ("mass_matrix", "coriolis_matrix", "inverse_dynamics_derivatives")
"""Where Pinocchio's last matrix is stored so."""
COMPILED = ("pinocchio_cpp", "casadi_c")
WHOLE_BATCH = (*COMPILED, "frax_jax")
GOALS = {"pinocchio_cpp": (25, 10), "casadi_c": (6, 3)}
"""Times as many rows a second: for arms, for humanoids."""


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--functions", default=",".join(FUNCTIONS))
    parser.add_argument("--peers", default=",".join(PEERS))
    parser.add_argument("--batch", type=int, default=4096)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--chains", action="store_true", help="chains of 2 to 500 joints too")
    parser.add_argument("--quick", action="store_true", help="3 rounds, nothing written")
    options = parser.parse_args()
    warnings.simplefilter("ignore", mcgee.ModelWarning)
    mcgee.set_num_threads(1)
    if options.quick:
        options.rounds = 3
    results = {"machine": machine(), "peak": peak.vectors_per_nanosecond(), "tables": {}}
    with tempfile.TemporaryDirectory() as folder:
        for name in filter(None, options.robots.split(",")):
            table = measured(name, Path(folder), options, options.functions.split(","))
            results["tables"][name] = table
            print(as_text(name, table), flush=True)
        for n in models.CHAINS if options.chains else ():
            some = ["inverse_dynamics", "forward_dynamics"]
            some_peers = COMPILED if n <= LONG else COMPILED[:1]  # long C takes clang many minutes
            options.peers = ",".join(p for p in some_peers if p in options.peers)
            table = measured(f"chain{n}", Path(folder), options, some)
            results["tables"][f"chain{n}"] = table
            print(as_text(f"chain{n}", table), flush=True)
    if not options.quick:
        (HERE / "results.json").write_text(json.dumps(results, indent=1) + "\n")
        (HERE / "RESULTS.md").write_text(as_markdown(results))


def machine() -> dict[str, str]:
    model = platform.processor()
    if Path("/proc/cpuinfo").exists():
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next((x.split(":")[1].strip() for x in lines if x.startswith("model name")), model)
    found = {"processor": model, "lanes": str(host().lanes), "Python": platform.python_version()}
    for package in ("numpy", "llvmlite", "pin", "casadi", "mujoco", "drake", "adam-robotics"):
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            found[package] = "absent"
    try:
        from peers import compiler

        said = subprocess.run([compiler.cpp(), "--version"], capture_output=True, text=True)
        found["C++"] = said.stdout.splitlines()[0]
    except AbsentError as absent:
        found["C++"] = str(absent)
    return found | {"date": datetime.date.today().isoformat()}


def measured(name: str, folder: Path, options: argparse.Namespace, functions: list[str]) -> list:
    file = models.file(name, folder)
    arm = mcgee.load(file, mimic=False)
    peers = at_hand(options.peers.split(","), arm, file)
    return [row(arm, function, peers, options) for function in functions]


def at_hand(names: list[str], arm: mcgee.Robot, file: Path) -> dict[str, dict]:
    found = {}
    for name in filter(None, names):
        try:
            found[name] = importlib.import_module(f"peers.{name}").functions(arm, file)
        except Exception as reason:  # not to be had, or its own reader cannot take the file
            print(f"{name}: absent ({type(reason).__name__}: {reason})")
    return found


def row(arm: mcgee.Robot, name: str, peers: dict, options: argparse.Namespace) -> dict:
    random = np.random.default_rng(0)
    shape = (options.batch, arm.n)
    arrays = [random.normal(size=shape) for _ in build.SIGNATURES[name].inputs]
    ours = getattr(arm, name)
    start = time.perf_counter()
    expected = flat(ours(*arrays))
    first = time.perf_counter() - start
    outputs = ours(*arrays)
    timed = {"mcgee": lambda: ours(*arrays, out=outputs)}
    single = [a[0].copy() for a in arrays]
    rates = {"mcgee": options.batch}
    wrong = {}
    for peer, functions in peers.items():
        if name not in functions:
            continue
        most = options.batch if peer in WHOLE_BATCH else functions.get("rows", 512)
        rows = min(options.batch, most)
        order = functions["order"] if "order" in functions else np.arange(arm.n)
        some = [np.ascontiguousarray(a[:rows, order]) for a in arrays]
        error = apart(functions[name](*some, keep=True), expected[:rows], peer, name, order)
        if not error < TOLERANCE:
            wrong[peer] = error
            continue
        timed[peer] = lambda f=functions[name], some=some: f(*some)
        rates[peer] = rows
    times = {peer: [] for peer in (*timed, "single")}
    for _ in range(options.rounds):
        for peer, call in timed.items():
            times[peer].append(seconds(call) / rates[peer])
        times["single"].append(seconds(lambda: [ours(*single) for _ in range(500)]) / 500)
    return {
        "function": name,
        "ns": {peer: statistics.median(t) * 1e9 for peer, t in times.items()},
        "wrong": wrong,
        "counts": build.trace(arm.mechanism, name).operation_counts(),
        "first call": first,
    }


def seconds(call) -> float:
    """Of one call among calls that take a millisecond together, after an untimed one."""
    start = time.perf_counter()
    call()
    times = max(1, int(1e-3 / (time.perf_counter() - start)))
    start = time.perf_counter()
    for _ in range(times):
        call()
    return (time.perf_counter() - start) / times


def flat(result) -> np.ndarray:
    parts = result if isinstance(result, tuple) else (result,)
    return np.concatenate([p.reshape(len(p), -1) for p in parts], axis=1)


def apart(got: np.ndarray, want: np.ndarray, peer: str, name: str, order: np.ndarray) -> float:
    """The largest difference over the largest element, of what both libraries define alike.

    Args:
        order: our joints in the peer's order
    """
    n, got = len(order), np.array(got).reshape(len(got), -1)
    if got.shape[1] == n:
        pairs = [(got, want[:, order])]
    elif (
        name == "regressor"
    ):  # of a link's ten columns, the mass's: the rest is in frames of its own
        own = np.swapaxes(got.reshape(len(got), 10 * n, n), 1, 2)
        own = own if peer == "pinocchio_cpp" else got.reshape(len(got), n, 10 * n)
        masses = want.reshape(len(want), n, 10 * n)[:, :, ::10]
        pairs = [(own[:, :, ::10], masses[:, order][:, :, order])]
    else:
        mine = want.reshape(len(want), -1, n, n)[:, :, order][:, :, :, order]
        own = got.reshape(len(got), -1, n, n)
        pairs = [[own[:, k], mine[:, k]] for k in range(own.shape[1])]
        if peer == "pinocchio_cpp" and name in COLUMNS_FIRST:
            pairs[-1][0] = np.swapaxes(pairs[-1][0], -1, -2)
        if name != "coriolis_matrix":  # the last, M or its inverse, may have one half only
            pairs[-1] = [np.triu(square) for square in pairs[-1]]
    return max(float(np.abs(g - w).max() / np.abs(w).max()) for g, w in pairs)


# -- tables ---------------------------------------------------------------------------------------


def operations(line: dict) -> int:
    return sum(line["counts"][k] for k in ("add", "mul", "div"))


def ratio(line: dict, peer: str) -> str:
    return f"{line['ns'][peer] / line['ns']['mcgee']:.1f}" if peer in line["ns"] else "–"


def as_text(name: str, table: list[dict]) -> str:
    heads = "".join(f"{head:>8}" for head in ("ops", "ns", "1 call", "C++", "CasADi", "×C++"))
    lines = [f"\n{name:30}{heads}{'×CasADi':>9}"]
    for line in table:
        ns = line["ns"]
        cells = [f"{operations(line)}", f"{ns['mcgee']:.1f}", f"{ns['single']:.0f}"]
        cells += [f"{ns[p]:.0f}" if p in ns else "–" for p in COMPILED]
        cells.append(ratio(line, "pinocchio_cpp"))
        text = f"{line['function']:30}" + "".join(f"{cell:>8}" for cell in cells)
        wrong = "".join(f"  {peer} WRONG {error:.1e}" for peer, error in line["wrong"].items())
        lines.append(f"{text}{ratio(line, 'casadi_c'):>9}{wrong}")
    return "\n".join(lines)


HEADS = (
    *("function", "operations", "mcgee, batch", "of the limit", "mcgee, one call"),
    *PEERS.values(),
    *("× Pinocchio C++", "× CasADi C"),
)
PREFACE = """# Results

Generated by `make bench`. {machine}.

One thread, medians; ns an evaluation. A batch is 4,096 rows in NumPy's own layout; a call is one
row from Python, Python included. Peers loop in C or C++ over the same rows; those from Python make
a call a row. CasADi's C is generated from mcgee's own recursions. The limit is the time that
{peak:.2f} fused multiply-adds of {lanes} lanes a nanosecond, measured, would need for the kernel's
arithmetic alone, without loads and stores.
"""


def as_markdown(results: dict) -> str:
    machine = results["machine"]
    said = ", ".join(f"{key} {value}" for key, value in machine.items())
    text = [PREFACE.format(machine=said, peak=results["peak"], lanes=machine["lanes"])]
    for name, table in results["tables"].items():
        text += [
            f"## {name}",
            "",
            "| " + " | ".join(HEADS) + " |",
            "|---" + "|--:" * (len(HEADS) - 1) + "|",
        ]
        text += [markdown_row(line, results) for line in table] + [""]
    return "\n".join(text)


def markdown_row(line: dict, results: dict) -> str:
    ns, counts = line["ns"], line["counts"]
    least = (counts["instructions"] + SINCOS * counts["sincos"]) / int(results["machine"]["lanes"])
    limit = least / results["peak"] / ns["mcgee"]
    cells = [line["function"].replace("_", " "), f"{operations(line):,}", f"{ns['mcgee']:.1f}"]
    cells += [f"{limit:.0%}", f"{ns['single']:.0f}"]
    cells += [f"{ns[p]:,.0f}" if p in ns else "–" for p in PEERS]
    cells += [f"**{ratio(line, p)}**" for p in COMPILED]
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    main()
