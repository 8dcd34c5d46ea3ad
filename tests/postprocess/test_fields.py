"""Reading and refining field files, against the geometry and the stream function they were made from."""

from pathlib import Path

import numpy as np
import pyvista as pv

import fsi
from postprocess.fields import cells_within, edges, mirrored, refine, rims, stream_function

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
    surface = refine(fsi.open_run(run).mesh())
    distance = np.hypot(surface.points[:, 0], surface.points[:, 1] - HEIGHT)
    assert distance.min() > RADIUS - 2e-5
    np.testing.assert_allclose(surface["speed"], np.linalg.norm(surface["velocity"], axis=1))


def test_stream_function_with_its_sign(run: Path) -> None:
    """The trapezoidal rule on refined edges gives 1e-3 of the range; the wrong sign is off by twice it."""
    surface = refine(fsi.open_run(run).mesh(0))
    found = stream_function(surface, surface["velocity"])
    exact = np.sin(0.5 * surface.points[:, 0]) * surface.points[:, 1] ** 2
    error = found - exact
    assert np.ptp(error) < 1e-3 * np.ptp(exact)


def test_stream_function_of_a_uniform_stream_along_an_axis(run: Path) -> None:
    """u = e_z has Stokes's stream function -r^2 / 2.

    Also beyond the axis; the plane one, -x, is odd there.
    """
    surface = refine(mirrored(fsi.open_run(run).mesh(0)))
    w = np.zeros((surface.n_points, 3))
    w[:, 1] = surface.points[:, 0]
    error = stream_function(surface, w) + 0.5 * surface.points[:, 0] ** 2
    assert np.ptp(error) < 1e-3 * np.ptp(surface.points[:, 0]) ** 2


def test_mirrored_flow_turns_its_radial_component(run: Path) -> None:
    fluid = fsi.open_run(run).mesh(0)
    both = mirrored(fluid)
    n = fluid.n_points
    assert both.n_cells == 2 * fluid.n_cells
    np.testing.assert_array_equal(both.points[n:, 0], -fluid.points[:, 0])
    np.testing.assert_array_equal(both["velocity"][n:], fluid["velocity"] * [-1.0, 1.0, 1.0])


def test_stream_function_of_separate_parts(run: Path) -> None:
    fluid = fsi.open_run(run).mesh(0)
    far_left = cells_within(fluid, np.array([-9.0, 0.0]), np.array([-5.5, 9.0]))
    far_right = cells_within(fluid, np.array([5.5, 0.0]), np.array([9.0, 9.0]))
    surface = refine(far_left.merge(far_right))
    assert np.all(np.isfinite(stream_function(surface, surface["velocity"])))


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
