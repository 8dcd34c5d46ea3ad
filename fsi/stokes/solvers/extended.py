"""Products in more digits than doubles have, where pressures of 1e18 cancel in loads of one.

A disc at 1e-7 radii from both walls of a corner shuts fluid in whose pressure is larger than that beside the
disc by (a/q)^(5/2). Rounded to a double it has lost what a torque needs: R_xT was a third of what it is.
Numbers are those that NumPy calls longdouble: of 64 bits after the point on x86, of 113 on most others. Where
they are doubles (ARM under macOS) nothing is gained.
"""

from typing import Any

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array

type Extended = NDArray[Any]  # of longdouble


class ExtendedMatrix:
    """The rows of a matrix of this rank, in extended precision."""

    def __init__(self, matrix: PETSc.Mat) -> None:
        """A copy of the matrix as it is now."""
        indptr, column, value = matrix.getValuesCSR()
        rows = len(indptr) - 1
        self._comm, self._first = matrix.comm.tompi4py(), matrix.getOwnershipRangesColumn()
        entries = (value.astype(np.longdouble), column, indptr)
        self._rows = scipy.sparse.csr_matrix(entries, (rows, matrix.size[1]))

    def times(self, x: Extended) -> Extended:
        """This rank's rows of the matrix times a vector given by this rank's values; collective."""
        every = np.concatenate(self._comm.allgather(x))
        product: Extended = self._rows @ every
        return product

    def transpose_times(self, y: Extended) -> Extended:
        """This rank's rows of the transposed matrix times a vector; collective."""
        parts = self._comm.allgather(self._rows.T @ y)
        rank = self._comm.rank
        product: Extended = np.sum(parts, axis=0)[self._first[rank] : self._first[rank + 1]]
        return product


def multiply(matrix: PETSc.Mat, values: Array) -> Array:
    """This rank's rows of a matrix times a vector given by this rank's values, in their precision."""
    if values.dtype == np.longdouble:
        return ExtendedMatrix(matrix).times(values)
    x, y = matrix.createVecs()
    x.array[:] = values
    matrix.mult(x, y)
    return _taken(y, x)


def multiply_transpose(matrix: PETSc.Mat, values: Array) -> Array:
    """The same with the matrix transposed."""
    if values.dtype == np.longdouble:
        return ExtendedMatrix(matrix).transpose_times(values)
    x, y = matrix.createVecs()
    y.array[:] = values
    matrix.multTranspose(y, x)
    return _taken(x, y)


def _taken(vector: PETSc.Vec, used: PETSc.Vec) -> Array:
    """The values of a vector; both are destroyed."""
    values: Array = vector.array.copy()
    vector.destroy()
    used.destroy()
    return values
