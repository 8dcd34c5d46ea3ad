"""A sparse matrix whose rows are those of x, filled anew when a mesh or its bodies move."""

from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array, Indices
from fsi.stokes.discretisation.loops import loops, pointer

NO_COLUMN = -1


class NodalMatrix:
    """Entries of some rows of this rank, by rows, in the places where PETSc has them: it copies none.

    Attributes:
        matrix: itself.
    """

    def __init__(
        self, sizes: tuple[int, tuple[int, int | None]], rows: Indices, column: Indices, value: Array
    ) -> None:
        """With `value[k, :]` in row `rows[k]`, local and each once, at `column[k, :]`, global; collective.

        sizes: rows of this rank, and columns of this rank and in all. NO_COLUMN: there is no entry.
        """
        comm, (here, columns) = MPI.COMM_WORLD, sizes
        # PETSc has columns of this rank in numbers of its own, and apart from those of others.
        first = comm.exscan(columns[0]) or 0
        own = (first, first + columns[0] if comm.size > 1 else np.iinfo(np.int64).max)
        listed = [np.ascontiguousarray(each, dtype=np.int64) for each in (rows, column)]
        shape, held, lib = column.shape, [pointer(each) for each in listed], loops().lib
        starts = np.zeros((2, here + 1), dtype=np.int32)
        lib.count_entries(*shape, *held, *own, *map(pointer, starts))
        np.cumsum(starts, axis=1, out=starts)
        self._entries, self._csr = [], []
        for inside, indptr in zip((True, False)[: comm.size], starts, strict=False):
            indices, entries = np.empty(indptr[-1], dtype=np.int32), np.empty(indptr[-1], dtype=np.int64)
            made: tuple[NDArray[Any], ...] = (indptr, indices, entries)
            lib.list_entries(*shape, *held, *own, inside, *map(pointer, made))
            self._entries.append(entries)
            self._csr.append((indptr, indices, value.ravel()[entries]))
        csr = tuple(self._csr) if comm.size > 1 else self._csr[0]
        self.matrix = PETSc.Mat().createAIJWithArrays(((here, None), columns), csr, comm=comm)

    def fill(self, value: Array) -> None:
        """Other values of the same entries; collective."""
        for (_, _, values), entries in zip(self._csr, self._entries, strict=True):
            values[:] = value.ravel()[entries]
        self.matrix.stateIncrease()
        self.matrix.assemble()
