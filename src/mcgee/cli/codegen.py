"""Packages of generated code from the terminal: what was written, and how well it agrees."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from mcgee.cli.working import working
from mcgee.robot import Robot

if TYPE_CHECKING:
    from mcgee.codegen import Package

VERIFIED, WRONG, REFUSED, NOT_VERIFIED = 0, 1, 2, 3
"""Exit codes."""


TargetOption = Annotated[
    str,
    typer.Option(
        "--target",
        metavar="LANGUAGE",
        help="python, c, cpp, java, matlab, simulink, fmu, wolfram or javascript; several with "
        "commas, or all: a folder each.",
    ),
]
FunctionsOption = Annotated[
    str,
    typer.Option(
        "--functions",
        metavar="NAMES",
        help="terms (M, C qd, g), inverse_dynamics, forward_dynamics, coriolis_matrix, jacobian, "
        "regressor, …, with commas; FMUs have their own.",
    ),
]


@dataclass(frozen=True)
class Wanted:
    targets: str
    functions: str
    params: bool
    single: bool
    frame: str | None
    force: bool
    verify: bool


def run(robot: Robot, wanted: Wanted, folder: Path, as_json: bool) -> int:
    """Write the packages; the exit code."""
    from mcgee.codegen import LANGUAGES, VerificationError, language
    from mcgee.codegen.package import check

    targets = list(LANGUAGES) if wanted.targets == "all" else _listed(wanted.targets)
    if not targets:
        raise ValueError(f"no target is named. Targets: {', '.join(LANGUAGES)}, or all.")
    places = {t: folder / t if len(targets) > 1 else folder for t in targets}
    for target, place in places.items():  # all of them, before any is written
        language(target, wanted.single)
        check(place, wanted.force)
    made: list[Package] = []
    failed: dict[int, list[str]] = {WRONG: [], REFUSED: []}
    for target, place in places.items():
        try:
            with working(f"writing and trying {target}" if wanted.verify else f"writing {target}"):
                made.append(_package(robot, target, place, wanted))
        except (VerificationError, ValueError) as error:
            failed[WRONG if isinstance(error, VerificationError) else REFUSED].append(target)
            typer.echo(f"mcgee: error: {error}", err=True)
    if as_json:
        written = [_content(p) for p in made]
        kinds = {"wrong": failed[WRONG], "refused": failed[REFUSED]}
        print(json.dumps({"written": written, **kinds}, indent=1))
    else:
        _print(made)
    missing = [p for p in made if wanted.verify and not p.verified]
    for package in missing:
        lacks = package.verification.missing if package.verification else ""
        typer.echo(f"mcgee: {package.target} is not verified: no {lacks} here", err=True)
    if failed[REFUSED] or failed[WRONG]:
        return REFUSED if failed[REFUSED] else WRONG
    return NOT_VERIFIED if missing else VERIFIED


def _package(robot: Robot, target: str, place: Path, wanted: Wanted) -> Package:
    return robot.codegen(
        target,
        place,
        _listed(wanted.functions),
        params=wanted.params,
        frame=wanted.frame,
        single=wanted.single,
        overwrite=wanted.force,
        verify=wanted.verify,
    )


def _listed(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _content(package: Package) -> dict[str, Any]:
    done = package.verification
    return {
        "target": package.target,
        "folder": str(package.folder),
        "files": list(package.files),
        "verified": package.verified,
        "tools": list(done.tools) if done else [],
        "missing": done.missing if done else "",
        "ulp": {
            a.function: {"60 digits": a.exact, "kernels": a.kernel}
            for a in (done.agreements if done else ())
        },
    }


def _print(made: Iterable[Package]) -> None:
    console = Console(highlight=False, soft_wrap=True)
    for package in made:
        sources = [path for path in package.files if not path.startswith("vectors/")]
        console.print(f"{package.folder}: {', '.join(sources)}", markup=False)
        if package.verification is None or not package.verification.done:
            continue
        console.print(f"  tried with {'; '.join(package.verification.tools)}", markup=False)
        for a in package.verification.agreements:
            console.print(
                f"  {a.function:<30} {a.exact:7.2g} ulp from 60 digits  "
                f"{a.kernel:7.2g} ulp from the kernels",
                markup=False,
            )
