"""Boundary nodes follow the law of sizes in the docstring of `fsi.meshes.planar.sizing`."""

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.planar.sizing import Curve, Surfaces
from fsi.meshes.resolution import Resolution
from tests.flows import BOX, HALF_PLANE, disc_over_plane, discs

COARSE = Resolution(1.0, 24, 0.5)
FINE = Resolution(2.0, 48, 0.25)


def curves(container: Container, q: Configuration, resolution: Resolution = COARSE) -> list[Curve]:
    return boundary(FluidDomain(container, q.centres, q.radii), resolution)


def chords(curve: Curve) -> tuple[Array, Array]:
    """Lengths of a curve's pieces and their middles, moved onto the circle where it follows one."""
    x = np.vstack([curve.nodes, curve.nodes[:1]]) if curve.closed else curve.nodes
    middle = 0.5 * (x[1:] + x[:-1])
    if curve.centre is not None:
        from_centre = middle - curve.centre
        radius = np.hypot(*(x[0] - curve.centre))
        middle = curve.centre + radius * from_centre / np.hypot(*from_centre.T)[:, None]
    return np.hypot(*np.diff(x, axis=0).T), middle


def h_gap(d: Array, a: float, resolution: Resolution) -> Array:
    """The documented size at a gap d beside radius a, worked out again."""
    along = np.sqrt(a * d)
    longest = np.maximum(4.0 * d, 0.04 * along)
    size: Array = np.maximum(np.minimum(0.11 * along, longest), 0.3 * d) / resolution.cells_per_gap
    return size


def to_bodies(x: Array, q: Configuration, but: int | None = None) -> Array:
    """Distance of points to the nearest body, `but` one."""
    gaps = [np.hypot(*(x - q.centres[j]).T) - q.radii[j] for j in range(len(q)) if j != but]
    nearest: Array = np.min(gaps, axis=0, initial=np.inf)
    return nearest


def asked_on_body(x: Array, i: int, container: Container, q: Configuration, resolution: Resolution) -> Array:
    d = np.minimum(to_bodies(x, q, but=i), container.distances(x).min(axis=1))
    h_body = 2.0 * np.pi * q.radii[i] / resolution.cells_per_circle
    size: Array = np.minimum(h_gap(d, q.radii.min(), resolution), h_body)
    return size


def asked_on_wall(x: Array, longest: float, q: Configuration, resolution: Resolution) -> Array:
    d = to_bodies(x, q)
    away = [np.hypot(*(x - centre).T) - a for centre, a in zip(q.centres, q.radii, strict=True)]
    h_body = 2.0 * np.pi * q.radii[:, None] / resolution.cells_per_circle
    far: Array = np.maximum(h_body, resolution.growth * np.array(away)).min(axis=0)
    return np.minimum(np.minimum(h_gap(d, q.radii.min(), resolution), far), longest)


@pytest.mark.parametrize("resolution", [COARSE, FINE])
@pytest.mark.parametrize(
    ("container", "q"),
    [
        (BOX, disc_over_plane(0.1)),
        (BOX, disc_over_plane(1e-3)),
        (BOX, disc_over_plane(1e-5)),
        (BOX, discs([(0.0, 3.0), (1.0101, 3.0)], [1.0, 0.01])),
        (BOX, discs([(-1.00005, 8.0), (1.00005, 8.0)], [1.0, 1.0])),
        (HALF_PLANE, disc_over_plane(1e-3)),
    ],
    ids=["gap 0.1", "gap 1e-3", "gap 1e-5", "radii 1 and 0.01", "pair", "half-plane"],
)
def test_nodes_equidistribute(container: Container, q: Configuration, resolution: Resolution) -> None:
    """Every chord has about the length that is asked for at its middle.

    Between the samples of h the nodes are even, which gives the 30 %. Where a branch of the law is missing
    the ratio is 1.5 (the lubrication length, in the largest gap) to 3000 (no gaps at all).
    """
    for curve in curves(container, q, resolution):
        length, middle = chords(curve)
        if curve.closed:
            asked = asked_on_body(middle, curve.tag - 1, container, q, resolution)
        elif curve.centre is not None:
            asked = asked_on_wall(middle, 0.5 * container.size() / 2.0, q, resolution)
        else:
            side = float(np.hypot(*(curve.nodes[-1] - curve.nodes[0])))
            asked = asked_on_wall(middle, 0.25 * side, q, resolution)
        ratio = length / asked
        # Rounding up to whole cells shortens all of them by up to 1 / cells.
        rounding = len(ratio) / (len(ratio) + 1.0)
        assert ratio.max() < 1.3
        assert ratio.min() > 0.65 * rounding


@pytest.mark.parametrize("gap", [0.2, 1e-2, 1e-5])
def test_a_node_stands_at_the_narrowest_place(gap: float) -> None:
    on_disc = curves(BOX, disc_over_plane(gap))[0].nodes
    assert np.hypot(*(on_disc - [0.0, gap]).T).min() < 1e-15
    tilt, centre = np.array([np.cos(0.7), np.sin(0.7)]), np.array([0.0, 8.0])
    pair = Configuration(np.array([centre, centre + (1.5 + gap) * tilt]), np.zeros(2), np.array([1.0, 0.5]))
    first, second = curves(BOX, pair)[:2]
    assert np.hypot(*(first.nodes - (centre + tilt)).T).min() < 1e-14
    assert np.hypot(*(second.nodes - (centre + (1.0 + gap) * tilt)).T).min() < 1e-14


@pytest.mark.parametrize(
    ("gap", "expected"),
    [(0.25, 0.075), (2e-2, 0.11 * np.sqrt(2e-2)), (2e-4, 8e-4), (1e-5, 0.04 * np.sqrt(1e-5))],
    ids=["a third of the gap", "lubrication length", "four gaps", "a part of the lubrication length"],
)
def test_size_at_the_narrowest_place(gap: float, expected: float) -> None:
    """The four branches of the law; where each applies, the others are 10 % off at least."""
    for curve in (curves(BOX, disc_over_plane(gap))[k] for k in (0, 3)):
        length, middle = chords(curve)
        nearest = np.argmin(np.hypot(*middle.T))
        assert length[nearest] == pytest.approx(expected, rel=0.025)


def test_an_isolated_disc_has_its_cells_evenly() -> None:
    disc = curves(BOX, discs([(0.0, 8.0)], [1.0]))[0]
    length, _ = chords(disc)
    assert len(length) == COARSE.cells_per_circle
    np.testing.assert_allclose(length, 2.0 * np.sin(np.pi / 24.0), rtol=1e-12)


def test_finer_everywhere_when_all_is_halved() -> None:
    q = disc_over_plane(1e-2)
    for coarse, fine in zip(curves(BOX, q, COARSE)[:4], curves(BOX, q, FINE)[:4], strict=True):
        assert len(fine.nodes) == pytest.approx(2 * len(coarse.nodes), abs=8 if coarse.closed else 6)


def test_nodes_of_a_body_lie_on_its_circle() -> None:
    q = discs([(0.3, 3.1), (1.0101 + 0.3, 3.1)], [1.0, 0.01])
    for curve, centre, radius in zip(curves(BOX, q), q.centres, q.radii, strict=False):
        np.testing.assert_allclose(np.hypot(*(curve.nodes - centre).T), radius, atol=1e-15)


def test_walls_meet_in_the_corners() -> None:
    left, right, bottom, top = (c.nodes for c in curves(BOX, disc_over_plane(0.5))[1:])
    corners = {(-8.0, 0.0), (8.0, 0.0), (-8.0, 16.0), (8.0, 16.0)}
    ends = [tuple(float(z) for z in end) for wall in (left, right, bottom, top) for end in wall[[0, -1]]]
    assert sorted(ends) == sorted(2 * list(corners))
    plane, far = (c.nodes for c in curves(HALF_PLANE, disc_over_plane(0.5))[1:])
    np.testing.assert_array_equal(plane[[0, -1]], far[[-1, 0]])


def test_no_bodies() -> None:
    walls = boundary(FluidDomain(BOX, np.empty((0, 2)), np.empty(0)), COARSE)
    assert [curve.tag for curve in walls] == [1, 2, 3, 4]


def test_a_large_body_behind_many_small_ones_is_not_overlooked() -> None:
    """Its centre is farther than those of thirty others, its surface is nearer than theirs."""
    angle = np.linspace(0.0, 2.0 * np.pi, 30, endpoint=False)
    small = np.column_stack([2.0 * np.cos(angle), 2.0 * np.sin(angle)])
    q = Configuration.unturned(np.vstack([small, [[6.5, 0.0]]]), np.append(np.full(30, 0.01), 5.0))
    surfaces = Surfaces.of(FluidDomain(BOX, q.centres, q.radii), COARSE)
    x = np.array([[0.0, 0.0], [0.5, 0.0], [0.0, 1.0], [-1.0, 0.3]])
    np.testing.assert_allclose(surfaces.to_bodies(x)[:2], [1.5, 1.0], rtol=1e-14)
    np.testing.assert_allclose(surfaces.to_bodies(x), to_bodies(x, q), rtol=1e-14)
