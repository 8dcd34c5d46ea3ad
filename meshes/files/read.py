"""Read a user's own gmsh mesh, through meshio."""

from __future__ import annotations

import io
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import fsi.meshes.backend  # noqa: F401

import meshio
import numpy as np
from mpi4py import MPI

from fsi.meshes.build import FluidMesh, shared
from fsi.meshes.cells.curved import CurvedCells, curve, reference_points
from fsi.meshes.errors import MeshFileError
from fsi.meshes.files.write import LINES, TRIANGLES, gmsh_order
from fsi.meshes.geometry.containers import Array, Container, boundary_distances, boundary_names
from fsi.meshes.planar.sizing import Curve
from fsi.meshes.planar.triangulate import Indices

MISPLACED = 1e-3  # how far, in radii or sizes of the container, a tagged edge may lie off its body or wall


def read_mesh(
    path: Path, names: Sequence[str], container: Container, centres: Array, radii: Array, order: int,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
) -> FluidMesh:  # fmt: skip
    """Read a gmsh mesh of the fluid around discs; collective.

    The file needs a physical curve for each body and wall, of its name, and a physical surface of any name.
    Straight triangles are curved to `order` along the discs (and the arc `far`); curved ones are taken as
    they are.

    Raises:
        MeshFileError: unreadable file, missing or misplaced group, untagged boundary.
        MeshError: invalid cell.
    """

    def read() -> CurvedCells:
        try:
            if container.dimension == 3:
                raise MeshFileError("is a mesh in space, which cannot be read; leave domain.mesh out")
            return _cells(
                _read_gmsh(path), [*names, *boundary_names(container)], container, centres, radii, order
            )
        except MeshFileError as error:
            raise MeshFileError(f"domain.mesh = {path}: {error}") from error

    return shared(read, container, len(radii), comm)


def _read_gmsh(path: Path) -> meshio.Mesh:
    """The file as meshio gives it; what meshio prints is dropped."""
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            return meshio.gmsh.read(path)
    except Exception as error:  # a damaged file makes meshio raise errors of many kinds
        raise MeshFileError("cannot be read; give a .msh file written by gmsh") from error


def _cells(
    mesh: meshio.Mesh, names: Sequence[str], container: Container, centres: Array, radii: Array, order: int
) -> CurvedCells:
    """The cells of a file, with tags in our numbers: 1 + the place in `names`, of bodies and walls."""
    kinds = [k for k, name in enumerate(TRIANGLES) if name in mesh.cells_dict]
    if len(kinds) != 1:
        raise MeshFileError(
            f"has {len(kinds)} kinds of triangles; make the fluid a physical surface, of order 1 to 4"
        )
    own_order = kinds[0] + 1
    if own_order > order:
        raise MeshFileError(
            f"has triangles of order {own_order}; give discretisation.degree = {own_order} or more"
        )
    triangles = mesh.cells_dict[TRIANGLES[own_order - 1]].astype(np.int64)
    edges, tags = _tagged_edges(mesh, LINES[own_order - 1], names)
    used, numbers = np.unique(triangles, return_inverse=True)
    renumber = np.full(len(mesh.points), -1)
    renumber[used] = np.arange(len(used))
    triangles = numbers.reshape(triangles.shape)[:, np.argsort(gmsh_order(own_order))]
    nodes, edges = mesh.points[used, :2], renumber[edges]
    _require_boundary(triangles[:, :3], edges)
    _require_places(nodes[edges], tags, names, container, centres, radii)
    triangles = _counterclockwise(nodes, triangles, own_order)
    if own_order > 1:
        return CurvedCells(nodes, triangles, edges, tags, own_order)
    circles = [Curve(i + 1, np.empty((0, 2)), closed=True, centre=centre) for i, centre in enumerate(centres)]
    if "far" in names:
        circles.append(Curve(names.index("far") + 1, np.empty((0, 2)), closed=False, centre=np.zeros(2)))
    return curve(nodes, triangles, edges, tags, circles, order)


def _tagged_edges(mesh: meshio.Mesh, kind: str, names: Sequence[str]) -> tuple[Indices, Indices]:
    """Ends of the edges in the physical curves of these names, and the place of each name + 1."""
    curves = {name: tag for name, (tag, dimension) in mesh.field_data.items() if dimension == 1}
    edges = mesh.cells_dict.get(kind, np.empty((0, 2), dtype=int))[:, :2].astype(np.int64)
    physical = mesh.cell_data_dict.get("gmsh:physical", {}).get(kind, np.empty(0, dtype=int))
    tags = np.zeros(len(edges), dtype=np.int64)
    for k, name in enumerate(names):
        if name not in curves or not np.any(physical == curves[name]):
            raise MeshFileError(f"has no physical curve named {name}; it has {', '.join(curves) or 'none'}")
        tags[physical == curves[name]] = k + 1
    return edges[tags > 0], tags[tags > 0]


def _require_boundary(triangles: Indices, edges: Indices) -> None:
    """Every boundary edge must be tagged."""
    sides = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]), axis=1
    )
    found, count = np.unique(sides, axis=0, return_counts=True)
    boundary = {tuple(edge) for edge in found[count == 1].tolist()}
    tagged = {tuple(edge) for edge in np.sort(edges, axis=1).tolist()}
    if boundary != tagged:
        raise MeshFileError(
            f"{len(boundary - tagged)} boundary edges are in no group and {len(tagged - boundary)} edges in"
            " groups are not on the boundary; tag exactly the bodies and walls"
        )


def _require_places(
    ends: Array, tags: Indices, names: Sequence[str], container: Container, centres: Array, radii: Array
) -> None:
    """Tagged edges, their ends (E, 2, 2), must lie on their circle or wall."""
    for k, name in enumerate(names):
        x = ends[tags == k + 1].reshape(-1, 2)
        if k < len(radii):
            away, scale = np.hypot(*(x - centres[k]).T) - radii[k], radii[k]
        else:
            away, scale = boundary_distances(container, x)[:, k - len(radii)], container.size()
        worst = float(np.abs(away).max())
        if worst > MISPLACED * scale:
            raise MeshFileError(f"{name} lies up to {worst:.3g} off its place; correct the case or the mesh")


def _counterclockwise(nodes: Array, triangles: Indices, order: int) -> Indices:
    """The same triangles, clockwise ones mirrored."""
    a, b, c = (nodes[triangles[:, k]] for k in range(3))
    clockwise = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    X = reference_points(order)
    mirror = np.argmin(np.abs(X[:, None, ::-1] - X[None]).sum(axis=2), axis=1)
    return np.where(clockwise[:, None], triangles[:, mirror], triangles)
