"""What ranks decide by is the same number on all of them: else one takes a way where it waits for the others.

Each rank runs the checks below; a rank that finds another number than the others, or never ends, fails.
"""

from __future__ import annotations

import subprocess
from typing import Any

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fsi.meshes.cells.curved import scaled_jacobian
from fsi.meshes.moving.move import Mover
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solve import solve
from fsi.stokes.solvers.mumps import REFINE_ABOVE, Factorisation
from tests.flows import SMALL_BOX, discs, held, mesh, resting
from tests.ranks import python_on

COMM = MPI.COMM_WORLD
Q = discs([(-1.0, 0.1), (1.1, -0.2)], [0.8, 0.5])
MOTION = [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]


def of_all(value: Any) -> list[Any]:
    """The values of all ranks."""
    return list(COMM.allgather(value))


def check_quality_of_a_moved_mesh() -> None:
    """The worst cell lies on one rank alone; the other would keep a mesh that this one makes anew."""
    fluid = mesh(SMALL_BOX, Q)
    mover = Mover(fluid, Q.centres)
    here, refused = [], []
    for step in (0.1, 0.3, 0.35, 0.4, 0.5, 0.7):  # of one disc: somewhere between, a first cell is too bad
        quality = of_all(mover.move(Q.centres + np.array([(step, 0.0), (0.0, 0.0)])))
        assert len(set(quality)) == 1, quality
        refused.append(quality[0] is None)
        if quality[0] is not None:
            x = fluid.mesh.geometry.x[fluid.mesh.geometry.dofmaps[0]][:, :, :2]
            here.append(of_all(float(scaled_jacobian(x, fluid.order).min())))
            assert quality[0] == min(here[-1])
    assert refused[-1]
    assert not refused[0]
    assert any(len(set(worst)) == len(worst) for worst in here)
    mover.close()


def check_residual_of_a_solve() -> None:
    """sum |x_i r_i| / sum |x_i b_i|, r = b - M x; once factorised, M changes on the last rank alone."""
    rows, last = 40, COMM.rank == COMM.size - 1
    matrix = PETSc.Mat().createAIJ(((rows, None), (rows, None)), nnz=1, comm=COMM)
    first = matrix.getOwnershipRange()[0]

    def fill(off: float) -> None:
        for row in range(first, first + rows):
            matrix.setValue(row, row, 1.0 + off)
        matrix.assemble()

    fill(0.0)
    b = np.full((rows, 1), 1.0 + COMM.rank)
    with Factorisation(matrix, 2) as factors:
        for off in (1e-7, 1e-14):  # is refined; is not
            fill(off if last else 0.0)
            x, residual = factors.solve(b)
            left = b - (1.0 + (off if last else 0.0)) * x
            true = sum(of_all(float(np.abs(x * left).sum()))) / sum(of_all(float(np.abs(x * b).sum())))
            assert residual[0] == pytest.approx(true, rel=1e-2, abs=1e-16)
            assert of_all(float(residual[0])) == [float(residual[0])] * COMM.size
            assert residual[0] < REFINE_ABOVE
    matrix.destroy()


def check_results_of_a_solve() -> None:
    """Bit by bit: a stepper compares them with its tolerance on each rank."""
    fluid = mesh(SMALL_BOX, Q)
    found = solve(StokesProblem(fluid, SMALL_BOX, Q, held(*MOTION), resting(SMALL_BOX), viscosity=1.0))
    numbers = [*found.U.ravel(), *found.F.ravel(), found.dissipation, *found.checks.values(), fluid.quality]
    assert all(np.array_equal(numbers, others) for others in of_all(numbers))
    assert np.abs(found.F).max() > 0.0


CHECKS = (check_quality_of_a_moved_mesh, check_residual_of_a_solve, check_results_of_a_solve)


@pytest.mark.mpi
def test_two_ranks_have_the_same_numbers() -> None:
    program = "from tests.stokes.test_decisions_of_ranks import CHECKS\nfor check in CHECKS: check()"
    command = [*python_on(2), "-m", "mpi4py"]
    done = subprocess.run([*command, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
