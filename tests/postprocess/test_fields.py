"""Reading and refining field files, against the geometry and the stream function they were made from."""

from pathlib import Path

import numpy as np
import pytest

from fsi.errors import InputError
from postprocess.fields import cells_within, edges, mirrored, nodes, read_step, refine, stream_function

RADIUS, HEIGHT, FAR, CELLS = 1.0, 1.2, 6.0, 2 * 24 * 5


def test_all_parts_of_a_step_are_joined(run: Path) -> None:
    fluid, time = read_step(run)
    assert (time, fluid.n_cells) == (2.0, CELLS)
    vertices = np.unique(nodes(fluid)[:, :3])
    assert len(vertices) == 24 * 6  # the parts share the points of their border


def test_nearest_step_is_read(run: Path) -> None:
    early, time = read_step(run, 0.4)
    late, _ = read_step(run)
    assert time == 0.0
    np.testing.assert_allclose(late["velocity"], 3.0 * early["velocity"])


def test_curved_edges_follow_the_disc(run: Path) -> None:
    fluid, _ = read_step(run)
    lines = edges(fluid)
    assert lines.n_cells == CELLS + 24 * 6  # Euler: a ring has as many edges as cells and vertices together
    distance = np.hypot(lines.points[:, 0], lines.points[:, 1] - HEIGHT)
    assert distance.min() > RADIUS - 2e-5  # cubic interpolation; straight edges come 8.6e-3 inside
    on_disc = np.abs(distance - RADIUS) < 1e-4
    assert on_disc.sum() >= 24 * 9


def test_refined_triangles_follow_the_disc(run: Path) -> None:
    surface = refine(read_step(run)[0])
    distance = np.hypot(surface.points[:, 0], surface.points[:, 1] - HEIGHT)
    assert distance.min() > RADIUS - 2e-5
    np.testing.assert_allclose(surface["speed"], np.linalg.norm(surface["velocity"], axis=1))


def test_stream_function_with_its_sign(run: Path) -> None:
    """The trapezoidal rule on refined edges gives 1e-3 of the range; the wrong sign is off by twice it."""
    surface = refine(read_step(run, 0.0)[0])
    found = stream_function(surface, surface["velocity"])
    exact = np.sin(0.5 * surface.points[:, 0]) * surface.points[:, 1] ** 2
    error = found - exact
    assert np.ptp(error) < 1e-3 * np.ptp(exact)


def test_stream_function_of_a_uniform_stream_along_an_axis(run: Path) -> None:
    """u = e_z has Stokes's stream function -r^2 / 2.

    Also beyond the axis; the plane one, -x, is odd there.
    """
    surface = refine(mirrored(read_step(run, 0.0)[0]))
    w = np.zeros((surface.n_points, 3))
    w[:, 1] = surface.points[:, 0]
    error = stream_function(surface, w) + 0.5 * surface.points[:, 0] ** 2
    assert np.ptp(error) < 1e-3 * np.ptp(surface.points[:, 0]) ** 2


def test_mirrored_flow_turns_its_radial_component(run: Path) -> None:
    fluid = read_step(run, 0.0)[0]
    both = mirrored(fluid)
    n = fluid.n_points
    assert both.n_cells == 2 * fluid.n_cells
    np.testing.assert_array_equal(both.points[n:, 0], -fluid.points[:, 0])
    np.testing.assert_array_equal(both["velocity"][n:], fluid["velocity"] * [-1.0, 1.0, 1.0])


def test_stream_function_of_separate_parts(run: Path) -> None:
    fluid, _ = read_step(run, 0.0)
    far_left = cells_within(fluid, np.array([-9.0, 0.0]), np.array([-5.5, 9.0]))
    far_right = cells_within(fluid, np.array([5.5, 0.0]), np.array([9.0, 9.0]))
    surface = refine(far_left.merge(far_right))
    assert np.all(np.isfinite(stream_function(surface, surface["velocity"])))


def test_cells_within_a_window(run: Path) -> None:
    fluid, _ = read_step(run)
    low, high = np.array([-0.2, 0.0]), np.array([0.2, 0.2])
    near = cells_within(fluid, low, high)
    assert 0 < near.n_cells < CELLS // 4
    everything = cells_within(fluid, np.array([-9.0, -9.0]), np.array([9.0, 9.0]))
    assert everything.n_cells == CELLS
    everything.points = 0.0 * everything.points
    assert np.ptp(fluid.points) > FAR


def test_run_without_fields(run: Path) -> None:
    (run / "fluid.pvd").unlink()
    with pytest.raises(InputError, match=r"fluid\.pvd.*no fields; set output\.fields = true"):
        read_step(run)
