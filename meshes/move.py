"""Carry a mesh along with the bodies, without gmsh.

The displacement d of the vertices extends those of the bodies harmonically,

    div( (1 / area) grad d ) = 0,    d = displacement of body i on its surface,  d = 0 on the walls,

where `area`, of the cell in the base mesh, makes small cells stiff. Curved nodes follow by linear
interpolation, so that a disc, whose own rotation nobody sees, stays exactly a disc. Every move starts
from the base mesh: it depends on where the bodies are, not on how they came there.
"""

from __future__ import annotations

from functools import cache

import meshes.backend  # noqa: F401

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from meshes.build import FluidMesh, coordinate_element
from meshes.curved import reference_points
from meshes.geometry import Array
from meshes.quality import scaled_jacobian

# A moved cell may differ from its base by this ratio of stretches at most, and keeps this scaled Jacobian.
LARGEST_DISTORTION = 2.0
SMALLEST_JACOBIAN = 0.2


class Mover:
    """Moves one base mesh and keeps its factorised Laplace matrix; `close` frees that."""

    def __init__(self, fluid: FluidMesh, centres: Array) -> None:
        """Prepare to move `fluid`, which was built around bodies at `centres` (N, 2); collective."""
        self.fluid = fluid
        self.centres = centres
        self._x = fluid.mesh.geometry.x[:, :2].copy()
        self._vertices = fem.functionspace(fluid.mesh, vertex_element())
        self._tags = self._boundary_tags()
        self._stiffness = self._laplace()
        self._solver = _factorised(self._stiffness, np.flatnonzero(self._tags))

    def close(self) -> None:
        """Free matrix and factors."""
        self._solver.destroy()
        self._stiffness.destroy()

    def move(self, centres: Array) -> float | None:
        """Move the bodies to `centres` (N, 2), in place; collective.

        Returns:
            the worst scaled Jacobian, or None (and the base mesh again) if the moved mesh is not good enough.
        """
        d = self._extension(centres - self.centres)
        geometry = self.fluid.mesh.geometry
        linear = _linear_weights(self.fluid.order)
        geometry.x[geometry.dofmaps[0], :2] = self._x[geometry.dofmaps[0]] + np.einsum(
            "nv,tvd->tnd", linear, d
        )
        quality = self._quality()
        if quality is None:
            geometry.x[:, :2] = self._x
        return quality

    def _boundary_tags(self) -> NDArray[np.int32]:
        """Tag of each owned vertex, 0 inside. Vertices at the corner of two walls have either's tag."""
        marker = fem.Function(self._vertices)
        for tag in range(1, self.fluid.bodies + len(self.fluid.walls) + 1):
            marker.x.array[
                fem.locate_dofs_topological(self._vertices, 1, self.fluid.facet_tags.find(tag))
            ] = tag
        owned = self._vertices.dofmap.index_map.size_local
        return np.rint(marker.x.array[:owned]).astype(np.int32)

    def _laplace(self) -> PETSc.Mat:
        """Stiffness matrix with weights 1 / area."""
        mesh = self.fluid.mesh
        form, weight = _stiffness_form(self.fluid.order)
        inverse_area = fem.Function(fem.functionspace(mesh, cell_element()))
        a, b = _sides(self._x[mesh.geometry.dofmaps[0]])
        inverse_area.x.array[:] = 2.0 / np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        cells = np.arange(mesh.topology.index_map(2).size_local, dtype=np.int32)
        domain = {fem.IntegralType.cell: [(-1, cells)]}
        matrix = assemble_matrix(
            fem.create_form(form, [self._vertices] * 2, mesh, domain, {weight: inverse_area}, {})
        )
        matrix.assemble()
        return matrix

    def _extension(self, displacements: Array) -> Array:
        """Displacements of the corners of this rank's cells, (T, 3, 2), from those of the bodies (N, 2)."""
        tags = self._tags
        moved = (tags >= 1) & (tags <= self.fluid.bodies)
        result = fem.Function(self._vertices)
        corners = np.empty((len(self._vertices.dofmap.list), 3, 2))
        given, rhs = self._stiffness.createVecRight(), self._stiffness.createVecLeft()
        solution = given.duplicate()
        for axis in range(2):
            boundary = np.zeros(len(tags))
            boundary[moved] = displacements[tags[moved] - 1, axis]
            given.array[:] = boundary
            self._stiffness.mult(given, rhs)
            rhs.array[:] = np.where(tags > 0, boundary, -rhs.array)
            self._solver.solve(rhs, solution)
            result.x.array[: len(tags)] = solution.array
            result.x.scatter_forward()
            corners[:, :, axis] = result.x.array[self._vertices.dofmap.list]
        for vector in (given, rhs, solution):
            vector.destroy()
        return corners

    def _quality(self) -> float | None:
        """Worst scaled Jacobian over all ranks, None if a cell is distorted too much."""
        mesh = self.fluid.mesh
        x = mesh.geometry.x[mesh.geometry.dofmaps[0]][:, :, :2]
        worst = float(scaled_jacobian(x, self.fluid.order).min(initial=1.0))
        before, after = (np.stack(_sides(y), axis=2) for y in (self._x[mesh.geometry.dofmaps[0]], x))
        stretches = np.linalg.svd(after @ np.linalg.inv(before), compute_uv=False)
        distortion = float((stretches[:, 0] / stretches[:, 1]).max(initial=1.0))
        worst = mesh.comm.allreduce(worst, op=MPI.MIN)
        distortion = mesh.comm.allreduce(distortion, op=MPI.MAX)
        return worst if worst >= SMALLEST_JACOBIAN and distortion <= LARGEST_DISTORTION else None


def vertex_element() -> basix.ufl._ElementBase:
    """Continuous linear functions."""
    return basix.ufl.element("Lagrange", "triangle", 1)


def cell_element() -> basix.ufl._ElementBase:
    """Functions constant on each cell."""
    return basix.ufl.element("Discontinuous Lagrange", "triangle", 0)


@cache
def _stiffness_form(order: int) -> tuple[fem.forms.CompiledForm, ufl.Coefficient]:
    """`int w grad d . grad v`, compiled without a mesh, and its weight w."""
    omega = ufl.Mesh(coordinate_element(order))
    space = ufl.FunctionSpace(omega, vertex_element())
    w = ufl.Coefficient(ufl.FunctionSpace(omega, cell_element()))
    d, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    form = (
        w
        * ufl.inner(ufl.grad(d), ufl.grad(v))
        * ufl.dx(omega, metadata={"quadrature_degree": 2 * (order - 1)})
    )
    return fem.compile_form(MPI.COMM_WORLD, form), w


def _factorised(stiffness: PETSc.Mat, boundary: NDArray[np.intp]) -> PETSc.KSP:
    """Solver with the stiffness matrix inside and unit rows at the owned boundary vertices."""
    inside = stiffness.copy()
    first, _ = inside.getOwnershipRange()
    inside.zeroRowsColumns((boundary + first).astype(PETSc.IntType), 1.0)
    solver = PETSc.KSP().create(inside.comm)
    solver.setOperators(inside)
    solver.setType(PETSc.KSP.Type.PREONLY)
    pc = solver.getPC()
    pc.setType(PETSc.PC.Type.CHOLESKY)
    pc.setFactorSolverType("mumps")
    solver.setUp()
    pc.destroy()
    inside.destroy()
    return solver


def _sides(x: Array) -> tuple[Array, Array]:
    """The two sides of each cell (T, nodes, 2) that leave its first corner, (T, 2) each."""
    return x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]


@cache
def _linear_weights(order: int) -> Array:
    """Barycentric coordinates of the cell's nodes, (nodes, 3)."""
    X = reference_points(order)
    return np.column_stack([1.0 - X.sum(axis=1), X])
