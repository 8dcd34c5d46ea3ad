"""Ellipsoids in space: gaps against formulas and dense samples, curved cells, volumes, moved meshes."""

from __future__ import annotations

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.bodies.surface_gap import narrowest_gap
from fsi.integration.gap_limiter import greatest_approach
from fsi.meshes.build import build
from fsi.meshes.errors import TouchingError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.ellipsoid import Ellipsoid, PlacedEllipsoid
from fsi.meshes.geometry.rotations import turn_between
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.meshes.geometry.wall_feet import feet_in_space
from fsi.meshes.moving.move import Mover
from fsi.meshes.resolution import Resolution
from tests.meshes.spheres import volume

BOX = Box((-3.0, -3.0, -3.0), (3.0, 3.0, 3.0))
EVERYWHERE = np.random.default_rng(0).normal(size=(20_000, 3))
EVERYWHERE /= np.linalg.norm(EVERYWHERE, axis=1)[:, None]

half_axes = st.tuples(*[st.floats(0.2, 2.0)] * 3)
vectors = st.tuples(*[st.floats(-2.0, 2.0)] * 3)


def placed(axes: tuple[float, ...], centre: tuple[float, ...], angle: tuple[float, ...]) -> PlacedEllipsoid:
    return PlacedEllipsoid(Ellipsoid(np.array(axes)), np.array(centre), np.array(angle))


def surface(body: PlacedEllipsoid) -> Array:
    """A dense sample of it."""
    return body.centre + body.stretched(EVERYWHERE)


def fluid_of(body: PlacedEllipsoid) -> FluidDomain:
    return FluidDomain(BOX, body.centre[None], np.array([body.form.radius]), ellipsoids=(body,))


@settings(max_examples=15, deadline=None)
@given(half_axes, vectors, half_axes, vectors, vectors)
def test_gaps_between_ellipsoids_are_distances(
    a: tuple[float, ...], angle: tuple[float, ...], b: tuple[float, ...], turn: tuple[float, ...],
    apart: tuple[float, ...],
) -> None:  # fmt: skip
    """Alike from both sides; the foot and its opposite lie on the two; no sampled points are nearer."""
    one, other = placed(a, (0.0, 0.0, 0.0), angle), placed(b, apart, turn)
    there, back = one.gap_to(other), other.gap_to(one)
    assert there.gap == pytest.approx(back.gap, abs=1e-10)
    inside = np.linalg.norm(other.unstretched(surface(one)), axis=1).min() < 1.0
    if there.gap > 1e-9:
        on = [np.linalg.norm(one.unstretched(there.x)), np.linalg.norm(other.unstretched(there.opposite))]
        np.testing.assert_allclose(on, 1.0, atol=1e-7)
        assert not inside
    elif inside:
        assert there.gap < 0.0


@settings(max_examples=15, deadline=None)
@given(half_axes, vectors, st.tuples(*[st.floats(-0.5, 0.5)] * 3))
def test_gaps_of_an_ellipsoid_to_walls(
    a: tuple[float, ...], angle: tuple[float, ...], centre: tuple[float, ...]
) -> None:
    """Of planes, and of the sphere around it, against 20 000 of its points, which miss some 1e-4."""
    body = placed(a, centre, angle)
    x = surface(body)
    for container in (BOX, Round(3.0, dimension=3)):
        sampled = container.distances(x).min(axis=0)
        gaps = np.array([foot.gap for foot in feet_in_space(body, container)])
        assert np.all(gaps <= sampled + 1e-12)
        np.testing.assert_allclose(gaps, sampled, atol=5e-3)


def test_spheres_are_ellipsoids_of_equal_axes() -> None:
    """Gaps by centres and radii, and one ellipsoid across another, 3 - 1 - 0.5 apart."""
    one, other = (
        placed((1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (0.3, 0.0, 0.0)),
        placed((0.5,) * 3, (0.0, 2.0, 1.0), (0.0,) * 3),
    )
    assert one.gap_to(other).gap == pytest.approx(np.sqrt(5.0) - 1.5, rel=1e-13)
    long, flat = (
        placed((1.0, 0.2, 0.3), (0.0,) * 3, (0.0,) * 3),
        placed((2.0, 0.5, 1.0), (3.0, 0.0, 0.0), (0.0, 0.0, 0.5 * np.pi)),
    )
    assert long.gap_to(flat).gap == pytest.approx(1.5, rel=1e-13)


def test_overlap_is_found_where_no_centre_is_inside() -> None:
    """Two rods crossed like an X, 0.3 apart with half widths 0.2; at 0.41 they are free."""
    rod = placed((2.0, 0.2, 0.2), (0.0, 0.0, 0.0), (0.0, 0.0, 0.4))
    for height, gap in ((0.3, -0.1), (0.41, 0.01)):
        other = placed((2.0, 0.2, 0.2), (0.0, 0.0, height), (0.0, 0.0, -0.4))
        assert rod.gap_to(other).gap == pytest.approx(gap, abs=1e-12)


def test_gaps_of_a_configuration_turn_with_its_bodies() -> None:
    """Beside the floor of a half space a rod of half axes 2 and 0.5 stands 1 above it, upright on it."""
    q = Configuration(
        np.array([[0.0, 0.0, 2.5]]),
        np.zeros((1, 3)),
        np.array([2.0]),
        ellipsoids=(Ellipsoid(np.array([2.0, 0.5, 0.5])),),
    )
    container, turn = HalfPlane(50.0, dimension=3), np.array([[0.0, 0.0, 0.0, 0.0, 0.5 * np.pi, 0.0]])
    assert find_gaps(q, container).wall_gaps[0, 0] == pytest.approx(2.0, rel=1e-13)
    assert find_gaps(q.moved(turn), container).wall_gaps[0, 0] == pytest.approx(0.5, rel=1e-13)
    found = narrowest_gap(q.moved(turn), container)
    assert found is not None
    np.testing.assert_allclose(found.opposite, [0.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(q.way_to(q.moved(turn)), turn, atol=1e-14)
    # It loses 1.5 of 2 on the whole way.
    assert greatest_approach(q, container, turn, 0.5).loss > 0.5
    assert greatest_approach(q, container, 0.05 * turn, 0.5).loss < 0.5


@pytest.mark.slow
@pytest.mark.parametrize(("order", "rate"), [(2, 3.5), (3, 5.5)])
def test_the_volume_converges_at_twice_the_order(order: int, rate: float) -> None:
    """What is left of a box: of order h^(2 k), as around spheres."""
    body = placed((1.0, 0.5, 0.7), (0.1, 0.0, 0.0), (0.3, 0.2, 1.0))
    errors, sizes = [], []
    for cells in (14, 28):
        mesh = build(fluid_of(body), Resolution(1.0, cells, 1.0), order)
        errors.append(abs((BOX.volume - volume(mesh)) / body.form.volume - 1.0))
        sizes.append(1.0 / cells)
    assert errors[1] < 1e-4
    assert np.log(errors[0] / errors[1]) / np.log(2.0) > rate


def test_a_moved_mesh_keeps_the_ellipsoid_as_it_is() -> None:
    """Its nodes turn and move with it: the volume stays to rounding, and its facets lie on the new place."""
    body = placed((1.0, 0.5, 0.7), (0.1, 0.0, 0.0), (0.3, 0.2, 1.0))
    mesh = build(fluid_of(body), Resolution(1.0, 14, 1.0), 3)
    mover, before = Mover(mesh, body.centre[None], ellipsoids=[body]), volume(mesh)
    turned = placed((1.0, 0.5, 0.7), (0.15, 0.05, 0.0), (0.35, 0.3, 1.1))
    assert mover.move(turned.centre[None], angles=turned.angle[None]) is not None
    assert volume(mesh) == pytest.approx(before, rel=1e-12)
    x = mesh.mesh.geometry.x
    off = np.sort(np.abs(turned.off(x[np.abs(turned.off(x)) < 0.1])))
    old = np.sort(np.abs(body.off(x[np.abs(body.off(x)) < 0.1])))
    assert np.sum(off < 1e-4) > 100 > np.sum(old < 1e-4)
    mover.close()


def test_turns_compose() -> None:
    angles, others = np.array([[0.3, 0.2, 1.0]]), np.array([[-0.4, 1.0, 0.1]])
    q = Configuration(np.zeros((1, 3)), angles, np.ones(1))
    turn = np.column_stack([np.zeros((1, 3)), turn_between(angles, others)])
    np.testing.assert_allclose(q.moved(turn).angles, others, atol=1e-14)


@pytest.mark.parametrize(
    ("height", "words"), [(0.4, "touches a body or wall"), (0.505, "is below 0.02 of its")]
)
def test_what_has_no_room_is_refused(height: float, words: str) -> None:
    body = placed((1.0, 0.5, 0.5), (0.0, 0.0, height - 3.0), (0.0, 0.0, 0.0))
    with pytest.raises(TouchingError, match=words):
        build(fluid_of(body), Resolution(1.0, 14, 1.0), 2)
