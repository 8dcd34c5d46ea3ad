"""Curved triangles of order k: the nodes of isoparametric cells, in NumPy; and whether cells are valid.

Edges on a circle follow it through their Gauss-Lobatto points; inner edges stay straight; inner nodes
follow by a polynomial lift (Szabo and Babuska, Finite Element Analysis, 1991, section 6.1). The derivatives
of order m of the map are then O(h^m), which the full order 2 k of the forces requires (Lenoir 1986, SIAM J.
Numer. Anal. 23:562).

A cell is valid if its Jacobian determinant is positive. That of a triangle of order k is a polynomial of
degree 2 (k - 1), that of a tetrahedron one of degree 3 (k - 1); it lies between the smallest and the largest
of its Bezier coefficients, which bound it rigorously.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from math import factorial, prod

import basix
import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.errors import apart
from fsi.meshes.cells.followed import centres, image_of, partly_straight, within
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.parts import at_parts
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.planar.sizing import Curve
from fsi.meshes.planar.triangulate import StraightCells, side_keys

SIMPLEX = {2: basix.CellType.triangle, 3: basix.CellType.tetrahedron}  # by dimension
EDGES = ((1, 2), (0, 2), (0, 1))  # local vertices of the local edges, as in basix
WORST_ACCEPTED = 0.1
AT_ONCE = 1000  # cells whose determinants are found together, so that they stay in the processor's cache


@dataclass(frozen=True, slots=True)
class CurvedCells:
    """A triangulation of order k before it is distributed.

    Attributes:
        nodes: vertices first, (n, d).
        cells: node numbers in the order of basix, (T, (k+1)(k+2)/2), of tetrahedra (T, (k+1)(k+2)(k+3)/6).
        edges: vertices of the edges on the boundary, in space of the triangles there, (E, d).
        tags: of these, (E,).
        order: k.
    """

    nodes: Array
    cells: Indices
    edges: Indices
    tags: Indices
    order: int


def reference_points(order: int, dimension: int = 2) -> Array:
    """Equispaced nodes of the reference simplex in the order of basix, shape (nodes, dimension)."""
    points: Array = _lagrange(order, dimension).points
    return points


def _lagrange(order: int, dimension: int) -> basix.finite_element.FiniteElement:
    variant = basix.LagrangeVariant.equispaced
    return basix.create_element(basix.ElementFamily.P, SIMPLEX[dimension], order, variant)


@cache
def along_side(order: int) -> basix.finite_element.FiniteElement:
    """Polynomials along a side by their values at the Gauss-Lobatto points."""
    variant = basix.LagrangeVariant.gll_isaac
    return basix.create_element(basix.ElementFamily.P, basix.CellType.interval, order, variant)


def barycentric(X: Array) -> Array:
    """Barycentric coordinates (n, d + 1) of reference points (n, d)."""
    return np.column_stack([1.0 - X.sum(axis=1), X])


def curve(straight: StraightCells, curves: Sequence[Curve], order: int) -> CurvedCells:
    """Cells of the given order from straight triangles whose boundary lies on the curves."""
    vertices, triangles = straight.vertices, straight.cells
    sides = np.stack([triangles[:, EDGES[e]] for e in range(3)], axis=1)
    keys, side_numbers = np.unique(side_keys(sides.reshape(-1, 2), len(vertices)), return_inverse=True)
    unique, side_numbers = np.column_stack(np.divmod(keys, len(vertices))), side_numbers.reshape(-1, 3)
    bend = _Bend(straight, unique, curves, order)

    per_side = order - 1
    t = np.arange(1, order) / order
    a, b = vertices[unique[:, 0]], vertices[unique[:, 1]]
    bent = bend(np.arange(len(unique)), t, np.ones(len(unique), dtype=bool))
    side_nodes = a[:, None] * (1 - t)[:, None] + b[:, None] * t[:, None] + bent

    X = reference_points(order)
    cells = np.empty((len(triangles), len(X)), dtype=np.int64)
    cells[:, :3] = triangles
    first = len(vertices)
    for e in range(3):
        forward = (sides[:, e, 0] < sides[:, e, 1])[:, None]
        k = np.where(forward, np.arange(per_side), np.arange(per_side)[::-1])
        cells[:, 3 + e * per_side : 3 + (e + 1) * per_side] = first + side_numbers[:, e, None] * per_side + k

    inner = X[3 + 3 * per_side :]
    inner_nodes = _inner_nodes(vertices[triangles], inner, sides, side_numbers, bend)
    first += per_side * len(unique)
    cells[:, 3 + 3 * per_side :] = first + np.arange(inner_nodes[..., 0].size).reshape(len(triangles), -1)
    nodes = np.concatenate([vertices, side_nodes.reshape(-1, 2), inner_nodes.reshape(-1, 2)])
    return CurvedCells(nodes, cells, straight.facets, straight.tags, order)


class _Bend:
    """How far each side bends from its chord.

    On a circle it follows the polynomial of the cells' order through the Gauss-Lobatto points of the arc.
    With equispaced points of the arc the area, and with it every force, would converge at order 4 only for
    order 3; with Gauss-Lobatto points the order is 2 k.
    """

    def __init__(self, straight: StraightCells, sides: Indices, curves: Sequence[Curve], order: int) -> None:
        """Of the cells' sides, vertex numbers (s, 2), the lower one first."""
        curved = np.isin(straight.tags, [c.tag for c in curves if c.centre is not None or c.body])
        ends = np.sort(straight.facets[curved], axis=1)
        vertices, n = straight.vertices, len(straight.vertices)
        self.side = np.searchsorted(side_keys(sides, n), side_keys(ends, n))
        self.row = np.full(len(sides), -1)
        self.row[self.side] = np.arange(len(self.side))
        self.a, self.b = vertices[ends[:, 0]], vertices[ends[:, 1]]
        self.tags = straight.tags[curved]
        self.centre = centres(self.tags, (self.a, self.b), curves)
        self.side_element = along_side(order)
        self.values = self._arc_minus_chord(self.side_element.points[:, 0])
        self.values[np.isnan(self.centre[:, 0])] = 0.0  # the straight rest of a wall
        bodies = {curve.tag: list[Placed]() for curve in curves if curve.body is not None}
        for curve in curves:
            if curve.body is not None:
                bodies[curve.tag].append(curve.body)
        for tag, images in bodies.items():
            some = np.flatnonzero(self.tags == tag)
            on, mixed = image_of(images, self.a[some], self.b[some]), tag in partly_straight(curves)
            for k, body in enumerate(images):
                self._follow(body, some[on == k], mixed=mixed)

    def _follow(self, body: Placed, some: Indices, *, mixed: bool) -> None:
        """Those of some sides that end on the outline of a body follow it, by its length.

        mixed: of a wall that has straight pieces too.
        """
        f, a, b = self.side_element.points[:, 0], self.a[some], self.b[some]
        start, end = body.nearest(a), body.nearest(b)
        off = np.maximum(np.hypot(*(body.at(start).x - a).T), np.hypot(*(body.at(end).x - b).T))
        on = off <= within(body.outline.radius, (a, b), mixed=mixed)
        some, a, b, start, end = some[on], a[on], b[on], start[on], end[on]
        along = (end - start + 0.5) % 1.0 - 0.5
        t = at_parts(body, start, along, f)
        x = body.at(t.ravel()).x.reshape(*t.shape, 2)
        self.values[some] = x - (a[:, None] * (1.0 - f)[:, None] + b[:, None] * f[:, None])

    def _arc_minus_chord(self, t: Array) -> Array:
        """Of all curved sides at fractions t (m,) of the angle from the lower vertex, (curved, m, 2)."""
        a, b = self.a - self.centre, self.b - self.centre
        angle = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1))
        # On the arc: a cos(t angle) + a_perp sin(t angle), seen from the centre.
        perp = np.column_stack([-a[:, 1], a[:, 0]])
        turn, t = (angle[:, None] * t)[..., None], t[:, None]
        arc = a[:, None] * np.cos(turn) + perp[:, None] * np.sin(turn)
        return arc - (a[:, None] * (1 - t) + b[:, None] * t)

    def __call__(self, sides: Indices, t: Array, upwards: NDArray[np.bool_]) -> Array:
        """Polynomial minus chord of sides (s,) at fractions t (m,), (s, m, 2).

        upwards: whether t is counted from the lower vertex of each, or from the other.
        """
        offset, rows = np.zeros((len(sides), len(t), 2)), self.row[sides]
        for fractions, some in ((t, upwards), (1.0 - t, ~upwards)):
            curved = np.flatnonzero(some & (rows >= 0))
            basis = self.side_element.tabulate(0, fractions[:, None])[0, :, :, 0]
            offset[curved] = basis @ self.values[rows[curved]]
        return offset


def _inner_nodes(corners: Array, inner: Array, sides: Indices, side_numbers: Indices, bend: _Bend) -> Array:
    """Inner nodes (T, m, 2): the straight place plus the lift of each side's bend into the cell.

    The bend is s (1 - s) c(s) with polynomials c; its lift  l_i l_j c((1 + l_j - l_i) / 2)  in barycentric
    coordinates is a polynomial of the same degree, equal to it on the side and zero on the two others.
    """
    l = barycentric(inner)  # noqa: E741  (as in the formula)
    x: Array = np.einsum("mv,tvd->tmd", l, corners)
    if len(inner) == 0:
        return x
    for e, (i, j) in enumerate(EDGES):
        a, b = l[:, i], l[:, j]
        t, upwards = 0.5 * (1.0 + b - a), sides[:, e, 0] < sides[:, e, 1]
        x += (a * b / (t * (1.0 - t)))[:, None] * bend(side_numbers[:, e], t, upwards)
    return x


def scaled_jacobian(x: Array, order: int) -> Array:
    """Smallest over largest Jacobian determinant of each cell, (T,): 1 for a straight cell.

    Where it is positive it is a lower bound, and the cell is valid; an inverted cell has it <= 0. The nodes x
    of the cells are in the order of basix, shape (T, nodes, dimension).
    """
    derivatives, to_bezier = _tables(order, x.shape[2])
    ratio = np.empty(len(x))
    for first in range(0, len(x), AT_ONCE):
        some = slice(first, first + AT_ONCE)
        # Cells come last, so that what is done for all of them is done along memory.
        J = np.tensordot(derivatives, np.ascontiguousarray(x[some].transpose(1, 2, 0)), axes=1)
        bezier = np.tensordot(to_bezier, determinant(J.transpose(1, 3, 2, 0)), axes=1)
        largest = np.abs(bezier).max(axis=0)
        ratio[some] = bezier.min(axis=0) / np.maximum(largest, np.finfo(float).tiny)
    return ratio


def determinant(J: Array) -> Array:
    """Determinants of matrices (..., dimension, dimension)."""
    if J.shape[-1] == 2:
        area: Array = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
        return area
    volume: Array = (
        J[..., 0, 0] * (J[..., 1, 1] * J[..., 2, 2] - J[..., 1, 2] * J[..., 2, 1])
        - J[..., 0, 1] * (J[..., 1, 0] * J[..., 2, 2] - J[..., 1, 2] * J[..., 2, 0])
        + J[..., 0, 2] * (J[..., 1, 0] * J[..., 2, 1] - J[..., 1, 1] * J[..., 2, 0])
    )
    return volume


def require_valid(x: Array, order: int) -> float:
    """The worst scaled Jacobian of all cells. Raises MeshError where a cell is inverted or nearly so."""
    quality = scaled_jacobian(x, order)
    worst = int(np.argmin(quality))
    if not quality[worst] > WORST_ACCEPTED:
        place, size = x[worst].mean(axis=0), "cells_per_circle" if x.shape[-1] == 2 else "cells_per_gap"
        raise MeshError(
            f"the cell at {{}} has scaled Jacobian {apart(quality[worst], WORST_ACCEPTED)}, at most "
            f"{WORST_ACCEPTED:g} is refused; lower discretisation.growth or raise {size}",
            place,
        )
    return float(quality[worst])


@cache
def _tables(order: int, dimension: int) -> tuple[Array, Array]:
    """Derivatives of the nodal basis (dimension, q, nodes) at the sample points; matrix samples -> Bezier."""
    degree = dimension * (order - 1)
    middle = np.full((1, dimension), 1.0 / (dimension + 1))
    samples = reference_points(degree, dimension) if degree else middle
    derivatives = _lagrange(order, dimension).tabulate(1, samples)[1:, :, :, 0]
    return derivatives, np.linalg.inv(_bernstein(degree, samples))


def _bernstein(degree: int, X: Array) -> Array:
    """Bernstein polynomials of the simplex at points X, shape (points, polynomials)."""
    columns = []
    for powers in product(range(degree + 1), repeat=X.shape[1]):
        first = degree - sum(powers)
        if first >= 0:
            weight = factorial(degree) / prod(factorial(p) for p in (first, *powers))
            columns.append(weight * np.prod(barycentric(X) ** np.array([first, *powers]), axis=1))
    return np.column_stack(columns)
