"""Write the mesh of one step of a run to a file of its own."""

from __future__ import annotations

from pathlib import Path

from fsi.meshes.geometry.containers import FluidDomain
from fsi.postprocess.run.run import open_run


def write_step_mesh(run: Path, step: int | None, output: Path) -> int:
    """Write the mesh of a run at a step (default: the last with fields), with its tags; gives the step.

    Raises:
        InputError: the run has no fields of that step.
        MeshFileError: the suffix is unknown, or a file cannot be read or written.
    """
    from fsi.meshes.files.read import recover
    from fsi.meshes.files.write import require_suffix, write_cells

    require_suffix(output)
    read = open_run(run)
    case = read.case
    step = read.step(step)
    t = float(read.times[step])
    q = read.configuration(step)
    parts = sorted((run / "fields").glob(f"fluid_{step:06d}*.vtu"))
    container = case.container().at(t)
    write_cells(
        recover(parts, FluidDomain(container, q.centres, q.radii)),
        output,
        [*case.names, *container.boundary_names],
    )
    return step
