"""A level below the coarsest mesh: aggregates of nodes, each with one velocity, smoothed, and the modes.

With the matrix A of a level and T_0, which is 1 where a node is in an aggregate or a mode is itself, values
there are T z of those z of the next level (Vanek, Mandel and Brezina 1996, Computing 56:179),

    T = (1 - (4 / 3) W A) T_0,       W_ii = 1 / sum_j |A_ij|,

so that no eigenvalue of W A is above 1. In rows of modes W is zero: a body meets all nodes around it, and
would make each aggregate of these meet all others, in a matrix with five to fifty times the entries.
"""

from __future__ import annotations

import numpy as np
import scipy  # its modules load when they are used
from mpi4py import MPI
from petsc4py import PETSc

from fsi.stokes.discretisation.loops import Numbers, loops, pointer
from fsi.stokes.discretisation.shared_rows import shared_columns
from fsi.stokes.solvers.components import COMPONENTS

SMOOTHED = 4.0 / 3.0


def aggregated(A: PETSc.Mat, modes: int) -> PETSc.Mat:
    """T, of aggregates within each rank and after them its modes; collective.

    Args:
        A: three rows for each of this rank's nodes, which act on each component alike, then those of modes.
        modes: how many of this rank's rows those are.
    """
    indptr, column, value = A.getValuesCSR()
    here, first = len(indptr) - 1, A.getOwnershipRange()[0]
    rows = scipy.sparse.csr_array((value, column, indptr), shape=(here, A.size[1]))
    aggregate, count = _gathered(rows[: here - modes : COMPONENTS], first)
    of_nodes = COMPONENTS * aggregate[:, None] + np.arange(COMPONENTS)
    width = COMPONENTS * count + modes
    coarse = np.concatenate([of_nodes.ravel(), np.arange(width - modes, width)])
    coarse += MPI.COMM_WORLD.exscan(width) or 0
    W = 1.0 / np.abs(rows).sum(axis=1)
    W[here - modes :] = 0.0
    rows.data *= np.repeat(-SMOOTHED * W, np.diff(indptr))
    rows.eliminate_zeros()
    met, shared = shared_columns(rows.indices, here)
    number = np.empty(A.size[1], dtype=np.int32)
    number[met] = np.arange(len(met))
    columns, total = shared.with_ghosts(coarse), MPI.COMM_WORLD.allreduce(width)
    rows.indices = columns[number[rows.indices]].astype(np.int32)
    T = scipy.sparse.csr_array((rows.data, rows.indices, rows.indptr), shape=(here, total))
    T += scipy.sparse.csr_array((np.ones(here), coarse, np.arange(here + 1)), shape=T.shape)
    csr = (T.indptr.astype(PETSc.IntType), T.indices.astype(PETSc.IntType), T.data)
    return PETSc.Mat().createAIJ(size=((here, None), (width, None)), csr=csr, comm=A.comm)


def _gathered(rows: scipy.sparse.csr_array, first: int) -> tuple[Numbers, int]:
    """The aggregate of each node, and how many there are; rows: of a component, first: this rank's column."""
    nodes = rows.shape[0]
    inside = (rows.indices >= first) & (rows.indices < first + COMPONENTS * nodes)
    neighbour = ((rows.indices[inside] - first) // COMPONENTS).astype(np.int32)
    indptr = np.concatenate([[0], np.cumsum(inside)])[rows.indptr].astype(np.int32)
    aggregate = np.empty(nodes, dtype=np.int32)
    return aggregate, loops().lib.gather_nodes(nodes, *map(pointer, (indptr, neighbour, aggregate)))
