"""Containers: which wall is how far, which way it faces, what flows through it, what repeats itself."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.meshes.geometry.tube import Tube

IN_PLANE: list[Container] = [
    Box((-1.0, -2.0), (3.0, 5.0)),
    HalfPlane(4.0),
    Round(4.0),
    Box((-1.0, -2.0), (3.0, 5.0), periodic=("x",)),
    Box((-1.0, -2.0), (3.0, 5.0), periodic=("y",)),
    Box((-1.0, -2.0), (3.0, 5.0), periodic=("x", "y")),
    Cell(((5.0, 0.0), (1.0, 4.0)), ((0.0, 1.0), (0.0, 0.0))),
]
IN_SPACE: list[Container] = [
    Box((-1.0, -2.0, 1.0), (3.0, 5.0, 2.0)),
    HalfPlane(4.0, dimension=3),
    Tube(2.0, 5.0),
    Round(4.0, dimension=3),
    Box((-1.0, -2.0, 1.0), (3.0, 5.0, 2.0), periodic=("x", "z")),
]
ON_AXIS: list[Container] = [
    Box((0.0, -2.0), (3.0, 5.0), axisymmetric=True),
    HalfPlane(4.0, axisymmetric=True),
    Round(4.0, axisymmetric=True),
]


def test_distances_in_a_box() -> None:
    box = Box((-1.0, 0.0), (3.0, 2.0))
    d = box.distances(np.array([[0.0, 0.5], [3.5, 1.0]]))
    assert box.walls == ("left", "right", "bottom", "top")
    np.testing.assert_array_equal(d, [[1.0, 3.0, 0.5, 1.5], [4.5, -0.5, 1.0, 1.0]])  # negative: outside


def test_distances_in_a_half_plane() -> None:
    half = HalfPlane(10.0)
    d = half.distances(np.array([[3.0, 4.0], [0.0, -1.0], [6.0, 9.0]]))
    assert half.walls == ("plane", "far")
    np.testing.assert_allclose(d, [[4.0, 5.0], [-1.0, 9.0], [9.0, 10.0 - np.sqrt(117.0)]], rtol=1e-15)


def test_no_distance_inside_exceeds_the_size() -> None:
    assert Box((-1.0, 0.0), (3.0, 3.0)).size() == 5.0  # 3-4-5 triangle
    assert HalfPlane(10.0).size() == 20.0


def test_corner_axes_are_the_normals_at_the_corners() -> None:
    assert Box((0.0, 0.0), (1.0, 1.0)).corner_axes == (0, 0, 1, 1)
    assert HalfPlane(1.0).corner_axes == (1, 0)


@pytest.mark.parametrize("container", [*IN_PLANE, *IN_SPACE, *ON_AXIS], ids=str)
def test_normals_are_the_slopes_of_the_distances(container: Container) -> None:
    x = np.random.default_rng(0).uniform(0.1, 1.9, (20, container.dimension))
    h = 1e-6 * np.eye(container.dimension)
    slopes = [(container.distances(x + e) - container.distances(x - e)) / 2e-6 for e in h]
    np.testing.assert_allclose(container.normals(x), np.stack(slopes, axis=-1), atol=1e-9)


def by_quadrature(container: Container) -> Array:
    """Integrals of n_i and n_i x_j by Gauss's rule along the outline, whose left side is the fluid."""
    fluxes = np.zeros((len(container.walls), 2, 3))
    points, weights = np.polynomial.legendre.leggauss(20)
    for curve in container.outline():
        start, end = curve.interval
        s = start + 0.5 * (end - start) * (points + 1.0)
        x, ds = curve.at(s), 0.5 * (end - start) * weights
        outward = -container.normals(x)[:, curve.wall]
        np.testing.assert_allclose(container.distances(x)[:, curve.wall], 0.0, atol=1e-14)
        np.testing.assert_allclose(curve.at(np.array([start, end])), curve.ends, atol=1e-14)
        fluxes[curve.wall] += np.einsum("p,pi,pj->ij", ds, outward, np.column_stack([np.ones(len(x)), x]))
    return fluxes


def without_source(fluxes: Array) -> Array:
    """Less the part of n_i x_j that a flow with a source alone would feel."""
    d = fluxes.shape[1]
    outward, moments = fluxes[:, :, :1], fluxes[:, :, 1:]
    trace = np.einsum("kii->k", moments)[:, None, None]
    return np.concatenate([outward, moments - trace * np.eye(d) / d], axis=2)


@pytest.mark.parametrize("container", IN_PLANE, ids=str)
def test_fluxes_through_walls_in_the_plane(container: Container) -> None:
    """As each shape states them, and as its outline says."""
    expected = without_source(by_quadrature(container))
    np.testing.assert_allclose(without_source(container.wall_fluxes()), expected, atol=1e-12)
    np.testing.assert_allclose(Container.wall_fluxes(container), expected, atol=1e-12)


@pytest.mark.parametrize("container", [*IN_SPACE, *ON_AXIS], ids=str)
def test_what_a_linear_flow_brings_in_it_takes_out(container: Container) -> None:
    """With an axis that is one along z, or -r/2 and z, where no other goes."""
    net = container.wall_fluxes().sum(axis=0)
    if container.axisymmetric:
        np.testing.assert_allclose([net[1, 0], net[1, 2] - net[0, 1] / 2.0], 0.0, atol=1e-12)
    elif len(container.periods):
        np.testing.assert_allclose(net[:, 0], 0.0, atol=1e-12)
    else:
        np.testing.assert_allclose(without_source(net[None]), 0.0, atol=1e-12)


def test_fluxes_through_walls_in_space() -> None:
    """By hand: 7 x 1, 4 x 1 and 4 x 7, and times x in their middles; discs of radius 4, a lid of radius 3."""
    box = IN_SPACE[0].wall_fluxes()
    ends = np.array([[7.0, 21.0, 10.5, 10.5], [4.0, 4.0, 20.0, 6.0], [28.0, 28.0, 42.0, 56.0]])
    np.testing.assert_allclose(box[1::2], np.eye(3)[:, :, None] * ends[:, None])
    starts = np.array([[-7.0, 7.0, -10.5, -10.5], [-4.0, -4.0, 8.0, -6.0], [-28.0, -28.0, -42.0, -28.0]])
    np.testing.assert_allclose(box[::2], np.eye(3)[:, :, None] * starts[:, None])
    assert IN_SPACE[1].wall_fluxes()[1, 2, 0] == pytest.approx(16.0 * np.pi)
    round_axis = np.pi * np.array([[42.0, 0.0], [0.0, -9.0], [0.0, 9.0]])
    np.testing.assert_allclose(ON_AXIS[0].wall_fluxes()[:, :, 0], round_axis)


@pytest.mark.parametrize("container", [*IN_PLANE[:3], *ON_AXIS], ids=str)
def test_the_outline_goes_once_around(container: Container) -> None:
    """With the axis, it closes; Gauss' theorem gives the area that the container states, and the volume.

    The area is the integral of x.n / 2 along it, the volume of what revolves that of 2 pi r x.n / 3.
    """
    curves = container.outline()
    ends = np.array([curve.ends for curve in curves])
    assert sorted({curve.wall for curve in curves}) == list(range(len(container.walls)))
    points, weights = np.polynomial.legendre.leggauss(20)
    area = revolved = 0.0
    for curve in curves:
        start, end = curve.interval
        s, ds = start + 0.5 * (end - start) * (points + 1.0), 0.5 * (end - start) * weights
        outward = -container.normals(curve.at(s))[:, curve.wall]
        across = (curve.at(s) * outward).sum(axis=1)  # zero on an axis
        area += 0.5 * float(ds @ across)
        revolved += 2.0 / 3.0 * np.pi * float((ds * curve.at(s)[:, 0]) @ across)
    assert area == pytest.approx(container.volume, rel=1e-12)
    expected = revolved if container.axisymmetric else area
    assert container.volume_in_space == pytest.approx(expected, rel=1e-12)
    firsts, lasts = (sorted(map(tuple, ends[:, side].tolist())) for side in range(2))
    loose = set(firsts) ^ set(lasts)
    assert loose == ({(0.0, z) for z in container.axis()} if container.axisymmetric else set())


def test_a_box_may_be_periodic_in_any_directions() -> None:
    box = Box((0.0, 1.0, 2.0), (2.0, 4.0, 7.0), periodic=("x", "z"))
    assert box.walls == ("front", "back")
    assert box.corner_axes == (1, 1)
    assert box.boundary_names == ("front", "back", "cut")
    np.testing.assert_array_equal(box.periods, [[2.0, 0.0, 0.0], [0.0, 0.0, 5.0]])
    np.testing.assert_array_equal(box.distances(np.array([[9.0, 1.5, -3.0]])), [[0.5, 2.5]])
    all_ways = Box((0.0, 1.0, 2.0), (2.0, 4.0, 7.0), periodic=("x", "y", "z"))
    assert all_ways.walls == ()
    assert all_ways.normals(np.zeros((4, 3))).shape == (4, 0, 3)
    np.testing.assert_array_equal(all_ways.periods, np.diag([2.0, 3.0, 5.0]))
    assert (box.image_reach, Box((0.0,), (1.0,)).image_reach) == (box.size(), np.inf)


def test_corners_of_a_shape_that_does_not_state_their_axes() -> None:
    for container in (IN_PLANE[0], HalfPlane(4.0)):
        assert Container.corner_axes.fget(container) == container.corner_axes  # type: ignore[attr-defined]
