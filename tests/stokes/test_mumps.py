"""The direct solver measures its residual, refines where that is large, and refuses what stays so."""

import subprocess

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
import scipy.sparse
from petsc4py import PETSc

from fsi.arrays import Array
from fsi.errors import SolveError
from fsi.stokes.solvers.mumps import Factorisation
from tests.ranks import python_on

N = 50


def saddle(drift: float, seed: int = 0) -> PETSc.Mat:
    """[A B^T; B 0] with its whole diagonal stored, A off by a part `drift` of its diagonal."""
    rng = np.random.default_rng(seed)
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
    with Factorisation(matrix, 2) as factors:
        saddle(drift).copy(matrix, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        x, residual = factors.solve(b)
    assert residual.max() < most
    full = matrix.convert("dense").getDenseArray()
    np.testing.assert_allclose(full @ x, b, rtol=0, atol=10.0 * most * np.linalg.norm(b))


def with_a_weak_direction(size: float) -> tuple[PETSc.Mat, Array]:
    """The saddle matrix where along one direction v, no unit vector, it is that small; and v."""
    full = saddle(0.0).convert("dense").getDenseArray()
    values, vectors = np.linalg.eigh(full)
    values[0] = size
    full, n = (vectors * values) @ vectors.T, len(full)
    matrix = PETSc.Mat().createAIJ((n, n), comm=PETSc.COMM_SELF)
    matrix.setPreallocationCOO(*(i.ravel().astype(PETSc.IntType) for i in np.indices((n, n))))
    matrix.setValuesCOO(full.ravel())
    return matrix, vectors[:, 0]


def test_one_direction_that_the_factors_have_wrong_is_mended() -> None:
    """A part 1e-8 of the rest, and twice that in the factors: refinement halves the error, GMRES finds it."""
    matrix, weak = with_a_weak_direction(2e-8)
    b = np.random.default_rng(1).standard_normal((len(weak), 2))
    with Factorisation(matrix, 2) as factors:
        with_a_weak_direction(1e-8)[0].copy(matrix, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        x, residual = factors.solve(b)
    assert residual.max() < 1e-9
    np.testing.assert_allclose(weak @ x, weak @ b / 1e-8, rtol=1e-6)


def test_what_no_refinement_mends_is_refused() -> None:
    """Factors of a matrix that has nothing to do with this one."""
    matrix = saddle(0.0)
    with Factorisation(matrix, 2) as factors:
        saddle(0.0, seed=1).copy(matrix, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        with pytest.raises(SolveError, match="the linear solve left a relative residual"):
            factors.solve(np.ones((N + N // 5, 1)))


def operations(matrix: PETSc.Mat, dimension: int) -> float:
    """RINFOG(3), what MUMPS has done for the factors."""
    with Factorisation(matrix, dimension) as factors:
        return float(factors._ksp.getPC().getFactorMatrix().getMumpsRinfog(3))


def test_in_space_factors_are_ordered_by_nested_dissection() -> None:
    """Of 16^3 points, each with all around it: 1.1e8 operations where minimum fill takes 2.0e8."""
    ones = scipy.sparse.diags_array([1.0, 1.0, 1.0], offsets=[-1, 0, 1], shape=(16, 16))
    near = scipy.sparse.kron(scipy.sparse.kron(ones, ones), ones)
    full = (near + scipy.sparse.diags_array(np.full(16**3, 30.0))).tocsr()
    matrix = PETSc.Mat().createAIJ(full.shape, csr=(full.indptr, full.indices, full.data))
    assert operations(matrix, 3) < 0.7 * operations(matrix, 2)


# Lines of a program. Where fluid slides MUMPS has all unknowns, also those of groups of cells.
DELAYED = """
import fsi.meshes.backend
from mpi4py import MPI

import fsi.stokes.solvers.mumps as mumps
from fsi.case.load import parse_case
from fsi.stokes.model import StokesModel

factorise = mumps._factorise

def counted(ksp):
    status = factorise(ksp)
    pc = ksp.getPC()
    factor = pc.getFactorMatrix()
    if MPI.COMM_WORLD.rank == 0:
        print(status, ksp.getOperators()[0].getSize()[0], factor.getMumpsInfog(13))
    factor.destroy()
    pc.destroy()
    return status

mumps._factorise = counted
case = parse_case({
    "name": "x", "fluid": {"viscosity": 1.0}, "discretisation": {"degree": 3},
    "domain": {"lower": [-3.0, 0.0], "upper": [3.0, 4.0], "walls": {"top": {"slip_length": 0.1}}},
    "bodies": [{"name": "disc", "radius": 1.0, "position": [0.0, 1.5], "force": [0.0, -1.0]}],
})
StokesModel(case)(case.configuration(), 0.0)
"""


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [1, 2])
def test_no_pivot_is_delayed(ranks: int) -> None:
    """Scaled by the diagonal, which MUMPS leaves out on two ranks, 172 were; of quintic elements most are."""
    command = [*python_on(ranks), "-m", "mpi4py", "-c", DELAYED]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    status, unknowns, delayed = map(int, done.stdout.split())
    assert status == 0
    assert unknowns > 5000
    assert delayed == 0
