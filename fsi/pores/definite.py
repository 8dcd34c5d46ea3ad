"""Sparse symmetric positive definite systems by Cholesky's factors, scaled to unit diagonal.

The factors L L^T are those of CHOLMOD (Chen, Davis, Hager, Rajamanickam 2008, ACM Trans. Math. Softw. 35:22),
as CVXOPT brings it. Where bodies slide in several very narrow gaps rounding may leave a pivot that is not
positive: its factors L D L^T need no root of it, and how much such a flow is worth its checks say.
"""

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.errors import SolveError
from fsi.machine.compiled import compiled
from fsi.pores.columns import sparse_matrix
from fsi.pores.pattern import Short

_TINY = float(np.finfo(float).tiny)


class Cholesky:
    """The factors of the rows and columns of a symmetric K + diag(D) that are free, n of all."""

    def __init__(self, lower: sp.csr_matrix, free: NDArray[np.bool_], D: Array | None = None) -> None:
        """The lower triangle of K, the columns of each row in ascending order; D of all rows.

        Raises SolveError: it is not positive definite.
        """
        diagonal = _diagonal(lower.indptr, lower.indices, lower.data)
        diagonal += 0.0 if D is None else D
        if not np.all(diagonal[free] > 0.0):
            raise SolveError("pores: the motion is not determined: a free body meets no fluid")
        scale = np.zeros(len(free))
        scale[free] = 1.0 / np.sqrt(diagonal[free])
        number = np.where(free, np.cumsum(free) - 1, -1)
        self._scale = scale[free]
        first = _first(lower.indptr, lower.indices, number)

        def write(row: Indices, value: Array) -> None:
            _write((row, value), (lower.indptr, lower.indices, lower.data), scale, number)

        self._factors = _factors(sparse_matrix(first, write))

    def solve(self, b: Array) -> Array:
        """x; b (n,), or one right side a column, (n, k)."""
        from cvxopt import cholmod, matrix  # takes 0.2 s to load: not where nothing is solved

        x = matrix((b.T * self._scale).T)
        cholmod.solve(self._factors, x)
        found: Array = (np.array(x).reshape(b.shape).T * self._scale).T
        return found

    def residual(self, defect: Array, b: Array, dissipation: Array | float = 0.0) -> float:
        """The largest defect of `scaled_residual`, rows scaled to unit diagonal."""
        return scaled_residual((defect, b), self._scale, dissipation)


def scaled_residual(rows: tuple[Array, Array], scale: Array, dissipation: Array | float) -> float:
    """The largest defect over the size of its column: defects and right sides, (n,) or (n, k) each.

    The right side of a free row is what given motions and loads add up to there, and may cancel to rounding,
    as by symmetry. No row of K x, scaled to unit diagonal, is larger than the root of the dissipation
    x^T K x, by Cauchy and Schwarz, so that this is the size of what cancels. scale: of rows. dissipation:
    x^T K x of each column, with what is given.
    """
    largest, size = (np.abs((r.T * scale).T).max(axis=0, initial=0.0) for r in rows)
    return float(np.max(largest / (size + np.sqrt(np.abs(dissipation)) + _TINY), initial=0.0))


def _factors(upper: Any) -> Any:
    """Those of a matrix with this upper triangle. Raises SolveError: a pivot is 0."""
    from cvxopt import cholmod

    for cholmod.options["supernodal"] in (2, 0):  # L L^T, then L D L^T
        factors = cholmod.symbolic(upper, uplo="U")
        try:
            cholmod.numeric(upper, factors)
        except ArithmeticError:
            continue
        return factors
    raise SolveError("pores: the dissipation is not positive: do bodies overlap?")


@compiled
def _diagonal(indptr: Short, indices: Short, data: Array) -> Array:
    """The diagonal of a lower triangle, with which rows end where it is not 0, (n,)."""
    diagonal = np.zeros(len(indptr) - 1)
    for i in range(len(diagonal)):
        last = indptr[i + 1] - 1
        if last >= indptr[i] and indices[last] == i:
            diagonal[i] = data[last]
    return diagonal


@compiled
def _first(indptr: Short, indices: Short, number: Indices) -> Indices:
    """Where the columns of the upper triangle begin, those that have a number, and their end."""
    first, n = np.zeros(number.max() + 2, np.int64), 0
    for i in range(len(number)):
        if number[i] >= 0:
            for p in range(indptr[i], indptr[i + 1]):
                n += number[indices[p]] >= 0
            first[number[i] + 1] = n
    return first


@compiled
def _write(
    columns: tuple[Indices, Array], lower: tuple[Short, Short, Array], scale: Array, number: Indices
) -> None:
    """Rows and values of the upper triangle, column by column, scaled to unit diagonal.

    These columns are the rows of the lower triangle. Of all of them: scales, and numbers, -1 where left out.
    """
    (row, value), (indptr, indices, data), n = columns, lower, 0
    for i in range(len(scale)):
        if number[i] < 0:
            continue
        for p in range(indptr[i], indptr[i + 1]):
            j = indices[p]
            if number[j] >= 0:
                row[n], value[n] = number[j], scale[i] * data[p] * scale[j] if j < i else 1.0
                n += 1
