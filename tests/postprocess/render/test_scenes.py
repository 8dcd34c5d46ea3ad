"""A window filled with the images of a periodic flow."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv

from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.containers import Box
from fsi.meshes.geometry.lattice import Cell
from fsi.postprocess.render.scenes import images, tiled
from fsi.postprocess.render.view import around_period

SHEARED = Cell(((4.0, 0.0), (1.0, 3.0)), ((0.0, 0.8), (0.0, 0.0)))
CHANNEL = Box((-1.0, 0.0), (5.0, 3.0), periodic=("x",))


def one_period(container: Container, origin: tuple[float, float]) -> pv.UnstructuredGrid:
    """Two triangles that fill a period, opened anywhere, with the velocity E x."""
    a = container.periods[0]
    b = container.periods[1] if isinstance(container, Cell) else np.array([0.0, 3.0])
    x = np.array(origin) + np.array([np.zeros(2), a, a + b, b])
    gradient = np.array(container.gradient) if isinstance(container, Cell) else np.zeros((2, 2))
    cells = np.array([[3, 0, 1, 2], [3, 0, 2, 3]])
    grid = pv.UnstructuredGrid(cells, [pv.CellType.TRIANGLE] * 2, np.pad(x, ((0, 0), (0, 1))))
    grid["velocity"] = np.pad(x @ gradient.T, ((0, 0), (0, 1)))
    return grid


@pytest.mark.parametrize("container", [SHEARED, CHANNEL])
@pytest.mark.parametrize("along", [0.0, 17.0])
def test_copies_fill_the_window_without_overlap(container: Container, along: float) -> None:
    """Areas add up to whole periods, and the velocity is E x in every copy, so that it is continuous."""
    start = along * container.periods[0] / np.linalg.norm(container.periods[0])
    fluid, view = one_period(container, (start[0], start[1])), around_period(container)
    found = tiled(fluid, container, view)
    copies = found.area / container.volume
    assert copies == pytest.approx(round(copies), abs=1e-9)
    low, high = np.array(found.bounds[:4:2]), np.array(found.bounds[1:4:2])
    if isinstance(container, Cell):
        assert np.all(low <= view.low)
        assert np.all(high >= view.high)
    gradient = np.array(container.gradient) if isinstance(container, Cell) else np.zeros((2, 2))
    np.testing.assert_allclose(found["velocity"][:, :2], found.points[:, :2] @ gradient.T, atol=1e-12)
    points = np.unique(np.round(found.points, 9), axis=0)
    assert len(points) == found.n_points  # nodes of neighbouring copies are one


@pytest.mark.parametrize("container", [SHEARED, CHANNEL])
def test_images_of_bodies_against_a_plain_search(container: Container) -> None:
    q = Configuration.unturned(np.array([[0.3, 0.4], [30.0, 2.0]]), np.array([0.5, 0.3]))
    view = around_period(container)
    found, which = images(q, container, view)
    periods, expected = container.periods, []
    for i, a in enumerate(q.radii):
        for k in range(-20, 21):
            for m in range(-20, 21) if len(periods) == 2 else (0,):
                x = q.centres[i] + k * periods[0] + (m * periods[1] if len(periods) == 2 else 0.0)
                if np.all(np.abs(x - view.centre) <= view.half + a):
                    expected.append((*x, a))
    rows = sorted(map(tuple, np.column_stack([found.centres, found.radii]).tolist()))
    np.testing.assert_allclose(rows, sorted(expected), atol=1e-9)
    np.testing.assert_array_equal(found.radii, q.radii[which])
