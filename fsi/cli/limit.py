"""`fsi limit`: one body as the viscosity vanishes."""

from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import CaseFile, Overrides, load, output_to, require_writable

EXAMPLE = "Example: fsi limit cases/gluey/pushed_then_pulled.toml --output limit.png"


def limit(
    case_file: CaseFile,
    output: Annotated[Path | None, output_to("A picture to write.", "none")] = None,
    overrides: Overrides = None,
) -> None:
    """Solve q'' = -eps q'/q + f, of one gap of a case, for ever smaller eps, and compare with the limit.

    Prints when the body sticks and is released, the errors for each eps, and the order of the slides' scheme.
    """
    from fsi.gluey.limit_study import study
    from fsi.report.console import standard_output
    from fsi.report.studies import draw, print_study

    case = load(case_file, overrides)
    if not parallel.is_root():
        return
    if output is not None:
        require_writable(output)
    found = study(case)
    print_study(standard_output(), found)
    if output is not None:
        draw(case, found, output)
        typer.echo(f"{output}: written")
