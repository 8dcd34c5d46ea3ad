"""Whole meshes: area, perimeter, tags, hard geometries, determinism."""

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.mesh import exterior_facet_indices
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.bodies.configuration import Configuration
from fsi.meshes.build import FluidMesh, build
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.planar import triangulate
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial import tetrahedra
from tests.flows import BOX, HALF_PLANE, SMALL_BOX, disc_over_plane, discs, mesh

QUADRATURE = {"quadrature_degree": 12}


def area(fluid: FluidMesh) -> float:
    one = fem.Constant(fluid.mesh, 1.0)
    return float(np.real(fem.assemble_scalar(fem.form(one * ufl.dx(fluid.mesh, metadata=QUADRATURE)))))


def length(fluid: FluidMesh, tag: int) -> float:
    ds = ufl.ds(fluid.mesh, subdomain_data=fluid.facet_tags, metadata=QUADRATURE)
    return float(np.real(fem.assemble_scalar(fem.form(fem.Constant(fluid.mesh, 1.0) * ds(tag)))))


@pytest.mark.parametrize("order", [1, 2, 3])
def test_area_and_perimeter_converge(order: int) -> None:
    """Order 2 k with Gauss-Lobatto nodes on the circle; k + 1 (or 4 for k = 3) with others."""
    q = discs([(0.0, 8.0)], [1.0])
    n, errors = [], []
    for cells_per_circle in (9, 14, 21):
        fluid = mesh(BOX, q, Resolution(1.0, cells_per_circle, 0.5), order)
        n.append(len(fluid.facet_tags.find(1)))
        errors.append((abs(area(fluid) - (256.0 - np.pi)), abs(length(fluid, 1) - 2.0 * np.pi)))
    orders = np.diff(np.log(errors), axis=0) / -np.diff(np.log(n))[:, None]
    np.testing.assert_allclose(orders, 2 * order, atol=0.15)


@pytest.mark.parametrize(
    ("container", "area_of_all", "perimeter"),
    [(BOX, 256.0, 64.0), (HALF_PLANE, 12.5e6 * np.pi, 5e3 * (2.0 + np.pi))],
)
def test_tags_cover_the_boundary(container: Container, area_of_all: float, perimeter: float) -> None:
    fluid = mesh(container, discs([(0.0, 1.1), (2.5, 3.0)], [1.0, 0.5]))
    np.testing.assert_array_equal(
        np.sort(fluid.facet_tags.indices), exterior_facet_indices(fluid.mesh.topology)
    )
    assert set(fluid.facet_tags.values) == set(range(1, 3 + len(container.walls)))
    assert area(fluid) == pytest.approx(area_of_all - 1.25 * np.pi, rel=1e-8)
    walls = {wall: length(fluid, fluid.wall_tag(wall)) for wall in container.walls}
    assert sum(walls.values()) == pytest.approx(perimeter, rel=1e-8)
    if isinstance(container, Box):
        assert walls == pytest.approx(dict.fromkeys(container.walls, 16.0), rel=1e-12)
    assert [length(fluid, 1), length(fluid, 2)] == pytest.approx([2.0 * np.pi, np.pi], rel=1e-7)


GAP = 1e-5
RING, THIRDS = 2.0 * (1.0 + GAP) / np.sqrt(3.0), 2.0 * np.pi / 3.0 * np.arange(3)
HARD = {
    "disc on a plane": (BOX, disc_over_plane(GAP)),
    "pair": (BOX, discs([(-1.0 - GAP / 2, 4.0), (1.0 + GAP / 2, 4.0)], [1.0, 1.0])),
    "radii 1 and 0.01": (BOX, discs([(0.0, 4.0), (1.01 + GAP, 4.0)], [1.0, 0.01])),
    "in a corner": (BOX, discs([(-7.0 + GAP, 1.0 + GAP)], [1.0])),
    "three in a ring": (BOX, discs([(RING * np.cos(z), 8.0 + RING * np.sin(z)) for z in THIRDS], [1.0] * 3)),
    "wall to wall": (Box((-3.0, 0.0), (3.0, 2.0 + 2.0 * GAP)), disc_over_plane(GAP)),
}


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("case", HARD)
def test_gaps_of_1e_5(case: str, order: int) -> None:
    container, q = HARD[case]
    fluid = mesh(container, q, order=order)
    assert fluid.quality > 0.75
    assert fluid.cells() < 4000


def test_a_mesh_is_the_same_twice() -> None:
    """Bitwise, also after another mesh was made in between."""
    q = discs([(0.0, 1.01), (2.5, 3.0)], [1.0, 0.5])
    first = mesh(BOX, q)
    mesh(SMALL_BOX, discs([(0.0, 0.0)], [1.0]))
    second = mesh(BOX, q)
    np.testing.assert_array_equal(first.mesh.geometry.x, second.mesh.geometry.x)
    np.testing.assert_array_equal(first.mesh.geometry.dofmaps[0], second.mesh.geometry.dofmaps[0])
    np.testing.assert_array_equal(first.facet_tags.values, second.facet_tags.values)
    assert first.quality == second.quality


def scattered(seed: int, gap: float) -> Configuration:
    """Thirty discs of radii 0.2 ... 0.6 at random in a box of side 10, the second `gap` from the first."""
    random = np.random.default_rng(seed)
    centres, radii = np.array([[5.0, 5.0]]), np.array([0.6])
    x = centres[0] + (0.6 + gap + 0.2) * np.array([np.cos(seed), np.sin(seed)])
    centres, radii = np.vstack([centres, x]), np.append(radii, 0.2)
    while len(radii) < 30:
        a = random.uniform(0.2, 0.6)
        x = random.uniform(a + gap, 10.0 - a - gap, 2)
        if np.all(np.hypot(*(centres - x).T) - radii - a > gap):
            centres, radii = np.vstack([centres, x]), np.append(radii, a)
    return Configuration(centres, np.zeros(30), radii)


@settings(max_examples=5, derandomize=True, database=None)
@given(seed=st.integers(0, 10**6), gap=st.floats(1e-5, 0.05))
def test_thirty_random_discs(seed: int, gap: float) -> None:
    q = scattered(seed, gap)
    fluid = mesh(Box((0.0, 0.0), (10.0, 10.0)), q, Resolution(1.0, 16, 0.5))
    assert fluid.quality > 0.5
    assert area(fluid) == pytest.approx(100.0 - np.pi * (q.radii**2).sum(), rel=1e-7)
    assert length(fluid, 2) == pytest.approx(0.4 * np.pi, rel=1e-5)


@pytest.mark.parametrize("width", [3.5, 4.9])
def test_cells_at_corners_are_not_too_small_for_gmsh(width: float) -> None:
    """With cells of 1e-9 of the size beside them it loses a part of the boundary of each of these boxes."""
    corners = np.array([[0.0, 3.3], [width, 3.3]])
    domain = FluidDomain(Box((0.0, 0.0), (width, 3.3)), np.array([[1.2, 1.6]]), np.array([0.6]), corners)
    fluid = build(domain, Resolution(0.5, 16, 0.08), 2)
    assert not fluid.instead
    assert area(fluid) == pytest.approx(3.3 * width - 0.36 * np.pi, rel=1e-4)


def test_no_bodies() -> None:
    fluid = build(FluidDomain(SMALL_BOX, np.empty((0, 2)), np.empty(0)), Resolution(), 2)
    assert area(fluid) == pytest.approx(24.0, rel=1e-13)
    assert fluid.wall_tag("top") == 4


def test_crossing_bodies_are_refused() -> None:
    with pytest.raises(MeshError) as caught:
        mesh(BOX, discs([(0.0, 4.0), (1.0, 4.0)], [1.0, 1.0]))
    assert "\n" not in str(caught.value)


def test_where_gmsh_makes_no_cells_it_is_said_what_to_change() -> None:
    """No boundary, so no triangles and no tetrahedra."""
    domain = FluidDomain(Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), np.empty((0, 3)), np.empty(0))
    for read in (triangulate._read_triangles, lambda: tetrahedra._read(domain, (), ())):
        with (
            triangulate.gmsh_model(),
            pytest.raises(MeshError, match=r"; lower discretisation\.growth or raise cells_per_circle$"),
        ):
            read()
