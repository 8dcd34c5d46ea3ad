"""Fields for drawing: refine curved cells, mirror them, find streamlines.

Points have shape (n, 3) with z = 0. A fluid cell is a Lagrange triangle: 3 vertices, then the inner nodes
of the edges 01, 12, 20, then the inner nodes of the cell.
"""

from __future__ import annotations

import numpy as np
import pyvista as pv
from numpy.polynomial.polynomial import polyvander
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from fsi.bodies import Array

Indices = NDArray[np.intp]

_SEGMENTS = 8  # straight pieces that stand for a curved edge
_TRIANGLES = 2e5  # about as many a picture can show


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
    """Small straight triangles along the curved cells, with the same point data, and `speed`.

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
    points = _along(curves[first], fluid.points).reshape(-1, 3)
    lines = np.arange(len(points)).reshape(len(first), -1)
    return pv.PolyData(points, lines=np.insert(lines, 0, lines.shape[1], axis=1).ravel())


def rims(bodies: pv.UnstructuredGrid, inward: float) -> pv.PolyData:
    """Ribbons along the curved surfaces of bodies, `inward` wide into them, with the point data.

    The cells of `bodies` run around them either way; their data `inside` (cells, 3) are points in the bodies.
    """
    curves = nodes(bodies)[:, [0, *range(2, _width(bodies)), 1]]
    outer = _along(curves, bodies.points)
    towards = bodies.cell_data["inside"][:, None] - outer
    depth = np.linalg.norm(towards, axis=2, keepdims=True)
    inner = outer + towards / depth * np.minimum(inward, 0.5 * depth)
    count = outer[..., 0].size
    at = np.arange(count).reshape(outer.shape[:2])
    quads = np.stack([at[:, :-1], at[:, 1:], at[:, 1:] + count, at[:, :-1] + count], axis=-1).reshape(-1, 4)
    points = np.concatenate([outer.reshape(-1, 3), inner.reshape(-1, 3)])
    ribbon = pv.PolyData(points, faces=np.insert(quads, 0, 4, axis=1).ravel())
    for name, values in bodies.point_data.items():
        along = _along(curves, values.reshape(len(values), -1))
        ribbon.point_data[name] = np.tile(
            along.reshape(count, *values.shape[1:]), (2, *[1] * (values.ndim - 1))
        )
    return ribbon


def _width(grid: pv.UnstructuredGrid) -> int:
    """Nodes of a cell."""
    return int(len(grid.cell_connectivity) // grid.n_cells)


def _along(curves: Indices, values: Array) -> Array:
    """Values (n, c) at even steps along curves (m, degree + 1), nodes in order: (m, segments + 1, c)."""
    degree = curves.shape[1] - 1
    shape = polyvander(np.linspace(0, 1, _SEGMENTS + 1), degree)
    shape = shape @ np.linalg.inv(polyvander(np.linspace(0, 1, degree + 1), degree))
    found: Array = np.einsum("sn,end->esd", shape, values[curves])
    return found


def mirrored(grid: pv.UnstructuredGrid) -> pv.UnstructuredGrid:
    """An axisymmetric field on both sides of its axis: r, components along r and vorticity change sign."""
    other = grid.copy()
    other.points[:, 0] *= -1.0
    for name, values in other.point_data.items():
        if name == "vorticity":
            values *= -1.0
        elif values.ndim == 2:
            values[:, 0] *= -1.0
    return pv.merge([grid, other], merge_points=False)


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
