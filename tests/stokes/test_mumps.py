"""The direct solver measures its residual, refines once where that is large, and refuses what stays so."""

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from petsc4py import PETSc

from fsi.errors import SolveError
from fsi.stokes.solvers.mumps import Factorisation

N = 50


def saddle(drift: float) -> PETSc.Mat:
    """[A B^T; B 0] with its whole diagonal stored, A off by a part `drift` of its diagonal."""
    rng = np.random.default_rng(0)
    B = rng.standard_normal((N // 5, N))
    full = np.block([[np.diag(1.0 + rng.random(N)) * (1.0 + drift), B.T], [B, np.zeros((len(B), len(B)))]])
    rows, columns = np.nonzero((full != 0.0) | np.eye(len(full), dtype=bool))
    matrix = PETSc.Mat().createAIJ((len(full),) * 2, comm=PETSc.COMM_SELF)
    matrix.setPreallocationCOO(rows.astype(PETSc.IntType), columns.astype(PETSc.IntType))
    matrix.setValuesCOO(full[rows, columns])
    return matrix


@pytest.mark.parametrize(("drift", "most"), [(0.0, 1e-14), (1e-7, 1e-11)])
def test_residuals_are_measured_and_refined(drift: float, most: float) -> None:
    """Factors of a matrix that has changed since by 1e-7 leave 1e-8, which one refinement brings to 1e-15."""
    matrix, b = saddle(0.0), np.ones((N + N // 5, 2))
    with Factorisation(matrix) as factors:
        saddle(drift).copy(matrix, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        x, residual = factors.solve(b)
    assert residual.max() < most
    full = matrix.convert("dense").getDenseArray()
    np.testing.assert_allclose(full @ x, b, rtol=0, atol=10.0 * most * np.linalg.norm(b))


def test_what_one_refinement_does_not_mend_is_refused() -> None:
    """After a change by 1e-2 the refined residual is 1e-5 or so, above the bound of 1e-9."""
    matrix = saddle(0.0)
    with Factorisation(matrix) as factors:
        saddle(1e-2).copy(matrix, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        with pytest.raises(SolveError, match="the linear solve left a relative residual"):
            factors.solve(np.ones((N + N // 5, 1)))
