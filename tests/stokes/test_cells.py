"""Sums of cells without what one cell or group has alone, against matrices of DOLFINx that NumPy reduces."""

from __future__ import annotations

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane
from fsi.meshes.resolution import Resolution
from fsi.stokes.discretisation import groups
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.problem import SolverOptions
from fsi.stokes.resistance import held_at_rest
from fsi.stokes.solve import Clock, assembled
from fsi.stokes.solvers.reduced import Added, Elimination
from fsi.stokes.solvers.system import StokesSystem
from tests.flows import discs, mesh
from tests.stokes import matrices

COARSE = Resolution(0.3, 10, 1.0)
# Two discs about the cut of a channel with slaves, and a sphere on an axis, both with all modes unknown: the
# first disc and the sphere have inertia.
DISCS = (Box((0.0, -2.6), (5.0, 2.6), periodic=("x",)), discs([(0.4, -1.3), (2.1, 0.2)], [1.0, 0.8]))
SPHERE = (HalfPlane(6.0, axisymmetric=True), discs([(0.0, 1.5)], [1.0]))


def reduced(system: StokesSystem, elimination: Elimination) -> tuple[Array, int]:
    """P^T M P of Y = (y, z), dense, column by column of P; and the size of y."""
    y = len(elimination.left)
    P = elimination.prolonged(np.eye(y + len(system.layout.inner)))
    K: Array = P.T @ (matrices.assembled(system.forms) @ P)
    return K, y


@pytest.mark.parametrize("degree", [2, 3, 4])
@pytest.mark.parametrize("flow", [DISCS, SPHERE], ids=["discs", "sphere"])
def test_the_sum_of_cells_is_the_reduced_matrix_without_inner_unknowns(
    flow: tuple[Container, Configuration], degree: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(groups, "FEWEST", 16)  # or the few cells of these meshes would be merged once at most
    container, q = flow
    problem = held_at_rest(mesh(container, q, COARSE, degree), container, q)
    with assembled(problem, SolverOptions(degree), Clock()) as system:
        axial = np.arange(system.layout.modes) % 3 == 1
        unknown = axial if system.layout.axisymmetric else np.ones(system.layout.modes, dtype=bool)
        D = np.linspace(1.0, 2.0, system.layout.modes) * (np.arange(system.layout.modes) < 3)
        elimination = system.workspace.elimination(system.layout, system.rigid, unknown, Added(D))
        K, y = reduced(system, elimination)
        modes = slice(elimination.first_mode, y)
        K[modes, modes] += np.diag(D[unknown])
        left = np.flatnonzero(elimination.left)
        assert len(left) < 0.5 * y, "groups of cells leave a part of y only"
        assert elimination.left[modes][D[unknown] > 0.0].all()
        inner = np.setdiff1d(np.arange(len(K)), left)
        outer, inner_rows = np.ix_(left, left), np.ix_(inner, inner)
        S = K[outer] - K[left][:, inner] @ np.linalg.solve(K[inner_rows], K[inner][:, left])
        dense = elimination.reduced.convert("dense").getDenseArray()
        assert_allclose(dense, S, rtol=0, atol=1e-11 * np.abs(S).max())
        b = np.random.default_rng(0).standard_normal((len(K), 2))
        assert_allclose(elimination.times(b), K @ b, rtol=0, atol=1e-11 * np.abs(K).max())
        solved = elimination.solved(b, lambda right: np.linalg.solve(S, right))
        assert_allclose(K @ solved, b, rtol=0, atol=1e-8 * np.abs(b).max())
        assert elimination.times(b.astype(np.longdouble)).dtype == np.longdouble


@pytest.mark.parametrize(("flow", "degree"), [(DISCS, 6), (SPHERE, 5)], ids=["discs", "sphere"])
def test_cells_are_integrated_as_dolfinx_does(flow: tuple[Container, Configuration], degree: int) -> None:
    """Curved cells and straight ones, which are integrated on the reference cell."""
    container, q = flow
    one_with_the_other(Forms(mesh(container, q, COARSE, degree), degree, 0.7))


@pytest.mark.parametrize("degree", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_cells_in_space_are_integrated_as_dolfinx_does(degree: int) -> None:
    q = Configuration.unturned(np.array([[0.0, 0.0, 1.5]]), np.ones(1))
    sizes = Resolution(0.5, 6, 1.0)
    one_with_the_other(Forms(mesh(HalfPlane(4.0, dimension=3), q, sizes, degree), degree, 0.7))


def one_with_the_other(forms: Forms) -> None:
    """Both agree to rounding."""
    expected = matrices.assembled(forms)
    off = matrices.added_up(forms) - expected
    assert np.abs(off.data).max() < 1e-12 * np.abs(expected.data).max()
