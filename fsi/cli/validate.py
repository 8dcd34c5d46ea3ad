"""`fsi validate`: resolved against exact."""

from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import option, output_to
from fsi.report.console import standard_error, standard_output

EXAMPLE = "Example: fsi validate two_discs concentric_sphere"


def validate(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME...", help="Validation cases.", show_default="all of them"),
    ] = None,
    cases: Annotated[
        Path | None, option("The folder of the case files.", "those that come with the program")
    ] = None,
    output: Annotated[Path, output_to("A new folder for the results.")] = Path("runs/validation"),
) -> None:
    """Compare resolved forces, velocities and times with exact ones, and error bars with true errors.

    Prints a table, and writes it as JSON, CSV and a plot. Exit code 4 if a value lies outside its tolerance.
    """
    from fsi.cli.cases import shipped_cases
    from fsi.postprocess.plots.studies import plot_rows
    from fsi.report.studies import print_errors, print_rows
    from fsi.validation.resolved import require_passed, validate_cases

    progress, console = standard_error(), standard_output()
    folder = cases or shipped_cases() / "validation"
    rows = validate_cases(folder, names or (), output, lambda rows: print_errors(progress, rows))
    parallel.on_root(lambda: plot_rows(rows, output / "validation.png"))
    if parallel.is_root():
        print_rows(console, rows)
        console.print(f"wrote {output}/validation.json, .csv and .png", highlight=False)
    require_passed(rows)
