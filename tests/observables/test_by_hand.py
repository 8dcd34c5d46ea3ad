"""Mean stresses and resistance matrices with literal numbers: parts, signs, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.errors import SolveError
from fsi.observables.bulk_stress import BulkStress
from fsi.observables.resistance import difference, inverse, positive_eigenvalues, symmetrised


def test_the_mean_stress_has_three_parts_and_a_difference_of_normal_stresses() -> None:
    """Fluid, stresslets over the area 4, and what forces carry; N_1 = xx - yy."""
    fluid = np.array([[1.0, 0.5], [0.5, -1.0]])
    stresslets = np.array([[[4.0, 2.0], [2.0, 0.0]], [[0.0, 2.0], [2.0, 8.0]]])
    forces = np.array([[0.25, 0.0], [0.5, 0.125]])
    bulk = BulkStress(fluid, stresslets, forces, 4.0, 3.0)
    assert_allclose(bulk.mean, [[2.25, 1.5], [2.0, 1.125]])
    assert bulk.normal_stress_difference == 1.125
    record = bulk.record
    assert (record["stress_xx"], record["stress_xy"], record["stress_yy"]) == (2.25, 1.5, 1.125)
    assert (record["N_1"], record["apparent_viscosity"]) == (1.125, 3.0)


@pytest.mark.parametrize(("missed", "bar"), [(0.0, 0.06), (0.4, 0.2)])
def test_an_apparent_viscosity_is_known_to_a_part_of_what_the_stress_misses(
    missed: float, bar: float
) -> None:
    """Of Sigma, 0.4 are missed in each normal component and nothing, or as much, in Sigma_xy = 2 mu_app.

    S = 2 mu E = [[0, 2], [2, 0]], so |d mu_app| <= 4 / 8 |d Sigma|, and 0.3 of it is by chance. A pressure
    that is missed, 100, is no part of it.
    """
    S, none = np.array([[0.0, 2.0], [2.0, 0.0]]), np.zeros((1, 2, 2))
    off = np.array([[100.4, missed], [missed, 99.6]])
    first, other = (
        BulkStress(stress, none, np.zeros((2, 2)), 1.0, 0.5 * stress[0, 1], newtonian=S)
        for stress in (2.0 * S, 2.0 * S + off)
    )
    assert first.viscosity_error(other, 1.0, 0.3, 1e-12) == pytest.approx(bar)
    alone = replace(first, newtonian=None).viscosity_error(other, 1.0, 0.3, 1e-12)
    assert alone == pytest.approx(max(0.5 * missed, 2e-12))


def test_an_apparent_viscosity_is_known_as_well_in_the_thinnest_fluid() -> None:
    """The first of these bars, 0.06, with all stresses times 1e-300, whose squares are zero."""
    S, none = np.array([[0.0, 2e-300], [2e-300, 0.0]]), np.zeros((1, 2, 2))
    off = np.diag([4e-301, -4e-301])
    first, other = (
        BulkStress(stress, none, np.zeros((2, 2)), 1.0, 2.0, newtonian=S)
        for stress in (2.0 * S, 2.0 * S + off)
    )
    with np.errstate(divide="raise", invalid="raise", over="raise"):
        assert first.viscosity_error(other, 1.0, 0.3, 1e-12) == pytest.approx(0.06)


def test_a_resistance_matrix_is_symmetric_to_1e9_or_refused() -> None:
    """Half of a difference of 1e-10 goes to both sides; one of 2e-9 is no rounding."""
    R, scale = np.array([[4.0, 1.0], [1.0 + 4e-10, 4.0]]), np.ones(2)
    found, asymmetry = symmetrised(R, scale)
    assert asymmetry == pytest.approx(1e-10, rel=1e-5)
    assert found[0, 1] == found[1, 0] == pytest.approx(1.0 + 2e-10, rel=1e-14)
    with pytest.raises(SolveError, match=r"relative asymmetry 2e-09, bound 1e-09"):
        symmetrised(np.array([[4.0, 1.0], [1.0 + 8e-9, 4.0]]), scale)


@pytest.mark.parametrize(
    ("smallest", "resting", "sound"),
    [
        (2e-14, True, True),  # gaps of 1e-8 radii in the largest containers
        (0.0, True, False),
        (-1e-10, True, False),
        (-1e-10, False, True),  # rounding of a motion that costs nothing
        (-1e-8, False, False),
    ],
)
def test_eigenvalues_are_positive_or_refused(smallest: float, resting: bool, sound: bool) -> None:
    R = np.diag([smallest, 1.0])
    if sound:
        assert_allclose(positive_eigenvalues(R, np.ones(2), resting=resting), [smallest, 1.0])
    else:
        with pytest.raises(SolveError, match="resistance matrix is not positive"):
            positive_eigenvalues(R, np.ones(2), resting=resting)


def test_differences_count_over_the_diagonal_of_row_and_column() -> None:
    """1e-3 beside diagonals of 4 and 1e-2: over 0.2; beside 4 and 4: over 4."""
    R = np.diag([4.0, 1e-2, 4.0])
    other = R.copy()
    other[0, 1] += 1e-3
    assert difference(R, other, np.full(3, 1e-9)) == pytest.approx(1e-3 / 0.2)
    assert difference(R, other, np.full(3, 1.0)) == pytest.approx(1e-3 / 2.0)
    assert_allclose(inverse(R), np.diag([0.25, 100.0, 0.25]))
