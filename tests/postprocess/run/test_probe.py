"""Values of flow in space, at points of the user's choice."""

from pathlib import Path

import numpy as np
import pytest

import fsi
from fsi.errors import InputError
from fsi.postprocess.run.probe import on_plane, probe
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


def test_rectangles_lie_across_an_axis() -> None:
    grid = on_plane([0.0, 1.0, -1.0], [2.0, 1.0, 1.0], 3)
    assert grid.shape == (9, 3)
    np.testing.assert_allclose(grid[5], [2.0, 1.0, 0.0])
    with pytest.raises(InputError, match=r"--plane 0,1,0,1,2,3: give corners that share exactly one"):
        on_plane([0.0, 1.0, 0.0], [1.0, 2.0, 3.0], 3)
