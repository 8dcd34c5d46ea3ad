"""Curved tetrahedra of order k: the nodes of isoparametric cells around spheres and ellipsoids, in NumPy.

Let p(X) be the straight place of a point of a facet on a sphere of radius a around c, and

    Phi(X) = c + a (p - c) / |p - c|

its place on the sphere. Edges follow Phi through their Gauss-Lobatto points. A facet's inner nodes have the
tangential place of Phi; their radial place makes the moments of |x - c| - a with polynomials of degree
k - 3, over solid angles, vanish, so that order 3, like order 2, has volumes and forces of order 2 k.
The bend `x - p` goes on into the cells by polynomials of degree k in the barycentric coordinates l (Szabo
and Babuska, Finite Element Analysis, 1991, section 6.1):

    edge ij:   l_i l_j c((1 + l_j - l_i) / 2),       facet ijk:   l_i l_j l_k (c_i l_i + ...),

zero on all other sides. The derivatives of order m of the map are O(h^m) (Lenoir 1986, SIAM J. Numer. Anal.
23:562), as Phi is one smooth map for edges and facets.

On a cylinder |p - c| is the distance from its axis, and a solid angle is an angle about it times a length.

An ellipsoid is a sphere that is stretched: facets bend before that, and their bends are stretched. Such maps
take polynomials to such of the same degree, and volumes to volumes times one number.
"""

from collections.abc import Mapping
from itertools import combinations, permutations

import basix
import numpy as np

from fsi.arrays import Array, Indices
from fsi.meshes.cells.curved import CurvedCells, along_side, barycentric, reference_points
from fsi.meshes.geometry.curves import Sphere
from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid
from fsi.meshes.planar.triangulate import StraightCells, ascending, distinct, places_of, side_keys

type RoundSurface = Sphere | PlacedEllipsoid

LARGEST = np.iinfo(np.int64).max

NEWTON_STEPS = 3  # for the radial place of a facet: linear but for (h / a)^2


def curve_tets(straight: StraightCells, spheres: Mapping[int, RoundSurface], order: int) -> CurvedCells:
    """Cells of the given order from straight ones.

    Args:
        straight: the cells; the vertices of the facets on a sphere or ellipsoid lie on it.
        spheres: the surface of a tag, where that is curved.
        order: 1 ... 4.
    """
    return joined(straight, curved_places(straight, spheres, order), order)


def joined(straight: StraightCells, x: Array, order: int) -> CurvedCells:
    """Cells with the nodes x (T, nodes, 3) of each."""
    weights = barycentric(reference_points(order, 3))
    nodes, cells = _numbered(x, straight.cells, np.rint(order * weights).astype(np.int64))
    nodes[: len(straight.vertices)] = straight.vertices
    return CurvedCells(nodes, cells, straight.facets, straight.tags, order)


def curved_places(straight: StraightCells, spheres: Mapping[int, RoundSurface], order: int) -> Array:
    """The nodes of each cell, (T, nodes, 3); as `curve_tets`, with the facets near these cells."""
    vertices, tets = straight.vertices, straight.cells
    l = barycentric(reference_points(order, 3))  # noqa: E741
    x: Array = l @ vertices[tets]
    parts = [_bent(straight, tag, sphere, order) for tag, sphere in spheres.items() if tag in straight.tags]
    if parts:
        edges, bends, faces, bubbles = (np.concatenate(each) for each in zip(*parts, strict=True))
        some = bent_cells(straight, spheres)
        near = tets[some]
        for ij in permutations(range(4), 2):
            cells, rows = _matches(near[:, ij], edges)
            x[some[cells]] += np.einsum("nm,cmd->cnd", _edge_lift(l[:, ij], order), bends[rows])
        for ijk in permutations(range(4), 3) if order > 2 else ():
            cells, rows = _matches(near[:, ijk], faces)
            x[some[cells]] += np.einsum("nm,cmd->cnd", _bubbles(l[:, ijk], order), bubbles[rows])
    return x


def bent_cells(straight: StraightCells, spheres: Mapping[int, RoundSurface]) -> Indices:
    """The cells with two vertices and more on round surfaces, (b,): all others stay straight."""
    on = np.zeros(len(straight.vertices), dtype=bool)
    on[straight.facets[np.isin(straight.tags, list(spheres))]] = True
    return np.flatnonzero(on[straight.cells].sum(axis=1) >= 2)


def _bent(
    straight: StraightCells, tag: int, surface: RoundSurface, order: int
) -> tuple[Indices, Array, Indices, Array]:
    """Edges (E, 2) of a surface and how they bend, its facets (F, 3) and coefficients of their bubbles."""
    faces, n = np.column_stack(ascending(straight.facets[straight.tags == tag].T)), len(straight.vertices)
    keys = np.unique(side_keys(faces[:, [0, 1, 0, 2, 1, 2]].reshape(-1, 2), n))
    edges = np.column_stack(np.divmod(keys, n))
    ends, corners = (surface.unstretched(straight.vertices[some]) for some in (edges, faces))
    bends, bubbles = _edge_bends(ends, surface.unit, order), np.empty((len(faces), 0, 3))
    if order > 2:
        bubbles = _face_bends(corners, bends, _find(faces, edges), surface.unit, order)
    return edges, surface.stretched(bends), faces, surface.stretched(bubbles)


def _keys(rows: Indices, n: int) -> Indices:
    """One number for each row of vertex numbers below n."""
    keys: Indices = rows @ (n ** np.arange(rows.shape[1])[::-1])
    return keys


def _matches(corners: Indices, sides: Indices) -> tuple[Indices, Indices]:
    """Which rows of `corners` are rows of `sides` (sorted each), and which rows those are."""
    n = int(max(corners.max(), sides.max())) + 1
    place, there = places_of(_keys(corners, n), _keys(sides, n))
    return np.flatnonzero(there), place


def _find(faces: Indices, edges: Indices) -> Indices:
    """Numbers of the edges 01, 02, 12 of each face, (F, 3)."""
    return np.column_stack([_matches(faces[:, ij], edges)[1] for ij in combinations(range(3), 2)])


def _edge_bends(ends: Array, sphere: Sphere, order: int) -> Array:
    """Phi minus chord at the inner Gauss-Lobatto points of edges (E, 2, 3), shape (E, order - 1, 3)."""
    t = along_side(order).points[2:]
    chord = ends[:, :1] * (1.0 - t) + ends[:, 1:] * t
    bends: Array = sphere.project(chord) - chord
    return bends


def _edge_lift(l: Array, order: int) -> Array:  # noqa: E741
    """What each inner node of an edge adds at points whose l_i, l_j are (points, 2); (points, order - 1)."""
    a, b = l.T
    t = 0.5 * (1.0 + b - a)
    at_end = a * b == 0.0
    t = np.where(at_end, 0.5, t)
    basis = along_side(order).tabulate(0, t[:, None])[0, :, 2:, 0]
    lift: Array = np.where(at_end, 0.0, a * b / (t * (1.0 - t)))[:, None] * basis
    return lift


def _bubbles(l: Array, order: int) -> Array:  # noqa: E741
    """Polynomials of a facet that vanish on its edges, at points whose l_i, l_j, l_k are (points, 3)."""
    bubble: Array = l.prod(axis=1)[:, None] * _moments(l, order)
    return bubble


def _moments(l: Array, order: int) -> Array:  # noqa: E741
    """Polynomials of degree order - 3 on a facet: 1 for order 3, l_i, l_j, l_k for order 4."""
    return np.ones((len(l), 1)) if order == 3 else l


def _face_bends(corners: Array, edge_bends: Array, edges: Indices, sphere: Sphere, order: int) -> Array:
    """Coefficients (F, m, 3) of `_bubbles` for facets with the corners (F, 3, 3) and edges (F, 3)."""

    def without_bubbles(l: Array) -> Array:  # noqa: E741
        x: Array = np.einsum("nv,fvd->fnd", l, corners)
        for e, ij in enumerate(combinations(range(3), 2)):
            x += np.einsum("nm,fmd->fnd", _edge_lift(l[:, ij], order), edge_bends[edges[:, e]])
        return x

    inner = barycentric(reference_points(order)[3 * order :])
    straight = np.einsum("nv,fvd->fnd", inner, corners)
    bend = sphere.project(straight) - without_bubbles(inner)
    coefficients: Array = np.linalg.inv(_bubbles(inner, order)) @ bend

    points, weights = basix.make_quadrature(basix.CellType.triangle, 2 * order + 2)
    l = barycentric(points)  # noqa: E741
    # The angle that a piece of the facet is seen under from the centre.
    away = np.linalg.norm(sphere.from_centre(np.einsum("nv,fvd->fnd", l, corners)), axis=2)
    moments = np.einsum("ni,n,fn->fin", _moments(l, order), weights, away**-sphere.opening)
    bubbles = _bubbles(l, order)
    x = without_bubbles(l)
    normal = sphere.from_centre(corners.mean(axis=1))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    for _ in range(NEWTON_STEPS):
        off = np.linalg.norm(sphere.from_centre(x + bubbles @ coefficients), axis=2) - sphere.radius
        amount = np.linalg.solve(moments @ bubbles, moments @ off[:, :, None])
        coefficients -= amount * normal[:, None]
    return coefficients


def _numbered(x: Array, tets: Indices, weights: Indices) -> tuple[Array, Indices]:
    """Nodes without repetition, vertices first, and cells, from the nodes x (T, nodes, 3) of each cell.

    A node is known by its barycentric coordinates, in steps of 1 / order, to vertices: `weights` (nodes, 4).
    """
    n = int(tets.max()) + 1
    corners = np.array([np.repeat(np.arange(4), w) for w in weights])
    inner = slice(4, None)
    key, *others = ascending(tets[:, column].ravel() for column in corners[inner].T)
    names = n
    for column in others:
        if names > LARGEST // n:
            first, key = distinct(key)
            names = len(first)
        key, names = key * n + column, names * n
    first, number = distinct(key)
    cells = np.concatenate([tets, n + number.reshape(len(tets), -1)], axis=1)
    nodes = np.empty((n + len(first), 3))
    nodes[tets] = x[:, :4]
    nodes[n:] = x[:, inner].reshape(-1, 3)[first]
    return nodes, cells
