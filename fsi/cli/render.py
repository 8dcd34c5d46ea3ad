"""`fsi render`: a picture of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fsi import parallel
from fsi.cli.arguments import RunFolder

EXAMPLE = "Example: fsi render runs/settling_disc -o settling.png"


def render(
    folder: RunFolder,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The picture.", show_default="in the run folder")
    ] = None,
) -> None:
    """Draw the last fields of a run: speed, streamlines, mesh."""
    from postprocess.render import render_run

    picture = parallel.on_root(lambda: render_run(folder, output))
    if parallel.is_root():
        typer.echo(f"wrote {picture}")
