"""Read a user's own gmsh mesh, or the mesh of any step of a run back from its field files, through meshio.

Field files hold the curved cells, of one rank each; the tags of the boundary follow from where bodies and
walls were.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import fsi.meshes.backend  # noqa: F401

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array, Indices
from fsi.meshes.build import FluidMesh, shared
from fsi.meshes.cells.curved import CurvedCells, curve, reference_points
from fsi.meshes.cells.lagrange import order_of
from fsi.meshes.errors import MeshFileError, at
from fsi.meshes.files.write import LINES, TRIANGLES, VTK_SIMPLICES, gmsh_order, vtk_order
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.planar.sizing import Curve
from fsi.meshes.planar.triangulate import StraightCells, boundary_sides, clockwise

if TYPE_CHECKING:
    import meshio

MISPLACED = 1e-3  # how far, in radii or sizes of the container, a tagged edge may lie off its body or wall


def read_mesh(path: Path, names: Sequence[str], domain: FluidDomain, order: int) -> FluidMesh:
    """Read a gmsh mesh of the fluid around bodies in the plane or on an axis; collective.

    The file needs a physical curve for each body and wall, of its name, and a physical surface of any name.
    Straight triangles are curved to `order` along the circles and round walls; curved ones are taken as they
    are.

    The names are those of the bodies, the order 1 ... 6. Raises MeshFileError for any mesh in space, an
    unreadable file, a missing or misplaced group, an untagged boundary, and MeshError for an invalid cell.
    """

    def read() -> CurvedCells:
        try:
            if domain.container.dimension == 3:
                raise MeshFileError("is a mesh in space, which cannot be read; leave domain.mesh out")
            return _cells(_read_gmsh(path), [*names, *domain.container.boundary_names], domain, order)
        except MeshFileError as error:
            raise MeshFileError(f"domain.mesh = {path}: {error}") from error

    return shared({"": read}, domain)


def _read_gmsh(path: Path) -> meshio.Mesh:
    """The file as meshio gives it; what meshio prints is dropped."""
    import meshio  # takes a tenth of a second to load

    unread = MeshFileError("cannot be read; give a .msh file written by gmsh")
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            mesh = meshio.gmsh.read(path)
    except Exception as error:  # a damaged file makes meshio raise errors of many kinds
        raise unread from error
    if not mesh.cells:  # of some a head is enough for it
        raise unread
    return mesh


def _cells(mesh: meshio.Mesh, names: Sequence[str], domain: FluidDomain, order: int) -> CurvedCells:
    """The cells of a file, with tags in our numbers: 1 + the place in `names`, of bodies and walls."""
    curves = _physical_curves(mesh, names)
    kinds = [k for k, name in enumerate(TRIANGLES) if name in mesh.cells_dict]
    if len(kinds) != 1:
        has = "triangles of several orders" if kinds else "no triangles"
        raise MeshFileError(
            f"has {has}; make the fluid a physical surface, of one order, 1 to {len(TRIANGLES)}"
        )
    degree = kinds[0] + 1
    if degree > order:
        raise MeshFileError(f"has triangles of order {degree}; give discretisation.degree = {degree} or more")
    triangles = mesh.cells_dict[TRIANGLES[kinds[0]]].astype(np.int64)
    edges, tags = _tagged_edges(mesh, LINES[kinds[0]], curves)
    used, numbers = np.unique(triangles, return_inverse=True)
    renumber = np.full(len(mesh.points), -1)
    renumber[used] = np.arange(len(used))
    triangles = numbers.reshape(triangles.shape)[:, np.argsort(gmsh_order(degree, 2))]
    nodes, edges = mesh.points[used, :2], renumber[edges]
    _require_boundary(triangles[:, :3], edges)
    _require_places(nodes[edges], tags, names, domain)
    triangles = _counterclockwise(nodes, triangles, degree)
    if degree > 1:
        return CurvedCells(nodes, triangles, edges, tags, degree)
    walls = zip(domain.container.walls, domain.container.spheres, strict=True)
    centres = dict(enumerate(domain.centres))
    centres |= {names.index(wall): sphere.centre for wall, sphere in walls if sphere is not None}
    circles = [Curve(k + 1, np.empty((0, 2)), centre=x) for k, x in centres.items()]
    return curve(StraightCells(nodes, triangles, edges, tags), circles, order)


def _physical_curves(mesh: meshio.Mesh, names: Sequence[str]) -> dict[str, int]:
    """The number of the physical curve of each of these names. Raises MeshFileError: there is none."""
    curves = {name: tag for name, (tag, dimension) in mesh.field_data.items() if dimension == 1}
    for name in names:
        if name not in curves:
            raise MeshFileError(f"has no physical curve named {name}; it has {', '.join(curves) or 'none'}")
    return {name: curves[name] for name in names}


def _tagged_edges(mesh: meshio.Mesh, kind: str, curves: dict[str, int]) -> tuple[Indices, Indices]:
    """Ends of the edges in these physical curves, and the place of the curve of each + 1."""
    edges = mesh.cells_dict.get(kind, np.empty((0, 2), dtype=int))[:, :2].astype(np.int64)
    physical = mesh.cell_data_dict.get("gmsh:physical", {}).get(kind, np.empty(0, dtype=int))
    tags = np.zeros(len(edges), dtype=np.int64)
    for k, (name, number) in enumerate(curves.items()):
        if not np.any(physical == number):
            raise MeshFileError(f"has no edges in the physical curve {name}; put those of {name} there")
        tags[physical == number] = k + 1
    return edges[tags > 0], tags[tags > 0]


def _require_boundary(triangles: Indices, edges: Indices) -> None:
    boundary = {tuple(edge) for edge in boundary_sides(triangles).tolist()}
    tagged = {tuple(edge) for edge in np.sort(edges, axis=1).tolist()}
    if boundary != tagged:
        raise MeshFileError(
            f"{len(boundary - tagged)} boundary edges are in no group and {len(tagged - boundary)} edges in"
            " groups are not on the boundary; tag exactly the bodies and walls"
        )


def _require_places(ends: Array, tags: Indices, names: Sequence[str], domain: FluidDomain) -> None:
    """Tagged edges, their ends (E, 2, 2), must lie on their circle or wall."""
    bodies = len(domain.radii)
    for k, name in enumerate(names):
        x = ends[tags == k + 1].reshape(-1, 2)
        if k < bodies:
            scale = domain.radii[k]
            away = np.hypot(*(x - domain.centres[k]).T) - scale
        else:
            scale = domain.container.size()
            away = domain.container.boundary_distances(x)[:, k - bodies]
        worst = float(np.abs(away).max())
        if worst > MISPLACED * scale:
            raise MeshFileError(f"{name} lies up to {worst:.3g} off its place; correct the case or the mesh")


def _counterclockwise(nodes: Array, triangles: Indices, order: int) -> Indices:
    """The same triangles, clockwise ones mirrored."""
    X = reference_points(order)
    mirror = np.argmin(np.abs(X[:, None, ::-1] - X[None]).sum(axis=2), axis=1)
    return np.where(clockwise(nodes, triangles)[:, None], triangles[:, mirror], triangles)


# Ranks share nodes to rounding; ends of a boundary edge lie on their body or wall nearly so.
SAME_NODE = 1e-13
ON_SURFACE = 1e-8
_REMEDY = "run the case again, or ask for another step"  # `fsi resume` does not look at field files


def recover(parts: Sequence[Path], domain: FluidDomain) -> CurvedCells:
    """The cells in the field files of one step, with their boundary tagged as in `FluidMesh`.

    The parts are the VTU files of all ranks. Raises MeshFileError where a file cannot be read, or its
    boundary is not that of the bodies and walls of the domain at that step.
    """
    pieces, first, d = [], 0, domain.container.dimension
    for part in parts:
        x, simplices = _read_vtu(part, d)
        pieces.append((x, simplices + first))
        first += len(x)
    x, cells = (np.concatenate([piece[k] for piece in pieces]) for k in range(2))
    x, cells = _merged(x, cells, SAME_NODE * domain.container.size())
    cells = cells[:, np.argsort(vtk_order(cells.shape[1], d))]
    order = order_of(cells.shape[1], d)
    edges = boundary_sides(cells[:, : d + 1])
    return CurvedCells(x, cells, edges, _tags(x[edges], domain), order)


def _read_vtu(path: Path, d: int) -> tuple[Array, Indices]:
    """Nodes (n, d) and simplices of a field file."""
    import meshio  # takes a tenth of a second to load

    if not path.is_file():
        raise MeshFileError(f"{path}: is not there, or no file; {_REMEDY}")
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            mesh = meshio.vtu.read(path)
        x, simplices = mesh.points[:, :d], mesh.cells_dict[VTK_SIMPLICES[d - 1]].astype(np.int64)
        if not np.isfinite(x).all() or simplices.min() < 0 or simplices.max() >= len(x):
            raise MeshFileError("its cells join nodes that it has not")
    except Exception as error:  # a damaged file makes meshio raise errors of many kinds
        told = " ".join(f"{type(error).__name__} {error}".split())[:200]
        raise MeshFileError(f"{path}: cannot be read ({told}); {_REMEDY}") from None
    return x, simplices


def _merged(x: Array, cells: Indices, distance: float) -> tuple[Array, Indices]:
    """Nodes that coincide become one."""
    same = np.arange(len(x))
    pairs = scipy.spatial.cKDTree(x).query_pairs(distance, output_type="ndarray")
    np.minimum.at(same, pairs.max(axis=1), pairs.min(axis=1))
    distinct, number = np.unique(same, return_inverse=True)
    return x[distinct], number[cells]


def _tags(ends: Array, domain: FluidDomain) -> Indices:
    """The body or wall that all corners of each facet (E, d, d) lie on; the rest is the cut, if any."""
    container, radii = domain.container, domain.radii
    tags, lattice = np.zeros(len(ends), dtype=np.int64), Lattice(container.periods)
    centres = lattice.wrapped(domain.centres)
    home = lattice.wrapped(ends.mean(axis=1))
    ends = ends - (ends.mean(axis=1) - home)[:, None]
    middles = scipy.spatial.cKDTree(home)
    reach = 2.0 * float(radii.max()) if domain.placed else 0.0
    for i, m in product(range(len(radii)), lattice.near(reach)):
        centre, radius = centres[i] + lattice.shift(m[None])[0], radii[i]
        near = np.array(middles.query_ball_point(centre, radius * (1.0 + ON_SURFACE)), dtype=np.intp)
        if domain.placed:
            off, _ = domain.placed[i].moved(centre).signed_distance(ends[near].reshape(-1, 2))
            away = np.abs(off).reshape(-1, 2).max(axis=1, initial=0.0)
        elif domain.ellipsoids:
            off = domain.ellipsoids[i].off(ends[near].reshape(-1, 3))
            away = np.abs(off).reshape(-1, 3).max(axis=1, initial=0.0)
        else:
            away = np.abs(np.hypot.reduce(ends[near] - centre, axis=2) - radius).max(axis=1, initial=0.0)
        tags[near[away < ON_SURFACE * radius]] = i + 1
    corners = np.moveaxis(ends, 1, 0)
    to_walls = np.abs(np.stack([container.boundary_distances(x) for x in corners])).max(axis=0)
    if to_walls.shape[1]:
        wall = to_walls.argmin(axis=1)
        on_wall = (tags == 0) & (to_walls.min(axis=1) < ON_SURFACE * container.size())
        tags[on_wall] = len(radii) + 1 + wall[on_wall]
    if lattice.dimension:
        tags[tags == 0] = len(radii) + 1 + len(container.walls)
    if not tags.all():
        lost = ends[np.flatnonzero(tags == 0)[0]].mean(axis=0)
        raise MeshFileError(f"the boundary at {at(lost)} is on no body or wall; is it another run's file?")
    return tags
