"""Sparse symmetric positive definite systems, scaled to unit diagonal and refined once."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fsi.bodies.configuration import Array
from fsi.errors import SolveError

_TINY = float(np.finfo(float).tiny)


def solve_definite(A: sp.csr_matrix, b: Array) -> tuple[Array, float]:
    """x and the largest relative residual of A x = b; b (n,), or one right side a column, (n, k).

    Raises SolveError: A is not positive definite.
    """
    diagonal = A.diagonal()
    if not np.all(diagonal > 0.0):
        raise SolveError("pores: the motion is not determined: a free body meets no fluid")
    scale = 1.0 / np.sqrt(diagonal)
    values = A.data * np.repeat(scale, np.diff(A.indptr)) * scale[A.indices]
    scaled = sp.csc_matrix((values, A.indices, A.indptr), shape=A.shape)  # rows of A are its columns
    right = (b.T * scale).T
    try:
        options = {"SymmetricMode": True}
        factors = splu(scaled, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError as error:
        raise SolveError(f"pores: the dissipation is not positive ({error}): do bodies overlap?") from None
    y = factors.solve(right)
    y += factors.solve(right - scaled @ y)
    defect = np.abs(right - scaled @ y).max(axis=0, initial=0.0)
    size = np.abs(right).max(axis=0, initial=0.0) + _TINY
    return (y.T * scale).T, float(np.max(defect / size, initial=0.0))
