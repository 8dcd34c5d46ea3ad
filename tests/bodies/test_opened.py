"""Where narrow gaps of the plane shut fluid in."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.opened import way_out
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane

BOX, WALLS = Box((0.0, 0.0), (9.0, 9.0)), ("left", "right", "bottom", "top")
PLANE = HalfPlane(100.0)
TRIANGLE = 3.0 + 2.01 * np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)]])
CELL = Cell(((6.03, 0.0), (0.0, 9.0)), ((0.0, 0.0), (0.0, 0.0)))


@pytest.mark.parametrize(
    ("container", "solid", "centres", "widest"),
    [
        (BOX, WALLS, TRIANGLE, 0.01),
        (BOX, WALLS, TRIANGLE[:2], 0.02),
        (BOX, WALLS, np.array([[1.001, 1.01]]), 0.01),  # a corner: the wider of its gaps
        (BOX, ("right", "bottom", "top"), np.array([[1.01, 1.01]]), 0.02),  # that is open
        (BOX, WALLS, np.array([[1.01, 4.0]]), 0.02),
        (PLANE, ("plane",), np.array([[0.0, 1.005], [2.01, 1.005]]), 0.01),  # two that touch above it
        (PLANE, ("plane",), np.array([[0.0, 1.01], [2.5, 1.01]]), 0.02),
        (CELL, (), np.array([[1.0, 1.0], [3.01, 1.0], [5.02, 1.0]]), 0.02),  # a chain from side to side
        (CELL, (), TRIANGLE + np.array([3.0, 6.5]), 0.01),  # across the sides
    ],
)
def test_the_widest_gap_of_the_narrowest_loop_is_the_way_out(
    container: Container, solid: tuple[str, ...], centres: Array, widest: float
) -> None:
    q = Configuration.unturned(centres, np.ones(len(centres)))
    assert way_out(q, container, 0.02, solid) == pytest.approx(widest)
