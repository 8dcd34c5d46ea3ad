"""`fsi export`: a run as one file for other programs."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder, output_to, require_writable, tell

EXAMPLE = "Example: fsi export runs/settling_discs --format vtkhdf -o discs.vtkhdf"


class ExportFormat(StrEnum):
    """What a run can be written as."""

    vtkhdf = "vtkhdf"
    csv = "csv"


def export(
    folder: RunFolder,
    file_format: Annotated[
        ExportFormat,
        typer.Option(
            "--format",
            help="vtkhdf: the fields of all steps, on their curved cells; csv: the bodies, with radii.",
        ),
    ] = ExportFormat.vtkhdf,
    output: Annotated[
        Path | None,
        output_to("A file with that suffix.", "fields.vtkhdf or all_bodies.csv in the run folder"),
    ] = None,
) -> None:
    """Write a run as one file.

    ParaView and pyvista read a .vtkhdf file as a series whose mesh changes from step to step. XDMF is not
    written: its readers have no curved cells of this kind.
    """
    from fsi.postprocess.export import write_bodies
    from fsi.postprocess.run.run import open_run
    from fsi.postprocess.vtk_hdf import write_vtkhdf

    names = {ExportFormat.vtkhdf: "fields.vtkhdf", ExportFormat.csv: "all_bodies.csv"}
    path = output or folder / names[file_format]

    def write() -> str:
        run = open_run(folder)
        require_writable(path)
        if file_format is ExportFormat.csv:
            return f"{write_bodies(run, path)} rows"
        return f"{write_vtkhdf(run, path)} steps"

    tell(f"wrote {path}, {parallel.on_root(write)}")
