"""Meshes in space graded towards edges."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.meshes.build import build
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.tube import Tube
from fsi.meshes.resolution import Resolution
from tests.meshes.spheres import CUBE, cells

RIGHT, BACK = (CUBE.walls.index(wall) for wall in ("right", "back"))
# (1, 1) from the edge of right and back: 2^0.5 - 0.5 from it to the surface of the sphere.
CENTRE, RADIUS = np.array([[1.0, 1.0, 0.0]]), np.array([0.5])


def beside(growth: float, edges: tuple[tuple[int, int], ...]) -> Array:
    """Distances between the vertices on the edge of right and back."""
    domain = FluidDomain(CUBE, CENTRE, RADIUS, edges=edges)
    corners = cells(build(domain, Resolution(0.5, 8, growth), 2))[:, :4]
    on_edge = (np.abs(corners[:, :, :2] - 2.0) < 1e-9).all(axis=2)
    z = np.unique(corners[on_edge][:, 2].round(9))
    return np.asarray(np.diff(z))


@pytest.mark.parametrize("growth", [0.25, 0.5])
def test_cells_beside_an_edge_are_in_proportion_to_growth(growth: float) -> None:
    """growth / 2 of the distance from the sphere; gmsh keeps sizes within a third."""
    smallest = 0.5 * growth * (np.sqrt(2.0) - 0.5)
    steps = beside(growth, ((RIGHT, BACK),))
    assert 0.67 * smallest < steps.mean() < 1.33 * smallest


def test_an_edge_without_a_jump_costs_nothing() -> None:
    assert beside(0.5, ()).mean() > 2.0 * 0.25 * (np.sqrt(2.0) - 0.5)


def test_where_cells_grow_fast_they_are_small_beside_an_edge_all_the_same() -> None:
    """Above growth = 0.5 no cell would be small against the distance from the edge: as many as for that."""
    assert len(beside(1.0, ((RIGHT, BACK),))) == len(beside(0.5, ((RIGHT, BACK),)))


@pytest.mark.parametrize("around", [10, 16])
def test_rims_of_tubes_are_finer_than_their_sides_and_in_proportion_to_growth(around: int) -> None:
    """growth H at most, H = 2 pi R / cells_per_circle, or growth / 2 of the 4.66 to the sphere.

    With the bound H of all cells instead of growth H, the steps of both meshes are H.
    """
    tube, centre = Tube(2.0, 12.0), np.array([[0.0, 0.0, 0.7]])
    top = tube.walls.index("top"), tube.walls.index("side")
    H, mean = 2.0 * np.pi * 2.0 / around, []
    for growth in (0.5, 0.5 / 1.5):  # of a mesh, and of the one that its bar compares it with
        domain = FluidDomain(tube, centre, np.array([1.0]), edges=(top,))
        x = np.unique(cells(build(domain, Resolution(0.5, around, growth), 2))[:, :4].reshape(-1, 3), axis=0)
        x = x[(np.hypot(x[:, 0], x[:, 1]) > 2.0 - 1e-9) & (np.abs(x[:, 2] - 6.0) < 1e-9)]
        mean.append(2.0 * np.pi * 2.0 / len(x))
        assert 0.67 * growth * H < mean[-1] < 1.33 * growth * H
    assert mean[0] / mean[1] == pytest.approx(1.5, rel=0.15)
