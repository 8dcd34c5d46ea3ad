"""`fsi validate`: resolved against exact."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fsi.report.console import standard_output

EXAMPLE = "Example: fsi validate two_discs concentric_sphere"


def validate(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME...", help="Validation cases.", show_default="all of them"),
    ] = None,
    cases: Annotated[
        Path | None,
        typer.Option(help="The folder of the case files.", show_default="those that come with the program"),
    ] = None,
    output: Annotated[Path, typer.Option("--output", "-o", help="A new folder for the results.")] = Path(
        "runs/validation"
    ),
) -> None:
    """Compare resolved forces, velocities and times with exact ones, and error bars with true errors.

    Prints a table, and writes it as JSON, CSV and a plot. Exit code 4 if a value lies outside its tolerance.
    """
    from fsi.cli.shipped import shipped_cases
    from fsi.validation.validate import validate_cases

    validate_cases(cases or shipped_cases() / "validation", names or (), output, standard_output())
