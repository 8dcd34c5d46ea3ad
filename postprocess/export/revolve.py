"""An axisymmetric run in three dimensions: its series, turned around the axis, for ParaView.

The axis becomes z. Each curved cell is cut into small triangles between its own nodes, each triangle becomes
a ring of wedges, and all data are those of the nodes, vectors turned along; surfaces become rings of
rectangles.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.errors import InputError
from fsi.meshes.cells.lagrange import order_of
from fsi.postprocess.render.curved_cells import small_triangles
from fsi.postprocess.run.run import Run
from fsi.run_folder.checkpoint import replace
from fsi.run_folder.pvd import Entry, collection

Indices = NDArray[np.int64]

SERIES = ("fluid", "surface")


def export_revolved(run: Run, folder: Path, degrees: float, sectors: int) -> list[Path]:
    """Write fluid.pvd and surface.pvd, with their files, into a new folder; gives the collections.

    Args:
        run: an axisymmetric one.
        folder: does not exist yet.
        degrees: how far to turn, up to 360; less shows the inside.
        sectors: into how many to divide that.

    Raises:
        InputError: the run is planar or has no fields, or the folder is there or cannot be written.
    """
    if not run.case.axisymmetric:
        raise InputError(f"{run.path}: the run is planar; only an axisymmetric one can be revolved")
    run.step()
    try:
        folder.mkdir()
        angles = np.linspace(0.0, np.radians(degrees), sectors + 1)
        written = [_series(run, name, folder, angles) for name in SERIES]
    except OSError as error:
        raise InputError(f"output = {folder}: {error.strerror}; give a new folder") from None
    return written


def _series(run: Run, series: str, folder: Path, angles: Array) -> Path:
    """One series, a file for each step."""
    entries = []
    for step, t in run.times_of(series).items():
        name = f"{series}_{step:06d}.vtu"
        revolved(run.mesh(int(str(step)), series), angles).save(folder / name)
        entries.append(Entry(float(t), 0, name))
    path = folder / f"{series}.pvd"
    replace(path, collection(entries))
    return path


def revolved(grid: pv.UnstructuredGrid, angles: Array) -> pv.UnstructuredGrid:
    """The grid of a meridian plane, (r, z), at the angles (k,) and between them; a full turn is closed."""
    nodes = grid.cell_connectivity.reshape(grid.n_cells, -1)
    surface = grid.celltypes[0] == pv.CellType.LAGRANGE_CURVE
    pieces = (
        _segments(nodes) if surface else nodes[:, small_triangles(order_of(nodes.shape[1]))].reshape(-1, 3)
    )
    n, rings = grid.n_points, len(angles) - 1
    closed = np.isclose(angles[-1] - angles[0], 2.0 * np.pi)
    kept = rings if closed else rings + 1
    ring = np.arange(rings)
    here, there = (pieces[None] + n * k[:, None, None] for k in (ring, (ring + 1) % kept))
    sides = [here, there[..., ::-1]] if surface else [there, here]  # as VTK numbers rectangles and wedges
    cells = np.concatenate(sides, axis=2).reshape(-1, 2 * pieces.shape[1])
    kind = pv.CellType.QUAD if surface else pv.CellType.WEDGE
    solid = pv.UnstructuredGrid({kind: cells}, _turned(grid.points, angles[:kept]))
    for name, values in grid.point_data.items():
        solid.point_data[name] = _turned(values, angles[:kept]) if values.ndim == 2 else np.tile(values, kept)
    for name, values in grid.cell_data.items():
        solid.cell_data[name] = np.tile(np.repeat(values, len(pieces) // len(nodes)), rings)
    return solid


def _turned(v: Array, angles: Array) -> Array:
    """Vectors (n, 3) with components (r, z, 0) at each angle, as (x, y, z), (angles n, 3)."""
    r, z = v[None, :, 0], np.broadcast_to(v[:, 1], (len(angles), len(v)))
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    found: Array = np.stack([r * cos, r * sin, z], axis=-1).reshape(-1, 3)
    return found


def _segments(nodes: Indices) -> Indices:
    """The pieces between the nodes of each curve, (order cells, 2)."""
    along: Sequence[int] = [0, *range(2, nodes.shape[1]), 1]
    pairs = np.column_stack([along[:-1], along[1:]])
    return nodes[:, pairs].reshape(-1, 2)
