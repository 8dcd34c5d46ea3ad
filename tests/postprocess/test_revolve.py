"""Revolved grids: volumes and surfaces of revolution, vectors that turn along."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

import fsi
from fsi.errors import InputError
from fsi.meshes.cells.lagrange import reference_nodes
from fsi.postprocess.export import export_revolved, revolved


def meridian() -> pv.UnstructuredGrid:
    """One cubic cell, the triangle (0, 0), (1, 0), (0, 1) of the plane (r, z), with u = (r, 2 z)."""
    nodes = reference_nodes(3)
    points = np.column_stack([nodes, np.zeros(10)])
    grid = pv.UnstructuredGrid({pv.CellType.LAGRANGE_TRIANGLE: np.arange(10)[None]}, points)
    grid.point_data["velocity"] = points * [1.0, 2.0, 0.0]
    grid.point_data["pressure"] = points[:, 1]
    return grid


@pytest.mark.parametrize(("degrees", "sectors", "points"), [(360.0, 60, 600), (90.0, 15, 160)])
def test_a_triangle_becomes_a_cone(degrees: float, sectors: int, points: int) -> None:
    """Its volume is pi/3 at a full turn, less what a polygon of 60 sides lacks; no wedge is turned over."""
    cone = revolved(meridian(), np.linspace(0.0, np.radians(degrees), sectors + 1))
    assert (cone.n_points, cone.n_cells) == (points, 9 * sectors)
    sizes = cone.compute_cell_sizes()["Volume"]
    polygon = np.sin(2.0 * np.pi / 60) / (2.0 * np.pi / 60)
    assert sizes.sum() == pytest.approx(np.pi / 3.0 * polygon * degrees / 360.0, rel=1e-6)
    assert np.all(sizes > 0.0)


def test_vectors_turn_along() -> None:
    """u = (x, y, 2 z) everywhere, p = z."""
    cone = revolved(meridian(), np.linspace(0.0, 2.0 * np.pi, 13))
    np.testing.assert_allclose(cone["velocity"], cone.points * [1.0, 1.0, 2.0], atol=1e-14)
    np.testing.assert_allclose(cone["pressure"], cone.points[:, 2], atol=1e-14)


def test_a_curve_becomes_a_surface_that_keeps_its_body() -> None:
    """The line from (1, 0) to (1, 3), a cylinder of area 2 pi 3."""
    points = np.array([[1.0, 0.0, 0.0], [1.0, 3.0, 0.0], [1.0, 1.0, 0.0], [1.0, 2.0, 0.0]])
    line = pv.UnstructuredGrid({pv.CellType.LAGRANGE_CURVE: np.arange(4)[None]}, points)
    line.cell_data["body"] = np.array([7])
    cylinder = revolved(line, np.linspace(0.0, 2.0 * np.pi, 361))
    assert cylinder.n_cells == 3 * 360
    assert cylinder.compute_cell_sizes()["Area"].sum() == pytest.approx(6.0 * np.pi, rel=1e-4)
    assert set(cylinder["body"]) == {7}


def test_planar_runs_are_refused(run: Path) -> None:
    with pytest.raises(InputError, match="the run is planar"):
        export_revolved(fsi.open_run(run), run / "revolved", 360.0, 12)
    assert not (run / "revolved").exists()
