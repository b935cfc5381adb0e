"""The commands, their options, and what every command does with errors and warnings."""

from __future__ import annotations

import io
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

import mcgee
from mcgee.cli import bench as bench_view
from mcgee.cli import codegen as codegen_view
from mcgee.cli import derive as derive_view
from mcgee.cli import explain as explain_view
from mcgee.cli import simulate as simulate_view
from mcgee.cli import terms as terms_view
from mcgee.cli.state import read_state

app = typer.Typer(
    name="mcgee",
    help="The terms of a robot arm's equation of motion, M(q) qdd + C(q, qd) qd + g(q) = tau.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

RobotArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT", help="A URDF file, or a built-in arm such as planar_2r, puma560 or panda."
    ),
]
PositionOption = Annotated[
    str,
    typer.Option(
        "--q",
        help="Joint positions [rad | m]: comma-separated, one for each joint (0.5,0.3) or by name "
        "(elbow=0.3, others zero).",
    ),
]
VelocityOption = Annotated[
    str, typer.Option("--qd", help="Joint velocities [rad/s | m/s], in the same form.")
]
DegreesOption = Annotated[
    bool, typer.Option("--degrees", help="Read and show angles in degrees; M, C and g stay in SI.")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON, in SI units and radians.")]


def main() -> None:
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without Greek still shows numbers
    try:
        app(prog_name="mcgee")
    except BrokenPipeError:
        raise
    except OSError as error:  # a full disk, say
        sys.stderr.write(f"mcgee: error: {error}\n")
        sys.exit(2)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"mcgee {mcgee.__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


@app.command(
    no_args_is_help=True,
    epilog="Example:  mcgee terms planar_2r --q 0.5,0.3 --qd 0.1,-0.2",
)
def terms(
    robot: RobotArgument,
    q: PositionOption = "",
    qd: VelocityOption = "",
    degrees: DegreesOption = False,
    json: JsonOption = False,
) -> None:
    """Print M(q), C(q, qd) qd and g(q) of a robot in one state; at rest in q = 0 by default."""
    with reported():
        arm = mcgee.load(robot)
        state = read_state(arm, q, qd, degrees=degrees)
        (terms_view.print_json if json else terms_view.print_tables)(arm, state)


@app.command(
    no_args_is_help=True,
    epilog="Example:  mcgee explain planar_2r --q 0.5,0.3 --qd 0.1,-0.2",
)
def explain(
    robot: RobotArgument,
    q: PositionOption = "",
    qd: VelocityOption = "",
    qdd: Annotated[
        str, typer.Option("--qdd", help="Joint accelerations [rad/s² | m/s²], in the same form.")
    ] = "",
    frame: Annotated[
        str | None, typer.Option("--frame", help="Where a hand would push; the end by default.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option("--html", metavar="FILE", help="Write an interactive page too.")
    ] = None,
    degrees: Annotated[
        bool, typer.Option("--degrees", help="Read angles in degrees; the report stays in SI.")
    ] = False,
    json: JsonOption = False,
) -> None:
    """Say what M, C and g mean for a robot in one state: in figures and in words."""
    with reported():
        arm = mcgee.load(robot)
        state = read_state(arm, q, qd, qdd, degrees=degrees)
        explanation = arm.explain(state.q, state.qd, state.qdd, frame=frame)
        if html is not None:
            explanation.to_html(html)
            typer.echo(f"mcgee: wrote {html}", err=True)
        explain_view.print_json(explanation) if json else explain_view.print_report(explanation)


@app.command(no_args_is_help=True, epilog="Example:  mcgee derive planar_2r --html arm.html")
def derive(
    robot: RobotArgument,
    simplify: Annotated[
        str,
        typer.Option(
            "--simplify",
            metavar="WAY",
            help="expanded, collected by configuration, or lumped: constants named once.",
        ),
    ] = "collected",
    symbolic: Annotated[
        bool, typer.Option("--symbolic", help="Ten symbols for the inertia of every body.")
    ] = False,
    limit: Annotated[
        int | None,
        typer.Option(
            "--limit", metavar="N", min=0, help="Terms a section shows at most; 0 for all."
        ),
    ] = None,
    latex: Annotated[
        Path | None, typer.Option("--latex", metavar="FILE", help="Write an article.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option("--html", metavar="FILE", help="Write a page.")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Derive T, P, M, C and g as exact formulas, and prove them."""
    with reported():
        derive_view.check(latex, html)
        form = derive_view.derived(mcgee.load(robot), simplify, symbolic)
        most = (limit or None) if limit is not None else derive_view.FILES
        for path in derive_view.write(form, most, latex, html):
            typer.echo(f"mcgee: wrote {path}", err=True)
        if json:
            derive_view.print_json(form)
        elif latex is None and html is None:
            most = (limit or None) if limit is not None else derive_view.TERMINAL
            derive_view.print_report(form, most)


@app.command(
    no_args_is_help=True,
    epilog="Exit code: 0 written and verified (or --no-verify), 1 wrong and not written, "
    "2 refused, 3 written and not verified for want of a toolchain. "
    "Example:  mcgee codegen planar_2r --target cpp --params -o arm",
)
def codegen(
    robot: RobotArgument,
    target: codegen_view.TargetOption,
    folder: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Where to write.")],
    functions: codegen_view.FunctionsOption = "terms",
    params: Annotated[
        bool, typer.Option("--params", help="Leave parameters open; else numbers are folded in.")
    ] = False,
    single: Annotated[
        bool, typer.Option("--float", help="float in the place of double (c, cpp).")
    ] = False,
    frame: Annotated[
        str | None,
        typer.Option("--frame", help="Of forward_kinematics and jacobian; the end by default."),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write over generated files in a folder in use.")
    ] = False,
    verify: Annotated[
        bool, typer.Option(help="Compile, run and compare, where the toolchain is here.")
    ] = True,
    json: JsonOption = False,
) -> None:
    """Write verified code of the dynamics in another language."""
    with reported():
        wanted = codegen_view.Wanted(
            target, functions, params=params, single=single, frame=frame, force=force, verify=verify
        )
        raise typer.Exit(codegen_view.run(mcgee.load(robot), wanted, folder, json))


@app.command(
    no_args_is_help=True,
    epilog="Example:  mcgee simulate panda --controller computed-torque "
    "--q panda_joint4=-2 --target panda_joint4=-1 --duration 3 --html run.html",
)
def simulate(
    robot: RobotArgument,
    duration: simulate_view.DurationOption,
    q: PositionOption = "",
    qd: VelocityOption = "",
    controller: simulate_view.ControllerOption = "none",
    target: simulate_view.TargetOption = "",
    rise: simulate_view.RiseOption = None,
    bandwidth: simulate_view.BandwidthOption = None,
    method: simulate_view.MethodOption = "DOP853",
    step: simulate_view.StepOption = None,
    dt: simulate_view.DtOption = 1e-3,
    friction: simulate_view.FrictionOption = False,
    stops: simulate_view.StopsOption = False,
    limits: simulate_view.LimitsOption = False,
    html: simulate_view.HtmlOption = None,
    output: simulate_view.OutputOption = None,
    degrees: DegreesOption = False,
    json: JsonOption = False,
) -> None:
    """Let an arm move, free or under control, and account for its energy."""
    with reported():
        arm = mcgee.load(robot)
        settings = {"method": method, "step": step, "dt": dt, "friction": friction}
        settings |= {"stops": stops, "effort_limits": limits}
        start = read_state(arm, q, qd, degrees=degrees)
        goal = read_state(arm, target, "", degrees=degrees).q if target else None
        wanted = simulate_view.Wanted(duration, controller, goal, rise, bandwidth, settings)
        raise typer.Exit(simulate_view.run(arm, start, wanted, (html, output), json))


@app.command(no_args_is_help=True, epilog="Example:  mcgee bench ur5e --counts")
def bench(
    robot: RobotArgument,
    counts: Annotated[
        bool, typer.Option("--counts", help="Count operations instead of measuring time.")
    ] = False,
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="QUANTITY", help="Of this quantity; can be given several times."),
    ] = None,
    json: JsonOption = False,
) -> None:
    """Say what each quantity costs: nanoseconds on this machine, or operations on any."""
    with reported():
        arm = mcgee.load(robot)
        if json:
            bench_view.print_json(arm, counts, only or [])
        else:
            (bench_view.print_counts if counts else bench_view.print_times)(arm, only or [])


@contextmanager
def reported() -> Iterator[None]:
    """Warnings as one line each on stderr; what a user got wrong as one line and exit code 2."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", mcgee.ModelWarning)
        warnings.showwarning = _show
        try:
            yield
        except (ValueError, ModuleNotFoundError) as error:
            typer.echo(f"mcgee: error: {error}", err=True)
            raise typer.Exit(2) from None


def _show(message: Warning | str, *_: object, **__: object) -> None:
    typer.echo(f"mcgee: warning: {message}", err=True)
