"""P^T (L x 1) P by rows, against PETSc's products of whole matrices."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.stokes.discretisation.constraints import Prolongation
from fsi.stokes.discretisation.loops import loops, pointer
from fsi.stokes.model import StokesModel
from fsi.stokes.solvers import components, multigrid
from tests.ranks import needs_mpi, result_on
from tests.stokes import spatial_flows as spatial
from tests.stokes import test_periodic_in_space as periodic

CASES = {
    "bodies between walls": spatial.case(spatial.BOX, solver="iterative", cells_per_circle=8, growth=1.0),
    "images of bodies and sides": periodic.case(
        periodic.OBLIQUE, periodic.TWO, solver="iterative", cells_per_circle=9, growth=0.8, degree=3
    ),
}


def vectors(scalar: PETSc.Mat) -> PETSc.Mat:
    """L x 1, as PETSc has matrices."""
    indptr, column, value = scalar.getValuesCSR()
    rows = sp.kron(
        sp.csr_matrix((value, column, indptr), (len(indptr) - 1, scalar.size[1])), np.eye(3)
    ).tocsr()
    size = (rows.shape[0], rows.shape[1])
    csr = (rows.indptr.astype(PETSc.IntType), rows.indices.astype(PETSc.IntType), rows.data)
    return PETSc.Mat().createAIJ(size=(size, size), csr=csr, comm=scalar.comm)


def solve_with(name: str, part: str, function: Callable[..., PETSc.Mat]) -> None:
    """Solve one of the cases, with another function as this one of the multigrid; collective."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(multigrid, part, function)
        one = CASES[name]
        StokesModel(one)(one.configuration(), 0.0)


def differences(name: str) -> list[float]:
    """Of both on all levels, relative to the entries; collective."""
    found = list[float]()

    def compared(scalar: PETSc.Mat, P: Prolongation) -> PETSc.Mat:
        T, every = P.matrix, vectors(scalar)
        products = T.transposeMatMult(every.matMult(T))
        by_rows = components.projected(scalar, P)
        products.axpy(-1.0, by_rows)
        found.append(products.norm(PETSc.NormType.INFINITY) / by_rows.norm(PETSc.NormType.INFINITY))
        return by_rows

    solve_with(name, "projected", compared)
    return found


@pytest.mark.parametrize("name", CASES)
def test_rows_are_those_of_products(name: str) -> None:
    found = differences(name)
    assert len(found) >= 2
    assert max(found) < 1e-14


def test_what_a_node_meets_through_images_is_added_up_in_order() -> None:
    """A row that meets unknowns 6 and 0, 6 again by an image, and a body with one mode, 3."""
    given = {
        "indptr": np.array([0, 4], dtype=np.int32),
        "column": np.arange(4, dtype=np.int32),
        "value": np.array([1.0, 2.0, 4.0, 8.0]),
        "unknown": np.array([6, 0, 6, -1], dtype=np.int32),
        "on_body": np.array([-1, -1, -1, 0], dtype=np.int32),
        "modes": np.array([3, 3, 3], dtype=np.int32),
        "weights": np.array([1.0, 10.0, 100.0]),
    }
    alike = loops().ffi.new("Alike *", {"width": 1} | {name: pointer(a) for name, a in given.items()})
    row, number, indptr, columns = np.zeros(1, np.int32), *(np.zeros(n, np.int32) for n in (4, 4, 12))
    total, values = np.zeros(4), np.zeros(12)
    assert loops().lib.room_of_rows(alike, 1, pointer(row)) == 12
    arrays: tuple[NDArray[Any], ...] = (row, number, total, indptr, columns, values)
    assert loops().lib.rows_of_nodes(alike, 1, *map(pointer, arrays)) == 9
    assert indptr.tolist() == [0, 3, 6, 9]
    assert columns[:9].tolist() == [0, 3, 6, 1, 3, 7, 2, 3, 8]
    assert values[:9].tolist() == [2.0, 8.0, 5.0, 2.0, 80.0, 5.0, 2.0, 800.0, 5.0]


@needs_mpi
@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_ranks_send_each_other_what_rows_of_others_have(ranks: int) -> None:
    """Nodes on bodies and images of one rank, whose modes and unknowns are another's."""
    found = result_on(ranks, "tests.stokes.test_components", "[max(differences(name)) for name in CASES]")
    assert max(found) < 1e-14
