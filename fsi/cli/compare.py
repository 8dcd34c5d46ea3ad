"""`fsi compare`: reduced against resolved."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from fsi import parallel
from fsi.cli.arguments import AsJson, CaseFile, Overrides, load
from fsi.report.console import standard_output

EXAMPLE = "Example: fsi compare cases/settling_discs.toml --law exact --set reduced.drag=12"


def compare(
    case_file: CaseFile,
    law: Annotated[
        str, typer.Option(help='The law of the reduced model: "slides", "leading", "exact" or a law file.')
    ] = "exact",
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The folder.", show_default="runs/<case file>_compared"),
    ] = None,
    as_json: AsJson = False,
    overrides: Overrides = None,
) -> None:
    """Run a case with the resolved and with the reduced model, and say how far they differ.

    What is in the folder already is not run again. The reduced model takes drag and cutoff from the section
    [reduced] of the case.
    """
    from fsi.compare import compare_models, print_comparison
    from fsi.report.progress import ProgressBar

    case = load(case_file, overrides)
    folder = output or Path("runs") / f"{case_file.stem}_compared"
    path = str(Path(law).resolve()) if Path(law).is_file() else law
    with ProgressBar() as bar:
        bar.begin(case.time.end if case.time else None)
        found, data = compare_models(case, path, folder, bar.show)
    if parallel.is_root() and as_json:
        typer.echo(json.dumps(data))
    elif parallel.is_root():
        print_comparison(standard_output(), case, found)
        typer.echo(f"wrote {folder}/comparison.json and .png")
