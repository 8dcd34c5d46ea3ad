"""`fsi calibrate`: from resolved forces to a lubrication law."""

import os
from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import CaseFile, Overrides, load_resolved, option, output_to
from fsi.report.console import standard_output

EXAMPLE = "Example: fsi calibrate cases/calibration/equal_discs.toml --workers 2"


def calibrate(
    case_file: CaseFile,
    output: Annotated[
        Path | None, output_to("The folder of the law.", "runs/calibration/<case file>")
    ] = None,
    cache: Annotated[Path, option("The folder of all samples ever computed, of any case.")] = Path(
        "runs/calibration/samples"
    ),
    workers: Annotated[int | None, option("Local processes.", "one for each CPU", min=1)] = None,
    overrides: Overrides = None,
) -> None:
    """Sample the resolved resistance of a pair over its gap and fit a lubrication law to it.

    The section [calibration] of the case says which pair, which motion, which gaps. Writes the law
    (law.toml), the samples with their error bars and a plot. A sample is kept as soon as it is there and
    never computed again: a command that was killed goes on when it is given again.
    """
    from fsi.calibration.calibrate import calibrate_case
    from fsi.calibration.sampling import Sampling
    from fsi.postprocess.plots.calibration import plot_calibration
    from fsi.report.progress import counting
    from fsi.report.studies import print_calibration

    case = load_resolved(case_file, overrides, "calibrate")
    folder = output or Path("runs") / "calibration" / case_file.stem
    with counting("samples") as show:
        sampling = Sampling(cache, workers or os.cpu_count() or 1, show)
        result = calibrate_case(case, case_file.name, folder, sampling)
    parallel.on_root(lambda: plot_calibration(folder, folder / "calibration.png"))
    if parallel.is_root():
        print_calibration(standard_output(), result)
        typer.echo(f"wrote {folder}: law.toml, samples.csv, calibration.json, calibration.png")
