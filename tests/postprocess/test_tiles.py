"""Windows on periodic flows: images of fluid and bodies, and the gaps to images."""

import numpy as np
import pytest
import pyvista as pv

from fsi.bodies import Configuration
from meshes.cell import Cell, Channel
from postprocess.tiles import images, tiled, window
from postprocess.view import View, gap_between, narrowest_gap

SHEAR, RISE = 0.5, -0.3
CELL = Cell(((1.0, 0.0), (0.2, 1.0)), ((0.0, SHEAR), (0.0, 0.0)))
CHANNEL = Channel((0.0, 0.0), (1.0, 1.0))


def parallelogram(periods: list[list[float]]) -> pv.UnstructuredGrid:
    """One period of the flow u = (shear y, 0), p = rise x, on two triangles."""
    a, b = np.array(periods)
    x = np.array([[0.0, 0.0], a, b, a + b])
    grid = pv.UnstructuredGrid(
        {pv.CellType.TRIANGLE: np.array([[0, 1, 2], [1, 3, 2]])}, np.pad(x, ((0, 0), (0, 1)))
    )
    grid["velocity"] = np.column_stack([SHEAR * x[:, 1], np.zeros(4), np.zeros(4)])
    grid["pressure"] = RISE * x[:, 0]
    return grid


def test_images_of_a_sheared_cell_fill_the_window_with_one_flow() -> None:
    """Their velocities are that of the mean flow where they are: merged nodes agree."""
    view = window(CELL)
    grid = parallelogram([[1.0, 0.0], [0.2, 1.0]])
    grid["pressure"][:] = 0.0
    flow = tiled(grid, CELL, view)
    np.testing.assert_allclose(flow["velocity"][:, 0], SHEAR * flow.points[:, 1], atol=1e-7)
    assert len(np.unique(np.round(flow.points, 6), axis=0)) == flow.n_points  # merged
    inside = np.random.default_rng(0).uniform(view.low, view.high, (200, 2))
    assert np.all(flow.find_containing_cell(np.pad(inside, ((0, 0), (0, 1)))) >= 0)


def test_pressure_goes_on_from_period_to_period() -> None:
    flow = tiled(parallelogram([[1.0, 0.0], [0.0, 1.0]]), CHANNEL, View(np.array([1.0, 0.5]), 1.0))
    np.testing.assert_allclose(flow["pressure"], RISE * flow.points[:, 0], atol=1e-7)
    assert flow.bounds[1] - flow.bounds[0] >= 2.0


def test_images_of_bodies_meet_the_window() -> None:
    q = Configuration(np.array([[0.95, 0.5]]), np.array([0.3]), np.array([0.1]))
    seen = images(q, CHANNEL, window(CHANNEL))
    np.testing.assert_allclose(np.sort(seen.centres[:, 0]), [-0.05, 0.95])
    np.testing.assert_allclose(seen.angles, 0.3)


@pytest.mark.parametrize("shift", [0.0, 3.0])
def test_gap_to_the_nearest_image(shift: float) -> None:
    """Discs at 0.1 and 0.95 - or periods away - face each other across the end of the period."""
    q = Configuration(np.array([[0.1, 0.5], [0.95 + shift, 0.5]]), np.zeros(2), np.array([0.05, 0.06]))
    for gap in (narrowest_gap(q, CHANNEL), gap_between(q, CHANNEL, (0, 1))):
        assert gap.width == pytest.approx(0.15 - 0.11)
        assert gap.middle[0] == pytest.approx(0.03)
