"""`fsi revolve`: an axisymmetric run in three dimensions."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder

EXAMPLE = "Example: fsi revolve runs/settling_spheres --degrees 270 -o runs/spheres_3d"


def revolve(
    folder: RunFolder,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="A new folder.", show_default="revolved in the run folder"),
    ] = None,
    degrees: Annotated[
        float, typer.Option(min=1.0, max=360.0, help="How far to turn; less than 360 shows the inside.")
    ] = 360.0,
    sectors: Annotated[int, typer.Option(min=3, max=360, help="Into how many to divide that.")] = 36,
) -> None:
    """Turn the ParaView series of an axisymmetric run around its axis, z.

    Fluid and surfaces come as straight cells between the nodes, where all values are those of the run.
    """
    from fsi.postprocess.export import export_revolved
    from fsi.postprocess.run.run import open_run

    path = output or folder / "revolved"
    parallel.on_root(lambda: export_revolved(open_run(folder), path, degrees, sectors))
    if parallel.is_root():
        typer.echo(f"wrote {path / 'fluid.pvd'} and {path / 'surface.pvd'}")
