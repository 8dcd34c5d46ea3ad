"""What frame, units, order of the bodies and number of modes may do to a flow through pores."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.pores.solve import PoreFlow, PoreLoading, solve_pores
from fsi.pores.surfaces import BoundingSurfaces
from fsi.pores.system import PoreSystem
from tests.packings import in_cell, in_channel, scattered
from tests.pore_surfaces import free, resistance, sheared

G = np.array([[0.3, 1.0], [-0.2, -0.3]])
SKEW = np.array([[1.0, 0.0], [0.2, 1.0]])
SEEDS, NUMBERS = st.integers(0, 10**6), st.integers(2, 5)
few = settings(max_examples=3, deadline=None, derandomize=True, phases=[Phase.generate])


def packing(seed: int, n: int) -> BoundingSurfaces:
    """Discs in a skew cell."""
    centres, radii = scattered(seed, n, 0.5, walls=True)
    return in_cell(centres, radii, SKEW)


def strained(surfaces: BoundingSurfaces, gradient: Array = G, viscosity: float = 1.0) -> PoreFlow:
    """Free bodies in a mean flow."""
    system = PoreSystem.make(surfaces, 2, viscosity)
    return solve_pores(system, PoreLoading(free(system.bodies), np.zeros((0, 3)), gradient))


def require_same(found: PoreFlow, expected: PoreFlow, U: Array) -> None:
    """The same dissipation, and these velocities, to what rounding between narrow necks leaves.

    Points of quadrature that began in another corner of a pore would change them by 3e-6 and 4e-5.
    """
    assert found.dissipation == pytest.approx(expected.dissipation, rel=1e-6)
    assert pytest.approx(U, abs=1e-5 * np.abs(U).max()) == found.U


@given(SEEDS, NUMBERS, st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)))
@few
def test_a_cell_may_lie_anywhere(seed: int, n: int, shift: tuple[float, float]) -> None:
    one = packing(seed, n)
    flow = strained(one)
    U = flow.U.copy()
    U[:, :2] += G @ np.array(shift)
    require_same(strained(replace(one, centre=one.centre + np.array(shift))), flow, U)


@pytest.mark.parametrize("moved", [np.ones(4), np.array([1.0, 0.0, 0.0, -2.0])], ids=["all", "some"])
def test_bodies_may_be_given_by_images_far_away(moved: Array) -> None:
    """Thousands of periods: where circles of fluid came near the origin there was no end of them."""
    one, away = packing(7, 4), np.outer(moved, 1000.0 * SKEW[0] - 3000.0 * SKEW[1])
    flow, far = strained(one), strained(replace(one, centre=one.centre + away))
    assert far.dissipation == pytest.approx(flow.dissipation, rel=1e-6)
    np.testing.assert_allclose(far.U[:, :2] - away @ G.T, flow.U[:, :2], atol=1e-5)
    np.testing.assert_allclose(far.U[:, 2], flow.U[:, 2], atol=1e-5)


@given(SEEDS, NUMBERS, st.floats(0.0, 6.3), st.booleans())
@few
def test_a_cell_may_be_turned_and_mirrored(seed: int, n: int, angle: float, mirrored: bool) -> None:
    one, side = packing(seed, n), -1.0 if mirrored else 1.0
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ np.diag([side, 1.0])
    other = replace(one, centre=one.centre @ Q.T, periods=one.periods @ Q.T)
    flow = strained(one)
    expected = np.column_stack([flow.U[:, :2] @ Q.T, side * flow.U[:, 2]])
    require_same(strained(other, Q @ G @ Q.T), flow, expected)


@given(SEEDS, NUMBERS)
@few
def test_bodies_may_come_in_any_order(seed: int, n: int) -> None:
    one = packing(seed, n)
    order = np.random.default_rng(seed + 1).permutation(len(one))
    other = replace(one, centre=one.centre[order], radius=one.radius[order])
    flow = strained(one)
    require_same(strained(other), flow, flow.U[order])


@given(SEEDS, NUMBERS)
@few
def test_units_do_not_matter(seed: int, n: int) -> None:
    """Lengths in micrometres, viscosity in nPa s: D = mu G^2 L^2, to rounding between narrow necks (1e-7)."""
    one, unit, mu = packing(seed, n), 1e-6, 1e9
    small = replace(one, centre=unit * one.centre, radius=unit * one.radius, periods=unit * one.periods)
    flow, scaled = strained(one), strained(small, viscosity=mu)
    assert scaled.dissipation == pytest.approx(mu * unit**2 * flow.dissipation, rel=1e-6)
    assert pytest.approx(flow.U * [unit, unit, 1.0], rel=1e-5, abs=1e-8 * unit) == scaled.U


@given(SEEDS, st.integers(1, 4))
@few
def test_resistances_are_reciprocal_and_dissipate(seed: int, n: int) -> None:
    centres, radii = scattered(seed, n, 0.5, walls=True)
    R = resistance(PoreSystem.make(in_channel(centres, radii, 1.0, 1.0), 1, 1.0), 2)
    assert np.abs(R - R.T).max() <= 1e-11 * np.abs(R).max()
    assert np.linalg.eigvalsh(R).min() > 0.0


@given(SEEDS, NUMBERS)
@few
def test_more_modes_dissipate_less(seed: int, n: int) -> None:
    """In a channel, so that the walls are among the surfaces; less the bias of few points of quadrature."""
    centres, radii = scattered(seed, n, 0.5, walls=True)
    surfaces = in_channel(centres, radii, 1.0, 1.0)
    D = [sheared(PoreSystem.make(surfaces, modes, 1.0), 1.0).dissipation for modes in (0, 1, 2, 4)]
    assert np.all(np.diff(D) < 0.0)
