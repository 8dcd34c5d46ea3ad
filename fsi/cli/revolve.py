"""`fsi revolve`: an axisymmetric run in three dimensions."""

from pathlib import Path
from typing import Annotated

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder, option, output_to, tell

EXAMPLE = "Example: fsi revolve runs/settling_spheres --degrees 270 -o runs/spheres_3d"


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
