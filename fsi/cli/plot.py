"""`fsi plot`: histories of runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fsi import parallel

EXAMPLE = "Example: fsi plot runs/settling_disc runs/settling_discs -o gaps.pdf"


def plot(
    folders: Annotated[
        list[Path], typer.Argument(metavar="RUN...", help="Folders made by fsi run.", show_default=False)
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="A .png, .svg or .pdf file.",
            show_default="history.png in the first run folder",
        ),
    ] = None,
    gap: Annotated[
        str | None,
        typer.Option(
            metavar="A,B",
            help="The gap between two bodies, or a body and a wall, by name or number from 0.",
            show_default="the smallest gap of each body",
        ),
    ] = None,
) -> None:
    """Draw gap, speed, load and apparent viscosity against time, or strain, several runs over each other.

    A single body that settles onto a plane comes with its exact law and that law's asymptote.
    """
    from postprocess.histories import plot_runs
    from postprocess.run import open_run

    path = output or folders[0] / "history.png"
    parallel.on_root(lambda: plot_runs([open_run(folder) for folder in folders], path, gap))
    if parallel.is_root():
        typer.echo(f"wrote {path}")
