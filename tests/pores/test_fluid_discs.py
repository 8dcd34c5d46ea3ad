"""Fluid discs leave no pore wide, and free every neck."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fsi.pores import fluid_discs
from fsi.pores.circles import Circles, circles_in_pores, renewed
from fsi.pores.fluid_discs import Wide, pores_without_wide
from fsi.pores.links import Links
from fsi.pores.surfaces import DISC, BoundingSurfaces, Shapes
from fsi.pores.topology import linked, triangulate
from tests.packings import in_box, in_cell, in_channel, in_container, in_square, scattered
from tests.pores.test_topology import require_tiling


def with_fluid_discs(surfaces: BoundingSurfaces) -> BoundingSurfaces:
    """These surfaces and fluid discs, until no pore is wide."""
    return pores_without_wide(surfaces).surfaces


def require_narrow(surfaces: BoundingSurfaces) -> None:
    """No inscribed circle beside a body is larger than `Wide` says but where bodies reach into it."""
    links, wide = linked(surfaces), Wide()
    circles = circles_in_pores(surfaces.shapes(), links, flat=False)
    body = (surfaces.kind[links.body] == DISC) & ~surfaces.fluid[links.body]
    smallest = np.where(body, surfaces.radius[links.body], np.inf).min(axis=1)
    assert np.nanmax(circles.radius / smallest, initial=0.0) <= 2.0 * wide.least
    assert np.isinf(circles.asked).all()  # no body lies across a neck


def test_a_void_between_two_walls_is_filled() -> None:
    surfaces = with_fluid_discs(in_channel(np.array([[0.3, 1.2]]), np.ones(1), 12.0, 12.0))
    assert 5 < np.count_nonzero(surfaces.fluid) < 40
    require_tiling(triangulate(surfaces))
    require_narrow(surfaces)


@pytest.mark.parametrize(
    "surfaces",
    [
        in_channel(np.array([[3.22, 12.73]]), np.array([0.405]), 3.224, 27.05),
        in_cell(np.array([[4.41, 5.58]]), np.array([0.966]), np.array([[5.178, 0.0], [-1.6, 17.1]])),
    ],
)
def test_a_void_many_periods_high_is_filled(surfaces: BoundingSurfaces) -> None:
    """By circles that do not touch their own images, where the inscribed ones are wider than a period."""
    surfaces = with_fluid_discs(surfaces)
    period = np.linalg.norm(surfaces.periods, axis=1).min()
    assert 0.2 * period < surfaces.radius[surfaces.fluid].max() <= Wide().share * 0.5 * period
    require_tiling(triangulate(surfaces))
    require_narrow(surfaces)


@pytest.mark.parametrize("half", [1e3, 1e6])
def test_a_box_a_million_times_as_wide_as_its_discs_is_filled(half: float) -> None:
    centres = half + np.array([[1.6, 1.5], [3.9, 2.9]])
    surfaces = with_fluid_discs(in_box(centres, np.array([1.0, 0.7]), 2.0 * half, 2.0 * half))
    assert np.count_nonzero(surfaces.fluid) < 80
    require_tiling(triangulate(surfaces))


@pytest.mark.parametrize("off", [1e-15, -1e-13, 1e-13, 1e-9])
def test_circles_that_symmetry_makes_alike_go_in_one_order(off: float) -> None:
    """Two discs are their own images, turned by half a turn: which circle was first was left to rounding.

    The viscosity with one mode jumped by 6e-5 under such shifts.
    """

    def circles(shift: float) -> NDArray[np.float64]:
        centres = np.array([[1.426823219954759, 2.0044881681435327], [4.670435097285521, 3.494944222433557]])
        centres[1, 0] += shift
        surfaces = with_fluid_discs(in_channel(centres, np.ones(2), 7.0, 6.0))
        return surfaces.centre[surfaces.fluid]

    np.testing.assert_allclose(circles(off), circles(0.0), atol=1e-6)


def test_neighbouring_discs_need_none() -> None:
    surfaces = in_cell(np.zeros((1, 2)), np.ones(1), 2.2 * np.eye(2))
    assert with_fluid_discs(surfaces).discs == 1


@pytest.mark.parametrize("place", [10.0, 1.01])
def test_a_small_disc_in_a_large_box(place: float) -> None:
    """Exactly on the diagonal, where choices are equal; the discs grow away from it."""
    surfaces = with_fluid_discs(in_box(np.full((1, 2), place), np.ones(1), 20.0, 20.0))
    fluid = surfaces.radius[surfaces.fluid]
    assert len(fluid) < 40
    assert fluid.max() > 2.0
    require_tiling(triangulate(surfaces))
    require_narrow(surfaces)


@given(
    st.integers(0, 10**6), st.integers(1, 30), st.sampled_from([1.0, 0.3, 0.1]), st.sampled_from([0, 2, 4])
)
@settings(max_examples=60, deadline=None)
def test_random_packings_are_tiled_with_them(seed: int, n: int, ratio: float, walls: int) -> None:
    surfaces = in_square(*scattered(seed, n, ratio, walls), walls)
    require_tiling(triangulate(with_fluid_discs(surfaces)))


def test_four_discs_without_free_necks_are_freed() -> None:
    """Those of `test_a_body_across_a_neck_is_named`."""
    require_tiling(triangulate(with_fluid_discs(in_square(*scattered(134, 4, 0.3), 0))))


def test_discs_of_one_tenth_beside_a_large_one() -> None:
    """A new fluid disc would reach into a body that lies across the necks of several pores."""
    require_tiling(triangulate(with_fluid_discs(in_square(*scattered(13804805, 11, 0.1), 0))))


@given(st.integers(0, 10**6), st.integers(1, 30))
@settings(max_examples=20, deadline=None)
def test_round_containers_are_tiled_with_them(seed: int, n: int) -> None:
    """Also where they do not surround the centre."""
    centres, radii = scattered(seed, n, 0.3, 4)
    inside = np.hypot(*(centres - 0.5).T) + radii < 0.499
    surfaces = in_container(3.0 * (centres - 0.5)[inside], 3.0 * radii[inside], 1.5)
    require_tiling(triangulate(with_fluid_discs(surfaces)))


@pytest.mark.parametrize("seed", [200, 284, 429])
def test_a_disc_that_nearly_touches_its_container_lies_across_no_neck(seed: int) -> None:
    """Of 600 such discs those that were refused, when no circle beside a disc was below 0.03 of it."""
    centres, radii = scattered(seed, 1, 0.3, 4)
    require_tiling(triangulate(with_fluid_discs(in_container(3.0 * (centres - 0.5), 3.0 * radii, 1.5))))


def test_circles_do_not_ask_for_ever_smaller_ones() -> None:
    """One that stood in a flat pore lay across necks of others: there were 1675 of them, down to 4e-6."""
    centres, radii = scattered(10619, 4, 0.3, 4)
    surfaces = with_fluid_discs(in_container(3.0 * (centres - 0.5), 3.0 * radii, 1.5))
    assert np.count_nonzero(surfaces.fluid) < 60
    require_tiling(triangulate(surfaces))


@pytest.mark.parametrize("angles", [[0.0], [0.0, np.pi], [0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi]])
def test_few_discs_in_a_round_container(angles: list[float]) -> None:
    """One, two opposite ones, four at right angles about the centre, and one in the middle."""
    centres = np.array([[0.0, 0.0], *([6.0 * np.cos(a), 6.0 * np.sin(a)] for a in angles)])
    surfaces = with_fluid_discs(in_container(centres, np.ones(len(centres)), 10.0))
    assert np.count_nonzero(surfaces.fluid) < 60
    require_tiling(triangulate(surfaces))


def test_a_concentric_disc_alone() -> None:
    require_tiling(triangulate(with_fluid_discs(in_container(np.zeros((1, 2)), np.ones(1), 10.0))))


def test_pores_of_the_last_round_are_those_made_anew() -> None:
    surfaces = in_square(*scattered(134, 4, 0.3), 0)
    kept, anew = pores_without_wide(surfaces), triangulate(with_fluid_discs(surfaces))
    assert kept.surfaces.fluid.any()
    for name in ("necks", "neck_image", "neck_gap", "vertices", "image", "sides"):
        np.testing.assert_array_equal(getattr(kept, name), getattr(anew, name))


CELL = np.array([[4.0, 0.0], [1.7125, 7.5018]])
HIGH_CELL = np.array([[4.0, 0.0], [0.1365, 10.574]])
FIVE = np.array([[0.96, 2.88], [3.41, 1.48], [3.7, 1.17], [3.68, 2.78], [1.88, 1.56]])


@pytest.mark.parametrize(
    "surfaces",
    [
        in_box(FIVE, np.array([0.021, 0.085, 0.205, 0.301, 0.027]), 4.0, 4.0),
        in_box(np.array([[3.05, 1.33], [3.44, 2.32], [1.8, 1.4]]), np.array([0.561, 0.024, 0.618]), 4.0, 4.0),
        in_cell(np.array([[0.86, 2.12], [0.15, 2.69]]), np.array([0.569, 0.239]), CELL),
        in_cell(np.array([[0.91, 0.09], [3.31, 0.62]]), np.array([0.428, 0.138]), HIGH_CELL),
    ],
)
def test_circles_that_are_kept_are_those_found_anew(
    surfaces: BoundingSurfaces, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where discs lie across necks, and where pores meet the same discs in other places after flips."""
    rounds = list[int]()

    def checked(shapes: Shapes, links: Links, known: Circles, kept: NDArray[np.bool_]) -> Circles:
        circles = renewed(shapes, links, known, kept)
        for one, other in zip(circles, circles_in_pores(shapes, links, flat=False), strict=True):
            assert np.array_equal(one, other, equal_nan=True)
        rounds.append(int(np.count_nonzero(kept)))
        return circles

    monkeypatch.setattr(fluid_discs, "renewed", checked)
    with_fluid_discs(surfaces)
    assert len(rounds) > 2
    assert min(rounds[1:]) > 0
