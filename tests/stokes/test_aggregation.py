"""Aggregates of nodes below the coarsest mesh."""

from __future__ import annotations

from itertools import chain

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

from fsi.arrays import Array
from fsi.bodies.configuration import rigid_motion
from fsi.stokes.discretisation.loops import loops, pointer
from fsi.stokes.model import StokesModel
from fsi.stokes.solvers import multigrid
from fsi.stokes.solvers.aggregation import aggregated
from fsi.stokes.solvers.components import COMPONENTS
from tests.ranks import needs_mpi, result_on
from tests.stokes.spatial_flows import BOX, case

MODES = 12  # of two spheres, of which the first is held but for what it is loaded with


def test_a_node_is_put_together_with_all_its_neighbours_if_these_are_free() -> None:
    """In a row 0, 1, 3, 4, 5, 2 these are 0 and 2; 3 joins 1, and 4 joins 5, not 3, which only joined."""
    neighbours = [[1], [0, 3], [5], [1, 4], [3, 5], [4, 2], []]
    indptr = np.cumsum([0, *map(len, neighbours)], dtype=np.int32)
    neighbour, aggregate = np.array([*chain(*neighbours)], dtype=np.int32), np.empty(7, dtype=np.int32)
    assert loops().lib.gather_nodes(7, *map(pointer, (indptr, neighbour, aggregate))) == 3
    assert aggregate.tolist() == [0, 0, 1, 0, 1, 1, 2]


def level() -> tuple[PETSc.Mat, PETSc.Mat, Array]:
    """A and T of the coarsest mesh around two spheres, and the translations in z, this rank's; collective."""
    one = case(BOX, solver="iterative", cells_per_circle=16)
    model, q, kept = StokesModel(one), one.configuration(), list[tuple[PETSc.Mat, PETSc.Mat]]()

    def keeping(A: PETSc.Mat, modes: int) -> PETSc.Mat:
        T = aggregated(A, modes)
        kept.append((A.copy(), T.copy()))
        return T

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(multigrid, "MOST_FACTORISED", 0)
        patch.setattr(multigrid, "aggregated", keeping)
        model(q, 0.0)
    ((A, T),) = kept
    modes = MODES if MPI.COMM_WORLD.rank == 0 else 0
    of_bodies = rigid_motion(q.centres)[..., :COMPONENTS].reshape(-1, COMPONENTS)[:modes]
    of_nodes = np.tile(np.eye(COMPONENTS), ((A.getLocalSize()[0] - modes) // COMPONENTS, 1))
    return A, T, np.concatenate([of_nodes, of_bodies])


def misfit() -> tuple[float, float, float]:
    """How far T z is from its formula for translations z; how many times fewer unknowns T^T A T has, and how
    many entries for each; collective.
    """
    A, T, translations = level()
    indptr, _, value = A.getValuesCSR()
    sums, here = np.add.reduceat(np.abs(value), indptr[:-1]), len(indptr) - 1
    modes = MODES if MPI.COMM_WORLD.rank == 0 else 0
    aggregates = (T.getLocalSize()[1] - modes) // COMPONENTS
    of_coarse = np.concatenate([np.tile(np.eye(COMPONENTS), (aggregates, 1)), translations[here - modes :]])
    away, coarse = 0.0, A.ptap(T)
    for given, z in zip(of_coarse.T, translations.T, strict=True):
        right, fine = T.createVecRight(), A.createVecRight()
        right.array[:], fine.array[:] = given, z
        expected = z - 4.0 / 3.0 * (A * fine).array / sums
        expected[here - modes :] = z[here - modes :]
        away = max(away, float(np.abs((T * right).array - expected).max(initial=0.0)))
    entries = coarse.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"] / coarse.size[0]
    return max(MPI.COMM_WORLD.allgather(away)), A.size[0] / coarse.size[0], entries


@needs_mpi
@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [1, 2])
def test_values_are_smoothed_but_for_modes(ranks: int) -> None:
    """Smoothed as nodes are, modes leave 47 entries for each unknown."""
    away, fewer, entries = (
        misfit() if ranks == 1 else result_on(ranks, "tests.stokes.test_aggregation", "misfit()")
    )
    assert away < 1e-14
    assert fewer > 8.0
    assert entries < 25.0


def test_aggregates_have_the_energy_of_slow_errors() -> None:
    """Of v with A v = e_x T z has all but 0.09; not smoothed all but 0.28, of nodes thrown together 0.15."""
    A, T, translations = level()
    fine, transfer = (csr_matrix(M.getValuesCSR()[::-1], M.size) for M in (A, T))
    load = translations[:, 0]
    v = spsolve(fine.tocsc(), load)
    of_coarse = transfer.T @ load
    z = spsolve((transfer.T @ fine @ transfer).tocsc(), of_coarse)
    assert 1.0 - (of_coarse @ z) / (load @ v) < 0.12
