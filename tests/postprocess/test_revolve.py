"""Revolved grids: volumes and surfaces of revolution, vectors that turn along."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

import fsi
from fsi.errors import InputError
from fsi.meshes.cells.lagrange import reference_nodes
from fsi.postprocess.export import export_revolved, revolved
from tests.postprocess.spatial_run import write_spatial_run


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


def test_only_axisymmetric_runs_are_revolved(run: Path, tmp_path: Path) -> None:
    in_space = tmp_path / "in_space"
    in_space.mkdir()
    for path, kind in (run, "planar"), (write_spatial_run(in_space), "spatial"):
        with pytest.raises(InputError, match=f"the run is {kind}; only an axisymmetric"):
            export_revolved(fsi.open_run(path), path / "revolved", 360.0, 12)
        assert not (path / "revolved").exists()


def test_nothing_is_left_of_a_revolution_that_fails(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """So that the command can be given again; a folder that was there is left alone."""
    case, folder = run / "case.toml", run / "revolved"
    case.write_text(case.read_text().replace('"planar"', '"axisymmetric"'))

    def full(_: object, path: Path) -> None:
        path.write_text("half a gr")
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(pv.UnstructuredGrid, "save", full)
        with pytest.raises(InputError, match="No space left on device"):
            export_revolved(fsi.open_run(run), folder, 90.0, 3)
    assert not folder.exists()
    folder.mkdir()
    (folder / "mine.txt").touch()
    with pytest.raises(InputError, match="give a new folder"):
        export_revolved(fsi.open_run(run), folder, 90.0, 3)
    assert [path.name for path in folder.iterdir()] == ["mine.txt"]
