"""Pressures and gaps across the ends of a period."""

import numpy as np
import pytest
import pyvista as pv

from fsi.bodies.configuration import Configuration
from fsi.bodies.surface_gap import gap_between, narrowest_gap
from fsi.meshes.geometry.box import Box
from fsi.postprocess.render.scenes import tiled
from fsi.postprocess.render.view import View

RISE = -0.3
CHANNEL = Box((0.0, 0.0), (1.0, 1.0), periodic=("x",))


def one_period() -> pv.UnstructuredGrid:
    """The unit square with the pressure p = rise x, on two triangles."""
    x = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
    grid = pv.UnstructuredGrid({pv.CellType.TRIANGLE: np.array([[0, 1, 2], [1, 3, 2]])}, x)
    grid["pressure"] = RISE * x[:, 0]
    return grid


def test_pressure_goes_on_from_period_to_period() -> None:
    flow = tiled(one_period(), CHANNEL, View(np.array([1.0, 0.5]), 1.0))
    np.testing.assert_allclose(flow["pressure"], RISE * flow.points[:, 0], atol=1e-7)
    assert flow.bounds[1] - flow.bounds[0] >= 2.0


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e6, 1e9])
def test_images_share_the_nodes_of_their_ends_and_no_others(size: float) -> None:
    """Three squares side by side have 8 nodes; with a tolerance in place of a part of the size, 1 at 1e9."""
    grid = one_period()
    grid.points *= size
    channel = Box((0.0, 0.0), (size, size), periodic=("x",))
    flow = tiled(grid, channel, View(size * np.array([0.5, 0.5]), 0.9 * size))
    assert (flow.n_cells, flow.n_points) == (6, 8)


@pytest.mark.parametrize("shift", [0.0, 3.0])
def test_gap_to_the_nearest_image(shift: float) -> None:
    """Discs at 0.1 and 0.95 - or periods away - face each other across the end of the period."""
    q = Configuration(np.array([[0.1, 0.5], [0.95 + shift, 0.5]]), np.zeros(2), np.array([0.05, 0.06]))
    for gap in (narrowest_gap(q, CHANNEL), gap_between(q, CHANNEL, (0, 1))):
        assert gap is not None
        assert gap.width == pytest.approx(0.15 - 0.11)
        assert gap.middle[0] == pytest.approx(0.03)
