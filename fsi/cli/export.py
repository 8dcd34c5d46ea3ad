"""`fsi export`: a run as one file for other programs."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder, output_to, require_writable, tell
from fsi.errors import InputError

EXAMPLE = "Example: fsi export runs/settling_discs --format vtkhdf -o discs.vtkhdf"


class ExportFormat(StrEnum):
    """What a run can be written as."""

    vtkhdf = "vtkhdf"
    xdmf = "xdmf"
    csv = "csv"


def export(
    folder: RunFolder,
    file_format: Annotated[
        ExportFormat | None,
        typer.Option(
            "--format",
            show_default="by the suffix of the file, else vtkhdf",
            help="vtkhdf: the fields of all steps, on their curved cells; xdmf: the same in small straight "
            "cells; csv: the bodies, with their shapes and radii (of a shape, to its farthest point).",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        output_to("A file with that suffix.", "fields.vtkhdf, fields.xdmf or all_bodies.csv in its folder"),
    ] = None,
) -> None:
    """Write a run as one file.

    ParaView reads .vtkhdf and .xdmf files as a series whose mesh changes from step to step; pyvista does so
    with .xdmf, and has the first step of .vtkhdf alone. XDMF has no curved cells of these orders: each is cut
    between its nodes. The numbers of NAME.xdmf are in the folder NAME.data beside it.
    """
    from fsi.postprocess.export import write_bodies
    from fsi.postprocess.run.run import open_run
    from fsi.postprocess.vtk_hdf import write_vtkhdf
    from fsi.postprocess.xdmf import write_xdmf

    names = {
        ExportFormat.vtkhdf: "fields.vtkhdf",
        ExportFormat.xdmf: "fields.xdmf",
        ExportFormat.csv: "all_bodies.csv",
    }
    wanted = file_format or _of_suffix(output)
    path = output or folder / names[wanted]

    def write() -> str:
        run = open_run(folder)
        require_writable(path)
        match wanted:
            case ExportFormat.vtkhdf:
                return f"{write_vtkhdf(run, path)} steps"
            case ExportFormat.xdmf:
                return f"{write_xdmf(run, path)} steps"
            case ExportFormat.csv:
                return f"{write_bodies(run, path)} rows"

    tell(f"wrote {path}, {parallel.on_root(write)}")


def _of_suffix(output: Path | None) -> ExportFormat:
    """The format whose suffix a file has, vtkhdf if no file is given. Raises InputError: it is of none."""
    if output is None:
        return ExportFormat.vtkhdf
    suffix = output.suffix.removeprefix(".")
    if suffix not in ExportFormat:
        known = ", ".join(f".{known}" for known in ExportFormat)
        raise InputError(f"output = {output}: unknown suffix {output.suffix!r}; give {known}")
    return ExportFormat(suffix)
