"""A run in other forms: the mesh of a step, and an axisymmetric run turned around its axis, for ParaView.

Of the latter the axis becomes z. Each curved cell is cut into small triangles between its own nodes, each
triangle becomes a ring of wedges, and all data are those of the nodes, vectors turned along; surfaces become
rings of rectangles.
"""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyvista as pv

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.files import replace, require_suffix, write_whole
from fsi.meshes.cells.lagrange import order_of, small_simplices
from fsi.meshes.geometry.container import FluidDomain
from fsi.postprocess.run.grids import along_curves, nodes
from fsi.postprocess.run.run import Run, open_run
from fsi.run_folder.paraview import Collection, Entry

SERIES = ("fluid", "surface")


def export_revolved(run: Run, folder: Path, degrees: float, sectors: int) -> list[Path]:
    """Write fluid.pvd and surface.pvd, with their files, into a new folder; gives the collections.

    degrees: how far to turn, up to 360 (less shows the inside), in so many sectors.

    Raises InputError: the run is not axisymmetric or has no fields, or the folder is there or not to be
    written.
    """
    if not run.case.axisymmetric:
        kind = run.case.geometry
        raise InputError(f"{run.path}: the run is {kind}; only an axisymmetric one can be revolved")
    run.step()
    try:
        with _new_folder(folder):
            angles = np.linspace(0.0, np.radians(degrees), sectors + 1)
            return [_series(run, name, folder, angles) for name in SERIES]
    except OSError as error:
        raise InputError(f"output = {folder}: {error.strerror}; give a new folder") from None


@contextmanager
def _new_folder(folder: Path) -> Iterator[None]:
    """Make a folder, and take it away again where what fills it fails."""
    folder.mkdir()
    try:
        yield
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _series(run: Run, series: str, folder: Path, angles: Array) -> Path:
    entries = []
    for step, t in run.times_of(series).items():
        name = f"{series}_{step:06d}.vtu"
        revolved(run.mesh(int(str(step)), series), angles).save(folder / name)
        entries.append(Entry(float(t), 0, name))
    path = folder / f"{series}.pvd"
    replace(path, Collection(entries).xml())
    return path


def revolved(grid: pv.UnstructuredGrid, angles: Array) -> pv.UnstructuredGrid:
    """The grid of a meridian plane, (r, z), at the angles (k,) and between them; a full turn is closed."""
    cells = nodes(grid)
    if surface := grid.celltypes[0] == pv.CellType.LAGRANGE_CURVE:
        pieces = np.lib.stride_tricks.sliding_window_view(along_curves(cells), 2, axis=1).reshape(-1, 2)
    else:
        pieces = cells[:, small_simplices(order_of(cells.shape[1]))].reshape(-1, 3)
    n, rings = grid.n_points, len(angles) - 1
    closed = np.isclose(angles[-1] - angles[0], 2.0 * np.pi)
    places = rings if closed else rings + 1
    ring = np.arange(rings)
    here, there = (pieces[None] + n * k[:, None, None] for k in (ring, (ring + 1) % places))
    sides = [here, there[..., ::-1]] if surface else [there, here]  # as VTK numbers rectangles and wedges
    corners = np.concatenate(sides, axis=2).reshape(-1, 2 * pieces.shape[1])
    kind = pv.CellType.QUAD if surface else pv.CellType.WEDGE
    solid = pv.UnstructuredGrid({kind: corners}, _turned(grid.points, angles[:places]))
    for name, values in grid.point_data.items():
        vectors = values.ndim == 2
        solid.point_data[name] = _turned(values, angles[:places]) if vectors else np.tile(values, places)
    for name, values in grid.cell_data.items():
        solid.cell_data[name] = np.tile(np.repeat(values, len(pieces) // len(cells)), rings)
    return solid


def _turned(v: Array, angles: Array) -> Array:
    """Vectors (n, 3) with components (r, z, 0) at each angle, as (x, y, z), (angles n, 3)."""
    r, z = v[None, :, 0], np.broadcast_to(v[:, 1], (len(angles), len(v)))
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    turned: Array = np.stack([r * cos, r * sin, z], axis=-1).reshape(-1, 3)
    return turned


def write_bodies(run: Run, output: Path) -> int:
    """Write where bodies were at all steps, their motion and loads, with shapes and radii, as CSV.

    The radius of a shape other than a disc or sphere is the distance of its farthest point from its centre.
    Gives the number of rows. Raises InputError: there are no bodies, another suffix, the disk refuses.
    """
    require_suffix(output, ".csv")
    if not run.case.names:
        raise InputError(f"{run.path}: the run has no bodies; use --format vtkhdf")
    names, simple = run.case.names, "sphere" if run.case.spheres else "disc"
    shapes = [body.shape.model_dump()["kind"] if body.shape else simple for body in run.case.bodies]
    radii = run.case.configuration().radii.tolist()
    table = run.bodies
    table.insert(3, "shape", table["body"].map(dict(zip(names, shapes, strict=True))))
    table.insert(4, "radius", table["body"].map(dict(zip(names, radii, strict=True))))
    write_whole(output, table.to_csv(index=False))
    return len(table)


def write_step_mesh(run: Path, step: int | None, output: Path) -> int:
    """Write the mesh of a run at a step (default: the last with fields), with its tags; gives the step.

    Raises:
        InputError: the run has no fields of that step, or no mesh.
        MeshFileError: the suffix is unknown, or a file cannot be read or written.
    """
    from fsi.meshes.files.read import recover
    from fsi.meshes.files.write import require_suffix as require_mesh_suffix
    from fsi.meshes.files.write import write_cells

    require_mesh_suffix(output)
    read = open_run(run)
    step = read.step(step)
    if not read.case.level.meshed:
        what = f'model = "{read.case.model}": only the resolved level has a mesh'
        raise InputError(f"{what}; give a run of the case with --set model=resolved")
    q, container = read.meshed(step), read.container(step)
    domain = FluidDomain(container, q.centres, q.radii, placed=q.placed, ellipsoids=q.standing)
    cells = recover(read.files(step), domain)
    write_cells(cells, output, [*read.case.names, *container.boundary_names])
    return step
