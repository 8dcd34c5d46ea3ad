"""Field files for drawing: read a step, refine its curved cells, find streamlines.

Points have shape (n, 3) with z = 0. A fluid cell is a Lagrange triangle: 3 vertices, then the inner nodes
of the edges 01, 12, 20, then the inner nodes of the cell.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista as pv
from numpy.polynomial.polynomial import polyvander
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from fsi.bodies import Array
from fsi.errors import InputError

Indices = NDArray[np.intp]

_SEGMENTS = 8  # straight pieces that stand for a curved edge
_TRIANGLES = 2e5  # about as many a picture can show


def read_step(run: Path, time: float | None = None) -> tuple[pv.UnstructuredGrid, float]:
    """The fluid at the written step nearest to `time` (default: the last), all ranks' parts in one; its time.

    Raises:
        InputError: the run has written no fields.
    """
    path = run / "fluid.pvd"
    reader = pv.PVDReader(str(path)) if path.is_file() else None
    if reader is None or not reader.time_values:
        raise InputError(f"{path}: the run has written no fields; set output.fields = true and run it again")
    times = np.asarray(reader.time_values)
    nearest = float(times[-1] if time is None else times[np.argmin(np.abs(times - time))])
    reader.set_active_time_value(nearest)
    try:
        return pv.merge(list(reader.read())), nearest
    except (OSError, RuntimeError) as error:
        raise InputError(
            f"{path}: a field file cannot be read ({error}); mend it with `fsi resume`"
        ) from None


def nodes(fluid: pv.UnstructuredGrid) -> Indices:
    """Node numbers of each cell, shape (cells, (d + 1)(d + 2) / 2)."""
    numbers: Indices = fluid.cell_connectivity.reshape(fluid.n_cells, -1)
    return numbers


def cells_within(fluid: pv.UnstructuredGrid, low: Array, high: Array) -> pv.UnstructuredGrid:
    """A copy of the cells whose box of nodes meets the rectangle [low, high]."""
    x = fluid.points[nodes(fluid), :2]
    meets = np.all((x.min(axis=1) <= high) & (x.max(axis=1) >= low), axis=1)
    return fluid.extract_cells(np.flatnonzero(meets)).copy()  # all of them would share their points


def refine(fluid: pv.UnstructuredGrid) -> pv.PolyData:
    """Small straight triangles along the curved cells, with point data `velocity`, `pressure`, `speed`.

    Each level quarters the triangles; a large mesh needs fewer levels to look smooth.
    """
    level = int(np.clip(np.log(_TRIANGLES / fluid.n_cells) / np.log(4.0), 1, 3))
    surface = fluid.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=level)
    surface["speed"] = np.linalg.norm(surface["velocity"], axis=1)
    return surface


def edges(fluid: pv.UnstructuredGrid) -> pv.PolyData:
    """The curved edges of the cells, as polylines."""
    cells = nodes(fluid)
    degree = round((np.sqrt(8 * cells.shape[1] + 1) - 3) / 2)
    inner = np.arange(3, 3 * degree).reshape(3, degree - 1)
    along = np.column_stack([[0, 1, 2], inner, [1, 2, 0]])
    curves = cells[:, along].reshape(-1, degree + 1)
    _, first = np.unique(np.sort(curves[:, [0, -1]], axis=1), axis=0, return_index=True)
    shape = polyvander(np.linspace(0, 1, _SEGMENTS + 1), degree)
    shape = shape @ np.linalg.inv(polyvander(np.linspace(0, 1, degree + 1), degree))
    points = np.einsum("sn,end->esd", shape, fluid.points[curves[first]]).reshape(-1, 3)
    lines = np.arange(len(points)).reshape(len(first), -1)
    return pv.PolyData(points, lines=np.insert(lines, 0, lines.shape[1], axis=1).ravel())


def mirrored(fluid: pv.UnstructuredGrid) -> pv.UnstructuredGrid:
    """An axisymmetric flow on both sides of its axis: r becomes -r, and u_r becomes -u_r."""
    other = fluid.copy()
    other.points[:, 0] *= -1.0
    other["velocity"][:, 0] *= -1.0
    return pv.merge([fluid, other], merge_points=False)


def stream_function(surface: pv.PolyData, w: Array) -> Array:
    """The function psi, (n,), with w = (d psi / dy, -d psi / dx) for w, (n, 3), without divergence.

    That is w = u in the plane, and w = r u with an axis (Stokes's stream function).
    Each edge carries the flux `w_x dy - w_y dx` from end to end; psi sums them along a tree of edges, from
    zero at one point of each connected part. No body may take in fluid: rigid ones do not.
    """
    triangles = surface.regular_faces
    pairs = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    n = surface.n_points
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n)).tocsr()
    psi = np.full(n, np.nan)
    for root in range(n):
        if np.isnan(psi[root]):
            psi[root] = 0.0
            reached, parent = breadth_first_order(graph, root, directed=False)
            _sum_fluxes(psi, reached[1:], parent, surface.points, w)
    return psi


def _sum_fluxes(psi: Array, children: Indices, parent: Indices, x: Array, w: Array) -> None:
    """Fill in psi at nodes whose parents come before them, from the roots on."""
    parents = parent[children]
    step, mean = (x[children] - x[parents]).astype(float), 0.5 * (w[children] + w[parents])
    flux = mean[:, 0] * step[:, 1] - mean[:, 1] * step[:, 0]
    for child, origin, rise in zip(children, parents, flux, strict=True):
        psi[child] = psi[origin] + rise
