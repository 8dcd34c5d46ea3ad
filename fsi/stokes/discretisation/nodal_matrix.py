"""A sparse matrix whose rows are those of x, filled anew when a mesh or its bodies move."""

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fsi.bodies.configuration import Array
from fsi.stokes.discretisation.shared_rows import Index

NO_COLUMN = -1


class NodalMatrix:
    """Entries of some rows of this rank, by rows: a list of them would have to be sorted by PETSc.

    Attributes:
        matrix: itself.
    """

    def __init__(
        self, sizes: tuple[int, tuple[int, int | None]], rows: Index, column: Index, value: Array
    ) -> None:
        """With `value[k, :]` in row `rows[k]`, local and each once, at `column[k, :]`, global; collective.

        sizes: rows of this rank, and columns of this rank and in all. NO_COLUMN: there is no entry.
        """
        here, columns = sizes
        flat = column.ravel()
        entries = np.flatnonzero(flat != NO_COLUMN)
        row = rows[entries // column.shape[1]]
        # They are nearly in order: rows ascend, and have few entries.
        order = np.argsort(row * (flat.max(initial=0) + 1) + flat[entries], kind="stable")
        self._entries = entries[order]
        counts = np.bincount(row, minlength=here)
        indptr = np.concatenate([[0], np.cumsum(counts)]).astype(PETSc.IntType)
        self._csr = (indptr, flat[self._entries].astype(PETSc.IntType), value.ravel()[self._entries])
        if MPI.COMM_WORLD.size == 1:
            size = here, columns[0]
            self.matrix = PETSc.Mat().createAIJWithArrays(size, self._csr, comm=MPI.COMM_WORLD)
        else:
            sizes_of_all = (here, None), columns
            self.matrix = PETSc.Mat().createAIJ(sizes_of_all, csr=self._csr, comm=MPI.COMM_WORLD)

    def fill(self, value: Array) -> None:
        """Other values of the same entries; collective."""
        self._csr[2][:] = value.ravel()[self._entries]
        if MPI.COMM_WORLD.size == 1:
            self.matrix.stateIncrease()
        else:
            first = self.matrix.getOwnershipRange()[0]
            rows = np.arange(first, first + len(self._csr[0]) - 1, dtype=PETSc.IntType)
            self.matrix.setValuesIJV(*self._csr, rowmap=rows)
        self.matrix.assemble()
