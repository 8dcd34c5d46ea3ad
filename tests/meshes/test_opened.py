"""Periodic domains opened along links: areas, matching sides, dense and awkward arrangements."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.cells.curved import curve, scaled_jacobian
from fsi.meshes.errors import MeshError, TouchingError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.lattice import Lattice, reduced
from fsi.meshes.geometry.matching import matching_points
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.planar.links import NeighbourLinks, neighbours
from fsi.meshes.planar.sizing import Surfaces
from fsi.meshes.planar.triangulate import triangulate
from fsi.meshes.resolution import Resolution

COARSE = Resolution(0.25, 12, 1.0)


def hexagonal(gap: float) -> tuple[Cell, Array]:
    """Two discs of radius 1 in the cell of a hexagonal array: every straight line cuts discs."""
    side = 2.0 + gap
    return Cell(((side, 0.0), (0.0, np.sqrt(3.0) * side)), ((0.0, 1.0), (0.0, 0.0))), np.array(
        [[0.1, 0.2], [0.1 + 0.5 * side, 0.2 + 0.5 * np.sqrt(3.0) * side]]
    )


def check(container: Container, centres: Array, radii: Array) -> None:
    """The area is that of the domain without the discs; both sides of the cut match; no cell is inverted."""
    curves = boundary(FluidDomain(container, centres, radii), COARSE)
    straight = triangulate(curves)
    vertices, triangles = straight.vertices, straight.cells
    cells = curve(straight, curves, 3)
    assert scaled_jacobian(cells.nodes[cells.cells], 3).min() > 0.1
    on_cut = np.unique(straight.facets[straight.tags == len(radii) + len(container.walls) + 1])
    pairs = matching_points(vertices[on_cut], Lattice(container.periods))
    assert 2 * len(pairs.slave) == len(on_cut) > 0
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area = 0.5 * np.sum((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    # Polygons in place of circles, whose sagitta is some hundredths of a radius.
    assert area == pytest.approx(
        container.volume - np.pi * np.sum(radii**2), abs=0.06 * np.sum(radii**2) * np.pi
    )


@pytest.mark.parametrize("gap", [0.5, 1e-2, 1e-4])
def test_hexagonal_array(gap: float) -> None:
    """Area fractions up to 0.9068."""
    cell, centres = hexagonal(gap)
    for t in (0.0, 0.3):
        if t == 0.0 or gap == 0.5:
            check(cell.at(t), centres, np.ones(2))


def test_a_channel_without_bodies() -> None:
    check(Box((0.0, 0.0), (3.0, 1.0), periodic=("x",)), np.empty((0, 2)), np.empty(0))


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.booleans())
def test_random_discs(seed: int, walls: bool) -> None:
    """Polydisperse discs anywhere, one of them alone or many."""
    random = np.random.default_rng(seed)
    container: Container = Cell(((6.0, 0.0), (2.0, 5.0)), ((0.0, 0.0), (0.0, 0.0)))
    if walls:
        container = Box((-1.0, 0.0), (5.0, 5.0), periodic=("x",))
    lattice, centres, radii = Lattice(container.periods), np.empty((0, 2)), np.empty(0)
    for _ in range(int(random.integers(1, 40))):
        x, a = random.uniform((-9.0, 0.0), (9.0, 5.0))[None], random.uniform(0.2, 1.2)
        apart = x - centres
        apart -= lattice.shift(lattice.nearest(apart))
        room = np.append(np.hypot(*apart.T) - radii, container.distances(x)).min(initial=2.0) - a
        if room > 1e-3:
            centres, radii = np.vstack([centres, x]), np.append(radii, a)
    if len(radii):
        check(container, centres, radii)


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_channels_in_strips(seed: int) -> None:
    """Each piece is filled by itself, and they fit together: `triangulate` requires it."""
    random = np.random.default_rng(seed)
    channel, centres = Box((0.0, 0.0), (20.0, 8.0), periodic=("x",)), np.empty((0, 2))
    for x in random.uniform((0.0, 0.51), (20.0, 7.49), (400, 2)):
        apart = x - centres - np.array([20.0, 0.0]) * np.rint((x - centres)[:, :1] / 20.0)
        if np.hypot(*apart.T).min(initial=9.0) > 1.001:
            centres = np.vstack([centres, x])
    radii = np.full(len(centres), 0.5)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fsi.meshes.planar.strips.FEWEST", 20)
        patch.setattr("fsi.meshes.planar.strips.BODIES", 10)
        curves = boundary(FluidDomain(channel, centres, radii), COARSE)
        assert len({piece for curve in curves for piece in curve.pieces}) > 1
        check(channel, centres, radii)


def test_without_periods_each_point_is_its_only_image() -> None:
    x, no_lattice = np.array([[1.0, -2.0, 3.0]]), Lattice(np.empty((0, 3)))
    assert no_lattice.near().shape == (1, 0)
    np.testing.assert_array_equal(no_lattice.wrapped(x), x)
    np.testing.assert_array_equal(x - no_lattice.shift(no_lattice.nearest(x)), x)


def test_reduced_basis_of_a_lattice() -> None:
    """Shortest vectors of a lattice sheared by 7/2, by hand: (1, 0) and (1/2, 1)."""
    a, b = reduced(np.array([[1.0, 0.0], [3.5, 1.0]]))
    assert a @ a == pytest.approx(1.0)
    assert b @ b == pytest.approx(1.25)


@pytest.mark.parametrize("vectors", [[[1, 0], [0.5, np.sqrt(0.75)]], [[0, 1, 1], [1, 0, 1], [1, 1, 0]]])
def test_lattices_with_vectors_as_long_as_each_other_are_reduced(vectors: list[list[float]]) -> None:
    """Hexagonal and face-centred ones of any size, where rounding may say either of two is the longer one."""
    for size in np.random.default_rng(0).uniform(1.0, 3.0, 500):
        lattice = size * np.array(vectors)
        oblique = np.vstack([lattice[0] - 2.0 * lattice[1], lattice[1:]])
        longest = np.linalg.norm(lattice[0])
        np.testing.assert_allclose(np.linalg.norm(reduced(oblique), axis=1), longest, rtol=1e-12)


@pytest.mark.parametrize(("off", "match"), [(1e-11, True), (1e-8, False), (1e-3, False)])
def test_images_match_to_1e9_of_a_period_or_not_at_all(off: float, match: bool) -> None:
    """Nodes of the left and the right side of a period of 5, one of them off along the side."""
    left = np.column_stack([np.zeros(4), np.arange(4.0)])
    right = left + np.array([5.0, 0.0])
    right[2, 1] += 5.0 * off
    x, lattice = np.vstack([left, right]), Lattice(np.array([[5.0, 0.0]]))
    if match:
        pairs = matching_points(x, lattice)
        np.testing.assert_array_equal(np.sort(pairs.slave), [4, 5, 6, 7])
    else:
        with pytest.raises(MeshError, match="two sides of a periodic domain do not match; shift all bodies"):
            matching_points(x, lattice)


def test_nodes_of_a_narrow_gap_match_though_they_are_nearer_to_each_other_than_a_misplaced_image() -> None:
    """Sides of a period of 5 whose nodes are 1e-9 apart, by the order of the numbers along each."""
    left = np.column_stack([np.zeros(4), 1e-9 * np.arange(4.0)])
    x, lattice = np.vstack([left, left + np.array([5.0, 0.0])]), Lattice(np.array([[5.0, 0.0]]))
    pairs = matching_points(x, lattice)
    np.testing.assert_array_equal(pairs.slave, [4, 5, 6, 7])
    np.testing.assert_array_equal(pairs.master, [0, 1, 2, 3])


BIG_AND_TINY = FluidDomain(
    Cell(((9.0, 0.0), (0.0, 9.0)), ((0.0, 1.0), (0.0, 0.0))),
    np.array([[4.5, 4.0], [0.0, 0.0]]),
    np.array([4.0, 0.1]),
)


def in_no_image(_: Array, x: Array) -> NDArray[np.bool_]:
    """No point is inside the opened domain."""
    return np.zeros(len(x), dtype=bool)


def two_rings(surfaces: Surfaces) -> NeighbourLinks:
    """A link from each disc to its own image: the one cannot be reached from the other."""
    links = neighbours(surfaces, 9.0)
    own = links.first == links.second
    return links[np.array([np.flatnonzero(own & (links.first == i))[0] for i in range(2)])]


@pytest.mark.parametrize(("name", "broken"), [("faces._inside", in_no_image), ("opened.cut", two_rings)])
def test_a_cell_that_cannot_be_opened_names_its_narrowest_gap(
    name: str, broken: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The big disc is 1 from its own image."""
    check(BIG_AND_TINY.container, BIG_AND_TINY.centres, BIG_AND_TINY.radii)
    monkeypatch.setattr(f"fsi.meshes.planar.{name}", broken)
    words = r"cannot be opened; its narrowest gap, of the disc at \(4.5, 4\), is 1: widen it$"
    with pytest.raises(MeshError, match=words):
        boundary(BIG_AND_TINY, COARSE)


def test_what_touches_is_named_by_its_place() -> None:
    cell = Cell(((9.0, 0.0), (0.0, 9.0)), ((0.0, 1.0), (0.0, 0.0)))
    touching = FluidDomain(cell, np.array([[2.0, 2.0], [3.0, 2.0]]), np.array([1.0, 0.5]))
    with pytest.raises(
        TouchingError, match=r"the disc at \(2, 2\) touches a disc or wall, or overlaps it; move"
    ):
        boundary(touching, COARSE)
