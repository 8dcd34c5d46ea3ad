"""Nodes that may slip along their surfaces: how far circles turn and walls slide when a mesh is moved.

Nobody sees where on a circle its nodes are, nor on a straight wall along the period of a channel. When discs
are displaced by s_i, their circles turn by theta_i and the walls slide by sigma_k, so that the mesh is
distorted least: of all

    d = s_i + theta_i e_z x r   on disc i,      d = sigma_k e   on wall k,  e along the period,

those for which the energy  int (1 / area) |grad d|^2  of the harmonic extension is smallest. Two discs that
go round each other then carry the mesh in their gap along as it is, where it would be sheared by their way
over the gap; in a dense sheared suspension that is thirty times as much. The curved cells around a disc turn
with the nodes on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import fsi.meshes.backend  # noqa: F401

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.meshes.build import FluidMesh
from fsi.meshes.cells.curved import barycentric, reference_points
from fsi.meshes.geometry.containers import Array
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


def factorised(stiffness: PETSc.Mat, P: PETSc.Mat) -> PETSc.KSP:
    """Solver for P^T K P, to be destroyed by the caller."""
    inside = stiffness.ptap(P)
    solver = unfactorised(inside)
    solver.setUp()
    inside.destroy()
    return solver


@dataclass(frozen=True, slots=True)
class CurvedBoundaryCells:
    """This rank's cells with an edge on a disc.

    Attributes:
        cells: their numbers, (n,).
        body: whose edge it is, (n,).
        off_straight: how far their nodes are from where a straight cell has them, (n, nodes, 2).
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
        return CurvedBoundaryCells(cells, body[cells] - 1, nodes - straight)


def turned(r: Array, angle: Array) -> Array:
    """What vectors r (n, ..., 2) change by if they turn by angles (n,), counterclockwise: (R - 1) r."""
    angle = angle.reshape(-1, *[1] * (r.ndim - 2))
    # cos - 1 without cancellation.
    lost, s = -2.0 * np.sin(0.5 * angle) ** 2, np.sin(angle)
    return np.stack([lost * r[..., 0] - s * r[..., 1], s * r[..., 0] + lost * r[..., 1]], axis=-1)


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


Integers = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class SlipModes:
    """The modes of slipping at this rank's vertices: mode `mode[k]` moves vertex `vertex[k]` by `by[k]`.

    Attributes:
        vertex: (n,).
        mode: (n,).
        by: (n, 2).
        count: how many modes there are on all ranks.
    """

    vertex: Integers
    mode: Integers
    by: Array
    count: int


class Slip:
    """Finds the slip of least distortion; `close` frees the factors."""

    def __init__(self, stiffness: PETSc.Mat, P: PETSc.Mat, modes: SlipModes) -> None:
        """Prepare.

        Args:
            stiffness: of `int (1 / area) grad d . grad v`, for one component of d at all vertices.
            P: its vertices by the free ones.
            modes: of slipping, at vertices that are not free.
        """
        comm = stiffness.comm.tompi4py()
        free_here = P.getLocalSize()[1]
        root_free = comm.bcast(free_here)
        self._comm, self._free = comm, 2 * free_here
        self._modes = modes.count if comm.rank == 0 else 0
        self._stiffness = _matrix(_of_both(stiffness), 2 * stiffness.getLocalSize()[1], stiffness)
        free = _of_both(P).tocoo()
        # Rank 0 owns the modes, after its own free vertices.
        columns = free.col + modes.count * (free.col >= 2 * root_free)
        rows = (2 * modes.vertex[:, None] + np.arange(2)).ravel()
        values = np.concatenate([free.data, modes.by.ravel()])
        rows = np.concatenate([free.row, rows])
        columns = np.concatenate([columns, np.repeat(2 * root_free + modes.mode, 2)])
        size = (free.shape[0], free.shape[1] + modes.count)
        every = sp.csr_matrix((values, (rows, columns)), size)
        self._P = _matrix(every, self._free + self._modes, stiffness)
        self._solver = factorised(self._stiffness, self._P)

    def of(self, known: Array) -> Array:
        """How far each mode slips, on all ranks.

        Args:
            known: displacements (n, 2) of this rank's vertices without slips, zero where they are free.
        """
        d, load = self._stiffness.createVecs()
        y, rhs = self._P.createVecRight(), self._P.createVecRight()
        d.array[:] = -known.ravel()
        self._stiffness.mult(d, load)
        self._P.multTranspose(load, rhs)
        self._solver.solve(rhs, y)
        amounts: Array = self._comm.bcast(y.array[self._free :].copy())
        for vector in (d, load, y, rhs):
            vector.destroy()
        return amounts

    def close(self) -> None:
        """Free matrices and factors."""
        for used in (self._solver, self._stiffness, self._P):
            used.destroy()


def _of_both(matrix: PETSc.Mat) -> sp.csr_matrix:
    """This rank's rows of a matrix that acts on each of two components, which lie side by side."""
    indptr, indices, values = matrix.getValuesCSR()
    rows = sp.csr_matrix((values, indices, indptr), (len(indptr) - 1, matrix.getSize()[1]))
    return sp.kron(rows, sp.eye_array(2), "csr")


def _matrix(rows: sp.csr_matrix, columns_here: int, like: PETSc.Mat) -> PETSc.Mat:
    """The distributed matrix with these rows of this rank."""
    csr = (rows.indptr.astype(PETSc.IntType), rows.indices.astype(PETSc.IntType), rows.data)
    size = ((rows.shape[0], None), (columns_here, rows.shape[1]))
    return PETSc.Mat().createAIJ(size, csr=csr, comm=like.comm)
