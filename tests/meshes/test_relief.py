"""Walls with a shape: distances, normals, areas and pieces, against closed forms and many points."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from fsi.arrays import Array
from fsi.case.profiles.profile import WallProfile
from fsi.case.profiles.tip import TipOfWall
from fsi.case.profiles.wave import Wave
from fsi.meshes.build import build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.jets import Jet
from fsi.meshes.geometry.round import HalfPlane
from fsi.meshes.geometry.shaped import ShapedWalls
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.planar.grading import Grading
from fsi.meshes.resolution import Resolution

BOX = Box((-3.0, 0.0), (3.0, 4.0))
WAVE = Wave(kind="wave", height=0.3, length=0.8, number=3, start=-1.5)
DIP = Wave(kind="wave", height=-1.5, length=0.8, number=3, start=-1.5)
TIP = TipOfWall(kind="tip", place=0.2, height=0.5, alpha=1.0 / 3.0, length=1.0, rounding=0.2)
PROFILES = {"wave": WAVE, "dip": DIP, "tip": TIP}


def box(profile: WallProfile, wall: str = "bottom") -> ShapedWalls:
    return ShapedWalls.of(BOX, {wall: profile.heights()})


@cache
def many_points(name: str) -> np.ndarray:
    """Of the bottom, 2e5 some 3e-5 apart."""
    at, heights = np.linspace(-3.0, 3.0, 200_001), PROFILES[name].heights()
    inside = (at > heights.interval[0]) & (at < heights.interval[1])
    x = np.column_stack([at, np.zeros_like(at)])
    x[inside, 1] = heights.at(at[inside])[0]
    return x


@pytest.mark.parametrize("name", PROFILES)
@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_distances_are_those_of_the_nearest_of_many_points(name: str, seed: int) -> None:
    """Half of the points near to the wall, on both sides of it; in the wall they are negative."""
    random, wall = np.random.default_rng(seed), many_points(name)
    x = random.uniform([-3.0, 0.0], [3.0, 3.0], (100, 2))
    x[::2] = wall[random.integers(len(wall), size=50)] + random.normal(scale=0.05, size=(50, 2))
    brute, _ = cKDTree(wall).query(x)
    distance = box(PROFILES[name]).distances(x)[:, 2]
    fluid = (x[:, 1] > np.interp(x[:, 0], *wall.T)) & (np.abs(x[:, 0]) < 3.0)
    np.testing.assert_allclose(distance[fluid], brute[fluid], atol=1e-4)
    assert np.all(distance[~fluid & (brute > 1e-4) & (np.abs(x[:, 0]) < 3.0)] < 0.0)


def test_the_nearest_point_takes_few_rounds() -> None:
    """Two searches of five points each; beside other points of the sample one took 41 rounds by halving."""
    (piece, *_) = (curve for curve in box(WAVE).outline() if curve.solid is not None)
    assert piece.solid is not None
    outline, places = piece.solid.outline, list[int]()

    def counted(t: Array) -> Jet:
        places.append(len(t))
        return outline.formula(t)

    x = np.array([(-1.1, 1.2), (-0.7, 0.9), (0.1, 2.5), (2.0, 3.0), (-2.9, 0.5)]) - piece.solid.centre
    found = replace(outline, formula=counted)
    assert len(found.t) > 100
    places.clear()
    t = found.nearest(x)
    assert len(places) <= 16
    np.testing.assert_array_equal(t, outline.nearest(x))


@pytest.mark.parametrize("name", PROFILES)
def test_normals_are_gradients_of_distances(name: str) -> None:
    random = np.random.default_rng(1)
    x = np.column_stack([random.uniform(-2.9, 2.9, 300), random.uniform(0.55, 3.0, 300)])
    container, step = box(PROFILES[name]), 1e-6
    gradient = np.stack(
        [
            container.distances(x + step * e)[:, 2] - container.distances(x - step * e)[:, 2]
            for e in np.eye(2)
        ],
        axis=1,
    ) / (2.0 * step)
    # On the medial axis between crests the nearest point jumps.
    same = np.linalg.norm(gradient, axis=1) > 1.0 - 1e-6
    assert same.mean() > 0.95
    np.testing.assert_allclose(container.normals(x)[same, 2], gradient[same], atol=1e-5)


@pytest.mark.parametrize("wall", ["bottom", "top", "left", "right"])
def test_every_wall_has_its_shape_towards_the_fluid(wall: str) -> None:
    """A tip of height 0.5 at the coordinate 0.2 along the wall, the foot of which is above the wall."""
    lower, upper = (-3.0, -3.0), (3.0, 3.0)
    container = ShapedWalls.of(Box(lower, upper), {wall: TIP.heights()})
    k, across = container.walls.index(wall), 1 if wall in ("bottom", "top") else 0
    end = np.full(2, 0.2)
    end[across] = (-1.0 if wall in ("bottom", "left") else 1.0) * (3.0 - 0.5 - 0.01)
    assert container.distances(end[None])[0, k] == pytest.approx(0.01, rel=1e-9)
    others = np.delete(np.arange(4), k)
    np.testing.assert_array_equal(
        container.distances(end[None])[0, others], Box(lower, upper).distances(end[None])[0, others]
    )


@pytest.mark.parametrize("name", ["wave", "dip"])
def test_the_area_over_a_wave_is_half_its_height_times_its_length(name: str) -> None:
    profile = PROFILES[name]
    assert isinstance(profile, Wave)
    lost = BOX.volume - box(profile).volume
    assert lost == pytest.approx(0.5 * profile.height * 3.0 * 0.8, rel=1e-12)


@pytest.mark.parametrize("name", PROFILES)
def test_the_pieces_of_a_wall_go_from_corner_to_corner(name: str) -> None:
    """Each begins where the one before ends, in the very same numbers, on the wall, the fluid on its left."""
    curves = [curve for curve in box(PROFILES[name], "top").outline() if curve.wall == 3]
    assert curves[0].ends[0].tolist() == [3.0, 4.0]
    assert curves[-1].ends[1].tolist() == [-3.0, 4.0]
    for before, after in pairwise(curves):
        assert before.ends[1].tolist() == after.ends[0].tolist()
    container = box(PROFILES[name], "top")
    for curve in curves:
        x = curve.at(curve.samples)
        np.testing.assert_allclose(x[[0, -1]], curve.ends, atol=1e-13)
        assert np.abs(container.distances(x)[:, 3]).max() < 1e-13
        along = np.diff(x, axis=0)
        left = np.column_stack([-along[:, 1], along[:, 0]])
        assert np.all((container.normals(x[:-1] + 0.5 * along)[:, 3] * left).sum(axis=1) > 0.0)


def test_a_larger_and_moved_wall_is_the_same_wall() -> None:
    x = np.random.default_rng(2).uniform([-2.5, 0.6], [2.5, 3.5], (50, 2))
    container, origin = box(TIP), np.array([0.3, -0.2])
    larger = container.scaled(7.0)
    np.testing.assert_allclose(larger.distances(7.0 * x), 7.0 * container.distances(x), rtol=1e-12)
    moved = container.seen_from(origin)
    assert moved is not None
    np.testing.assert_allclose(moved.distances(x - origin), container.distances(x), rtol=1e-12)
    assert ShapedWalls.of(HalfPlane(5.0), {"plane": TIP.heights()}).seen_from(origin) is None


def test_sizes_of_cells_follow_the_curvature_of_a_wall() -> None:
    """On the crest of a wave (2 / height) (length / 2 pi)^2; a wall that is straight asks for none."""
    crest = np.array([[-1.1, 0.3 + 1e-9]])
    bend = box(WAVE).bends(crest)[0, 2]
    assert bend == pytest.approx(2.0 / 0.3 * (0.8 / (2.0 * np.pi)) ** 2, rel=1e-6)
    assert box(WAVE).bends(np.array([[2.5, 0.1]]))[0, 2] == np.inf


@pytest.mark.parametrize(("wall", "height"), [("bottom", 0.6), ("right", 0.3)])
def test_a_wave_that_reaches_corners_is_meshed(wall: str, height: float) -> None:
    """Elements of the wall beside it began 33 times as long; triangles between it and the corner lay flat.

    They begin as long as those of the wave, whose radius is 1 / h'' = L^2 / (2 pi^2 height) there.
    """
    profile = Wave(kind="wave", height=height, length=1.0, number=8, start=-4.0)
    walls = ShapedWalls.of(Box((-4.0, -4.0), (4.0, 4.0)), {wall: profile.heights()})
    resolution, domain = (
        Resolution(0.45, 32, 0.33),
        FluidDomain(walls, np.array([[0.0, 0.0]]), np.array([0.6])),
    )
    fluid = build(domain, resolution, 4)
    assert fluid.instead == ""
    assert fluid.quality > 0.3
    corner = np.array([4.0, -4.0])
    away = [np.hypot(*(curve.nodes - corner).T) for curve in boundary(domain, resolution)]
    first = sorted(np.partition(d, 1)[1] for d in away if d.min() == 0.0)
    np.testing.assert_allclose(first, 2.0 * np.pi / 32 / (2.0 * np.pi**2 * height), rtol=0.05)


def test_a_wave_that_bends_away_from_the_fluid_changes_nothing_beside_it() -> None:
    walls = ShapedWalls.of(BOX, {"bottom": DIP.heights(), "left": WAVE.heights()})
    assert sum(len(Grading.beside_bends(walls.outline(), k, Resolution()).corners) for k in range(4)) == 0
    dip = Wave(kind="wave", height=-0.3, length=1.0, number=6, start=-3.0)
    outline = box(dip).outline()
    assert sum(len(Grading.beside_bends(outline, k, Resolution()).corners) for k in range(4)) == 0


def test_two_waves_that_meet_in_a_corner_are_meshed() -> None:
    """Their radii of curvature there are as 244 to 1; the gentler one had elements as long as elsewhere."""
    shapes = {"bottom": (0.07, 8.0 / 3.0, 3), "right": (0.6, 0.5, 16)}
    waves = {
        wall: Wave(kind="wave", height=height, length=length, number=number, start=-4.0).heights()
        for wall, (height, length, number) in shapes.items()
    }
    domain = FluidDomain(
        ShapedWalls.of(Box((-4.0, -4.0), (4.0, 4.0)), waves), np.array([[0.0, 0.0]]), np.array([0.6])
    )
    fluid = build(domain, Resolution(0.45, 32, 0.33), 4)
    assert fluid.instead == ""
    assert fluid.quality > 0.3
