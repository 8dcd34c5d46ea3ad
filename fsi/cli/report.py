"""`fsi report`, `fsi revolve`, `fsi probe`: a run as one page, turned around its axis, at points."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder, Step, numbers, option, output_to, require_writable, tell
from fsi.errors import InputError
from fsi.machine.resources import require_memory

if TYPE_CHECKING:
    from pandas import DataFrame

_POINT_BYTES = 2000.0  # of a point and what is found there: measured 1.5 kB
EXAMPLE = "Example: fsi report runs/settling_discs -o settling.html"
REVOLVE_EXAMPLE = "Example: fsi revolve runs/settling_spheres --degrees 270 -o runs/spheres_3d"
PROBE_EXAMPLE = "Example: fsi probe runs/settling_disc --line 0,0,3,0.5 --count 7 --step 20 -o line.csv"


def report(
    folder: RunFolder,
    output: Annotated[Path | None, output_to("A .html file.", "report.html in the run folder")] = None,
) -> None:
    """Write one HTML file about a run: case, pictures, animation, checks, tables, provenance.

    It opens from disk without a network. A run that was killed half-way is reported as far as it came.
    """
    from fsi.postprocess.report import write_report
    from fsi.postprocess.run.run import open_run

    path = output or folder / "report.html"
    parallel.on_root(lambda: write_report(open_run(folder), path))
    tell(f"wrote {path}")


def revolve(
    folder: RunFolder,
    output: Annotated[Path | None, output_to("A new folder.", "revolved in the run folder")] = None,
    degrees: Annotated[
        float, option("How far to turn; less than 360 shows the inside.", min=1.0, max=360.0)
    ] = 360.0,
    sectors: Annotated[int, option("Into how many to divide that.", min=3, max=360)] = 36,
) -> None:
    """Turn the ParaView series of an axisymmetric run around its axis, z.

    Fluid and surfaces come as straight cells between the nodes, where all values are those of the run.
    """
    from fsi.postprocess.export import export_revolved
    from fsi.postprocess.run.run import open_run

    path = output or folder / "revolved"
    parallel.on_root(lambda: export_revolved(open_run(folder), path, degrees, sectors))
    tell(f"wrote {path / 'fluid.pvd'} and {path / 'surface.pvd'}")


def probe(
    folder: RunFolder,
    line: Annotated[str | None, option("Along a line, from end to end.", False, metavar="X,Y,X,Y")] = None,
    plane: Annotated[
        str | None, option("On a grid over a rectangle, corner to corner.", False, metavar="X,Y,X,Y")
    ] = None,
    points: Annotated[
        Path | None, option("At the points of a CSV file: columns x,y.", False, metavar="FILE")
    ] = None,
    count: Annotated[int, option("Points along the line, or a side of the grid.", min=2)] = 11,
    step: Step = None,
    output: Annotated[Path | None, output_to("A CSV file.", "the terminal")] = None,
) -> None:
    """Print velocity, pressure, vorticity and strain rate, sqrt(2 e:e), at points, as CSV.

    The values are the finite element's own; between pores velocities are interpolated to some 1e-3 of the
    largest, pressures to 2e-2. `where` names the body that holds a point, or says `outside`.
    Bodies of axisymmetric runs lie on the axis r = 0: x, y are r, z. In space points have three coordinates,
    and a rectangle lies across one of the axes. A CSV file with a heading names these columns there, among
    others and in any order; one without has them first.
    """
    import numpy as np

    from fsi.postprocess.run.probe import letters_of, on_plane, read_points, write_values
    from fsi.postprocess.run.probe import probe as values_at
    from fsi.postprocess.run.run import open_run

    if sum(given is not None for given in (line, plane, points)) != 1:
        raise InputError("probe: give exactly one of --line, --plane and --points")
    if output is not None:
        require_writable(output)

    def values() -> "DataFrame":
        run = open_run(folder)
        d = run.case.dimension
        if points is not None:
            return values_at(run, read_points(points, letters_of(run)), step)
        place, option = (np.linspace, "--line") if line is not None else (on_plane, "--plane")
        ends = numbers(option, line or plane or "", 2 * d)
        total = float(count) if line is not None else float(count) ** 2
        require_memory(f"--count {count}: {total:.3g} points", _POINT_BYTES * total, "give fewer")
        return values_at(run, place(ends[:d], ends[d:], count), step)

    table = parallel.on_root(values)
    if not parallel.is_root():
        return
    if output is None:
        typer.echo(table.to_csv(index=False), nl=False)
    else:
        write_values(table, output)
        typer.echo(f"wrote {output}, {len(table)} points, {(table['where'] == 'fluid').sum()} in the fluid")
