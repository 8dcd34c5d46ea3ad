"""Meshes in space that are moved, written and recovered; prisms and tetrahedra on their own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import fsi.meshes.backend  # noqa: F401

import gmsh
import numpy as np
import pytest
import pyvista
from scipy.spatial.transform import Rotation

from fsi.case.load import parse_case
from fsi.meshes.cells.curved import determinant, reference_points, scaled_jacobian
from fsi.meshes.files.read import recover
from fsi.meshes.files.write import gather, write_mesh
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.curves import Sphere
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.meshes.moving.move import Mover
from fsi.meshes.planar.triangulate import StraightCells, gmsh_model
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial import curved_tetrahedra
from fsi.meshes.spatial.curved_tetrahedra import curve_tets
from fsi.meshes.spatial.gap_prisms import split_prisms
from fsi.stokes.model import StokesModel
from tests.meshes.spheres import CUBE, area, mesh, volume
from tests.meshes.test_halved import block

CENTRES, RADII = np.array([[-0.8, 0.1, 0.0], [0.9, -0.2, 0.3]]), np.array([0.8, 0.5])
STEP = np.array([[0.06, -0.04, 0.02], [-0.03, 0.05, 0.01]])
VOLUME = 64.0 - 4.0 * np.pi / 3.0 * (0.512 + 0.125)


def test_spheres_stay_exactly_spheres_when_moved() -> None:
    """Volume and areas, from curved facets, are those of before; walls stay."""
    fluid = mesh(CUBE, CENTRES, RADII, order=3)
    base = fluid.mesh.geometry.x.copy()
    before = volume(fluid), area(fluid, 1), area(fluid, 2)
    moving = Mover(fluid, CENTRES)
    quality = moving.move(CENTRES + STEP)
    assert quality is not None
    shift = fluid.mesh.geometry.x - base
    assert (volume(fluid), area(fluid, 1), area(fluid, 2)) == pytest.approx(before, rel=1e-12)
    for body in range(2):
        from_surface = np.linalg.norm(base - CENTRES[body], axis=1) - RADII[body]
        on_body = np.abs(from_surface) < 1e-12
        assert np.count_nonzero(on_body) > 20
        moved = np.linalg.norm((base + shift)[on_body] - (CENTRES + STEP)[body], axis=1)
        np.testing.assert_allclose(moved, np.linalg.norm(base[on_body] - CENTRES[body], axis=1), rtol=1e-12)
    on_wall = np.abs(CUBE.distances(base)).min(axis=1) < 1e-12
    np.testing.assert_array_equal(shift[on_wall], 0.0)
    assert moving.move(CENTRES + 20.0 * STEP) is None
    np.testing.assert_array_equal(fluid.mesh.geometry.x, base)
    assert moving.move(CENTRES) == pytest.approx(fluid.quality, rel=1e-12)
    moving.close()


@pytest.mark.parametrize("angle", [0.1, pytest.param(-0.2, marks=pytest.mark.slow)])
def test_spheres_that_go_round_each_other_take_the_mesh_of_their_gap_with_them(angle: float) -> None:
    """Without turns the gap would be sheared by 1.7 |angle| / 0.1 = 1.7, 3.4, and the move refused."""
    centres = np.array([[-0.9, 0.0, 0.0], [0.9, 0.0, 0.0]])
    fluid = mesh(Box((-4.0,) * 3, (4.0,) * 3), centres, [1.0, 0.7], Resolution(0.5, 10, 1.0))
    base = fluid.mesh.geometry.x.copy()
    turn = Rotation.from_rotvec([0.0, 0.3 * angle, angle]).as_matrix()
    moving = Mover(fluid, centres)
    assert moving.move(centres @ turn.T) is not None
    moving.close()
    near = (np.abs(base[:, 0] - 0.15) < 0.06) & (np.hypot(base[:, 1], base[:, 2]) < 0.15)
    assert np.count_nonzero(near) > 5
    # A part of the gap, for the box pulls; unturned, nodes on spheres would be off by 0.85 |angle| or more.
    np.testing.assert_allclose(fluid.mesh.geometry.x[near], base[near] @ turn.T, atol=0.25 * abs(angle))


@pytest.mark.slow
def test_a_cell_that_is_sheared_takes_its_mesh_along() -> None:
    """Sides still match, and the flow is that on a new mesh, but for mesh errors."""
    data = {
        "name": "cell", "geometry": "spatial", "fluid": {"viscosity": 1.0},
        "domain": {"shape": "cell", "vectors": (3.5 * np.eye(3)).tolist(), "shear": 1.0},
        "bodies": [
            {"name": "a", "radius": 1.0, "position": [0.0, 0.0, 0.0]},
            {"name": "b", "radius": 0.7, "position": [1.2, 1.0, 1.1]},
        ],
        "discretisation": {"degree": 2, "cells_per_circle": 10, "cells_per_gap": 0.5, "growth": 0.8},
        "time": {"end": 1.0, "remesh": "when-needed"},
    }  # fmt: skip
    case, strain = parse_case(data), 0.05
    model, q = StokesModel(case), case.configuration()
    later = replace(q, centres=q.centres + strain * np.outer(q.centres[:, 2], [1.0, 0.0, 0.0]))
    before = model(q, 0.0)
    moved = model(later, strain)
    new = StokesModel(case)(later, strain)
    assert moved.dofs == before.dofs != new.dofs
    assert max(moved.checks.values()) < 1e-8
    assert moved.apparent_viscosity == pytest.approx(new.apparent_viscosity, rel=1e-2)
    assert moved.apparent_viscosity != pytest.approx(before.apparent_viscosity, rel=1e-3)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_gmsh_reads_the_same_cells(order: int, tmp_path: Path) -> None:
    """gmsh itself finds valid cells (a wrong order of nodes folds them) and the physical groups."""
    fluid = mesh(CUBE, CENTRES[:1], RADII[:1], order=order)
    write_mesh(fluid, tmp_path / "ball.msh", ["ball"])
    with gmsh_model():
        gmsh.merge(str(tmp_path / "ball.msh"))
        groups = {gmsh.model.getPhysicalName(*group): group[0] for group in gmsh.model.getPhysicalGroups()}
        cells = gmsh.model.mesh.getElementsByType({2: 11, 3: 29, 4: 30}[order])[0]
        facets = gmsh.model.mesh.getElementsByType({2: 9, 3: 21, 4: 23}[order])[0]
        quality = np.array(gmsh.model.mesh.getElementQualities(cells, "minDetJac"))
        on_facets = np.array(gmsh.model.mesh.getElementQualities(facets, "minSJ"))
    assert groups == dict.fromkeys(("ball", *fluid.container.walls), 2) | {"fluid": 3}
    assert (len(cells), len(facets)) == (fluid.cells(), len(fluid.facet_tags.indices))
    assert quality.min() > 0.0
    assert on_facets.min() > 0.1


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_vtu_file_is_recovered(order: int, tmp_path: Path) -> None:
    """The cells keep their nodes; pyvista's pieces of them have the volume."""
    fluid = mesh(CUBE, CENTRES, RADII, order=order)
    path = tmp_path / "pair.vtu"
    write_mesh(fluid, path, ["big", "small"])
    again, made = recover([path], FluidDomain(CUBE, CENTRES, RADII)), gather(fluid)
    assert made is not None
    assert again.order == order
    np.testing.assert_allclose(again.nodes[again.cells], made.nodes[made.cells], rtol=0.0, atol=1e-12)
    assert np.array_equal(np.bincount(again.tags), np.bincount(made.tags))
    drawn = pyvista.read(path).tessellate(max_n_subdivide=2).compute_cell_sizes().cell_data["Volume"].sum()
    assert drawn == pytest.approx(VOLUME, rel=0.01)


def test_prisms_fill_what_they_stand_in() -> None:
    """A hexagon of places around one, each diagonal of the rim either way: no cell is turned over."""
    angle = np.pi / 3.0 * np.arange(6)
    y = np.concatenate([np.zeros((1, 2)), np.column_stack([np.cos(angle), np.sin(angle)])])
    triangles = np.array([[0, 1 + k, 1 + (k + 1) % 6] for k in range(6)])
    x = np.concatenate([np.column_stack([y, np.full(7, z)]) for z in (0.0, 0.1)])
    rim = np.sort(np.column_stack([1 + np.arange(6), 1 + (np.arange(6) + 1) % 6]), axis=1)
    for choice in range(64):
        backwards = rim[(choice >> np.arange(6)) % 2 == 1]
        tets = split_prisms(triangles, np.arange(7), 7 + np.arange(7), backwards)
        sides = x[tets[:, 1:]] - x[tets[:, :1]]
        volumes = np.abs(determinant(sides)) / 6.0
        np.testing.assert_allclose(volumes, 0.1 * np.sqrt(3.0) / 4.0 / 3.0, rtol=1e-12)
        faces = np.sort(tets[:, [0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3]].reshape(-1, 3), axis=1)
        _, count = np.unique(faces, axis=0, return_counts=True)
        assert np.count_nonzero(count == 1) == 6 + 6 + 12


@pytest.mark.parametrize("order", [2, 3, 4])
def test_the_jacobian_bound_in_space(order: int) -> None:
    """1 for a straight cell; an inverted one is found."""
    x = reference_points(order, 3) @ np.array([[2.0, 0.3, 0.1], [-0.1, 1.0, 0.2], [0.0, 0.4, 0.1]])
    np.testing.assert_allclose(scaled_jacobian(x[None], order), 1.0, rtol=1e-10)
    assert scaled_jacobian(x[None] * [1.0, 1.0, -1.0], order)[0] == pytest.approx(-1.0)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_a_curved_facet_meets_its_sphere(order: int) -> None:
    """Edges in their Lobatto points to rounding; the facet as a whole to O(h^4), 1e-2 for straight ones."""
    corners = np.array([[1.0, 0.0, 0.0], [np.cos(0.3), np.sin(0.3), 0.0], [np.cos(0.3), 0.0, np.sin(0.3)]])
    vertices = np.concatenate([corners, [[1.5, 0.1, 0.1]]])
    unit = Sphere(np.zeros(3), 1.0)
    tet = StraightCells(vertices, np.array([[0, 1, 2, 3]]), np.array([[0, 1, 2]]), np.array([1]))
    made = curve_tets(tet, {1: unit}, order)
    np.testing.assert_array_equal(made.nodes[:4], vertices)
    X = reference_points(order, 3)
    on_facet = made.nodes[made.cells[0]][X[:, 2] == 0.0]
    away = np.abs(np.linalg.norm(on_facet, axis=1) - 1.0)
    assert away.max() < 2e-4
    if order == 2:  # the middle of an edge is a Lobatto point
        assert away.max() < 1e-15
    others = made.nodes[made.cells[0]][X[:, 2] == 1.0]
    np.testing.assert_array_equal(others, [[1.5, 0.1, 0.1]])


@pytest.mark.parametrize("order", [2, 3, 4])
def test_nodes_have_the_same_numbers_where_their_names_are_too_long(
    order: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Names of nodes, of up to four vertices, that no integer has room for are renumbered on the way."""
    cells = block(3, 2)
    nodes = curve_tets(cells, {}, order)
    monkeypatch.setattr(curved_tetrahedra, "LARGEST", 0)
    renumbered = curve_tets(cells, {}, order)
    np.testing.assert_array_equal(renumbered.cells, nodes.cells)
    np.testing.assert_array_equal(renumbered.nodes, nodes.nodes)


def test_containers_in_space() -> None:
    box = Box((-1.0, 0.0, 2.0), (3.0, 2.0, 9.0))
    np.testing.assert_array_equal(
        box.distances(np.array([[0.0, 0.5, 4.0]])), [[1.0, 3.0, 0.5, 1.5, 2.0, 5.0]]
    )
    assert box.walls == ("left", "right", "front", "back", "bottom", "top")
    assert box.corner_axes == (0, 0, 1, 1, 2, 2)
    assert Box((0.0, 0.0, 0.0), (1.0, 2.0, 2.0)).size() == 3.0
    half, ball = HalfPlane(10.0, dimension=3), Round(10.0, dimension=3)
    np.testing.assert_allclose(half.distances(np.array([[1.0, 2.0, 2.0]])), [[2.0, 7.0]], rtol=1e-15)
    np.testing.assert_allclose(ball.distances(np.array([[1.0, 2.0, 2.0]])), [[7.0]], rtol=1e-15)
    assert (box.dimension, half.dimension, ball.dimension, Round(1.0).dimension) == (3, 3, 3, 2)
    assert half.corner_axes == (2, 0)
