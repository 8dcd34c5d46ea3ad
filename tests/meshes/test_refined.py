"""Fine meshes are those of twice the sizes, each cell of which is parted in eight."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fsi.arrays import Array
from fsi.meshes.cells.curved import CurvedCells, reference_points, scaled_jacobian
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import FluidDomain, lengths
from fsi.meshes.planar.triangulate import StraightCells, require_boundary
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial import tetrahedra
from fsi.meshes.spatial.curved_tetrahedra import RoundSurface, curve_tets
from fsi.meshes.spatial.gap_prisms import GapPrisms
from fsi.meshes.spatial.halved import EDGES
from fsi.meshes.spatial.refined import refined, twice, volumes
from fsi.meshes.spatial.sizing import Spacing
from fsi.meshes.spatial.tetrahedra import fill
from tests.meshes.spheres import HALF_BALL, mesh, volume
from tests.meshes.test_halved import block

FINE = Resolution(1.0, 32, 0.4)
ROOM = Box((-3.0,) * 3, (3.0,) * 3)
SKEW = Cell(((3.0, 0.0, 0.0), (0.3, 3.2, 0.0), (0.0, 0.2, 3.5)), ((0.0, 0.0, 0.0),) * 3)
FACES = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])


def upright(cells: StraightCells) -> StraightCells:
    mirrored = volumes(cells.vertices, cells.cells) < 0.0
    return replace(cells, cells=np.where(mirrored[:, None], cells.cells[:, [1, 0, 2, 3]], cells.cells))


@given(arrays(float, (3, 3), elements=st.floats(-0.9, 0.9)))
def test_the_eight_parts_of_any_tetrahedron_are_equal(A: Array) -> None:
    """Each has an eighth of its volume, and none is mirrored, whatever diagonal parts its inside."""
    A = A + 3.0 * np.eye(3)[[1, 2, 0]]  # by Gershgorin regular, with a positive determinant
    parts = refined(CurvedCells(reference_points(2, 3) @ A, np.arange(10)[None], FACES, np.arange(4), 2))
    np.testing.assert_allclose(volumes(parts.vertices, parts.cells), np.linalg.det(A) / 48.0, rtol=1e-12)
    require_boundary(parts.cells, parts.facets)


def test_cells_and_facets_of_a_block_are_parted_where_they_were() -> None:
    """Middles that are eased stay inside; facets keep their tags and areas."""
    whole = upright(block(3, 2))
    cells = curve_tets(whole, {}, 2)
    parts = refined(cells)
    require_boundary(parts.cells, parts.facets)
    some = volumes(parts.vertices, parts.cells)
    assert len(some) == 8 * len(whole.cells)
    np.testing.assert_allclose(some.sum(), 6.0, rtol=1e-13)
    assert some.min() > 0.0
    for tag in (1, 2, 3):
        areas = [
            lengths(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])).sum()
            for x in (each.vertices[each.facets[each.tags == tag]] for each in (whole, parts))
        ]
        assert areas[1] == pytest.approx(areas[0], rel=1e-13)


def test_middles_inside_go_half_way_to_the_mean_of_their_neighbours() -> None:
    """Weighted by one over the distance; corners and what stands on facets stay."""
    cells = curve_tets(upright(block(2, 2)), {}, 2)
    parts, x, first = refined(cells), cells.nodes, 1 + int(cells.cells[:, :4].max())
    edges = {frozenset(pair) for pair in parts.cells[:, EDGES].reshape(-1, 2).tolist()}
    on, moved = set(parts.facets.ravel().tolist()), 0
    for vertex in range(len(x)):
        goal = x[vertex]
        if vertex >= first and vertex not in on:
            near = [next(iter(edge - {vertex})) for edge in edges if vertex in edge]
            weights = [1.0 / np.linalg.norm(x[other] - x[vertex]) for other in near]
            mean = sum(w * x[other] for w, other in zip(weights, near, strict=True)) / sum(weights)
            goal, moved = 0.5 * (x[vertex] + mean), moved + 1
        np.testing.assert_allclose(parts.vertices[vertex], goal, atol=1e-14)
    assert moved > 4
    assert lengths(parts.vertices - x).max() > 0.01


def test_middles_of_facets_stand_on_their_sphere() -> None:
    """A chord's middle is 1 - cos(pi / 32) = 0.005 within it."""
    domain = FluidDomain(ROOM, np.array([[0.1, 0.2, -0.3]]), np.ones(1))
    cells = fill(domain, FINE).cells
    on = np.unique(cells.facets[cells.tags == 1])
    away = lengths(cells.vertices[on] - domain.centres[0])
    np.testing.assert_allclose(away, 1.0, rtol=1e-13)
    assert volumes(cells.vertices, cells.cells).min() > 0.0


def made(domain: FluidDomain, sizes: Resolution, monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Of each time that gmsh was asked for cells whether they were to be parted."""
    asked, outside = list[bool](), tetrahedra._outside

    def told(spacing: Spacing, layers: list[GapPrisms]) -> object:
        asked.append(spacing.parted)
        return outside(spacing, layers)

    monkeypatch.setattr(tetrahedra, "_outside", told)
    fill(domain, sizes)
    return asked


def beside_plane(gap: float) -> FluidDomain:
    return FluidDomain(HALF_BALL, np.array([[0.0, 0.0, 1.0 + gap]]), np.ones(1))


@pytest.mark.parametrize(
    ("gap", "sizes", "parted"),
    [
        (0.1, FINE, [True]),
        (0.012, FINE, [True]),
        (0.008, FINE, [False]),
        (0.1, Resolution(1.0, 30, 0.4), [False]),
        (0.1, Resolution(1.0, 32, 0.5), [False]),
    ],
)
def test_fine_meshes_with_no_narrow_gap_are_parted(
    gap: float, sizes: Resolution, parted: list[bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """GMRES takes twice the iterations where two layers of cubic cells fill a gap of 0.006 (by a script)."""
    assert made(beside_plane(gap), sizes, monkeypatch) == parted


def test_cells_are_not_parted_beside_edges_where_the_flow_is_singular(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Sizes there end at growth = 0.5: twice 0.4 and twice 0.3 would give the same, and bars see nothing."""
    domain = FluidDomain(ROOM, np.zeros((1, 3)), np.ones(1), edges=((0, 4),))
    assert made(domain, FINE, monkeypatch) == [False]


def test_where_large_cells_are_not_valid_gmsh_makes_small_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    def flat(cells: StraightCells, surfaces: Mapping[int, RoundSurface], order: int) -> CurvedCells:
        good = curve_tets(cells, surfaces, order)
        good.nodes[good.cells[0, 0]] = good.nodes[good.cells[0, 1]]
        return good

    monkeypatch.setattr(tetrahedra, "curved_and_valid", flat)
    assert made(beside_plane(0.1), FINE, monkeypatch) == [True, False]


def test_middles_go_back_where_a_cell_would_become_flat(monkeypatch: pytest.MonkeyPatch) -> None:
    """All sides of this cell cut the sphere: eased anyhow some middle there turns a cell over."""
    domain = FluidDomain(SKEW, np.zeros((1, 3)), np.array([1.4]))
    assert made(domain, FINE, monkeypatch) == [True]


def test_sizes_are_twice_as_large_everywhere() -> None:
    """On bodies, away from them and in gaps, and the largest in a box."""
    half = twice(FINE)
    assert half.on_body(1.0) == 2.0 * FINE.on_body(1.0)
    assert (half.growth, half.cells_per_gap) == (2.0 * FINE.growth, 0.5 * FINE.cells_per_gap)
    one = FluidDomain(ROOM, np.zeros((1, 3)), np.ones(1))
    for container, centres in ((ROOM, one.centres), (HALF_BALL, np.array([[0.0, 0.0, 2.0]]))):
        domain = FluidDomain(container, centres, np.ones(1))
        large = Spacing(domain, half, parted=True).largest
        assert large == pytest.approx(2.0 * Spacing(domain, FINE).largest, rel=1e-15)


@pytest.mark.parametrize("order", [2, 3])
def test_a_cell_with_periods_is_parted(order: int) -> None:
    """Its sides match, though they cut the larger sphere, and cells of either order have the whole volume."""
    centres, radii = np.array([[0.2, 0.1, 0.3], [1.5, 1.6, 1.7]]), np.array([1.0, 0.6])
    cells = fill(FluidDomain(SKEW, centres, radii), FINE)
    assert len(cells.cells.cells) % 8 == 0
    curved = cells.curved(order)
    assert scaled_jacobian(curved.nodes[curved.cells], order).min() > 0.1
    fluid = mesh(SKEW, centres, radii, FINE, order)
    whole = 3.0 * 3.2 * 3.5 - 4.0 / 3.0 * np.pi * (radii**3).sum()
    assert volume(fluid) == pytest.approx(whole, rel=1e-5 if order == 2 else 1e-9)
