"""Fields for drawing: refine curved cells, mirror them, find streamlines.

Points have shape (n, 3) with z = 0. For the nodes of the cells see `fsi.postprocess.run.run`.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pyvista as pv
from numpy.polynomial.polynomial import polyvander
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from fsi.arrays import Array
from fsi.meshes.cells.lagrange import order_of, reference_nodes, small_simplices, tabulate
from fsi.postprocess.run.grids import Indices, along_curves, counted, nodes

_SEGMENTS = 8  # straight pieces that stand for a curved edge
_MOST_HALVINGS = 4  # of the sides of a cell


def cells_within(fluid: pv.UnstructuredGrid, low: Array, high: Array) -> pv.UnstructuredGrid:
    """A copy of the cells whose box of nodes meets the rectangle [low, high]."""
    x = np.asarray(fluid.points)[nodes(fluid).T, :2]
    meets = np.all((x.min(axis=0) <= high) & (x.max(axis=0) >= low), axis=1)
    return fluid.extract_cells(np.flatnonzero(meets)).copy()  # all of them would share their points


def refine(fluid: pv.UnstructuredGrid, names: Sequence[str], side: float) -> pv.PolyData:
    """Small straight triangles along the curved cells, with the named point data, in single precision.

    The sides of each cell are halved until they are shorter than `side`, four times at most. Neighbouring
    triangles do not share their points.
    """
    cells = nodes(fluid)
    order = order_of(cells.shape[1])
    corners = fluid.points[cells[:, :3], :2]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    halvings = np.clip(np.ceil(np.log2(longest / side)), 0, _MOST_HALVINGS).astype(int)
    if "pore" in fluid.cell_data:  # patches meet along curves: cut alike, so that no chinks open
        halvings[:] = halvings.max(initial=0)
    at_nodes = {"": np.asarray(fluid.points)} | {name: np.asarray(fluid[name]) for name in names}
    refined: dict[str, list[Array]] = {name: [] for name in at_nodes}
    faces, count = [], 0
    for level in np.unique(halvings):
        alike = cells[halvings == level]
        phi = tabulate(order, reference_nodes(2**level))[0].astype(np.float32)
        small = small_simplices(2**level) + len(phi) * np.arange(len(alike))[:, None, None]
        faces.append(count + small.reshape(-1, 3))
        count += len(alike) * len(phi)
        for name, values in at_nodes.items():
            inside = values.astype(np.float32)[alike].reshape(*alike.shape, -1)
            refined[name].append((phi @ inside).reshape(-1, *values.shape[1:]))
    surface = pv.PolyData.from_regular_faces(np.concatenate(refined.pop("")), np.concatenate(faces))
    for name, parts in refined.items():
        surface[name] = np.concatenate(parts)
    return surface


def edges(fluid: pv.UnstructuredGrid) -> pv.PolyData:
    """The curved edges of the cells, as polylines."""
    cells = nodes(fluid)
    degree = order_of(cells.shape[1])
    inner = np.arange(3, 3 * degree).reshape(3, degree - 1)
    along = np.column_stack([[0, 1, 2], inner, [1, 2, 0]])
    curves = cells[:, along].reshape(-1, degree + 1)
    _, first = np.unique(np.sort(curves[:, [0, -1]], axis=1), axis=0, return_index=True)
    points = _along(curves[first], fluid.points).reshape(-1, 3)
    return pv.PolyData(points, lines=counted(np.arange(len(points)).reshape(len(first), -1)))


def rims(bodies: pv.UnstructuredGrid, inward: float) -> pv.PolyData:
    """Ribbons along the curved surfaces of bodies, `inward` wide into them, with the point data.

    The cells of `bodies` run around them either way; their data `inside` (cells, 3) are points in the bodies.
    """
    curves = along_curves(nodes(bodies))
    outer = _along(curves, bodies.points)
    towards = bodies.cell_data["inside"][:, None] - outer
    depth = np.linalg.norm(towards, axis=2, keepdims=True)
    inner = outer + towards / depth * np.minimum(inward, 0.5 * depth)
    count = outer[..., 0].size
    at = np.arange(count).reshape(outer.shape[:2])
    quads = np.stack([at[:, :-1], at[:, 1:], at[:, 1:] + count, at[:, :-1] + count], axis=-1).reshape(-1, 4)
    points = np.concatenate([outer.reshape(-1, 3), inner.reshape(-1, 3)])
    ribbon = pv.PolyData(points, faces=counted(quads))
    for name, values in bodies.point_data.items():
        along = _along(curves, values.reshape(len(values), -1)).reshape(count, *values.shape[1:])
        ribbon.point_data[name] = np.concatenate([along, along])
    return ribbon


def _along(curves: Indices, values: Array) -> Array:
    """Values (n, c) at even steps along curves (m, degree + 1), nodes in order: (m, segments + 1, c)."""
    degree = curves.shape[1] - 1
    shape = polyvander(np.linspace(0, 1, _SEGMENTS + 1), degree)
    shape = shape @ np.linalg.inv(polyvander(np.linspace(0, 1, degree + 1), degree))
    return np.asarray(shape @ values[curves])


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


def stream_function(fluid: pv.UnstructuredGrid, w: Array) -> Array:
    """The function psi, (n,), with w = (d psi / dy, -d psi / dx) for w, (n, 3), without divergence.

    That is w = u in the plane, and w = r u with an axis (Stokes's stream function).
    Each piece of a cell's side carries the flux `w_x dy - w_y dx` from node to node; psi sums them along a
    tree of pieces, from zero at one node of each connected part. No body may take in fluid: rigid ones do
    not.
    """
    start, end, flux = _fluxes(nodes(fluid), np.asarray(fluid.points, dtype=float), w)
    n = fluid.n_points
    graph = coo_array((np.ones(len(start)), (start, end)), shape=(n, n)).tocsr()
    parent = np.arange(n)
    for root in np.unique(connected_components(graph, directed=False)[1], return_index=True)[1]:
        reached, before = breadth_first_order(graph, root, directed=False)
        parent[reached[1:]] = before[reached[1:]]
    psi = np.zeros(n)
    psi[end[parent[end] == start]] = flux[parent[end] == start]
    psi[start[parent[start] == end]] = -flux[parent[start] == end]
    while np.any(parent != parent[parent]):  # psi: the flux from `parent` on; twice as far each time
        psi, parent = psi + psi[parent], parent[parent]
    return psi


def _fluxes(cells: Indices, x: Array, w: Array) -> tuple[Indices, Indices, Array]:
    """Nodes at both ends of the pieces of the cells' sides, and to those inside, and the flux across each."""
    order = order_of(cells.shape[1])
    side = [[k, *range(3 + k * (order - 1), 3 + (k + 1) * (order - 1)), (k + 1) % 3] for k in range(3)]
    pieces = [pair for along in side for pair in pairwise(along)]
    pieces += [(0, inside) for inside in range(3 * order, cells.shape[1])]
    a, b = np.array(pieces).T
    X = reference_nodes(order)
    points, weights = np.polynomial.legendre.leggauss(order)
    flux = np.zeros((len(cells), len(pieces)))
    x, w = (values[cells][..., :2].transpose(2, 0, 1) for values in (x, w))
    for s, weight in zip(0.5 * (1.0 + points), 0.5 * weights, strict=True):
        phi, dphi = tabulate(order, X[a] + s * (X[b] - X[a]))
        dx, dy = x @ np.einsum("pnk,pk->np", dphi, X[b] - X[a])
        w_x, w_y = w @ phi.T
        flux += weight * (w_x * dy - w_y * dx)
    return cells[:, a].ravel(), cells[:, b].ravel(), flux.ravel()
