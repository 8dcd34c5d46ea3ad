"""`fsi cases`: the cases of the documentation, to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel

EXAMPLE = "Example: fsi cases, then fsi run cases/settling_disc.toml"


def cases(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="A new folder.")] = Path("cases"),
) -> None:
    """Write the cases that come with the program into a folder: examples, validation, calibration."""
    from fsi.cli.shipped import write_cases

    count = parallel.on_root(lambda: write_cases(folder))
    if parallel.is_root():
        typer.echo(f"wrote {count} cases to {folder}; begin with: fsi run {folder}/settling_disc.toml")
