"""Cells that curving would turn over: vertices move until they are valid, on coarse meshes too."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.arrangements.arrangement import Wanted
from fsi.arrangements.kinds import arrange
from fsi.meshes.cells.curved import CurvedCells, scaled_jacobian
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.curves import Sphere
from fsi.meshes.planar.triangulate import StraightCells
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.curved_tetrahedra import curve_tets
from fsi.meshes.spatial.tetrahedra import fill
from fsi.meshes.spatial.untangle import curved_and_valid

UNIT = {1: Sphere(np.zeros(3), 1.0)}


def fan(height: float) -> StraightCells:
    """A facet on the unit sphere, three outer corners, and a vertex so high above it, in a fan of cells."""
    angle = 2.0 * np.pi / 3.0 * np.arange(3)
    around = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(3)])
    low = 0.35 * around + [0.0, 0.0, np.sqrt(1.0 - 0.35**2)]
    high = 0.6 * around * [-1.0, -1.0, 1.0] + [0.0, 0.0, 1.6]
    apex = low.mean(axis=0) + height * np.array([0.0, 0.0, 1.0])
    a, b, c, d, e, f, v = range(7)
    shell = [(a, b, c), (a, b, f), (b, c, d), (c, a, e), (a, f, e), (b, d, f), (c, e, d), (d, e, f)]
    vertices = np.vstack([low, high, apex])
    cells = np.array([(*face, v) for face in shell])
    x = vertices[cells]
    upright = np.linalg.det(x[:, 1:] - x[:, :1]) > 0.0
    cells[~upright] = cells[~upright][:, [1, 0, 2, 3]]
    return StraightCells(vertices, cells, np.array(shell), np.array([1] + 7 * [2]))


def worst(cells: CurvedCells) -> float:
    return float(scaled_jacobian(cells.nodes[cells.cells], cells.order).min())


@pytest.mark.parametrize("order", [2, 3])
def test_a_flat_cell_over_a_facet_is_raised(order: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The sphere bulges by 1 - sqrt(1 - 0.35^2) = 0.063 there: 0.03 above the facet a cell turns over."""
    monkeypatch.setattr("fsi.meshes.spatial.untangle.MOST", 1.0)  # of eight cells here many are bad
    flat = fan(0.03)
    assert worst(curve_tets(flat, UNIT, order)) < 0.0
    mended = curved_and_valid(flat, UNIT, order)
    assert worst(mended) > 0.1
    np.testing.assert_array_equal(mended.nodes[:6], flat.vertices[:6])  # the others stand on walls


def test_a_good_mesh_is_left_as_it_is() -> None:
    good = fan(0.3)
    np.testing.assert_array_equal(curved_and_valid(good, UNIT, 3).nodes, curve_tets(good, UNIT, 3).nodes)


def test_coarse_cells_around_spheres_in_a_cell() -> None:
    """The first mesh is valid; its vertices are on the spheres, and opposite sides match."""
    packed = arrange("random", Wanted(4, 0.2, 0.05, cell="periodic", dimension=3))
    side = packed.cell.sides[0]
    zero = ((0.0,) * 3,) * 3
    container = Cell(tuple(map(tuple, (side * np.eye(3)).tolist())), zero)
    domain = FluidDomain(container, packed.centres, packed.radii)
    cells = fill(domain, Resolution(0.5, 14, 0.9)).curved(2)
    assert worst(cells) > 0.1
    for k, centre in enumerate(packed.centres, 1):
        apart = cells.nodes[np.unique(cells.edges[cells.tags == k])] - centre
        apart -= side * np.rint(apart / side)
        np.testing.assert_allclose(np.linalg.norm(apart, axis=1), 1.0, rtol=1e-12)
    on_sides = cells.nodes[np.unique(cells.edges[cells.tags == 5])]
    low, high = on_sides.min(axis=0), on_sides.max(axis=0)
    np.testing.assert_allclose(high - low, side, rtol=1e-9)
    for axis in range(3):
        first, other = (on_sides[np.abs(on_sides[:, axis] - end[axis]) < 1e-9] for end in (low, high))
        first, other = (np.delete(x, axis, axis=1) for x in (first, other))
        apart = np.linalg.norm(first[:, None] - other, axis=2)
        assert len(first) == len(other)
        np.testing.assert_allclose(apart.min(axis=1), 0.0, atol=1e-9)
