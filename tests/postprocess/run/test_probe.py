"""Values of flow in space, at points of the user's choice."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fsi
from fsi.errors import InputError
from fsi.postprocess.run.probe import on_plane, probe, read_points
from tests.postprocess.spatial_run import write_spatial_run


def test_pressure_is_found_in_curved_tetrahedra(tmp_path: Path) -> None:
    """p = x at the nodes of isoparametric cells: the map itself, so that it is x wherever the point lies."""
    x = np.random.default_rng(1).uniform(-1.9, 1.9, (50, 3))
    table = probe(fsi.open_run(write_spatial_run(tmp_path)), x)
    assert (table["where"] == "fluid").all()
    np.testing.assert_allclose(table["p"], x[:, 0], atol=1e-6)  # the files' nodes are in single precision
    # The cells are bent: a flow of second degree is met to their error only.
    np.testing.assert_allclose(table["u_x"], x[:, 1] * x[:, 2], atol=0.3)
    assert {"vorticity_x", "vorticity_y", "vorticity_z", "strain_rate"} <= {*table}


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([[0.0, 1.0]], "points have 2 components where this geometry has 3; give"),
        ([0.0], "points have 1 components where this geometry has 3; give"),
        (np.zeros((1, 1, 3)), r"points: an array of 3 dimensions; give \(n, 3\) numbers"),
        (1.0, "points: an array of 0 dimensions; give"),
        ([[0.0, np.nan, 0.0]], "points: not all are finite; give"),
        ([[0.0, np.inf, 0.0]], "points: not all are finite; give"),
        ([[0.0, 1.0, 0.0], [1.0]], "points: are no numbers, or not as many of each point; give"),
        ("a", "points: are no numbers"),
        (None, "points: are no numbers"),
        (np.array([[0.0, 1.0j, 0.0]]), "points: are no numbers"),
    ],
)
def test_what_is_no_point_is_refused(points: Any, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"^{words}"):
        probe(fsi.open_run(write_spatial_run(tmp_path)), points)


def test_one_point_or_none(tmp_path: Path) -> None:
    run = fsi.open_run(write_spatial_run(tmp_path))
    assert probe(run, [0.5, 0.0, 0.0])["where"].tolist() == ["fluid"]
    assert probe(run, []).empty


def test_a_path_is_no_run(tmp_path: Path) -> None:
    folder: Any = str(write_spatial_run(tmp_path))
    with pytest.raises(InputError, match=r"^run: is of type str; give fsi\.open_run\(PATH\)$"):
        probe(folder, [0.5, 0.0, 0.0])


def test_rectangles_lie_across_an_axis() -> None:
    grid = on_plane([0.0, 1.0, -1.0], [2.0, 1.0, 1.0], 3)
    assert grid.shape == (9, 3)
    np.testing.assert_allclose(grid[5], [2.0, 1.0, 0.0])
    with pytest.raises(InputError, match=r"--plane 0,1,0,1,2,3: give corners that share exactly one"):
        on_plane([0.0, 1.0, 0.0], [1.0, 2.0, 3.0], 3)


@pytest.mark.parametrize(
    ("text", "letters"),
    [
        ("1,2\n3,4\n", "xy"),
        ("x,y\n1,2\n3,4\n", "xy"),
        ("# of a mesh\nname, y, u, x\na, 2, 0, 1\nb, 4, 0, 3\n", "xy"),
        ("z,r\n2,1\n4,3\n", "rz"),
    ],
)
def test_points_are_the_columns_that_the_heading_names(text: str, letters: str, tmp_path: Path) -> None:
    """They were the first two, whatever they were called; (1, 2) and (3, 4) in all of these files."""
    (tmp_path / "points.csv").write_text(text)
    assert read_points(tmp_path / "points.csv", letters).tolist() == [[1.0, 2.0], [3.0, 4.0]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("r,z\n1,2\n", "the heading r,z has not all of x,y; give a CSV file of x,y"),
        ("x,y\n1\n", "has lines without 2 numbers"),
        ("x,y\n", "has lines without 2 numbers"),
        ("1\n2\n", "has lines without 2 numbers"),
        ("1,2\n3,inf\n", "has lines without 2 numbers"),
        ("1,2\n3,four\n", "has lines without 2 numbers"),
        ("", "cannot be read"),
    ],
)
def test_points_that_are_none(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "points.csv").write_text(text)
    with pytest.raises(InputError, match=said):
        read_points(tmp_path / "points.csv")
