"""Reading and refining field files, against the geometry and the stream function they were made from."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

import fsi
from fsi.postprocess.render.curved_cells import cells_within, edges, mirrored, refine, rims, stream_function
from tests.postprocess.conftest import velocity

RADIUS, HEIGHT, FAR, CELLS = 1.0, 1.2, 6.0, 2 * 24 * 5


def test_curved_edges_follow_the_disc(run: Path) -> None:
    fluid = fsi.open_run(run).mesh()
    lines = edges(fluid)
    assert lines.n_cells == CELLS + 24 * 6  # Euler: a ring has as many edges as cells and vertices together
    distance = np.hypot(lines.points[:, 0], lines.points[:, 1] - HEIGHT)
    assert distance.min() > RADIUS - 2e-5  # cubic interpolation; straight edges come 8.6e-3 inside
    on_disc = np.abs(distance - RADIUS) < 1e-4
    assert on_disc.sum() >= 24 * 9


def test_refined_triangles_follow_the_disc(run: Path) -> None:
    fluid = fsi.open_run(run).mesh(0)
    surface = refine(fluid, ("velocity",), 0.02)
    distance = np.hypot(surface.points[:, 0], surface.points[:, 1] - HEIGHT)
    assert distance.min() > RADIUS - 2e-5
    assert surface.area == pytest.approx(0.5 * np.pi * FAR**2 - np.pi * RADIUS**2, rel=1e-3)
    normals = surface.compute_normals(auto_orient_normals=False, consistent_normals=False)["Normals"]
    assert np.ptp(normals[:, 2]) == 0.0  # none is turned over
    # The cubic through the nodes, 1e-2 of the exact flow where cells are as large as the disc.
    np.testing.assert_allclose(surface["velocity"], velocity(surface.points), atol=1e-2 * FAR**2)


def test_cells_are_refined_as_far_as_the_picture_shows(run: Path) -> None:
    """Sides of 0.26 and longer around the disc: one triangle a cell if longer ones will do."""
    fluid = fsi.open_run(run).mesh()
    assert refine(fluid, (), 100.0).n_cells == CELLS
    assert refine(fluid, (), 1e-9).n_cells == 4**4 * CELLS
    assert CELLS < refine(fluid, (), 1.0).n_cells < 4 * CELLS


def test_stream_function_with_its_sign(run: Path) -> None:
    """Cubic interpolation on cells as large as the disc errs by 1.2e-3 of the range; the wrong sign by 2."""
    fluid = fsi.open_run(run).mesh(0)
    exact = np.sin(0.5 * fluid.points[:, 0]) * fluid.points[:, 1] ** 2
    error = stream_function(fluid, fluid["velocity"]) - exact
    assert np.ptp(error) < 2e-3 * np.ptp(exact)


def test_stream_function_of_a_uniform_stream_along_an_axis(run: Path) -> None:
    """u = e_z has Stokes's stream function -r^2 / 2.

    Also beyond the axis; the plane one, -x, is odd there.
    """
    fluid = mirrored(fsi.open_run(run).mesh(0))
    r = np.asarray(fluid.points)[:, :1]
    error = stream_function(fluid, r * [0.0, 1.0, 0.0]) + 0.5 * r[:, 0] ** 2
    assert np.ptp(error) < 1e-6 * np.ptp(r) ** 2  # the files are in single precision


def test_mirrored_flow_turns_its_radial_component(run: Path) -> None:
    """And so does the vorticity, whose axis is seen from the other side; speeds and pressures stay."""
    fluid = fsi.open_run(run).mesh(0)
    fluid["vorticity"] = np.arange(1.0, fluid.n_points + 1.0)
    both = mirrored(fluid)
    n = fluid.n_points
    assert both.n_cells == 2 * fluid.n_cells
    np.testing.assert_array_equal(both.points[n:, 0], -fluid.points[:, 0])
    np.testing.assert_array_equal(both["velocity"][n:], fluid["velocity"] * [-1.0, 1.0, 1.0])
    np.testing.assert_array_equal(both["vorticity"][n:], -fluid["vorticity"])
    np.testing.assert_array_equal(both["pressure"][n:], fluid["pressure"])


def test_stream_function_of_separate_parts(run: Path) -> None:
    fluid = fsi.open_run(run).mesh(0)
    far_left = cells_within(fluid, np.array([-9.0, 0.0]), np.array([-5.5, 9.0]))
    far_right = cells_within(fluid, np.array([5.5, 0.0]), np.array([9.0, 9.0]))
    both = pv.merge([far_left, far_right], merge_points=False)
    psi = stream_function(both, both["velocity"])
    assert psi[0] == 0.0
    assert psi[far_left.n_points] == 0.0
    assert np.count_nonzero(psi) == both.n_points - 2


def test_cells_within_a_window(run: Path) -> None:
    fluid = fsi.open_run(run).mesh()
    low, high = np.array([-0.2, 0.0]), np.array([0.2, 0.2])
    near = cells_within(fluid, low, high)
    assert 0 < near.n_cells < CELLS // 4
    everything = cells_within(fluid, np.array([-9.0, -9.0]), np.array([9.0, 9.0]))
    assert everything.n_cells == CELLS
    everything.points = 0.0 * everything.points
    assert np.ptp(fluid.points) > FAR


def test_ribbons_lie_inside_the_bodies_and_carry_their_data() -> None:
    """Half a circle as one quadratic curve, (-1, 0), (1, 0), (0, 1): x = 2 s - 1, y = 1 - x^2."""
    points = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    body = pv.UnstructuredGrid({pv.CellType.LAGRANGE_CURVE: np.array([[0, 1, 2]])}, points)
    body.point_data["load"] = points[:, 0]
    body.cell_data["inside"] = np.zeros((1, 3))
    ribbon = rims(body, 0.1)
    outer, inner = np.split(ribbon.points, 2)
    np.testing.assert_allclose(outer[:, 1], 1.0 - outer[:, 0] ** 2, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(outer - inner, axis=1), 0.1, rtol=1e-12)
    np.testing.assert_allclose(ribbon["load"], np.tile(outer[:, 0], 2), atol=1e-14)
