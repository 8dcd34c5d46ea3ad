"""Nodes that may slip along their surfaces: how far circles and spheres turn and walls slide as a mesh moves.

Nobody sees where on a circle or a sphere its nodes are, nor on a straight wall along the period of a
channel. When bodies are displaced by s_i, they turn by theta_i and walls slide by sigma_k, so that the mesh
is distorted least: of all

    d = s_i + theta_i e_z x r   on disc i,      d = sigma_k e   on wall k,  e along the period,
    d = s_i + theta_i x r       on sphere i,

those for which the energy  int (1 / area) |grad d|^2  of the harmonic extension is smallest. Two discs that
go round each other then carry the mesh in their gap along as it is, where it would be sheared by their way
over the gap; in a dense sheared suspension that is thirty times as much. The curved cells around a body turn
with the nodes on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import fsi.meshes.backend  # noqa: F401

import numpy as np
import scipy  # its modules load when they are used
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array
from fsi.meshes.build import FluidMesh
from fsi.meshes.cells.curved import barycentric, reference_points
from fsi.meshes.geometry.lattice import Lattice


def unfactorised(matrix: PETSc.Mat) -> PETSc.KSP:
    """The solver for a symmetric matrix, whose factors are still to be made."""
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(matrix)
    solver.setType(PETSc.KSP.Type.PREONLY)
    pc = solver.getPC()
    pc.setType(PETSc.PC.Type.CHOLESKY)
    pc.setFactorSolverType("mumps")
    pc.destroy()  # handles hold references: undestroyed they leak megabytes a step in parallel
    return solver


class Extension:
    """Extends what is known of d such that d^T K d is smallest; `close` frees K, P and the factors."""

    def __init__(self, K: PETSc.Mat, P: PETSc.Mat) -> None:
        """Factorise P^T K P; P takes the unknowns y to d = known + P y."""
        self._K, self._P = K, P
        inside = K.ptap(P)
        self._solver = unfactorised(inside)
        self._solver.setUp()
        inside.destroy()

    def __call__(self, known: Array) -> tuple[Array, Array]:
        """This rank's rows of y and of d; `known` is zero where d is free."""
        Py, load = self._K.createVecs()
        y, rhs = self._P.createVecRight(), self._P.createVecRight()
        load.array[:] = -known
        self._K.mult(load, Py)
        self._P.multTranspose(Py, rhs)
        self._solver.solve(rhs, y)
        self._P.mult(y, Py)
        result = y.array.copy(), known + Py.array
        for vector in (Py, load, y, rhs):
            vector.destroy()
        return result

    def close(self) -> None:
        """Free matrices and factors."""
        for used in (self._solver, self._K, self._P):
            used.destroy()


@dataclass(frozen=True, slots=True)
class CurvedBoundaryCells:
    """This rank's cells with an edge on a body.

    Attributes:
        cells: their numbers, (n,).
        body: whose edge it is, (n,); in space, where a cell may have edges on two bodies, of each node that
            on which two corners of its side lie, (n, nodes).
        off_straight: how far their nodes are from where a straight cell has them, (n, nodes, d).
    """

    cells: NDArray[np.intp]
    body: NDArray[np.intp]
    off_straight: Array

    @staticmethod
    def of(fluid: FluidMesh, tags: NDArray[np.int32], x: Array) -> CurvedBoundaryCells:
        """Those of a mesh.

        The tags are those of the corners of this rank's cells, (T, d + 1), 0 inside; x are the nodes, (n, d).
        """
        ordered = np.sort(tags, axis=1)
        # Corners of one disc alone belong to an edge on it: two discs never share a triangle's three corners.
        twice = np.where(ordered[:, 1:] == ordered[:, :-1], ordered[:, 1:], 0)
        twice[twice > fluid.bodies] = 0
        body = twice.max(axis=1)
        cells = np.flatnonzero(body)
        nodes = x[fluid.mesh.geometry.dofmaps[0][cells]]
        weights = linear_weights(fluid.order, fluid.dimension)
        straight = np.einsum("kc,tcd->tkd", weights, nodes[:, : fluid.dimension + 1])
        of_nodes = body[cells]
        if fluid.dimension == 3:
            beside = np.sort(np.where(weights > 0.0, tags[cells][:, None], 0), axis=2)
            on_two = (beside[..., 1:] == beside[..., :-1]) & (beside[..., 1:] <= fluid.bodies)
            # Where no two corners are on one body the node is that of a straight cell, whichever is meant.
            of_nodes = np.maximum(np.where(on_two, beside[..., 1:], 0).max(axis=2), 1)
        return CurvedBoundaryCells(cells, of_nodes - 1, nodes - straight)


def along(lattice: Lattice) -> Array:
    """The direction of the only period, (2,); zero where there is none, or two."""
    if lattice.dimension != 1:
        return np.zeros(2)
    direction: Array = lattice.vectors[0] / lattice.longest()
    return direction


@cache
def linear_weights(order: int, dimension: int) -> Array:
    """Barycentric coordinates of the cell's nodes, (nodes, dimension + 1)."""
    return barycentric(reference_points(order, dimension))


class Slip:
    """Finds the slip of least distortion; `close` frees the factors."""

    def __init__(
        self, stiffness: PETSc.Mat, P: PETSc.Mat, modes: scipy.sparse.csr_matrix, dimension: int
    ) -> None:
        """Prepare.

        Args:
            stiffness: of `int (1 / area) grad d . grad v`, for one component of d at all vertices.
            P: its vertices by the free ones.
            modes: by which slipping moves this rank's vertices, none of them free, (d vertices, modes).
            dimension: d.
        """
        d = dimension
        self._comm, self._free = MPI.COMM_WORLD, d * P.getLocalSize()[1]
        # Rank 0 owns the modes, after its own free vertices.
        before = self._comm.bcast(self._free)
        free = _of_all(P, d)
        every = scipy.sparse.hstack([free[:, :before], modes, free[:, before:]], "csr")
        columns_here = self._free + (modes.shape[1] if self._comm.rank == 0 else 0)
        K = _matrix(_of_all(stiffness, d), d * stiffness.getLocalSize()[1], stiffness)
        self._extension = Extension(K, _matrix(every, columns_here, stiffness))
        self.close = self._extension.close

    def of(self, known: Array) -> Array:
        """How far each mode slips, on all ranks.

        Args:
            known: displacements (n, d) of this rank's vertices without slips, zero where they are free.
        """
        y, _ = self._extension(known.ravel())
        amounts: Array = self._comm.bcast(y[self._free :])
        return amounts


def _of_all(matrix: PETSc.Mat, components: int) -> scipy.sparse.csr_matrix:
    """This rank's rows of a matrix that acts on each of some components, which lie side by side."""
    indptr, indices, values = matrix.getValuesCSR()
    rows = scipy.sparse.csr_matrix((values, indices, indptr), (len(indptr) - 1, matrix.getSize()[1]))
    return scipy.sparse.kron(rows, scipy.sparse.eye_array(components), "csr")


def _matrix(rows: scipy.sparse.csr_matrix, columns_here: int, like: PETSc.Mat) -> PETSc.Mat:
    """The distributed matrix with these rows of this rank."""
    csr = (rows.indptr.astype(PETSc.IntType), rows.indices.astype(PETSc.IntType), rows.data)
    size = ((rows.shape[0], None), (columns_here, rows.shape[1]))
    return PETSc.Mat().createAIJ(size, csr=csr, comm=like.comm)
