"""Pores tile the fluid exactly, and each neck lies between two of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.errors import SolveError
from fsi.pores.topology import Pores, triangulate
from tests.packings import area_inside, areas, in_cell, in_channel, in_square, neighbours_of_necks, scattered

OBLIQUE = np.array([[1.0, 0.1], [2.4, 1.3]])  # far from reduced


def require_tiling(pores: Pores) -> None:
    """Two sides for each neck, Euler's count, and areas that add up to the fluid's."""
    surfaces = pores.surfaces
    N, inside = surfaces.discs, pores.sides[pores.sides >= 0]
    assert np.array_equal(np.bincount(inside, minlength=len(pores.necks)), np.full(len(pores.necks), 2))
    # V - E + F is 0 on a torus; with each wall or container shrunk to a point it is 2 on a sphere, where the
    # corners of a box are edges between its walls.
    corners = np.count_nonzero(pores.sides < 0)
    edges = len(pores.necks) + corners
    faces = len(pores) + (corners > 0)  # the outside of a box is one more
    assert len(surfaces) - edges + faces == (2 if len(surfaces) > N else 0)
    area = areas(pores)
    assert area.min() > 0.0
    assert area.sum() == pytest.approx(
        area_inside(surfaces) - np.pi * np.sum(surfaces.radius[:N] ** 2), rel=1e-12
    )
    assert pores.neck_gap.min() > 0.0


@pytest.mark.parametrize("vectors", [np.eye(2), np.array([[1.0, 0.0], [0.5, 0.75**0.5]]), OBLIQUE])
def test_one_disc_in_a_cell_has_two_pores(vectors: np.ndarray) -> None:
    pores = triangulate(in_cell(np.array([[3.3, -0.2]]), np.array([0.1]), vectors))
    assert len(pores) == 2
    require_tiling(pores)


def test_one_disc_in_a_channel_has_two_pores() -> None:
    pores = triangulate(in_channel(np.array([[3.3, 0.4]]), np.array([0.3]), 1.0, 1.0))
    assert len(pores) == 2
    require_tiling(pores)
    # Hand calculation: 0.4 - 0.3 to the lower wall, 1 - 0.4 - 0.3 to the upper, 1 - 2 * 0.3 to its image.
    assert sorted(pores.neck_gap) == pytest.approx([0.1, 0.3, 0.4], abs=1e-15)


@pytest.mark.parametrize("vectors", [6.0 * np.eye(2), 6.0 * np.array([[1.0, 0.0], [0.5, 0.75**0.5]])])
def test_arrays_are_cut_alike_everywhere(vectors: np.ndarray) -> None:
    """Squares have two equal diagonals: all of an array take the same one."""
    grid = np.stack(np.meshgrid(np.arange(6), np.arange(6)), axis=-1).reshape(-1, 2) / 6.0
    pores = triangulate(in_cell(grid @ vectors, np.full(36, 0.4), vectors))
    require_tiling(pores)
    assert np.all(np.bincount(pores.necks.ravel()) == 6)
    places = pores.surfaces.centre[pores.necks[:, 1]] + pores.neck_image @ vectors
    along = places - pores.surfaces.centre[pores.necks[:, 0]]
    assert len(np.unique(np.round(np.abs(along), 9), axis=0)) <= 3


@given(st.integers(0, 10**6), st.integers(1, 30), st.sampled_from([1.0, 0.3]), st.sampled_from([0, 2, 4]))
@settings(max_examples=60, deadline=None)
def test_random_packings_are_tiled(seed: int, n: int, ratio: float, walls: int) -> None:
    surfaces = in_square(*scattered(seed, n, ratio, walls), walls)
    try:
        pores = triangulate(surfaces)
    except SolveError as error:
        assert "across the neck" in str(error)  # noqa: PT017
    else:
        require_tiling(pores)


@given(st.integers(0, 10**6), st.integers(2, 20))
@settings(max_examples=20, deadline=None)
def test_order_and_origin_do_not_matter(seed: int, n: int) -> None:
    centres, radii = scattered(seed, n, 1.0)
    n = len(radii)  # of as many as found room
    order = np.random.default_rng(seed).permutation(n)
    moved = in_cell((centres + np.array([0.37, 5.11]))[order], radii[order], np.eye(2))
    try:
        pores = triangulate(in_cell(centres, radii, np.eye(2)))
    except SolveError:
        return
    assert neighbours_of_necks(triangulate(moved), order) == neighbours_of_necks(pores, np.arange(n))


def test_narrow_gaps_are_necks() -> None:
    """A ring of discs, a thousandth of a radius apart, and a wall as near."""
    angle = 2.0 * np.pi * np.arange(12) / 12.0
    centres = (2.001 / (2.0 * np.sin(np.pi / 12.0))) * np.column_stack([np.cos(angle), np.sin(angle)])
    centres += [8.0, 1.001 - centres[:, 1].min()]
    pores = triangulate(in_channel(np.vstack([centres, [[8.0, 5.0]]]), np.ones(13), 16.0, 10.0))
    assert np.count_nonzero(pores.neck_gap < 0.01) == 13  # 12 in the ring, its lowest disc and the wall


def test_bodies_that_overlap_are_named() -> None:
    with pytest.raises(SolveError, match="surface 0 and surface 1 touch or overlap"):
        triangulate(in_cell(np.array([[0.2, 0.2], [0.4, 0.3]]), np.full(2, 0.15), np.eye(2)))


def test_a_body_across_a_neck_is_named() -> None:
    """Of 300 such packings of four discs the one whose pores cannot be flipped free of bodies."""
    centres, radii = scattered(134, 4, 0.3)
    with pytest.raises(SolveError, match="one of surface 1, surface 3 and surface 0 lies across the neck"):
        triangulate(in_cell(centres, radii, np.eye(2)))
