"""Sides at which periodic domains in space are opened spare spheres, and gmsh cuts all images alike."""

from __future__ import annotations

import fsi.meshes.backend  # noqa: F401

import dolfinx
import numpy as np
import pytest
import ufl
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.case.load import parse_case
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.gap_prisms import choose, find_gaps
from fsi.meshes.spatial.seams import seam_turns
from fsi.meshes.spatial.sides import NEAR, Sides, choose_sides, clear_where_sides_meet, images
from fsi.meshes.spatial.sizing import Spacing
from fsi.stokes.meshes import CaseMeshes

SIDE = 7.5
AT_REST = ((0.0, 0.0, 0.0),) * 3


def cell(across: float = 0.0) -> Cell:
    return Cell(((SIDE, 0.0, 0.0), (across * SIDE, SIDE, 0.0), (0.0, 0.0, SIDE)), AT_REST)


def scattered(seed: int, container: Cell) -> FluidDomain:
    """Twenty spheres of radius 1 that do not touch, nor their images."""
    random, x = np.random.default_rng(seed), np.empty((0, 3))
    away = np.array(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3)).reshape(3, -1).T @ container.periods
    while len(x) < 20:
        more = random.uniform(0.0, 1.0, 3) @ container.periods
        if np.linalg.norm(x[:, None] + away - more, axis=2).min(initial=9.0) > 2.05:
            x = np.vstack([x, more])
    return FluidDomain(container, x, np.ones(20))


def one_sphere(places: Array) -> float:
    """How clear of a sphere of radius 1 around 0 lines and the corner are, with the sides at these places."""
    domain = FluidDomain(cell(), np.zeros((1, 3)), np.ones(1))
    sides = Sides(np.zeros(3), SIDE * np.eye(3), 3)
    return float(clear_where_sides_meet(sides, domain, [np.array([s / SIDE]) for s in places]).item())


def test_lines_and_corners_at_known_distances() -> None:
    """The line of two sides 0.6 and 0.8 away is 1 away, as is a corner 1 / sqrt(3) along all three."""
    assert one_sphere(np.array([0.6, 0.8, 3.0])) == pytest.approx(0.0, abs=1e-12)
    assert one_sphere(np.ones(3) / np.sqrt(3.0)) == pytest.approx(0.0, abs=1e-12)
    assert one_sphere(np.array([0.3, 0.4, 3.0])) == pytest.approx(0.5)
    assert one_sphere(np.array([3.0, 0.9, 1.2])) == pytest.approx(0.5)


@settings(max_examples=6, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.3]))
def test_no_two_sides_meet_where_they_nearly_touch_a_sphere(seed: int, across: float) -> None:
    """Of every third crowd the places that are best for each side alone have a line within NEAR of one."""
    domain = scattered(seed, cell(across))
    sides = choose_sides(domain, np.empty((0, 3)), np.empty(0))
    (places,) = Sides(np.zeros(3), sides.edges, 3).coordinates(sides.origin[None])
    at = [np.array([place]) for place in places]
    assert clear_where_sides_meet(Sides(np.zeros(3), sides.edges, 3), domain, at).item() >= NEAR


def test_images_of_a_sphere_turn_alike() -> None:
    """A sphere on a side has a narrow gap beside one of its images only, on the seam, which turns it."""
    x = np.array([[0.0, 0.0, 0.0], [1.51, 0.0, 0.3]])
    domain = FluidDomain(cell(), x, np.array([1.0, 0.5]))
    sides = Sides(np.array([0.2, -3.0, -3.0]), SIDE * np.eye(3), 3)
    every, of = images(domain, sides, 0.5)
    spacing = Spacing(every, Resolution(1.0, 14, 1.0), sides, of)
    layers = choose(find_gaps(spacing), spacing)
    assert len(layers) == 1
    assert np.sum(of == 0) == 2
    turns = seam_turns(spacing, layers)
    first, second = (turn for turn, body in zip(turns, of, strict=True) if body == 0)
    assert first is second
    assert first.angle > 0.0


@pytest.mark.parametrize("place", [(1.5, 1.6, 1.5), (1.649, 0.083, 1.5)])
def test_a_sphere_in_a_short_channel_is_meshed_wherever_it_is(place: tuple[float, float, float]) -> None:
    """Periods of three and four radii: the side that lies best goes through its middle, where gmsh did not
    find edges of one side on the other; so it moves a little."""
    case = parse_case(
        {
            "name": "x", "geometry": "spatial", "fluid": {"viscosity": 1.0},
            "domain": {"lower": [0.0] * 3, "upper": [4.0, 3.0, 3.5], "periodic": ["x", "y"]},
            "bodies": [{"name": "sphere", "radius": 1.0, "position": place}],
        }
    )  # fmt: skip
    fluid = CaseMeshes(case).mesh(case.configuration(), 0.0)
    one = dolfinx.fem.Constant(fluid.mesh, 1.0) * ufl.dx
    volume = dolfinx.fem.assemble_scalar(dolfinx.fem.form(one))
    assert fluid.instead == ""
    assert volume == pytest.approx(4.0 * 3.0 * 3.5 - 4.0 / 3.0 * np.pi, rel=1e-4)
