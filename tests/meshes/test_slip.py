"""Rims turn and walls slide where that saves a moved mesh."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.meshes.build import build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.rotations import turned
from fsi.meshes.moving.move import Mover
from fsi.meshes.resolution import Resolution

BOX = Box((-4.0, -4.0), (4.0, 4.0))
CHANNEL = Box((0.0, 0.0), (5.0, 4.0), periodic=("x",))
RADII = np.array([1.0, 0.7])
COARSE = Resolution(cells_per_gap=0.3, cells_per_circle=16, growth=0.5)
GAP = 0.01


@contextmanager
def moving(container: Container, centres: Array) -> Iterator[tuple[Mover, Array]]:
    """A mesh around two discs that can be moved, and its nodes as they were."""
    mover = Mover(build(FluidDomain(container, centres, RADII), COARSE, 3), centres)
    try:
        yield mover, mover.fluid.mesh.geometry.x[:, :2].copy()
    finally:
        mover.close()


def gap_between(centres: Array, x: Array) -> Array:
    """Which points (n, 2) lie between the discs, a tenth of a radius from their line at most."""
    n = (centres[1] - centres[0]) / np.linalg.norm(centres[1] - centres[0])
    r = x - centres[0] - n
    found: Array = (np.abs(r @ n) < 2.0 * GAP) & (np.abs(r[:, 0] * n[1] - r[:, 1] * n[0]) < 0.1)
    return found


@pytest.mark.parametrize("angle", [0.02, -0.05])
def test_discs_that_go_round_each_other_take_the_mesh_of_their_gap_with_them(angle: float) -> None:
    """Without slips the gap would be sheared by 1.7 |angle| / GAP = 3.4, 8.5, and the move refused."""
    centres = np.array([[0.0, 0.0], [1.7 + GAP, 0.0]])
    end = centres + turned(centres - centres.mean(axis=0), np.full(2, angle))
    with moving(BOX, centres) as (mover, base):
        assert mover.move(end) is not None
        x = mover.fluid.mesh.geometry.x[:, :2]
        near = gap_between(centres, base)
        assert np.count_nonzero(near) > 20
        r = base[near] - centres.mean(axis=0)
        off = x[near] - centres.mean(axis=0) - r - turned(r, np.full(len(r), angle))
    # A tenth of the gap, for the box pulls a little; unturned, nodes would be off by 0.85 |angle|.
    assert np.abs(off).max() < 0.1 * GAP


def test_everything_slides_along_a_channel_with_its_discs() -> None:
    """Nothing is distorted then; walls that kept their nodes would shear the gap of 0.02 by 25."""
    centres = np.array([[1.0, 1.02], [3.6, 2.9]])
    with moving(CHANNEL, centres) as (mover, base):
        assert mover.move(centres + np.array([0.5, 0.0])) == pytest.approx(mover.fluid.quality, rel=1e-9)
        shift = mover.fluid.mesh.geometry.x[:, :2] - base
    np.testing.assert_allclose(shift - [0.5, 0.0], 0.0, atol=1e-12)


def test_each_wall_slides_by_itself_and_stays_where_it_is() -> None:
    """Discs that pass each other near the two walls take these with them."""
    centres = np.array([[1.0, 1.02], [3.6, 4.0 - 0.72]])
    with moving(CHANNEL, centres) as (mover, base):
        mover.move(centres + np.array([[0.05, 0.0], [-0.05, 0.0]]))
        shift = mover.fluid.mesh.geometry.x[:, :2] - base
    for height, way in ((0.0, 0.05), (4.0, -0.05)):
        on_wall = base[:, 1] == height
        along, away = shift[on_wall].T
        np.testing.assert_array_equal(away, 0.0)
        np.testing.assert_allclose(along, along[0], atol=1e-15)
        assert along[0] / way == pytest.approx(1.0, abs=0.6)
        assert along[0] / way > 0.4


def test_vectors_turn_without_becoming_longer() -> None:
    """A linear displacement would make them longer by half the square of the angle."""
    r = np.array([[3.0, 4.0], [3.0, 4.0], [0.0, 5.0]])
    change = turned(r, np.array([1e-9, 0.1, np.pi / 2]))
    np.testing.assert_allclose(np.hypot(*(r + change).T), 5.0, rtol=1e-15)
    np.testing.assert_allclose(change[0], 1e-9 * np.array([-4.0, 3.0]), rtol=1e-8)
    np.testing.assert_allclose(change[2], [-5.0, -5.0], rtol=1e-15)
