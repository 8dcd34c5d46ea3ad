"""`fsi run` and `fsi resume`: motion in time."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import CaseFile, Overrides, RunFolder, load, option, output_to
from fsi.report.console import standard_output

if TYPE_CHECKING:
    from fsi.case.case import Case
    from fsi.integration.state import StepRecord
    from fsi.report.progress import ProgressBar
    from fsi.runs import MakeEvolution, Outcome

Quiet = Annotated[bool, option("Say nothing but notes and errors.", True, "--quiet", "-q")]

EXAMPLE = "Example: fsi run cases/settling_disc.toml --output runs/settling --set time.end=20"
# What is said of a run at its end where a column of steps.csv has not been zero.
NOTES = {
    "solid_contacts": "films are thinner than the roughness (delta_eps < delta): the gluey model makes no "
    "sense there, contact is solid",
    "mesh_instead": "the sizes of the case gave some steps no valid mesh, and they took finer ones",
    "shut_in": "gaps below lubrication.below shut fluid in, whose pressure no law knows: bodies there may "
    "move wrongly, error bars say by how much; give a smaller one",
}

WATCH_EXAMPLE = "Example: fsi watch runs/settling_disc"
RESUME_EXAMPLE = "Example: fsi resume runs/settling_disc --set time.end=20"


def run(
    case_file: CaseFile,
    output: Annotated[Path | None, output_to("The run folder, a new one.", "runs/<case file>")] = None,
    quiet: Quiet = False,
    overrides: Overrides = None,
) -> None:
    """Move the bodies in time and write a run folder: tables, ParaView series, state.

    A run that was broken off, at any moment, goes on with fsi resume.
    """
    from fsi.runs import run as run_case

    folder = output or Path("runs") / case_file.stem
    case = load(case_file, overrides, folder)
    _follow(folder, lambda show, make: run_case(case, folder, show, make), quiet)


def resume(folder: RunFolder, quiet: Quiet = False, overrides: Overrides = None) -> None:
    """Continue a run from its last complete step. A finished run is left as it is.

    A run is one case: a case.toml that has been changed since is refused, but for time.end, output.interval
    and output.fields, which --set changes. With --set time.end=20 a finished run goes on as well.
    """
    from fsi.runs import resume as resume_run

    _follow(folder, lambda show, make: resume_run(folder, show, make, overrides or ()), quiet)


def watch(
    folder: RunFolder,
    once: Annotated[bool, typer.Option("--once", help="Print what is there, and leave.")] = False,
) -> None:
    """Follow a run that another process makes: a line for each step, until it ends or Ctrl-C.

    Nothing in the folder is changed; a run that was broken off is waited for.
    """
    from fsi.case.load import load_case
    from fsi.report.watch import follow
    from fsi.run_folder.kept import CASE, require_run

    require_run(folder)
    case = parallel.on_root(lambda: load_case(folder / CASE))
    if parallel.is_root():
        follow(standard_output(), folder, case.timing.end, case.timing.contact_gap, once=once)


def _follow(
    folder: Path,
    launch: Callable[[Callable[[StepRecord], None], MakeEvolution], Outcome],
    quiet: bool,
) -> None:
    """Show the progress of a run, and say how it ended and what to look at it with; quiet: only notes."""
    from fsi.case.load import load_case
    from fsi.integration.evolution import Evolution
    from fsi.models import make_evolution
    from fsi.report.progress import ProgressBar
    from fsi.report.watch import complete_rows
    from fsi.run_folder.kept import CASE

    def make(case: Case) -> Evolution:
        bar.begin(case.timing.end)
        return make_evolution(case)

    with ProgressBar(quiet=quiet) as bar:
        outcome = launch(bar.show, make)
    if not parallel.is_root():
        return
    rows, case = complete_rows(folder), load_case(folder / CASE)  # of the whole run, resumed or not
    if not quiet:
        _tell_end(folder, outcome, bar, rows)
        look = ["fsi", "render" if case.output.fields else "plot", str(folder)]
        typer.echo(f"look at it with: {shlex.join(look)}")
    for note in notes(case, rows):
        typer.echo(note)


def notes(case: Case, rows: list[dict[str, float]]) -> Iterator[str]:
    """What is said at the end of a run with these steps."""
    for column, note in NOTES.items():
        if column == "solid_contacts" and case.gluey.roughness is None:
            continue  # contact is solid at gamma_min, as was asked for
        since = next((row["t"] for row in rows if row.get(column, 0.0) > 0.0), None)
        if since is not None:
            yield f"note: from t = {since:g} {note}; see {column} in steps.csv"


def _tell_end(folder: Path, outcome: Outcome, bar: ProgressBar, rows: list[dict[str, float]]) -> None:
    if outcome.steps == 0:
        typer.echo(f"{folder} was finished at t = {outcome.state.t:g}; nothing to do")
    else:
        nearest = min(rows, key=lambda row: row["smallest_gap"])
        all_steps = outcome.state.step
        these = "" if outcome.steps == all_steps else f"the last {outcome.steps} in "
        typer.echo(
            f"{folder}: {all_steps} steps to t = {outcome.state.t:g}, "
            f"smallest gap {nearest['smallest_gap']:.4g} (at t = {nearest['t']:g}){_stored_gaps(rows)}, "
            f"{these}{bar.elapsed:.0f} s"
        )
    if outcome.contact:
        from fsi.postprocess.run.run import open_run
        from fsi.report.contact import told_contact

        finished = open_run(folder)
        typer.echo(told_contact(finished.case, finished.columns("steps")))


def _stored_gaps(rows: list[dict[str, float]]) -> str:
    """The least gap that pairs have stored, and how far such gaps are off those of the places."""
    if (drift := max(row.get("drift", 0.0) for row in rows)) == 0.0:
        return ""
    least = Decimal(10) ** Decimal(min(row["log10_stored_gap"] for row in rows))  # beyond the range of floats
    return f", stored {least:.4g} (drift {drift:.3g})"
