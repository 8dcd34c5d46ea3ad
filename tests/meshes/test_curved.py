"""Curved cells: where their nodes are."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import basix
import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.shapes.ellipse import Ellipse
from fsi.meshes.cells.curved import EDGES, CurvedCells, curve, reference_points
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.curves import WallCurve, arc, segment
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


@dataclass(frozen=True, slots=True)
class OneWall(Container):
    """A container with one wall of several pieces."""

    pieces: tuple[WallCurve, ...]
    walls: ClassVar[tuple[str, ...]] = ("rim",)
    volume: ClassVar[float] = 0.0  # not asked for

    def outline(self) -> tuple[WallCurve, ...]:
        return self.pieces

    def distances(self, x: Array) -> Array:
        assert len(x) == 0  # nothing else is asked for without bodies
        return np.empty((0, 1))

    def normals(self, x: Array) -> Array:
        return np.empty((len(x), 1, 2))

    def size(self) -> float:
        return 3.0


def around(y: float, radius: float, start: float, end: float, x: float = 0.0) -> WallCurve:
    """The arc around (x, y) between two angles."""
    piece, centre = arc(0, radius, start, end), np.array([x, y])
    return replace(piece, at=lambda s: centre + piece.at(s), ends=centre + piece.ends, centre=centre)


def stadium() -> tuple[WallCurve, ...]:
    """Around the points 1 from a line of length 0.6."""
    turn = 0.5 * np.pi
    right, left = around(0.0, 1.0, -turn, turn, 0.3), around(0.0, 1.0, turn, 3.0 * turn, -0.3)
    return segment(0, (-0.3, -1.0), (0.3, -1.0)), right, segment(0, (0.3, 1.0), (-0.3, 1.0)), left


def off_stadium(x: Array) -> Array:
    return np.asarray(np.hypot(x[:, 0] - np.clip(x[:, 0], -0.3, 0.3), x[:, 1]) - 1.0)


def cut_disc() -> tuple[WallCurve, ...]:
    """The unit disc above y = -1/2: pieces of the chord have both ends as far from the centre."""
    above = around(0.0, 1.0, -np.pi / 6.0, 7.0 * np.pi / 6.0)
    return above, replace(segment(0, above.ends[1], above.ends[0]), fewest_elements=5)


def off_cut_disc(x: Array) -> Array:
    return np.asarray(np.minimum(np.abs(np.hypot(*x.T) - 1.0), np.abs(x[:, 1] + 0.5)))


def lens() -> tuple[WallCurve, ...]:
    """Half the unit circle, and below it an arc around (0, 1/2): nearer to points is the other's centre."""
    turn = np.arctan(0.5)
    above, below = around(0.0, 1.0, 0.0, np.pi), around(0.5, np.sqrt(1.25), np.pi + turn, 2.0 * np.pi - turn)
    return above, replace(below, ends=above.ends[::-1])


def off_lens(x: Array) -> Array:
    above, below = np.hypot(*x.T) - 1.0, np.hypot(x[:, 0], x[:, 1] - 0.5) - np.sqrt(1.25)
    return np.asarray(np.where(x[:, 1] > 0.0, above, below))


@pytest.mark.parametrize(
    ("pieces", "off"),
    [(stadium(), off_stadium), (cut_disc(), off_cut_disc), (lens(), off_lens)],
    ids=["stadium", "cut disc", "lens"],
)
def test_each_piece_of_a_wall_follows_its_own_circle_or_none(
    pieces: tuple[WallCurve, ...], off: Callable[[Array], Array]
) -> None:
    """All sides of a wall were bent around the nearest centre of an arc: 0.03, 0.13 and 0.12 off."""
    curves = boundary(FluidDomain(OneWall(pieces), np.empty((0, 2)), np.empty(0)), Resolution())
    order = 3
    made = curve(triangulate(curves), curves, order)
    on_wall = {tuple(edge) for edge in np.sort(made.edges, axis=1).tolist()}
    t, vertices = lobatto(order), np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    for e in EDGES:
        mine = [k for k, c in enumerate(made.cells) if tuple(sorted(c[list(e)].tolist())) in on_wall]
        points = vertices[e[0]] * (1.0 - t)[:, None] + vertices[e[1]] * t[:, None]
        x = map_at(made.nodes[made.cells[mine]], order, points)
        np.testing.assert_allclose(off(x.reshape(-1, 2)), 0.0, atol=1e-12)
