"""`fsi calibrate` and `fsi validate`: a law from resolved forces, and these against exact ones."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import CaseFile, Overrides, Scheduler, load_with_flow, option, output_to, pool_of
from fsi.errors import InputError
from fsi.report.console import standard_error, standard_output

if TYPE_CHECKING:
    from fsi.workers.pools import Pool

EXAMPLE = "Example: fsi calibrate cases/calibration/equal_discs.toml --workers 2"
VALIDATE_EXAMPLE = "Example: fsi validate two_discs concentric_sphere"


def calibrate(
    case_file: CaseFile,
    output: Annotated[
        Path | None, output_to("The folder of the law.", "runs/calibration/<case file>")
    ] = None,
    cache: Annotated[Path, option("The folder of all samples ever computed, of any case.")] = Path(
        "runs/calibration/samples"
    ),
    workers: Annotated[int | None, option("Local processes.", "one for each CPU", min=1)] = None,
    scheduler: Scheduler = None,
    overrides: Overrides = None,
) -> None:
    """Sample the resistance of a pair over its gap and fit a lubrication law to it.

    The section [calibration] of the case says which pair, which motion, which gaps. Writes the law
    (law.toml), the samples with their error bars and a plot. A sample is kept as soon as it is there and
    never computed again: a command that was killed goes on when it is given again.
    """
    from fsi.calibration.calibrate import calibrate_case
    from fsi.calibration.sampling import Sampling
    from fsi.postprocess.plots.calibration import plot_calibration
    from fsi.report.progress import counting
    from fsi.report.studies import print_calibration

    cluster = _cluster("calibrate", scheduler, workers) if scheduler is not None else None
    case = load_with_flow(case_file, overrides, "calibrate")
    folder = output or Path("runs") / "calibration" / case_file.stem
    with counting("samples") as show:
        sampling = Sampling(cache, workers or os.cpu_count() or 1, show, cluster)
        result = calibrate_case(case, case_file.name, folder, sampling)
    parallel.on_root(lambda: plot_calibration(folder, folder / "calibration.png"))
    if parallel.is_root():
        print_calibration(standard_output(), result)
        typer.echo(f"wrote {folder}: law.toml, samples.csv, calibration.json, calibration.png")


def sample_run(folder: Path) -> None:
    """Take one sample of a calibration; ends when standard input does."""
    from fsi.calibration.sampling import compute_sample
    from fsi.workers.launch import end_with_parent

    end_with_parent()
    compute_sample(folder)


def validate_run(folder: Path) -> None:
    """Solve one part of a validation; ends when standard input does."""
    from fsi.validation.parts import compute_part
    from fsi.workers.launch import end_with_parent

    end_with_parent()
    compute_part(folder)


def _cluster(command: str, scheduler: str | None, workers: int | None) -> Pool:
    """Who does it in processes of their own. Raises InputError: this is one of several ranks."""
    if parallel.size() > 1:
        raise InputError(f"fsi {command}: starts its processes itself; run it without mpiexec")
    return pool_of(scheduler, workers)


def validate(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME...", help="Validation cases.", show_default="all of them"),
    ] = None,
    cases: Annotated[
        Path | None, option("The folder of the case files.", "those that come with the program")
    ] = None,
    output: Annotated[Path, output_to("A new folder for the results.")] = Path("runs/validation"),
    workers: Annotated[int | None, option("Local processes.", "none: this one does it", min=1)] = None,
    scheduler: Scheduler = None,
) -> None:
    """Compare resolved forces, velocities and times with exact ones, and error bars with true errors.

    Prints a table, and writes it as JSON, CSV and a plot. Exit code 4 if a value lies outside its tolerance.
    """
    from fsi.cli.cases import shipped_cases
    from fsi.postprocess.plots.studies import plot_rows
    from fsi.report.studies import print_errors, print_rows
    from fsi.validation.parts import handed_out
    from fsi.validation.resolved import require_passed, validate_cases

    alone = scheduler is None and workers is None
    solve = None if alone else handed_out(_cluster("validate", scheduler, workers))
    progress, console = standard_error(), standard_output()
    folder = cases or shipped_cases() / "validation"
    rows = validate_cases(folder, names or (), output, lambda rows: print_errors(progress, rows), solve)
    parallel.on_root(lambda: plot_rows(rows, output / "validation.png"))
    if parallel.is_root():
        print_rows(console, rows)
        console.print(f"wrote {output}/validation.json, .csv and .png", highlight=False)
    require_passed(rows)
