"""What the colours span: what pixels show, not what lies in films thinner than a pixel or out of sight."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv

from fsi.bodies.configuration import Configuration
from fsi.postprocess.render.fields_shown import DRAWINGS
from fsi.postprocess.render.scenes import Scene, derive
from fsi.postprocess.render.view import View


def scene(sides: list[float], values: list[float], away: float = 0.0) -> Scene:
    """Right triangles of those sides in a row, each with one pressure, and its size as the strain rate."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    starts = np.array([-0.9, -0.3, 0.3])[: len(sides)]
    x = np.concatenate(
        [side * corners + [start, 0.0, 0.0] for side, start in zip(sides, starts, strict=True)]
    )
    x[-3:, 0] += away
    cells = np.arange(len(x)).reshape(-1, 3)
    fluid = pv.UnstructuredGrid({pv.CellType.TRIANGLE: cells}, x)
    fluid["pressure"] = np.repeat(values, 3)
    fluid["strain_rate"] = np.abs(fluid["pressure"])
    derive(fluid, 1.0)
    nobody = Configuration.unturned(np.zeros((0, 2)), np.zeros(0))
    return Scene(View(np.zeros(2), 1.0), fluid, None, nobody, axisymmetric=False, viscosity=1.0)


@pytest.mark.parametrize(("side", "largest"), [(1e-3, 4.0), (0.02, 1e6)])
def test_a_film_below_a_pixel_does_not_set_the_colours(side: float, largest: float) -> None:
    """Parts 1e-6 and 4e-4 of the area; the limit lies at 1e-4, a hundred pixels of 1000 x 1000."""
    seen = scene([0.5, 0.5, side], [1.0, 4.0, -1e6])
    assert DRAWINGS["pressure"].span(seen) == (-largest, largest)
    low, high = DRAWINGS["dissipation"].span(seen)
    assert high == largest**2
    assert low == max(1.0, 1e-8 * high)


def test_what_is_out_of_sight_does_not_either() -> None:
    seen = scene([0.5, 0.5, 0.5], [1.0, 4.0, 1e6], away=3.0)
    assert DRAWINGS["pressure"].span(seen) == (-4.0, 4.0)


def test_a_constant_field_has_a_range() -> None:
    for value in (0.0, 1.0):
        low, high = DRAWINGS["dissipation"].span(scene([0.5], [value]))
        assert 0.0 < low < high
