"""`fsi run` and `fsi resume`: motion in time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fsi import parallel
from fsi.cli.arguments import CaseFile, Overrides, RunFolder, load

if TYPE_CHECKING:
    from fsi.case.case import Case
    from fsi.integration.stepper import Model
    from fsi.report.progress import ProgressBar
    from fsi.run import Outcome
    from fsi.run_folder.folder import StepRecord

EXAMPLE = "Example: fsi run cases/settling_disc.toml --output runs/settling --set time.end=20"
RESUME_EXAMPLE = "Example: fsi resume runs/settling_disc"


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
    from fsi.evolutions import model_of
    from fsi.models import make_model
    from fsi.report.progress import ProgressBar
    from fsi.run import run_case

    folder = output or Path("runs") / case_file.stem
    if parallel.on_root(lambda: model_of(case_file)) is not None:
        _evolve(case_file, folder, overrides)
        return
    case = load(case_file, overrides)
    with ProgressBar() as bar:
        bar.begin(case.time.end if case.time else None)
        outcome = run_case(case, folder, make_model(case), bar.show)
    _tell_end(folder, outcome, bar)


def resume(folder: RunFolder) -> None:
    """Continue a run from its last complete step. A finished run is left as it is."""
    from fsi.evolutions import model_of
    from fsi.models import make_model
    from fsi.report.progress import ProgressBar
    from fsi.run import resume_run
    from fsi.run_folder.folder import CASE

    if (folder / CASE).is_file() and parallel.on_root(lambda: model_of(folder / CASE)) is not None:
        _evolve(folder / CASE, folder, None)
        return
    with ProgressBar() as bar:

        def model(case: Case) -> Model:
            bar.begin(case.time.end if case.time else None)
            return make_model(case)

        outcome = resume_run(folder, model, bar.show)
    _tell_end(folder, outcome, bar)


def _evolve(case_file: Path, folder: Path, overrides: list[str] | None) -> None:
    """Run, or resume from its own case file, a case whose model steps by itself; all ranks do the same."""
    from fsi.errors import InputError
    from fsi.evolutions import load_evolving, resume_evolving, run_evolving
    from fsi.gluey.limit_study import LimitCase
    from fsi.report.progress import ProgressBar

    case = parallel.on_root(lambda: load_evolving(case_file, overrides or ()))
    if isinstance(case, LimitCase):
        raise InputError(f'{case_file}: model = "limit": nothing to run; use `fsi limit`')
    solid_since: list[float] = []

    def show(record: StepRecord) -> None:
        if record.columns.get("solid_contacts", 0) > 0:
            solid_since.append(record.t)
        bar.show(record)

    with ProgressBar() as bar:
        bar.begin(case.time.end)
        evolving = resume_evolving if case_file.parent == folder else run_evolving
        outcome = evolving(case, folder, show)
    _tell_end(folder, outcome, bar)
    if solid_since and parallel.is_root():
        typer.echo(
            f"note: from t = {solid_since[0]:g} films are thinner than the roughness (delta_eps < delta): "
            "the gluey model makes no sense there, contact is solid; see solid_contacts in steps.csv"
        )


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
