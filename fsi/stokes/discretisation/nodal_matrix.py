"""A sparse matrix whose rows are those of x, filled anew when a mesh or its bodies move."""

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fsi.arrays import Array, Indices

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
        flat = column.ravel()
        entries = np.flatnonzero(flat != NO_COLUMN)
        row = rows[entries // column.shape[1]]
        # They are nearly in order: rows ascend, and have few entries.
        order = np.argsort(row * (flat.max(initial=0) + 1) + flat[entries], kind="stable")
        entries, row = entries[order], row[order]
        # PETSc has columns of this rank in numbers of its own, and apart from those of others.
        first = comm.exscan(columns[0]) or 0
        inside = (flat[entries] >= first) & (flat[entries] < first + columns[0])
        parts = [(inside, first), (~inside, 0)] if comm.size > 1 else [(inside, first)]
        self._entries = [entries[part] for part, _ in parts]
        self._csr = []
        for (part, offset), chosen in zip(parts, self._entries, strict=True):
            indptr = np.concatenate([[0], np.cumsum(np.bincount(row[part], minlength=here))])
            numbers = (each.astype(PETSc.IntType) for each in (indptr, flat[chosen] - offset))
            self._csr.append((*numbers, value.ravel()[chosen]))
        csr = tuple(self._csr) if comm.size > 1 else self._csr[0]
        self.matrix = PETSc.Mat().createAIJWithArrays(((here, None), columns), csr, comm=comm)

    def fill(self, value: Array) -> None:
        """Other values of the same entries; collective."""
        for (_, _, values), entries in zip(self._csr, self._entries, strict=True):
            values[:] = value.ravel()[entries]
        self.matrix.stateIncrease()
        self.matrix.assemble()
