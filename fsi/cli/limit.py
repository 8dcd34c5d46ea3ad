"""`fsi limit`: one body as the viscosity vanishes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fsi import parallel
from fsi.cli.arguments import CaseFile, Overrides

EXAMPLE = "Example: fsi limit cases/gluey/pushed_then_pulled.toml --output limit.png"


def limit(
    case_file: CaseFile,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="A picture to write.", show_default="none")
    ] = None,
    overrides: Overrides = None,
) -> None:
    """Solve q'' = -eps q'/q + f for ever smaller eps, and compare with the exact limit.

    Prints when the body sticks and is released, the errors for each eps, and the order of the slides' scheme.
    """
    from fsi.cli.arguments import require_writable
    from fsi.errors import InputError
    from fsi.evolutions import load_evolving, model_of
    from fsi.gluey.limit_study import LimitCase, study
    from fsi.report.console import standard_output
    from fsi.report.limit import draw, print_study

    if not parallel.is_root():
        return
    if model_of(case_file) != "limit":
        raise InputError(
            f'{case_file}: model: not "limit"; give a case like cases/gluey/pushed_then_pulled.toml'
        )
    case = load_evolving(case_file, overrides or ())
    assert isinstance(case, LimitCase)
    if output is not None:
        require_writable(output)
    found = study(case)
    print_study(standard_output(), case, found)
    if output is not None:
        draw(case, found, output)
        typer.echo(f"{output}: written")
