"""A window filled with the images of a periodic flow."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import pyvista as pv

from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.postprocess.render.scenes import RIBBON, images, scene, tiled
from fsi.postprocess.render.view import View, around_period

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


def around_a_disc(container: Container, view: View) -> pv.UnstructuredGrid:
    """What a window shows of the surface, 96 sides, of a disc of radius 1 at the origin."""
    turn = 2.0 * np.pi * np.arange(96) / 96
    rim = np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
    sides = np.column_stack([np.arange(96), np.roll(np.arange(96), -1)])
    surface = pv.UnstructuredGrid({pv.CellType.LINE: sides}, rim)
    surface.cell_data["body"] = np.zeros(96, dtype=int)
    q = Configuration.unturned(np.zeros((1, 2)), np.ones(1))
    run: Any = SimpleNamespace(
        meshed=lambda _: q,
        container=lambda _: container,
        mesh=lambda *_: surface,
        case=SimpleNamespace(axisymmetric=False, fluid=SimpleNamespace(viscosity=1.0)),
    )
    corners = np.array([[-3.0, -2.0, 0.0], [3.0, -2.0, 0.0], [3.0, 2.0, 0.0], [-3.0, 2.0, 0.0]])
    fluid = pv.UnstructuredGrid({pv.CellType.TRIANGLE: np.array([[0, 1, 2], [0, 2, 3]])}, corners)
    bodies = scene(run, 0, fluid, view, tractions=True).bodies
    assert bodies is not None
    return bodies


@pytest.mark.parametrize("periodic", [("x",), ()])
def test_a_surface_just_out_of_sight_keeps_its_ribbon(periodic: tuple[str, ...]) -> None:
    """The leftmost point of the disc is 0.01 out of sight, its ribbon 0.1 wide: all its 96 sides are there.

    Without those that lie outside the window, up to 0.14 from that point, there would be 4 fewer.
    """
    view = View(np.array([1.01, 0.0]), 2.0)
    assert RIBBON * view.half == pytest.approx(0.1)
    assert around_a_disc(Box((-3.0, -2.0), (3.0, 2.0), periodic=periodic), view).n_cells == 96


def test_a_surface_far_away_is_not_drawn_in_a_close_up() -> None:
    """There single precision would be too coarse for what is near: 2 sides of 0.065 meet a window of 0.02."""
    bodies = around_a_disc(Box((-3.0, -2.0), (3.0, 2.0)), View(np.array([-1.0, 0.0]), 0.01))
    assert bodies.n_cells == 2
