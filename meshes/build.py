"""From bodies in a container to the distributed mesh of the fluid around them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib import import_module
from math import ceil
from typing import Protocol

import fsi.meshes.backend  # noqa: F401

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.meshes.cells.curved import SIMPLEX, CurvedCells, curve, require_valid
from fsi.meshes.errors import MeshError, TouchingError
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.matching import PeriodicPairs, matching_points
from fsi.meshes.helping import help_root, helped
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.planar.far_size import FarSize
from fsi.meshes.planar.grading import Grading
from fsi.meshes.planar.sizing import Curve
from fsi.meshes.planar.triangulate import StraightCells, places_of, side_keys, triangulate
from fsi.meshes.resolution import Resolution

# dolfinx's generic types at double precision.
type Mesh = dolfinx.mesh.Mesh[np.float64]
type FunctionSpace = fem.FunctionSpace[np.float64]

# How much faster sizes may grow in the fluid than along the walls.
SLOPE = 2.0
# Where a mesh is refused: what the growth is divided by in the plane, in space by what cells_per_circle and
# cells_per_gap are multiplied: of 80 coarse random meshes of orders 3 and 4 22 were valid at once, 36, 61, 71
# and 78 with one after the other of these, all with the last.
SLOWER, FINER = (2.0, 4.0), ((1.25, 1.0), (1.6, 1.0), (1.0, 2.0), (2.0, 2.0), (2.5, 1.0))


@dataclass(frozen=True, slots=True)
class FluidMesh:
    """The fluid domain Omega_F, meshed.

    Attributes:
        mesh: curved triangles, in space tetrahedra.
        facet_tags: body i has tag i + 1, wall k has tag N + 1 + k, the axis or the cut the one after these.
        bodies: N.
        container: what encloses the fluid, at the time of the mesh.
        order: of the cells.
        quality: worst scaled Jacobian of all cells.
        instead: the size that was taken as those of the case gave no valid mesh, "" where they did.
    """

    mesh: Mesh
    facet_tags: dolfinx.mesh.MeshTags
    bodies: int
    container: Container
    order: int
    quality: float
    instead: str = ""

    @property
    def lattice(self) -> Lattice:
        """Of the periods; the two sides of the cut differ by vectors of it."""
        return Lattice(self.container.periods)

    def wall_tag(self, wall: str) -> int:
        """Facet tag of a wall."""
        return self.bodies + 1 + self.container.walls.index(wall)

    @property
    def axis_tag(self) -> int:
        """Facet tag of the axis."""
        return self.bodies + 1 + len(self.container.walls)

    @property
    def cut_tag(self) -> int:
        """Facet tag of both sides of the cut; a periodic domain has no axis."""
        return self.axis_tag

    def moved(self, quality: float, container: Container) -> FluidMesh:
        """The same mesh, moved, with its new quality; the lattice may have moved too."""
        return replace(self, quality=quality, container=container)

    def scaled(self, factor: float, container: Container, shift: Array | float = 0.0) -> FluidMesh:
        """The same mesh, changed in place, all lengths times the factor, then moved; of this container."""
        self.mesh.geometry.x[:] *= factor
        self.mesh.geometry.x[:, : self.dimension] += shift
        return replace(self, container=container)

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return int(self.mesh.topology.dim)

    def cells(self) -> int:
        """Number of cells over all ranks."""
        return int(self.mesh.topology.index_map(self.dimension).size_global)


class Straight(Protocol):
    """Straight cells of a domain, from which those of any order are curved."""

    def curved(self, order: int) -> CurvedCells:
        """Cells of an order, valid or not. Raises MeshError."""
        ...


# The straight cells of one domain, by sizes.
type Made = dict[Resolution, Straight]


def build(domain: FluidDomain, resolution: Resolution, order: int, made: Made | None = None) -> FluidMesh:
    """Mesh the fluid around discs, or spheres in space, by cells of order 1 ... 6, in space 1 ... 4.

    Collective, rank 0 leads. Where sizes are coarse a cell that lies flat on a body can turn over when
    it is curved, and gmsh can lose a part of a boundary: then all is meshed again, with sizes that grow more
    slowly, in space with smaller elements on spheres and in gaps. Raises MeshError on all ranks if all fail.

    made: straight cells of this domain that are there; what rank 0 makes is put there.
    """
    make: Callable[[FluidDomain, Resolution], Straight] = _triangles
    if domain.container.dimension == 3:
        from fsi.meshes.spatial.tetrahedra import fill

        make, finer = fill, dict(_finer(resolution, *factors) for factors in FINER)
    else:
        growths = [resolution.growth / factor for factor in SLOWER]
        finer = {f"growth = {g:.4g}": replace(resolution, growth=g) for g in growths}
    kept = {} if made is None else made

    def cells(sizes: Resolution) -> CurvedCells:
        if sizes not in kept:
            kept[sizes] = make(domain, sizes)
        return kept[sizes].curved(order)

    tries = {f"discretisation.{size}": partial(cells, sizes) for size, sizes in finer.items()}
    return shared({"": partial(cells, resolution)} | tries, domain)


def _finer(resolution: Resolution, circle: float, gap: float) -> tuple[str, Resolution]:
    """Smaller elements on spheres and in gaps, and what differs."""
    around, across = ceil(circle * resolution.cells_per_circle), gap * resolution.cells_per_gap
    said = [f"cells_per_circle = {around}"] if circle > 1.0 else []
    said += [f"cells_per_gap = {across:.4g}"] if gap > 1.0 else []
    return " and ".join(said), replace(resolution, cells_per_circle=around, cells_per_gap=across)


@dataclass(frozen=True, slots=True)
class StraightTriangles:
    """Triangles and the curves that bound them."""

    cells: StraightCells
    curves: list[Curve]

    def curved(self, order: int) -> CurvedCells:
        """Cells of an order that follow the curves, valid or not."""
        return curve(self.cells, self.curves, order)


def _triangles(domain: FluidDomain, resolution: Resolution) -> StraightTriangles:
    curves = boundary(domain, resolution)
    h_body = resolution.on_body(float(domain.radii.max(initial=0.0)))
    slope, sparse = SLOPE * resolution.growth, resolution.interior == "sparse"
    grading = Grading.of(domain, resolution.growth)
    size, bodies = domain.container.size(), len(domain.radii)
    far = FarSize(bodies, h_body, slope, size, grading, alone=sparse, bent=domain.bent)
    return StraightTriangles(triangulate(curves, far), curves)


def shared(tries: Mapping[str, Callable[[], CurvedCells]], domain: FluidDomain) -> FluidMesh:
    """Make cells on rank 0, which others help, the first that are valid, and share them out; collective.

    tries: what makes cells, one after the other, by what is said of them. Raises the MeshError of the first
    on all ranks where none is valid, or at once where no other sizes would help.
    """
    # Python objects go by this one everywhere. What mpi4py hangs for them on a mesh's own copy cannot be
    # freed while an error is on its way, when the mesh may be: the program would not end.
    comm, container = MPI.COMM_WORLD, domain.container
    cells: CurvedCells | None = None
    problem: MeshError | None = None
    quality, order, instead = 0.0, 0, ""
    if comm.rank > 0:
        if container.dimension == 3:  # what all need later takes a quarter of a second to load
            import_module("scipy.spatial")
        help_root()
    else:
        with helped():
            cells, quality, instead, problem = _first_valid(tries)
        order = 0 if cells is None else cells.order
    problem, quality, order, instead = comm.bcast((problem, quality, order, instead))
    if problem is not None:
        raise problem
    # Each rank gives some of them, whichever: with all on one this alone would find which of them meet.
    parts = (
        None if cells is None else [np.array_split(each, comm.size) for each in (cells.cells, cells.nodes)]
    )
    topology, x = comm.scatter(None if parts is None else list(zip(*parts, strict=True)))
    element = coordinate_element(order, container.dimension)
    mesh = dolfinx.mesh.create_mesh(comm, topology, ufl.Mesh(element), x)
    tags = _facet_tags(mesh, *comm.bcast(None if cells is None else (cells.edges, cells.tags)))
    return FluidMesh(mesh, tags, len(domain.radii), container, order, quality, instead)


def _first_valid(
    tries: Mapping[str, Callable[[], CurvedCells]],
) -> tuple[CurvedCells, float, str, None] | tuple[None, float, str, MeshError]:
    """The first cells that are valid, their quality and what is said of them; or the first error."""
    problem: MeshError | None = None
    for said, make in tries.items():
        try:
            cells = make()
            return cells, require_valid(np.take(cells.nodes, cells.cells, axis=0), cells.order), said, None
        except TouchingError as error:
            return None, 0.0, "", error
        except MeshError as error:
            problem = problem or error
    assert problem is not None, "there is something to try"
    others = " and ".join(said for said in tries if said)
    return None, 0.0, "", problem.saying(f"; {others} did not help either") if others else problem


@cache
def coordinate_element(order: int, dimension: int = 2) -> basix.ufl._ElementBase:
    """The isoparametric element of the cells: equispaced nodes, as VTK and gmsh have them."""
    variant = basix.LagrangeVariant.equispaced
    return basix.ufl.element("Lagrange", SIMPLEX[dimension], order, variant, shape=(dimension,))


def _facet_tags(mesh: Mesh, edges: Indices, tags: Indices) -> dolfinx.mesh.MeshTags:
    """Tags of the boundary facets, recognised by the input numbers of their vertices."""
    dimension = mesh.topology.dim
    mesh.topology.create_entities(dimension - 1)
    mesh.topology.create_connectivity(dimension - 1, dimension)
    facets = dolfinx.mesh.exterior_facet_indices(mesh.topology)
    local = dolfinx.mesh.entities_to_geometry(mesh, dimension - 1, facets)[:, :dimension]
    ends = mesh.geometry.input_global_indices[local]
    n = int(edges.max()) + 1
    place, there = places_of(side_keys(ends, n), side_keys(edges, n))
    values = np.zeros(len(facets), dtype=np.int32)
    values[there] = tags[place]
    return dolfinx.mesh.meshtags(mesh, dimension - 1, facets, values)


def matching_nodes(fluid: FluidMesh, space: FunctionSpace, x: Array) -> PeriodicPairs:
    """The pairs of nodes x of a Lagrange space on the cut; collective, none without periods.

    Raises MeshError where a node on one side has none on the other.
    """
    comm, numbers = MPI.COMM_WORLD, space.dofmap.index_map
    if fluid.lattice.dimension == 0:
        nothing = np.empty(0, dtype=np.int64)
        return PeriodicPairs(nothing, nothing, nothing.reshape(0, 0))
    facets = fluid.facet_tags.find(fluid.cut_tag)
    nodes = fem.locate_dofs_topological(space, fluid.dimension - 1, facets)
    nodes = nodes[nodes < numbers.size_local]
    global_numbers = numbers.local_to_global(nodes.astype(np.int32)).astype(np.int64)
    parts = comm.allgather((global_numbers, x[nodes, : fluid.dimension]))
    every, on_cut = (np.concatenate([part[k] for part in parts]) for k in range(2))
    pairs = matching_points(on_cut, fluid.lattice)
    return PeriodicPairs(every[pairs.slave], every[pairs.master], pairs.shift)


def columns_of_masters(
    comm: MPI.Intracomm, master: NDArray[np.int64], rows: NDArray[np.int64], columns: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Which rows in `master` are unknowns, (n,), and their columns; collective.

    Args:
        comm: all ranks.
        master: global numbers of the rows asked for, perhaps of other ranks, (n,).
        rows: global numbers of this rank's rows that are unknowns.
        columns: of these.
    """
    wanted = np.concatenate(comm.allgather(master))
    asked = np.isin(rows, wanted)
    answers = comm.allgather((rows[asked], columns[asked]))
    row, column = (np.concatenate([part[k] for part in answers]) for k in range(2))
    place, known = places_of(master, row)
    return known, column[place]
