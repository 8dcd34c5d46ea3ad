"""gmsh, and nothing else of it: triangles between given boundary nodes.

gmsh gets discrete curves and fills them by its planar algorithms; it never moves, adds or renumbers
a boundary node, and takes its sizes from them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import meshes.backend  # noqa: F401

import gmsh
import numpy as np
from numpy.typing import NDArray

from meshes.errors import MeshError
from meshes.geometry import Array
from meshes.sizing import Curve

SAMPLES = 20  # of a body's curve, where distances are measured from
DELAUNAY = 5  # grades better than the frontal algorithm in large containers

Indices = NDArray[np.int64]


@contextmanager
def gmsh_model() -> Iterator[None]:
    """A fresh, silent, deterministic gmsh model, cleared afterwards (or it leaks 200 kB a mesh)."""
    if not gmsh.isInitialized():
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
        raise MeshError(
            f"gmsh failed: {error}; try a finer discretisation.cells_per_gap or cells_per_circle"
        ) from error
    finally:
        gmsh.clear()


def chain(curves: Sequence[Curve]) -> tuple[Array, list[Indices]]:
    """All boundary nodes (n, 2) without repetition, and each curve as a chain of node numbers.

    Open curves share their end nodes; the chain of a closed curve ends where it starts.
    """
    nodes: list[Array] = []
    corners: dict[tuple[float, float], int] = {}
    chains: list[Indices] = []
    count = 0
    for curve in curves:
        numbers = np.empty(len(curve.nodes), dtype=np.int64)
        for k, x in enumerate(curve.nodes):
            corner = not curve.closed and k in (0, len(curve.nodes) - 1)
            key = (float(x[0]), float(x[1]))
            if corner and key in corners:
                numbers[k] = corners[key]
                continue
            if corner:
                corners[key] = count
            nodes.append(x)
            numbers[k] = count
            count += 1
        chains.append(np.append(numbers, numbers[0]) if curve.closed else numbers)
    return np.array(nodes), chains


@dataclass(frozen=True, slots=True)
class FarSize:
    """A bound on the element size in the fluid: `smallest + slope d` at the distance d from the nearest body.

    Without it gmsh, which interpolates between distant boundaries, leaves the surroundings of bodies too
    coarse. bodies: how many, with the tags 1 ... N; reach: a length that no distance exceeds.
    """

    bodies: int
    smallest: float
    slope: float
    reach: float

    def apply(self, curves: Sequence[Curve]) -> None:
        """Make it gmsh's background size."""
        field = gmsh.model.mesh.field
        distance, bound = field.add("Distance"), field.add("Threshold")
        numbers_of_bodies = [k for k, curve in enumerate(curves, start=1) if curve.tag <= self.bodies]
        field.setNumbers(distance, "CurvesList", numbers_of_bodies)
        field.setNumber(distance, "Sampling", SAMPLES)
        numbers = {
            "InField": distance,
            "DistMin": 0.0,
            "SizeMin": self.smallest,
            "DistMax": self.reach,
            "SizeMax": self.smallest + self.slope * self.reach,
        }
        for name, number in numbers.items():
            field.setNumber(bound, name, number)
        field.setAsBackgroundMesh(bound)


def triangulate(
    curves: Sequence[Curve], far: FarSize | None = None
) -> tuple[Array, Indices, Indices, Indices]:
    """Triangles between the curves: the fluid lies inside the open ones and outside the closed ones.

    Args:
        curves: the boundary.
        far: bound on the size far from the bodies.

    Returns:
        vertices (n, 2); triangles (T, 3), counterclockwise; boundary edges (E, 2); their tags (E,).

    Raises:
        MeshError: gmsh fails, or loses a boundary edge.
    """
    nodes, chains = chain(curves)
    with gmsh_model():
        _add_curves(nodes, curves, chains)
        if far is not None and far.bodies:
            far.apply(curves)
        gmsh.model.mesh.generate(2)
        vertices, triangles = _read_triangles()
    edges = np.concatenate([np.column_stack([c[:-1], c[1:]]) for c in chains])
    tags = np.concatenate([np.full(len(c) - 1, curve.tag) for c, curve in zip(chains, curves, strict=True)])
    _require_boundary(triangles, edges)
    return vertices, triangles, edges, tags


def _add_curves(nodes: Array, curves: Sequence[Curve], chains: Sequence[Indices]) -> None:
    """Give gmsh the boundary: node k of ours is node k + 1 of gmsh's."""
    points: dict[int, int] = {}

    def point(node: int) -> int:
        if node not in points:
            tag = points[node] = len(points) + 1
            gmsh.model.addDiscreteEntity(0, tag)
            gmsh.model.mesh.addNodes(0, tag, [node + 1], [*nodes[node], 0.0])
            gmsh.model.mesh.addElementsByType(tag, 15, [], [node + 1])
        return points[node]

    outer, holes = [], []
    for number, (curve, numbers) in enumerate(zip(curves, chains, strict=True), start=1):
        gmsh.model.addDiscreteEntity(1, number, [point(int(numbers[0])), point(int(numbers[-1]))])
        inner = numbers[1:-1]
        gmsh.model.mesh.addNodes(
            1, number, inner + 1, np.column_stack([nodes[inner], np.zeros(len(inner))]).ravel()
        )
        gmsh.model.mesh.addElementsByType(
            number, 1, [], np.column_stack([numbers[:-1], numbers[1:]]).ravel() + 1
        )
        if curve.closed:
            holes.append(gmsh.model.geo.addCurveLoop([number]))
        else:
            outer.append(number)
    gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(outer, reorient=True), *holes])
    gmsh.model.geo.synchronize()


def _read_triangles() -> tuple[Array, Indices]:
    """Vertices in the order of gmsh's numbers, and counterclockwise triangles."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, corners = gmsh.model.mesh.getElementsByType(2)
    order = np.argsort(tags)
    vertices = coordinates.reshape(-1, 3)[order, :2]
    triangles = np.searchsorted(tags[order], corners).astype(np.int64).reshape(-1, 3)
    if len(triangles) == 0:
        raise MeshError("gmsh made no triangles; do two boundaries cross?")
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    clockwise = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    triangles[clockwise] = triangles[clockwise][:, [0, 2, 1]]
    return vertices, triangles


def _require_boundary(triangles: Indices, edges: Indices) -> None:
    """The edges that belong to one triangle must be the given ones."""
    sides = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]), axis=1
    )
    found, count = np.unique(sides, axis=0, return_counts=True)
    if not np.array_equal(found[count == 1], np.unique(np.sort(edges, axis=1), axis=0)):
        raise MeshError("gmsh lost a part of the boundary; try a finer discretisation.cells_per_gap")
