"""From velocities of one degree to those of the next, against DOLFINx's interpolation and PETSc's product."""

from __future__ import annotations

from fsi.meshes.backend import petsc_forms

import numpy as np
import pytest
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.meshes.build import FunctionSpace
from fsi.stokes.discretisation.constraints import DofLayout, Prolongation
from fsi.stokes.solvers.transfers import transfer
from tests.ranks import needs_mpi, result_on
from tests.stokes.test_components import CASES, solve_with

type Held = NDArray[np.bool_]


def misfits(name: str) -> list[float]:
    """The largest difference of T z and I P z of each level, where held modes move nothing; collective."""
    found = list[float]()

    def compared(
        fine: FunctionSpace, layout: DofLayout, coarse: FunctionSpace, P: Prolongation, held: Held
    ) -> PETSc.Mat:
        T = transfer(fine, layout, coarse, P, held)
        z, nodal = P.matrix.createVecRight(), P.matrix.createVecLeft()
        first, end = z.getOwnershipRange()
        z.array[:] = np.sin(np.arange(first, end))  # any; on all ranks the same
        moving, still = z.copy(), P.modes[held]
        moving.array[still[(still >= first) & (still < end)] - first] = 0.0
        P.matrix.mult(moving, nodal)
        interpolation = petsc_forms().interpolation_matrix(coarse, fine)
        interpolation.assemble()
        expected = (interpolation * nodal).array[layout.free]
        by_rows, modes = (T * z).array, z.array[len(z.array) - layout.modes_here :]
        away = np.abs(by_rows - np.concatenate([expected, modes])).max(initial=0.0)
        found.append(max(layout.comm.allgather(float(away))))
        assert T.size == (layout.comm.allreduce(len(expected)) + layout.modes, P.matrix.size[1])
        return T

    solve_with(name, "transfer", compared)
    return found


@pytest.mark.parametrize("name", CASES)
def test_rows_are_those_of_interpolation(name: str) -> None:
    """Of values up to 1; a node taken for another misses by as much."""
    found = misfits(name)
    assert len(found) >= 1
    assert max(found) < 1e-13


@needs_mpi
@pytest.mark.mpi
def test_nodes_of_other_ranks_have_their_columns() -> None:
    found = result_on(2, "tests.stokes.test_transfers", "[max(misfits(name)) for name in CASES]")
    assert max(found) < 1e-13
