"""Sparse symmetric positive definite systems by Cholesky's factors, scaled to unit diagonal and refined once.

The factors L L^T are those of CHOLMOD (Chen, Davis, Hager, Rajamanickam 2008, ACM Trans. Math. Softw. 35:22),
as CVXOPT brings it. Where bodies slide in several very narrow gaps rounding may leave a pivot that is not
positive: its factors L D L^T need no root of it, and how much such a flow is worth its checks say.
"""

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.errors import SolveError
from fsi.pores.compiled import compiled

_TINY = float(np.finfo(float).tiny)


def solve_definite(A: sp.csr_matrix, b: Array) -> tuple[Array, float]:
    """x and the largest relative residual of A x = b; b (n,), or one right side a column, (n, k).

    The columns of each row of A are in ascending order. Raises SolveError: A is not positive definite.
    """
    from cvxopt import cholmod, matrix, spmatrix  # takes 0.2 s to load: not where nothing is solved

    diagonal = A.diagonal()
    if not np.all(diagonal > 0.0):
        raise SolveError("pores: the motion is not determined: a free body meets no fluid")
    scale = 1.0 / np.sqrt(diagonal)
    lower = [matrix(part) for part in _scaled_lower(A.indptr, A.indices, A.data, scale)]
    factors = _factors(spmatrix(*lower, A.shape, "d"))

    def solved(right: Array) -> Array:
        x = matrix((right.T * scale).T)
        cholmod.solve(factors, x)
        found: Array = (np.array(x).reshape(right.shape).T * scale).T
        return found

    x = solved(b)
    x += solved(b - A @ x)
    defect = ((b - A @ x).T * scale).T
    size = np.abs((b.T * scale).T).max(axis=0, initial=0.0) + _TINY
    return x, float(np.max(np.abs(defect).max(axis=0, initial=0.0) / size, initial=0.0))


def _factors(lower: Any) -> Any:
    """Those of a matrix with this lower triangle. Raises SolveError: a pivot is 0."""
    from cvxopt import cholmod

    for cholmod.options["supernodal"] in (2, 0):  # L L^T, then L D L^T
        factors = cholmod.symbolic(lower, uplo="L")
        try:
            cholmod.numeric(lower, factors)
        except ArithmeticError:
            continue
        return factors
    raise SolveError("pores: the dissipation is not positive: do bodies overlap?")


type Index = NDArray[np.int64]


@compiled
def _scaled_lower(
    indptr: NDArray[np.int32], indices: NDArray[np.int32], data: Array, scale: Array
) -> tuple[Array, Index, Index]:
    """Values, rows and columns of the lower triangle of A scaled on both sides, one column after the other.

    A is symmetric: its rows from the diagonal on are these columns.
    """
    n = 0
    for i in range(len(scale)):
        for p in range(indptr[i], indptr[i + 1]):
            n += indices[p] >= i
    values, row, column = np.empty(n), np.empty(n, np.int64), np.empty(n, np.int64)
    n = 0
    for i in range(len(scale)):
        for p in range(indptr[i], indptr[i + 1]):
            j = indices[p]
            if j >= i:
                values[n], row[n], column[n] = scale[i] * data[p] * scale[j], j, i
                n += 1
    return values, row, column
