"""P^T (L x 1) P, where L acts on each component of the velocity alike.

Rows of free nodes are L's own, but where they meet bodies. Rows of nodes on bodies go to the modes of these,
with the weights that P has there, and those of images to what they are images of: these few alone are sent
from rank to rank. PETSc's two products with P take more than twice as long on one rank, on two seven times.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array, Indices
from fsi.stokes.discretisation.constraints import Prolongation
from fsi.stokes.discretisation.loops import Numbers, loops, pointer
from fsi.stokes.discretisation.nodal_matrix import NO_COLUMN
from fsi.stokes.discretisation.shared_rows import shared_columns

COMPONENTS = 3

type Rows = tuple[Numbers, Numbers, Array]  # where each row begins, the columns of its entries, and these


def projected(scalar: PETSc.Mat, P: Prolongation) -> PETSc.Mat:
    """P^T (L x 1) P for the matrix L over all nodes, which is destroyed; collective.

    P: of velocities in space that slide nowhere, so that the components of a node are free, tied, moved by a
    body or zero together.
    """
    rows, comm = _RowsOfNodes(scalar, P), scalar.comm
    scalar.destroy()
    given = _given(rows, P)
    indptr, columns, values = rows.of(rows.free, more=given.nnz)
    end, free = indptr[-1], len(indptr) - 1
    indptr = np.append(indptr, np.full(P.here - free, end, dtype=indptr.dtype))
    if given.indptr[free] == 0:  # those of the modes alone, which follow
        columns[end:], values[end:] = given.indices, given.data
        indptr = indptr + given.indptr
    else:
        own = scipy.sparse.csr_array((values[:end], columns[:end], indptr), shape=given.shape)
        total = own + given
        indptr, columns, values = total.indptr, total.indices, total.data
    size = (P.here, None)
    csr = (*(each.astype(PETSc.IntType, copy=False) for each in (indptr, columns)), values)
    return PETSc.Mat().createAIJ(size=(size, size), csr=csr, comm=comm)


class _RowsOfNodes:
    """Three rows of (L x 1) P for each node.

    Attributes:
        free: this rank's nodes that have unknowns, in the order of these.
        others: those that are images, or on bodies.
    """

    def __init__(self, scalar: PETSc.Mat, P: Prolongation) -> None:
        """Collective."""
        indptr, column, value = scalar.getValuesCSR()
        here, self._width = len(indptr) - 1, P.columns.shape[1]
        free = np.ones(here, dtype=bool)
        free[P.constrained // COMPONENTS] = False
        columns = P.columns.reshape(here, COMPONENTS, -1)
        self.free = np.flatnonzero(free)
        self.others = np.flatnonzero((columns[:, 0, 0] != NO_COLUMN) & ~free)
        met, shared = shared_columns(column, here)
        number = np.empty(scalar.size[1], dtype=np.int32)
        number[met] = np.arange(len(met))
        columns, weights = shared.with_ghosts(columns), shared.with_ghosts(P.weights.reshape(columns.shape))
        on_body = columns[:, 0, 1] != NO_COLUMN
        self._longest = int(np.diff(indptr).max(initial=0))
        self._arrays: dict[str, NDArray[Any]] = {
            "indptr": indptr,
            "column": number[column],
            "value": value,
            "unknown": np.where(on_body, NO_COLUMN, columns[:, 0, 0]).astype(np.int32),
            "on_body": np.where(on_body, np.cumsum(on_body) - 1, NO_COLUMN).astype(np.int32),
            "modes": columns[on_body].astype(np.int32),
            "weights": weights[on_body],
        }

    def of(self, nodes: Indices, more: int = 0) -> Rows:
        """Rows of some nodes, columns ascending; more: room for other entries at the end."""
        lib, row = loops().lib, nodes.astype(np.int32)
        held = {name: pointer(array) for name, array in self._arrays.items()}
        alike = loops().ffi.new("Alike *", {"width": self._width} | held)
        room = lib.room_of_rows(alike, len(row), pointer(row)) + more
        number, total = (np.empty(self._width * self._longest, kind) for kind in (np.int32, np.float64))
        indptr = np.empty(COMPONENTS * len(row) + 1, np.int32)
        columns, values = np.empty(room, np.int32), np.empty(room)
        arrays = (row, number, total, indptr, columns, values)
        end = lib.rows_of_nodes(alike, len(row), *map(pointer, arrays))
        return indptr, columns[: end + more], values[: end + more]


def _given(rows: _RowsOfNodes, P: Prolongation) -> scipy.sparse.csr_array:
    """What rows of bodies and images add to those of this rank's unknowns; collective."""
    comm, (unknowns, here) = P.matrix.comm.tompi4py(), (P.matrix.size[1], P.here)
    indptr, columns, values = rows.of(rows.others)
    row = (COMPONENTS * rows.others[:, None] + np.arange(COMPONENTS)).ravel()
    of_nodes = scipy.sparse.csr_array((values, columns, indptr), shape=(len(row), unknowns))
    k, entry = np.nonzero(P.columns[row] != NO_COLUMN)
    to = P.columns[row[k], entry]
    unknown, number = np.unique(to, return_inverse=True)
    weights = scipy.sparse.csr_array((P.weights[row[k], entry], (number, k)), shape=(len(unknown), len(row)))
    sums = (weights @ of_nodes).tocoo()
    to = unknown[sums.coords[0]]
    starts = np.cumsum([0, *comm.allgather(here)])
    owner = np.searchsorted(starts, to, side="right") - 1
    parts = [
        (to[mine], sums.coords[1][mine], sums.data[mine])
        for mine in (owner == rank for rank in range(comm.size))
    ]
    to, column, value = (np.concatenate(part) for part in zip(*comm.alltoall(parts), strict=True))
    given = scipy.sparse.csr_array((value, (to - starts[comm.rank], column)), shape=(here, unknowns))
    given.sum_duplicates()
    return given
