"""In the narrowest gaps nodes stand face to face, and gmsh is shown the gaps opened."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.build import build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.planar.facing import SAME_FROM, FacedGap
from fsi.meshes.planar.sizing import Curve
from fsi.meshes.planar.spread import spread
from fsi.meshes.resolution import FINEST, Resolution
from tests.flows import BOX, disc_over_plane, discs

SQUARE = Box((0.0, 0.0), (4.0, 4.0))
UP = np.array([0.0, 1.0])
SIXTY = np.array([0.5, 0.5 * np.sqrt(3.0)])
TILT = np.array([np.cos(0.7), np.sin(0.7)])


def touching_pair(gap: float, other: float) -> Configuration:
    centre = np.array([0.3, 7.9])
    return Configuration(
        np.array([centre, centre + (1.0 + gap + other) * TILT]), np.zeros(2), np.array([1.0, other])
    )


def in_corner(gap: float) -> Configuration:
    return discs([(1.0 + gap, 1.0 + 2.0 * gap)], [1.0])


def three(gap: float) -> Configuration:
    """Three discs, each of which has two narrow gaps."""
    side = 2.0 + gap
    return discs([(0.0, 6.0), (side, 6.0), (0.5 * side, 6.0 + 0.5 * np.sqrt(3.0) * side)], [1.0] * 3)


def sphere_on_axis(gap: float) -> Configuration:
    return discs([(0.0, 1.0 + gap)], [1.0])


def around(angle: float, gap: float) -> Configuration:
    return discs([tuple((1.5 - gap) * np.array([np.cos(angle), np.sin(angle)]))], [1.0])


CASES = {
    "plane": (BOX, disc_over_plane(1e-8), (np.array([0.0, 0.0]), np.array([0.0, 1.0]))),
    "corner, left": (SQUARE, in_corner(1e-8), (np.array([0.0, 1.0]), np.array([1.0, 0.0]))),
    "corner, bottom": (SQUARE, in_corner(1e-8), (np.array([1.0, 0.0]), np.array([0.0, 1.0]))),
    "pair": (BOX, touching_pair(1e-7, 1.0), (np.array([0.3, 7.9]) + TILT, TILT)),
    "radii 1 and 0.1": (BOX, touching_pair(1e-8, 0.1), (np.array([0.3, 7.9]) + TILT, TILT)),
    "second of two": (BOX, three(1e-7), (np.array([0.0, 6.0]) + SIXTY, SIXTY)),
    "round": (Round(2.5), around(0.4, 1e-8), (2.5 * np.array([np.cos(0.4), np.sin(0.4)]),) * 2),
    "round, where its arcs meet": (Round(2.5), around(-0.5 * np.pi, 1e-7), (-2.5 * UP, UP)),
    "axis": (HalfPlane(50.0, True), sphere_on_axis(1e-8), (np.zeros(2), np.array([0.0, 1.0]))),
    "cell": (
        Cell(((2.0 + 1e-7, 0.0), (0.0, 5.0)), ((0.0, 0.0), (0.0, 0.0))),
        discs([(0.0, 0.0)], [1.0]),
        (np.array([1.0, 0.0]), np.array([1.0, 0.0])),
    ),
}  # fmt: skip


def near(curves: list[Curve], place: Array, distance: float, lattice: Lattice) -> Array:
    """Where the nodes of all surfaces lie from a place, no farther than that, each once."""
    x = np.concatenate([curve.nodes for curve in curves if curve.opening is not None]) - place
    away = x - lattice.shift(lattice.nearest(x))
    return np.unique(np.round(away[np.hypot(*away.T) < distance], 15), axis=0)


@pytest.mark.parametrize("name", CASES)
def test_nodes_face_each_other(name: str) -> None:
    """At each place along a gap there are two nodes, one on each side, but on the axis where it has an end.

    Nodes that are spread on each surface by itself are a tenth to a half of an element off.
    """
    container, q, (place, along) = CASES[name]
    curves = boundary(FluidDomain(container, q.centres, q.radii), Resolution())
    unit = along / np.hypot(*along)
    gap = 1e-7
    h = FINEST * np.sqrt(gap * q.radii.min())
    x = near(curves, place, 6.0 * h, Lattice(container.periods))
    xi = np.sort(x @ np.array([-unit[1], unit[0]]))
    assert len(xi) >= 8
    assert len(xi) % 2 == 0
    np.testing.assert_allclose(xi[::2], xi[1::2], atol=1e-4 * h)
    assert np.diff(xi[::2]).min() > 0.1 * h


@pytest.mark.parametrize("name", CASES)
def test_what_gmsh_makes_is_valid(name: str) -> None:
    """Cells a thousand times as long as wide, in the worst of which the Jacobian changes by a few percent."""
    container, q, _ = CASES[name]
    fluid = build(FluidDomain(container, q.centres, q.radii), Resolution(1.0, 24, 0.5), 3)
    assert fluid.quality > 0.5


def test_places_follow_the_law_of_sizes() -> None:
    """Of `h = 0.04 sqrt(a d)` at d = q + kappa xi^2 / 2, up to d = 1e-4 a; cells grow like log(a / q)."""
    q, a, kappa = 1e-8, 0.5, 3.0
    gap = FacedGap(q, a, kappa)
    xi = gap.places(1.0)
    middle = 0.5 * (xi[1:] + xi[:-1])
    asked = FINEST * np.sqrt(a * (q + 0.5 * kappa * middle**2))
    ratio = np.diff(xi) / asked
    assert 0.99 < ratio.min() <= ratio.max() < 1.005
    assert q + 0.5 * kappa * xi[-1] ** 2 == pytest.approx(SAME_FROM * a)
    added = len(FacedGap(q / 100.0, a, kappa).places(1.0)) - len(xi)
    assert added == pytest.approx(np.log(10.0) / FINEST * np.sqrt(2.0 / (kappa * a)), abs=1.0)


def test_narrow_gaps_are_opened_until_cells_are_four_times_as_long_as_wide() -> None:
    q = disc_over_plane(1e-8)
    curves = boundary(FluidDomain(BOX, q.centres, q.radii), Resolution())
    disc, bottom = curves[0], curves[3]
    assert disc.opening is not None
    assert bottom.opening is not None
    width = bottom.opening[np.hypot(*bottom.nodes.T).argmin(), 1]
    lifted = disc.opening[np.hypot(*disc.nodes.T).argmin(), 1]
    assert lifted - width + 1e-8 == pytest.approx(FINEST * 1e-4 / 4.0, rel=1e-6)
    wide = Resolution().opened(np.array([2e-4, np.inf]), 1.0)
    np.testing.assert_array_equal(wide, 0.0)


def test_places_beside_an_end_stay_on_a_wall_that_is_far_longer() -> None:
    """A plane of 1e5 radii, cut by the axis under the gap: a place before its end turns it inside out."""
    fixed = 4e-5 * np.arange(-9.0, 10.0)
    s = np.concatenate([[0.0], np.geomspace(1e-5, 1e5, 200)])
    for sign in (1.0, -1.0):  # the axis at the beginning of the wall, and at its end
        places = spread(np.sort(sign * s), np.full(201, 1e3), [fixed], 1.0)
        near = np.abs(places[np.abs(places) < 4e-4])
        assert np.all(np.diff(places) > 0.0)
        assert_allclose(np.sort(near), fixed[9:], atol=1e-16)
