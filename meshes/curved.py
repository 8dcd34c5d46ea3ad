"""Curved triangles of order k: the nodes of isoparametric cells, in NumPy.

Edges on a circle get their nodes on the circle; inner edges stay straight; inner nodes follow by
blending (Lenoir 1986, SIAM J. Numer. Anal. 23:562), so that the map is smooth enough for the full
order of the method.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import basix
import numpy as np

from meshes.geometry import Array
from meshes.sizing import Curve
from meshes.triangulate import Indices

EDGES = ((1, 2), (0, 2), (0, 1))  # local vertices of the local edges, as in basix


@dataclass(frozen=True, slots=True)
class CurvedCells:
    """A triangulation of order k before it is distributed.

    nodes: (n, 2), vertices first; cells: node numbers in the order of basix, (T, (k+1)(k+2)/2);
    edges: vertices of the boundary edges, (E, 2); tags: of these edges, (E,).
    """

    nodes: Array
    cells: Indices
    edges: Indices
    tags: Indices
    order: int


def reference_points(order: int) -> Array:
    """Equispaced nodes of the reference triangle in the order of basix, shape (nodes, 2)."""
    element = basix.create_element(
        basix.ElementFamily.P, basix.CellType.triangle, order, basix.LagrangeVariant.equispaced
    )
    points: Array = element.points
    return points


def curve(vertices: Array, triangles: Indices, edges: Indices, tags: Indices, curves: Sequence[Curve], order: int) -> CurvedCells:
    """Cells of the given order from straight triangles (T, 3) and tagged boundary edges (E, 2)."""
    sides = np.stack([triangles[:, EDGES[e]] for e in range(3)], axis=1)
    unique, side_numbers = np.unique(np.sort(sides.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    side_numbers = side_numbers.reshape(-1, 3)
    bend = _Bend(vertices, unique, edges, tags, curves)

    per_side = order - 1
    t = np.arange(1, order) / order
    a, b = vertices[unique[:, 0]], vertices[unique[:, 1]]
    side_nodes = a[:, None] * (1 - t)[:, None] + b[:, None] * t[:, None] + bend(np.arange(len(unique)), t)

    X = reference_points(order)
    cells = np.empty((len(triangles), len(X)), dtype=np.int64)
    cells[:, :3] = triangles
    first = len(vertices)
    for e in range(3):
        forward = (sides[:, e, 0] < sides[:, e, 1])[:, None]
        k = np.where(forward, np.arange(per_side), np.arange(per_side)[::-1])
        cells[:, 3 + e * per_side : 3 + (e + 1) * per_side] = first + side_numbers[:, e, None] * per_side + k

    inner = X[3 + 3 * per_side :]
    inner_nodes = _inner_nodes(vertices[triangles], inner, sides, side_numbers, bend, order)
    first += per_side * len(unique)
    cells[:, 3 + 3 * per_side :] = first + np.arange(inner_nodes[..., 0].size).reshape(len(triangles), -1)
    nodes = np.concatenate([vertices, side_nodes.reshape(-1, 2), inner_nodes.reshape(-1, 2)])
    return CurvedCells(nodes, cells, edges, tags, order)


class _Bend:
    """How far the boundary lies from the straight side, as a function of the place along the side."""

    def __init__(self, vertices: Array, sides: Indices, edges: Indices, tags: Indices, curves: Sequence[Curve]) -> None:
        centres = {c.tag: c.centre for c in curves if c.centre is not None}
        round_edges = np.isin(tags, list(centres))
        ends = np.sort(edges[round_edges], axis=1)
        n = len(vertices)
        keys = sides[:, 0] * n + sides[:, 1]
        self.side = np.searchsorted(keys, ends[:, 0] * n + ends[:, 1])
        table = np.zeros((int(tags.max(initial=0)) + 1, 2))
        for tag, centre in centres.items():
            table[tag] = centre
        self.row = np.full(len(sides), -1)
        self.row[self.side] = np.arange(len(self.side))
        self.centre = table[tags[round_edges]]
        self.a, self.b = vertices[ends[:, 0]], vertices[ends[:, 1]]

    def __call__(self, sides: Indices, t: Array) -> Array:
        """Arc minus chord of the sides (s,) at fractions t (m,) or (s, m) from the lower vertex; (s, m, 2)."""
        t = np.broadcast_to(t, (len(sides), np.shape(t)[-1]))
        offset = np.zeros((*t.shape, 2))
        rows = self.row[sides]
        curved = np.flatnonzero(rows >= 0)
        r, t = rows[curved], t[curved]
        from_centre, to = self.a[r] - self.centre[r], self.b[r] - self.centre[r]
        angle = np.arctan2(from_centre[:, 0] * to[:, 1] - from_centre[:, 1] * to[:, 0], (from_centre * to).sum(axis=1))
        # On the arc: a cos(t angle) + a_perp sin(t angle), seen from the centre.
        perp = np.column_stack([-from_centre[:, 1], from_centre[:, 0]])
        turn = t * angle[:, None]
        arc = from_centre[:, None] * np.cos(turn)[..., None] + perp[:, None] * np.sin(turn)[..., None]
        offset[curved] = arc - (from_centre[:, None] * (1 - t)[..., None] + to[:, None] * t[..., None])
        return offset


def _inner_nodes(corners: Array, inner: Array, sides: Indices, side_numbers: Indices, bend: _Bend, order: int) -> Array:
    """Inner nodes (T, m, 2): the straight place plus each side's bend, faded out towards the vertex opposite."""
    barycentric = np.column_stack([1 - inner.sum(axis=1), inner])
    x = np.einsum("mv,tvd->tmd", barycentric, corners)
    if len(inner) == 0:
        return x
    for e, (i, j) in enumerate(EDGES):
        weight = barycentric[:, i] + barycentric[:, j]
        t = barycentric[:, j] / weight
        along = np.where((sides[:, e, 0] < sides[:, e, 1])[:, None], t, 1 - t)
        x += weight[:, None] ** (order + 2) * bend(side_numbers[:, e], along)
    return x
