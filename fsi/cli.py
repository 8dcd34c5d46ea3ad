"""The command `fsi`.

Exit codes: 0 done, 1 a defect of the program, 2 wrong input, 3 a solve, mesh or step failed,
4 a validation failed, 130 interrupted. Errors are one line on stderr. Under `mpiexec` root alone prints; see
`parallel.last_words` for how all ranks end together.
"""

from __future__ import annotations

import json
import os
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from fsi import parallel
from fsi.errors import FsiError, InputError
from meshes.errors import MeshError

if TYPE_CHECKING:  # what a command needs is imported in it: `fsi --help` must be quick
    from fsi.case import Case
    from fsi.progress import ProgressBar
    from fsi.run import Outcome
    from fsi.stokes.model import StokesModel

INTERRUPTED = 130

app = typer.Typer(
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    help="Rigid bodies moving in Stokes flow, resolved down to the lubrication film.\n\n"
    "Begin with: fsi check cases/disc_in_box.toml. Works under mpiexec -n 4 fsi ... as well.",
)

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="A case file (TOML).", show_default=False)]
RunFolder = Annotated[
    Path, typer.Argument(metavar="RUN", help="A folder made by fsi run.", show_default=False)
]
Overrides = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change a value of the case, e.g. discretisation.degree=2, bodies.0.radius=2. May be repeated.",
        show_default=False,
    ),
]


def _load(path: Path, overrides: list[str] | None) -> Case:
    from fsi.case import load_case

    return parallel.on_root(lambda: load_case(path, overrides or ()))


def _require_writable(output: Path) -> None:
    if output.is_dir() or not os.access(output.absolute().parent, os.W_OK):
        raise InputError(f"output = {output}: no file can be written there; give another path")


def _model(case: Case) -> StokesModel:
    from fsi.stokes.model import StokesModel

    return StokesModel(case)


@app.command(epilog="Example: fsi check cases/two_discs.toml --set 'bodies.0.position=[-1.5, 0.0]'")
def check(case_file: CaseFile, overrides: Overrides = None) -> None:
    """Read a case and say what it holds: bodies, gaps, what is free or held, walls. Nothing is computed."""
    case = _load(case_file, overrides)
    if parallel.is_root():
        from fsi.report import print_case

        print_case(Console(), case)


@app.command(epilog="Example: fsi mesh cases/disc_in_box.toml -o disc.vtu, or fsi mesh RUN --step 7 -o 7.msh")
def mesh(
    source: Annotated[
        Path, typer.Argument(metavar="CASE|RUN", help="A case file, or a run folder.", show_default=False)
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The mesh file: .msh or .vtu")],
    step: Annotated[
        int | None, typer.Option(help="Which step of a run.", show_default="the last with fields")
    ] = None,
    overrides: Overrides = None,
) -> None:
    """Write the mesh of a case at time 0, or the one that a run used at a step."""
    _require_writable(output)
    if source.is_dir():
        from postprocess.step_mesh import write_step_mesh

        if overrides:
            raise InputError(f"--set {overrides[0]}: a run is what it is; give a case file to change a value")
        written = parallel.on_root(lambda: write_step_mesh(source, step, output))
        message = f"wrote {output}, step {written}"
    else:
        from meshes.convert import require_suffix, write_mesh

        if step is not None:
            raise InputError(f"--step {step}: a case has no steps; give a run folder")
        case = _load(source, overrides)
        require_suffix(output)
        write_mesh(_model(case).mesh(case.configuration()), output, case.names)
        message = f"wrote {output}"
    if parallel.is_root():
        typer.echo(message)


@app.command(epilog="Example: fsi solve cases/disc_in_box.toml --set discretisation.cells_per_gap=2 --json")
def solve(
    case_file: CaseFile,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    overrides: Overrides = None,
) -> None:
    """Solve a case at time 0: velocities, forces of the fluid on the bodies with their errors, checks.

    The errors bound what the mesh and the elements do, estimated with one degree more. A case with
    discretisation.tolerance is refined until the largest, relative, is below it.

    A half-plane or a round container may stand for an infinite one: the solve is repeated with half its
    radius. The change of the results is the reported truncation, and the error at the full radius is less.
    """
    from fsi.report import print_solution, solution_json
    from fsi.stokes.refine import solve_with_errors
    from fsi.truncation import halved, truncation

    solved = solve_with_errors(_load(case_file, overrides))
    case, solution, errors = solved.case, solved.solution, solved.errors
    half = halved(case)
    truncated = None
    if half is not None:
        truncated = truncation(case, solution, _model(half)(half.configuration(), 0.0))
    if parallel.is_root() and as_json:
        typer.echo(json.dumps(solution_json(case, solution, errors, truncated)))
    elif parallel.is_root():
        print_solution(Console(), case, solution, errors, truncated)


@app.command(epilog="Example: fsi run cases/settling_disc.toml --output runs/settling --set time.end=20")
def run(
    case_file: CaseFile,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The run folder, a new one.", show_default="runs/<case file>"),
    ] = None,
    overrides: Overrides = None,
) -> None:
    """Move the bodies in time and write a run folder: tables, ParaView series, state.

    A run that was broken off, at any moment, goes on with fsi resume.
    """
    from fsi.progress import ProgressBar
    from fsi.run import run_case

    case = _load(case_file, overrides)
    folder = output or Path("runs") / case_file.stem
    with ProgressBar() as bar:
        bar.begin(case)
        outcome = run_case(case, folder, _model(case), bar.show)
    _tell_end(folder, outcome, bar)


@app.command(epilog="Example: fsi resume runs/settling_disc")
def resume(folder: RunFolder) -> None:
    """Continue a run from its last complete step. A finished run is left as it is."""
    from fsi.progress import ProgressBar
    from fsi.run import resume_run

    with ProgressBar() as bar:

        def model(case: Case) -> StokesModel:
            bar.begin(case)
            return _model(case)

        outcome = resume_run(folder, model, bar.show)
    _tell_end(folder, outcome, bar)


def _tell_end(folder: Path, outcome: Outcome, bar: ProgressBar) -> None:
    if not parallel.is_root():
        return
    if outcome.steps == 0:
        typer.echo(f"{folder} was finished at t = {outcome.state.t:g}; nothing to do")
    else:
        typer.echo(
            f"{folder}: {outcome.steps} steps to t = {outcome.state.t:g}, "
            f"smallest gap {bar.smallest_gap:.4g} (at t = {bar.smallest_at:g}), {bar.elapsed:.0f} s"
        )


@app.command(epilog="Example: fsi render runs/settling_disc -o settling.png")
def render(
    folder: RunFolder,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The picture.", show_default="in the run folder")
    ] = None,
) -> None:
    """Draw the last fields of a run: speed, streamlines, mesh."""
    from postprocess.render import render_run

    picture = parallel.on_root(lambda: render_run(folder, output))
    if parallel.is_root():
        typer.echo(f"wrote {picture}")


@app.command(epilog="Example: fsi resistance cases/two_discs.toml -o two_discs.npz")
def resistance(
    case_file: CaseFile,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="A .json or .npz file for R and its inverse, .csv for R.",
            show_default=False,
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    overrides: Overrides = None,
) -> None:
    """Compute the resistance matrix R of all bodies, F = R U, and its inverse, the mobility.

    F are the external loads that unit motions of the bodies need at time 0 between walls at rest, or open
    where the case has them open; its velocities of walls, its motions and loads of bodies are ignored. In a
    container of given radius the change of R with half that radius is reported, as by fsi solve.
    """
    from fsi.report_resistance import print_resistance, require_format, resistance_json, write_resistance
    from fsi.resistance import difference
    from fsi.truncation import halved

    if output is not None:
        _require_writable(output)
        require_format(output)
    case = _load(case_file, overrides)
    if not case.bodies:
        raise InputError("bodies: there are none; a resistance matrix needs at least one [[bodies]]")
    from fsi.stokes.resistance import case_resistance

    found = case_resistance(case)
    half = halved(case)
    truncation = None if half is None else difference(found.R, case_resistance(half).R, found.modes.scale)
    data = resistance_json(case.name, found, truncation)
    if output is not None:
        parallel.on_root(lambda: write_resistance(output, data))
    if parallel.is_root() and as_json:
        typer.echo(json.dumps(data))
    elif parallel.is_root():
        print_resistance(Console(), case.name, found, truncation)


@app.command(epilog="Example: fsi validate two_discs concentric_sphere")
def validate(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME...", help="Validation cases.", show_default="all of them"),
    ] = None,
    cases: Annotated[
        Path,
        typer.Option(help="The folder of the case files.", show_default="cases/validation of the checkout"),
    ] = Path(__file__).parents[1] / "cases" / "validation",
    output: Annotated[Path, typer.Option("--output", "-o", help="A new folder for the results.")] = Path(
        "runs/validation"
    ),
) -> None:
    """Compare resolved forces, velocities and times with exact ones, and error bars with true errors.

    Prints a table, and writes it as JSON, CSV and a plot. Exit code 4 if a value lies outside its tolerance.
    """
    from fsi.validate import validate_cases

    validate_cases(cases, names or (), output, Console())


def main() -> int:
    """Run the command line; returns the exit code."""
    if not parallel.is_root():
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115  (help and tables once, not once a rank)
    try:
        command = typer.main.get_command(app)
        code = command.main(sys.argv[1:] or ["--help"], prog_name="fsi", standalone_mode=False) or 0
        if code != INTERRUPTED:  # typer turns Ctrl-C into this exit code, and says nothing
            return int(code)
        return parallel.last_words("error: interrupted; a run goes on with fsi resume", INTERRUPTED)
    except (FsiError, MeshError) as error:
        line = " ".join(str(error).splitlines())
        return parallel.last_words(f"error: {line}", getattr(error, "exit_code", 3))
    except typer.TyperException as error:
        return parallel.last_words(f"error: {_usage(error)}", 2)
    except Exception:
        return parallel.last_words(traceback.format_exc(), 1)


def _usage(error: typer.TyperException) -> str:
    """What is wrong with the command line, and where its help is."""
    context = getattr(error, "ctx", None)
    command = "fsi" if context is None else context.command_path
    return f"{error.format_message().rstrip('.')}; see {command} --help"
