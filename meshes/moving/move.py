"""Carry a mesh along with the bodies, without gmsh.

The displacement d of the vertices extends those of the bodies harmonically,

    div( (1 / volume) grad d ) = 0,    d = displacement of body i on its surface,

where `volume`, in the plane the area, of the cell in the base mesh, makes small cells stiff. On the two sides
of the cut of a periodic domain d differs by what the lattice has moved. Nodes on discs and spheres, and in
the plane on the walls of a channel, slip along their surfaces where that saves the mesh (see `slip`); other
walls keep theirs. Curved nodes follow by linear interpolation; how far they are off a straight cell turns
with their body, so that discs and spheres stay exactly what they are. Every move starts from the base mesh:
it depends on where the bodies are, not on how they came there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from math import factorial

from fsi.meshes.backend import petsc_forms

import basix.ufl
import numpy as np
import scipy  # its modules load when they are used
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array
from fsi.meshes.build import FluidMesh, columns_of_masters, coordinate_element, matching_nodes
from fsi.meshes.cells.curved import SIMPLEX, WORST_ACCEPTED, determinant, scaled_jacobian
from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid
from fsi.meshes.geometry.images import to_images
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.rotations import turn_between, turned
from fsi.meshes.moving.slip import CurvedBoundaryCells, Extension, Slip, along, linear_weights

# A moved cell may differ from its base by this ratio of stretches at most, and keeps this scaled Jacobian, by
# dimension: in space that of a new mesh, for the flat cells of gaps begin with little more.
LARGEST_DISTORTION = 2.0
SMALLEST_JACOBIAN = {2: 0.2, 3: WORST_ACCEPTED}


class Mover:
    """Moves one base mesh and keeps its factorised Laplace matrix; `close` frees that."""

    def __init__(
        self,
        fluid: FluidMesh,
        centres: Array,
        placed: Sequence[Placed] = (),
        ellipsoids: Sequence[PlacedEllipsoid] = (),
    ) -> None:
        """Prepare to move `fluid`, which was built around bodies at `centres` (N, dimension); collective.

        placed: the bodies of the plane, if some are no discs, whose nodes turn with them; none of discs.
        ellipsoids: the same in space.
        """
        self.fluid = fluid
        self.centres = centres
        angles: list[float | Array] = [body.angle for body in placed]
        angles += [body.angle for body in ellipsoids]
        self.angles = np.array(angles) if angles else None
        self._x = fluid.mesh.geometry.x[:, : fluid.dimension].copy()
        self._vertices = fem.functionspace(fluid.mesh, vertex_element(fluid.dimension))
        self._inverse_sides = np.linalg.inv(_sides(self._x[fluid.mesh.geometry.dofmaps[0]]))
        tags = self._boundary_tags()
        self._curved = CurvedBoundaryCells.of(fluid, tags[self._vertices.dofmap.list], self._x)
        self._tags = tags[: self._vertices.dofmap.index_map.size_local]
        self._on_body = np.flatnonzero((self._tags >= 1) & (self._tags <= fluid.bodies))
        self._body = self._tags[self._on_body] - 1
        places = self._vertices.tabulate_dof_coordinates()[self._on_body, : fluid.dimension]
        self._to_image = fluid.lattice.shift(to_images(fluid.lattice, centres, placed, self._body, places))
        self._r = places - centres[self._body] - self._to_image
        self._slave, self._away, P = self._inside()
        stiffness, modes = self._laplace(), self._slip_modes()
        self._extension = Extension(stiffness, P)
        self._slip = None if modes is None else Slip(stiffness, P, modes, fluid.dimension)

    def close(self) -> None:
        """Free matrix and factors."""
        if self._slip is not None:
            self._slip.close()
        self._extension.close()

    def move(
        self,
        centres: Array,
        carried: Callable[[Array], Array] = np.copy,
        angles: Array | None = None,
    ) -> float | None:
        """Move the bodies to `centres` (N, dimension), shapes to `angles`; in place, collective.

        `carried` says what vectors (n, 2) between images have become. Gives the worst scaled Jacobian, or
        None (and the base mesh again) if the moved mesh is not good enough.
        """
        turned_by = None if angles is None or self.angles is None else turn_between(self.angles, angles)
        known, turns = self._known(centres - self.centres, carried, turned_by)
        geometry = self.fluid.mesh.geometry
        linear, d = linear_weights(self.fluid.order, self.fluid.dimension), self.fluid.dimension
        of_nodes = np.tensordot(self._at_corners(known), linear, axes=(1, 1)).transpose(0, 2, 1)
        if turns.any():
            of_nodes[self._curved.cells] += turned(self._curved.off_straight, turns[self._curved.body])
        geometry.x[geometry.dofmaps[0], :d] = self._x[geometry.dofmaps[0]] + of_nodes
        quality = self._quality()
        if quality is None:
            geometry.x[:, :d] = self._x
        return quality

    def _boundary_tags(self) -> NDArray[np.int32]:
        """Tag of each vertex, ghosts last, 0 inside. Vertices at the corner of walls have either's tag."""
        marker = fem.Function(self._vertices)
        facets, d = self.fluid.facet_tags, self.fluid.dimension
        for tag in range(1, self.fluid.bodies + len(self.fluid.container.walls) + 1):
            vertices = fem.locate_dofs_topological(self._vertices, d - 1, facets.find(tag))
            marker.x.array[vertices] = tag
        marker.x.scatter_forward()
        return np.rint(marker.x.array).astype(np.int32)

    def _laplace(self) -> PETSc.Mat:
        """Stiffness matrix with weights 1 / volume."""
        mesh, d = self.fluid.mesh, self.fluid.dimension
        form, weight = _stiffness_form(self.fluid.order, d)
        inverse_volume = fem.Function(fem.functionspace(mesh, cell_element(d)))
        sides = _sides(self._x[mesh.geometry.dofmaps[0]])
        inverse_volume.x.array[:] = factorial(d) / np.abs(determinant(sides))
        cells = np.arange(mesh.topology.index_map(d).size_local, dtype=np.int32)
        domain = {fem.IntegralType.cell: [(-1, cells)]}
        bound = fem.create_form(form, [self._vertices] * 2, mesh, domain, {weight: inverse_volume}, {})
        matrix = petsc_forms().assemble_matrix(bound)
        matrix.assemble()
        return matrix

    def _inside(self) -> tuple[NDArray[np.int64], Array, PETSc.Mat]:
        """Slaves on the cut, local rows, how far from their masters, and P: d = P y + what is given."""
        comm, numbers = MPI.COMM_WORLD, self._vertices.dofmap.index_map
        first, rows = numbers.local_range[0], numbers.size_local
        pairs = matching_nodes(self.fluid, self._vertices, self._vertices.tabulate_dof_coordinates())
        here = (pairs.slave >= first) & (pairs.slave < first + rows)
        here[here] = self._tags[pairs.slave[here] - first] == 0
        slave, away = pairs.slave[here] - first, self.fluid.lattice.shift(pairs.shift[here])
        free = self._tags == 0
        free[slave] = False
        unit = (comm.exscan(int(free.sum())) or 0) + np.arange(int(free.sum()))
        known, tied = columns_of_masters(comm, pairs.master[here], first + np.flatnonzero(free), unit)
        column = np.full(rows, -1)
        column[free], column[slave[known]] = unit, tied
        indptr = np.concatenate([[0], np.cumsum(column >= 0)]).astype(PETSc.IntType)
        entries = column[column >= 0].astype(PETSc.IntType)
        size, csr = ((rows, None), (len(unit), None)), (indptr, entries, np.ones(len(entries)))
        P = PETSc.Mat().createAIJ(size, csr=csr, comm=comm)
        return slave, away, P

    def _known(
        self, displacements: Array, carried: Callable[[Array], Array], turns: Array | None
    ) -> tuple[Array, Array]:
        """What is known of d at this rank's vertices, (n, d), and by what bodies' nodes turn, as angles are.

        turns: these where they are given.
        """
        known = np.zeros((len(self._tags), self.fluid.dimension))
        known[self._on_body] = displacements[self._body] + carried(self._to_image) - self._to_image
        known[self._slave] = carried(self._away) - self._away
        if turns is not None:
            known[self._on_body] += turned(self._r, turns[self._body])
            return known, turns
        if self._slip is None:
            return known, np.zeros(self.fluid.bodies)
        of_bodies = self.fluid.bodies * (3 if self.fluid.dimension == 3 else 1)
        turns, slides = np.split(self._slip.of(known), [of_bodies])
        if self.fluid.dimension == 3:
            turns = turns.reshape(-1, 3)
        known[self._on_body] += turned(self._r, turns[self._body])
        for k, slide in enumerate(slides):
            known[self._tags == self.fluid.bodies + 1 + k] = slide * along(self.fluid.lattice)
        return known, turns

    def _slip_modes(self) -> scipy.sparse.csr_matrix | None:
        """Discs and spheres turn, and the walls of a channel slide; None with an axis, and with outlines."""
        fluid = self.fluid
        if self.angles is not None or fluid.container.axisymmetric or fluid.bodies == 0:
            return None
        if fluid.dimension == 3:
            return self._turns_of_spheres()
        quarter = np.column_stack([-self._r[:, 1], self._r[:, 0]])
        sliding = len(fluid.container.walls) if fluid.lattice.dimension == 1 else 0
        on_wall = np.flatnonzero((self._tags > fluid.bodies) & (self._tags <= fluid.bodies + sliding))
        direction = np.tile(along(fluid.lattice), (len(on_wall), 1))
        vertex, mode = np.append(self._on_body, on_wall), np.append(self._body, self._tags[on_wall] - 1)
        rows, by = 2 * vertex[:, None] + np.arange(2), np.concatenate([quarter, direction])
        size = (2 * len(self._tags), fluid.bodies + sliding)
        return scipy.sparse.csr_matrix((by.ravel(), (rows.ravel(), np.repeat(mode, 2))), size)

    def _turns_of_spheres(self) -> scipy.sparse.csr_matrix:
        """theta_i x r on sphere i: three modes for each, (3 vertices, 3 N)."""
        by = np.cross(np.eye(3), self._r[:, None])  # mode, component
        rows = np.broadcast_to(3 * self._on_body[:, None, None] + np.arange(3), by.shape)
        columns = np.broadcast_to(3 * self._body[:, None, None] + np.arange(3)[:, None], by.shape)
        size = (3 * len(self._tags), 3 * self.fluid.bodies)
        return scipy.sparse.csr_matrix((by.ravel(), (rows.ravel(), columns.ravel())), size)

    def _at_corners(self, known: Array) -> Array:
        """Displacements of the corners of this rank's cells (T, d + 1, d) from what is known at vertices."""
        result, components = fem.Function(self._vertices), []
        for component in known.T:
            result.x.array[: len(known)] = self._extension(component)[1]
            result.x.scatter_forward()
            components.append(result.x.array[self._vertices.dofmap.list])
        return np.stack(components, axis=2)

    def _quality(self) -> float | None:
        """Worst scaled Jacobian over all ranks, None if a cell is distorted too much."""
        mesh = self.fluid.mesh
        x = mesh.geometry.x[mesh.geometry.dofmaps[0]][:, :, : self.fluid.dimension]
        worst = float(scaled_jacobian(x, self.fluid.order).min(initial=1.0))
        distortion = float(_distortion(_sides(x) @ self._inverse_sides).max(initial=1.0))
        worst = MPI.COMM_WORLD.allreduce(worst, op=MPI.MIN)
        distortion = MPI.COMM_WORLD.allreduce(distortion, op=MPI.MAX)
        least = SMALLEST_JACOBIAN[self.fluid.dimension]
        return worst if worst >= least and distortion <= LARGEST_DISTORTION else None


def vertex_element(dimension: int) -> basix.ufl._ElementBase:
    """Continuous linear functions."""
    return basix.ufl.element("Lagrange", SIMPLEX[dimension], 1)


def cell_element(dimension: int = 2) -> basix.ufl._ElementBase:
    """Functions constant on each cell."""
    return basix.ufl.element("Discontinuous Lagrange", SIMPLEX[dimension], 0)


@cache
def _stiffness_form(order: int, dimension: int) -> tuple[fem.forms.CompiledForm, ufl.Coefficient]:
    """`int w grad d . grad v`, compiled without a mesh, and its weight w."""
    omega = ufl.Mesh(coordinate_element(order, dimension))
    space = ufl.FunctionSpace(omega, vertex_element(dimension))
    w = ufl.Coefficient(ufl.FunctionSpace(omega, cell_element(dimension)))
    d, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    dx = ufl.dx(omega, metadata={"quadrature_degree": dimension * (order - 1)})
    form = w * ufl.inner(ufl.grad(d), ufl.grad(v)) * dx
    return fem.compile_form(MPI.COMM_WORLD, form), w


def _sides(x: Array) -> Array:
    """The d sides of each cell (T, nodes, d) that leave its first corner, as columns, (T, d, d)."""
    sides: Array = (x[:, 1 : x.shape[2] + 1] - x[:, :1]).transpose(0, 2, 1)
    return sides


def _distortion(gradients: Array) -> Array:
    """Ratio of the largest to the smallest stretch of deformation gradients (T, d, d), (T,)."""
    if gradients.shape[-1] == 2:
        # s1^2 + s2^2 = sum of squares, s1 s2 = |det|: ten times as fast as LAPACK.
        squares, area = np.square(gradients).sum(axis=(1, 2)), np.abs(determinant(gradients))
        # A flat cell has no finite ratio; 1e100 is as much too large, and its square a number.
        half = 0.5 * squares / np.maximum(area, 1e-100)
        of_two: Array = half + np.sqrt(np.maximum(half**2 - 1.0, 0.0))
        return of_two
    stretches = np.linalg.svd(gradients, compute_uv=False)
    ratio: Array = stretches[:, 0] / stretches[:, -1]
    return ratio
