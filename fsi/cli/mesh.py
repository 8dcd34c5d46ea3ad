"""`fsi mesh`: write a mesh."""

from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import Overrides, load_resolved, option, output_to, require_writable, tell
from fsi.errors import InputError

EXAMPLE = "Example: fsi mesh cases/disc_in_box.toml -o disc.vtu, or fsi mesh RUN --step 7 -o 7.msh"


def mesh(
    source: Annotated[
        Path, typer.Argument(metavar="CASE|RUN", help="A case file, or a run folder.", show_default=False)
    ],
    output: Annotated[Path, output_to("The mesh file: .msh or .vtu")],
    step: Annotated[int | None, option("Which step of a run.", "the last with fields")] = None,
    overrides: Overrides = None,
) -> None:
    """Write the mesh of a case at time 0, or the one that a run used at a step."""
    require_writable(output)
    if source.is_dir():
        from fsi.postprocess.export import write_step_mesh

        if overrides:
            raise InputError(f"--set {overrides[0]}: a run is what it is; give a case file to change a value")
        written = parallel.on_root(lambda: write_step_mesh(source, step, output))
        message = f"wrote {output}, step {written}"
    else:
        from fsi.meshes.files.write import require_suffix, write_mesh
        from fsi.stokes.model import StokesModel

        if step is not None:
            raise InputError(f"--step {step}: a case has no steps; give a run folder")
        case = load_resolved(source, overrides, "mesh")
        require_suffix(output)
        write_mesh(StokesModel(case).mesh(case.configuration()), output, case.names)
        message = f"wrote {output}"
    tell(message)
