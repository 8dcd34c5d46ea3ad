"""Curved cells: where their nodes are."""

from dataclasses import replace

import basix
import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.shapes.ellipse import Ellipse
from fsi.meshes.cells.curved import EDGES, CurvedCells, curve, reference_points
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.planar.triangulate import triangulate
from fsi.meshes.resolution import Resolution
from tests.flows import SMALL_BOX, discs

Q = discs([(-1.2, 0.1), (1.1, -0.2)], [1.0, 0.6])


def cells(order: int) -> CurvedCells:
    curves = boundary(FluidDomain(SMALL_BOX, Q.centres, Q.radii), Resolution())
    return curve(triangulate(curves), curves, order)


def map_at(x: Array, order: int, points: Array) -> Array:
    """Images of reference points (m, 2) under the maps of cells with nodes x (T, nodes, 2); (T, m, 2)."""
    element = basix.create_element(
        basix.ElementFamily.P, basix.CellType.triangle, order, basix.LagrangeVariant.equispaced
    )
    image: Array = np.einsum("mn,tnd->tmd", element.tabulate(0, points)[0, :, :, 0], x)
    return image


def lobatto(order: int) -> Array:
    """Gauss-Lobatto points of [0, 1], order + 1 of them."""
    inner: Array = np.real(np.polynomial.legendre.Legendre.basis(order).deriv().roots())
    return 0.5 + 0.5 * np.concatenate([[-1.0], inner, [1.0]])


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
def test_body_edges_meet_their_circle_in_the_lobatto_points(order: int) -> None:
    """At equispaced points instead the order 3 would be 1e-4 off the circle in its Lobatto points."""
    made = cells(order)
    t = lobatto(order)
    vertices = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    found = 0
    for body, (centre, radius) in enumerate(zip(Q.centres, Q.radii, strict=True)):
        edges = {tuple(sorted(edge)) for edge in made.edges[made.tags == body + 1].tolist()}
        for e in EDGES:
            mine = [k for k, c in enumerate(made.cells) if tuple(sorted(c[list(e)].tolist())) in edges]
            points = vertices[e[0]] * (1.0 - t)[:, None] + vertices[e[1]] * t[:, None]
            x = map_at(made.nodes[made.cells[mine]], order, points)
            np.testing.assert_allclose(np.hypot(*(x - centre).T), radius, rtol=2e-14)
            found += len(mine)
    assert found == np.count_nonzero(made.tags <= len(Q))


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 6])
def test_other_cells_are_straight(order: int) -> None:
    made = cells(order)
    on_body = np.unique(made.edges[made.tags <= len(Q)])
    inside = made.cells[np.isin(made.cells[:, :3], on_body).sum(axis=1) < 2]
    X = reference_points(order)
    barycentric = np.column_stack([1.0 - X.sum(axis=1), X])
    straight = np.einsum("nv,tvd->tnd", barycentric, made.nodes[inside[:, :3]])
    assert len(inside) > 100
    np.testing.assert_allclose(made.nodes[inside], straight, atol=1e-14)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 6])
def test_neighbours_share_the_nodes_of_their_side(order: int) -> None:
    """Nodes without repetition: Euler's formula with two holes counts them."""
    made = cells(order)
    vertices, triangles = len(np.unique(made.cells[:, :3])), len(made.cells)
    sides = vertices + triangles + 1  # V - S + T = -1 with two holes
    inner = (order - 1) * (order - 2) // 2
    assert len(made.nodes) == vertices + (order - 1) * sides + inner * triangles
    assert np.array_equal(np.unique(made.cells), np.arange(len(made.nodes)))
    assert len(np.unique(np.round(made.nodes, 10), axis=0)) == len(made.nodes)


@pytest.mark.parametrize("order", [4, 6])
def test_the_numbers_of_vertices_move_no_node(order: int) -> None:
    """Sides of an ellipse bend more towards one end: from the wrong one inner nodes are 1e-3 off."""
    ellipse = Placed(Ellipse(kind="ellipse", axes=(1.5, 0.6)).outline, np.array([0.2, 0.1]), 0.4)
    domain = FluidDomain(SMALL_BOX, ellipse.centre[None], np.array([1.5]), placed=(ellipse,))
    curves = boundary(domain, Resolution(0.3, 12, 1.0))
    straight = triangulate(curves)
    last = len(straight.vertices) - 1
    renumbered = replace(
        straight, vertices=straight.vertices[::-1], cells=last - straight.cells, facets=last - straight.facets
    )
    one, other = (curve(each, curves, order) for each in (straight, renumbered))
    np.testing.assert_allclose(other.nodes[other.cells], one.nodes[one.cells], rtol=0, atol=1e-13)
