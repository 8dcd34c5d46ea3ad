"""gmsh, and nothing else of it: triangles between given boundary nodes.

gmsh gets discrete curves and fills them by its planar algorithms; it never moves, adds or renumbers
a boundary node, and takes its sizes from them.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import accumulate

import fsi.meshes.backend  # noqa: F401

import gmsh
import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices, parted
from fsi.machine.signals import held
from fsi.meshes.errors import MeshError
from fsi.meshes.helping import shared_out
from fsi.meshes.planar.far_size import BODIES, FarSize
from fsi.meshes.planar.sizing import INSIDE, Curve

REST = BODIES + 1  # the curves that gmsh gets
DELAUNAY = 5  # grades better than the frontal algorithm in large containers
REMEDY = "lower discretisation.growth or raise cells_per_circle"


@dataclass(frozen=True, slots=True)
class StraightCells:
    """Triangles, or in space tetrahedra, and their boundary.

    Attributes:
        vertices: (n, d).
        cells: numbers of their vertices, (T, d + 1); triangles counterclockwise.
        facets: sides of cells on the boundary, (F, d).
        tags: of these, (F,).
    """

    vertices: Array
    cells: Indices
    facets: Indices
    tags: Indices


@contextmanager
def gmsh_model() -> Iterator[None]:
    """A fresh, silent, deterministic gmsh model, cleared afterwards (or it leaks 200 kB a mesh)."""
    if not gmsh.isInitialized():
        with held():  # it sets signals back to what ends the process at once
            gmsh.initialize(interruptible=False)
    gmsh.option.restoreDefaults()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)  # with two, meshes differ from run to run
    gmsh.option.setNumber("Mesh.Renumber", 0)  # keeps the numbers of the boundary nodes
    gmsh.option.setNumber("Mesh.Algorithm", DELAUNAY)
    gmsh.model.add("fluid")
    try:
        yield
    except MeshError:
        raise
    except Exception as error:
        raise MeshError(f"gmsh failed: {error}; {REMEDY}") from error
    finally:
        gmsh.model.mesh.removeSizeCallback()
        gmsh.clear()


def chain(curves: Sequence[Curve]) -> tuple[Array, list[Indices]]:
    """All boundary nodes (n, 2) without repetition, and each curve as a chain of node numbers.

    Open curves share their end nodes; the chain of a closed curve ends where it starts.
    """
    x = np.concatenate([curve.nodes for curve in curves])
    parts = parted(np.arange(len(x)), accumulate(len(curve.nodes) for curve in curves[:-1]))
    ends = [part[[0, -1]] for curve, part in zip(curves, parts, strict=True) if not curve.closed]
    corners = np.concatenate([*ends, np.empty(0, dtype=np.int64)])
    _, first, place = np.unique(x[corners], axis=0, return_index=True, return_inverse=True)
    same = np.arange(len(x))
    same[corners] = corners[first[place]]
    is_first = same == np.arange(len(x))
    number = (np.cumsum(is_first) - 1)[same]
    chains = [number[part] for part in parts]
    closed = [np.append(c, c[0]) if curve.closed else c for curve, c in zip(curves, chains, strict=True)]
    return x[is_first], closed


def triangulate(curves: Sequence[Curve], far: FarSize | None = None) -> StraightCells:
    """Triangles between the curves: the fluid lies inside the open ones and outside the closed ones.

    `far` bounds the size far from the bodies. Raises MeshError where gmsh fails, or loses a boundary edge.
    """
    nodes, chains = chain(curves)
    moved = nodes + _opening(nodes, chains, curves)
    bodies, numbers, pieces = 0 if far is None else far.bodies, list[Indices](), list[Piece]()
    bounds = defaultdict[int, list[int]](list)
    for k, curve in enumerate(curves):
        for piece in curve.pieces:
            bounds[piece].append(k)
    for _, some in sorted(bounds.items()):
        edges, tags = _edges(chains, curves, some)
        used, corners = np.unique(edges, return_inverse=True)
        on_body = (tags > INSIDE) & (tags <= bodies)
        numbers.append(used)
        pieces.append(Piece(moved[used], corners.reshape(-1, 2), on_body, far))
    vertices, triangles, count = [nodes], list[Indices](), len(nodes)
    for used, (x, cells) in zip(numbers, _filled(pieces), strict=True):
        vertices.append(x[len(used) :])
        triangles.append(np.append(used, count + np.arange(len(vertices[-1])))[cells])
        count += len(vertices[-1])
    edges, tags = _edges(chains, curves, [k for k, curve in enumerate(curves) if curve.tag != INSIDE])
    straight = StraightCells(np.concatenate(vertices), np.concatenate(triangles), edges, tags)
    require_boundary(straight.cells, edges)
    return straight


def _edges(chains: Sequence[Indices], curves: Sequence[Curve], some: list[int]) -> tuple[Indices, Indices]:
    """The edges (n, 2) of some chains and the tags of their curves."""
    first, second = (np.concatenate([chains[k][part] for k in some]) for part in (np.s_[:-1], np.s_[1:]))
    tags = np.repeat([curves[k].tag for k in some], [len(chains[k]) - 1 for k in some])
    return np.column_stack([first, second]), tags


@dataclass(frozen=True, slots=True)
class Piece:
    """A piece of the fluid for gmsh.

    Attributes:
        x: the nodes on its boundary, (n, 2).
        edges: between these, (m, 2).
        on_body: which of them lie on bodies, (m,).
        far: bounds the sizes within.
    """

    x: Array
    edges: Indices
    on_body: NDArray[np.bool_]
    far: FarSize | None


def _filled(pieces: Sequence[Piece]) -> list[tuple[Array, Indices]]:
    """All pieces as `fill` has them; the largest are dealt out first, so that ranks have as much to do."""
    order = np.argsort([-len(piece.edges) for piece in pieces], kind="stable").tolist()
    filled = dict(zip(order, shared_out(fill, [pieces[k] for k in order]), strict=True))
    return [filled[k] for k in range(len(pieces))]


def fill(piece: Piece) -> tuple[Array, Indices]:
    """gmsh's triangles in a piece; its vertices begin with the nodes on the boundary."""
    with gmsh_model():
        _add_boundary(piece.x, piece.edges, piece.on_body)
        if piece.far is not None:
            piece.far.apply()
        gmsh.model.mesh.generate(2)
        return _read_triangles()


def _opening(nodes: Array, chains: Sequence[Indices], curves: Sequence[Curve]) -> Array:
    """How far all nodes (n, 2) are moved for gmsh: those on lines in the fluid between what the ends are."""
    moved = np.zeros_like(nodes)
    for places, curve in zip(chains, curves, strict=True):
        if curve.opening is not None:
            moved[places[: len(curve.nodes)]] = curve.opening
    for places, curve in zip(chains, curves, strict=True):
        if curve.opening is None:
            s = np.linspace(0.0, 1.0, len(places))[:, None]
            moved[places[1:-1]] = ((1.0 - s) * moved[places[0]] + s * moved[places[-1]])[1:-1]
    return moved


def _add_boundary(nodes: Array, edges: Indices, on_body: NDArray[np.bool_]) -> None:
    """Give gmsh the boundary as two curves, the bodies and the rest: node k of ours is node k + 1 of gmsh's.

    gmsh does not mind that a curve is in pieces. With one curve for each piece it would evaluate every one of
    them 40 000 times in vain, to find out which way the normal of the surface points: at 200 discs that took
    0.8 of 1.2 s. It makes no triangles where a curve has no node of its own: edges that only join bodies, the
    cut through gaps of one cell each, go with the bodies.
    """
    model = gmsh.model
    model.addDiscreteEntity(0, 1)
    model.mesh.addNodes(0, 1, [1], [*nodes[0], 0.0])
    model.mesh.addElementsByType(1, 15, [], [1])
    of_body = np.zeros(len(nodes), dtype=bool)
    of_body[edges[on_body]] = True
    if of_body[1:].all():
        on_body = np.ones_like(on_body)
    loops = []
    for curve, chosen, placed in ((BODIES, on_body, of_body), (REST, ~on_body, ~of_body)):
        if chosen.any():
            model.addDiscreteEntity(1, curve, [1, 1])
            inner = np.flatnonzero(placed[1:]) + 1
            x = np.column_stack([nodes[inner], np.zeros(len(inner))])
            model.mesh.addNodes(1, curve, inner + 1, x.ravel())
            model.mesh.addElementsByType(curve, 1, [], edges[chosen].ravel() + 1)
            loops.append(model.geo.addCurveLoop([curve]))
    model.geo.addPlaneSurface(loops[::-1])
    model.geo.synchronize()


def _read_triangles() -> tuple[Array, Indices]:
    """Vertices in the order of gmsh's numbers, and counterclockwise triangles."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, corners = gmsh.model.mesh.getElementsByType(2)
    order = np.argsort(tags)
    vertices = coordinates.reshape(-1, 3)[order, :2]
    triangles = np.searchsorted(tags[order], corners).astype(np.int64).reshape(-1, 3)
    if len(triangles) == 0:
        raise MeshError(f"gmsh made no triangles; {REMEDY}")
    mirrored = clockwise(vertices, triangles)
    triangles[mirrored] = triangles[mirrored][:, [0, 2, 1]]
    return vertices, triangles


def clockwise(vertices: Array, triangles: Indices) -> NDArray[np.bool_]:
    """Which triangles, their first three columns corners, run clockwise."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    turns_right: NDArray[np.bool_] = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    return turns_right


def boundary_sides(cells: Indices) -> Indices:
    """The sides of cells (T, d + 1) that belong to one cell only, corners in order, (F, d)."""
    unique, count = np.unique(np.sort(_sides(cells), axis=1), axis=0, return_counts=True)
    outer: Indices = unique[count == 1]
    return outer


def _sides(cells: Indices) -> Indices:
    return np.concatenate([np.delete(cells, k, axis=1) for k in range(cells.shape[1])])


def require_boundary(cells: Indices, facets: Indices) -> None:
    """The sides that belong to one cell must be the facets, and none may belong to more than two."""
    n = int(max(cells.max(), facets.max())) + 1
    keys, count = np.unique(side_keys(_sides(cells), n), return_counts=True)
    if count.max() > 2 or not np.array_equal(keys[count == 1], np.sort(side_keys(facets, n))):
        raise MeshError(f"gmsh lost a part of the boundary; {REMEDY}")


def side_keys(sides: Indices, n: int) -> Indices:
    """One number for each side (F, d) of cells with n vertices, in whatever order its corners are."""
    keys, *others = ascending(sides.T)
    for column in others:
        keys = keys * n + column
    return keys


def ascending(columns: Iterable[Indices]) -> list[Indices]:
    """Columns (n,) with the numbers of each row in order: NumPy takes five times as long to sort so few."""
    ordered = list(columns)
    for end in range(len(ordered) - 1, 0, -1):
        for k in range(end):
            a, b = ordered[k : k + 2]
            ordered[k : k + 2] = np.minimum(a, b), np.maximum(a, b)
    return ordered


def distinct(keys: Indices) -> tuple[Indices, Indices]:
    """Where each key stands first, the keys ascending, and which of them each one is, (keys,).

    As np.unique tells, which sorts so that equal ones stay in order: that takes three times as long.
    """
    order = np.argsort(keys)
    in_order = keys[order]
    new = np.concatenate([np.ones(min(1, len(keys)), dtype=bool), in_order[1:] != in_order[:-1]])
    number = np.empty(len(keys), dtype=np.int64)
    number[order] = np.cumsum(new) - 1
    return np.minimum.reduceat(order, np.flatnonzero(new)), number


def places_of(wanted: Indices, keys: Indices) -> tuple[Indices, NDArray[np.bool_]]:
    """Where among the keys those of the wanted ones stand that are there, and which are, (wanted,)."""
    order = np.argsort(keys)
    first, end = (np.searchsorted(keys, wanted, side, sorter=order) for side in ("left", "right"))
    there = first < end
    return order[first[there]], there
