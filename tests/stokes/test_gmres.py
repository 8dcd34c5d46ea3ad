"""The iterative solver of flows in space: the flow that factors give, in few iterations; what stagnates."""

from __future__ import annotations

import re

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from numpy.testing import assert_allclose
from petsc4py import PETSc

from fsi.case.load import parse_case
from fsi.errors import InputError, SolveError
from fsi.stokes.resistance import case_resistance
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solvers import gmres
from tests.stokes.spatial_flows import BOX, case, solved


@pytest.fixture(scope="module")
def usual() -> StokesSolution:
    """By iterations, as nothing has been changed."""
    return solved(case(BOX, solver="iterative"))


def test_solvers_and_forms_agree(usual: StokesSolution) -> None:
    direct = solved(case(BOX, solver="direct"))
    multiplier = solved(case(BOX, formulation="multiplier"))
    assert (direct.iterations, multiplier.iterations) == (0, 0)
    # With S' twice as large they are 40, with L in place of 1.5 L 41, with the other sign of S' 83.
    assert 10 < usual.iterations < 39
    for other, tolerance in ((usual, 1e-9), (multiplier, 1e-11)):
        assert_allclose(other.U, direct.U, atol=tolerance * np.abs(direct.U).max())
        assert_allclose(other.F, direct.F, atol=tolerance * np.abs(direct.F).max())
    given = [[0.1, 0.0, -1.0, 0.0, 0.0, 0.0], [0.3, 0.5, 0.0, -0.2, 0.2, 0.0]]
    assert_allclose(direct.F[0], given[0], atol=1e-12)
    assert_allclose(direct.U[1, [0, 2, 4, 5]], [0.3, -0.2, 0.5, 0.0], atol=0.0)
    assert direct.F[1, 3] == pytest.approx(0.2, abs=1e-12)


def test_a_coarse_matrix_may_be_left_to_aggregates(
    usual: StokesSolution, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fsi.stokes.solvers.multigrid.MOST_FACTORISED", 0)
    aggregates = solved(case(BOX, solver="iterative"))
    assert_allclose(aggregates.F, usual.F, atol=1e-9 * np.abs(usual.F).max())
    assert aggregates.iterations <= usual.iterations + 2


def test_pressures_in_films_may_be_left_to_cycles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Smoothed by the diagonal alone these take 86 iterations, 36 with factors."""
    above = {"name": "ball", "radius": 1.0, "position": [0.0, 0.0, -1.999], "force": [0.1, 0.0, -1.0]}
    film = BOX | {"bodies": [above]}
    usual = solved(case(film, solver="iterative"))
    monkeypatch.setattr("fsi.stokes.solvers.gmres.MOST_FACTORISED", 0)
    cycles = solved(case(film, solver="iterative"))
    assert_allclose(cycles.F, usual.F, atol=1e-9 * np.abs(usual.F).max())
    assert cycles.iterations <= 1.5 * usual.iterations


def test_iterations_do_not_grow_with_the_mesh(usual: StokesSolution) -> None:
    """3.5 times the unknowns; algebraic multigrid on all of them took 87 and 98 on such meshes."""
    fine = solved(case(BOX, solver="iterative", cells_per_circle=24, growth=0.36))
    assert fine.dofs > 3.0 * usual.dofs
    assert fine.iterations < 1.1 * usual.iterations


def test_loads_may_come_in_extended_precision(usual: StokesSolution, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those beside gaps below NARROW do, for which LAPACK has no least squares."""
    monkeypatch.setattr("fsi.stokes.solvers.elimination.NARROW", np.inf)
    narrow = solved(case(BOX, solver="iterative"))
    assert_allclose(narrow.F, usual.F, rtol=0, atol=1e-9 * np.abs(usual.F).max())


def test_a_stagnating_iteration_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fsi.stokes.solvers.gmres.MOST_ITERATIONS", 5)
    words = r'relative residual \S+ after 5 .*bound 1e-10\); set discretisation.solver = "direct"$'
    with pytest.raises(SolveError, match=f"iterative solver stagnates: {words}"):
        solved(case(BOX, solver="iterative"))
    solved(case(BOX, solver="direct"))


def test_an_iteration_that_ends_too_early_starts_again(
    usual: StokesSolution, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rounding makes GMRES believe in too small a residual; here a test that is met too early does so."""
    made, starts = gmres._solver, list[float]()

    def hasty(matrix: PETSc.Mat, blocks: gmres.SchurBlocks) -> PETSc.KSP:
        ksp = made(matrix, blocks)

        def met(ksp: PETSc.KSP, steps: int, norm: float) -> bool:
            if steps == 0:
                starts.append(norm)
            enough = 1e-7 if len(starts) == 1 else gmres.TOLERANCE
            return bool(norm <= enough * ksp.getRhs().norm())

        ksp.setConvergenceTest(met)
        return ksp

    monkeypatch.setattr(gmres, "_solver", hasty)
    found = solved(case(BOX, solver="iterative"))
    assert len(starts) == 2
    assert_allclose(found.F, usual.F, atol=2e-9 * np.abs(usual.F).max())
    monkeypatch.setattr(gmres, "STARTS", 1)
    starts.clear()
    with pytest.raises(SolveError, match="stagnates"):
        solved(case(BOX, solver="iterative"))


def test_a_flow_that_misses_an_identity_is_solved_again(
    usual: StokesSolution, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bound is one that the usual residual misses, and one a hundred times as small keeps."""
    monkeypatch.setattr("fsi.stokes.identities.BOUND", 0.1 * max(usual.checks.values()))
    sharper = solved(case(BOX, solver="iterative"))
    assert sharper.checks["residual"] <= 2.0 * gmres.SHARPER
    assert sharper.iterations > usual.iterations
    monkeypatch.setattr("fsi.stokes.solve.SHARPER", gmres.TOLERANCE)
    with pytest.raises(SolveError, match="violates the identity"):
        solved(case(BOX, solver="iterative"))


def test_columns_that_are_not_reciprocal_are_solved_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """As above, with the asymmetry of R, of the small sphere alone."""
    one = case(BOX | {"bodies": BOX["bodies"][1:]}, solver="iterative")
    usual = case_resistance(one)
    monkeypatch.setattr("fsi.observables.resistance.BOUND", 0.1 * usual.checks["reciprocity"])
    sharper = case_resistance(one)
    assert sharper.checks["residual"] <= 2.0 * gmres.SHARPER
    monkeypatch.setattr("fsi.stokes.resistance.SHARPER", gmres.TOLERANCE)
    with pytest.raises(SolveError, match="violates reciprocity"):
        case_resistance(one)


@pytest.mark.parametrize("force", [0.0, -1.0])
def test_walls_that_carry_all_along_are_as_exact_as_walls_at_rest(force: float) -> None:
    """Forces are a small part of what such walls do: identities were off by 1e-8 to 2e-7, and refused."""
    walls = {wall: [0.0, 1.0, 0.0] for wall in ("left", "right", "front", "back", "bottom", "top")}
    ball = {"name": "ball", "radius": 0.8, "position": [0.5, 0.3, 0.2], "force": [0.0, force, 0.0]}
    domain = {"lower": [-2.0, -2.0, -2.0], "upper": [2.0, 2.0, 3.0]}
    at_rest, carried = (
        solved(case(BOX | {"domain": domain | {"walls": given}, "bodies": [ball]}, solver="iterative"))
        for given in ({}, walls)
    )
    assert_allclose(carried.U, at_rest.U + np.eye(6)[1], rtol=0, atol=1e-8)
    assert_allclose(carried.F, at_rest.F, rtol=0, atol=1e-9)


def test_the_iterative_solver_is_for_space() -> None:
    planar = {
        "name": "planar", "fluid": {"viscosity": 1.0}, "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
        "discretisation": {"solver": "iterative"},
    }  # fmt: skip
    with pytest.raises(InputError, match=re.escape('discretisation.solver = "iterative"')):
        parse_case(planar)
