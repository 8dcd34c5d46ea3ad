"""Shape functions, gradients and the search for points, on polynomials and maps that are known exactly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkLagrangeTetra

from fsi.meshes.cells.lagrange import (
    gradient,
    invert,
    locate,
    order_of,
    reference_nodes,
    small_simplices,
    tabulate,
)

ORDERS, IN_SPACE = (1, 2, 3, 4, 5, 6), (1, 2, 3, 4)
inside = st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)).map(
    lambda p: np.array(p if sum(p) <= 1.0 else (1.0 - p[0], 1.0 - p[1]))
)


def bent(X: NDArray[np.float64]) -> NDArray[np.float64]:
    """A quadratic map of the reference triangle, invertible on it."""
    s, t = X[..., 0], X[..., 1]
    return np.stack([2.0 * s + t + 0.3 * s * t, -s + t + 0.2 * s**2], axis=-1)


@pytest.mark.parametrize("order", ORDERS)
def test_each_shape_function_is_one_at_its_own_node_only(order: int) -> None:
    nodes = reference_nodes(order)
    assert order_of(len(nodes)) == order
    np.testing.assert_allclose(tabulate(order, nodes)[0], np.eye(len(nodes)), atol=1e-15)


@pytest.mark.parametrize(("dimension", "order"), [*((2, n) for n in ORDERS), *((3, n) for n in IN_SPACE)])
def test_straight_cells_between_the_nodes_fill_a_cell_once(dimension: int, order: int) -> None:
    """Equal parts of its volume, turned as it is, whose free sides are those of the cell cut alike."""
    nodes, small = reference_nodes(order, dimension), small_simplices(order, dimension)
    assert len(small) == order**dimension
    volume = np.linalg.det(nodes[small[:, 1:]] - nodes[small[:, :1]])
    np.testing.assert_allclose(volume, order**-dimension, rtol=1e-12)
    sides = np.concatenate([np.delete(small, k, axis=1) for k in range(dimension + 1)])
    unique, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    assert count.max() <= 2
    outer = unique[count == 1]
    assert len(outer) == (dimension + 1) * order ** (dimension - 1)
    bary = np.column_stack([1.0 - nodes.sum(axis=1), nodes])[outer]
    assert np.all(np.any(np.all(np.abs(bary) < 1e-12, axis=1), axis=1))


@pytest.mark.parametrize("order", IN_SPACE)
def test_nodes_of_tetrahedra_are_in_the_order_of_vtk(order: int) -> None:
    """VTK says where its nodes are; shape functions are one at their own."""
    nodes = reference_nodes(order, 3)
    assert order_of(len(nodes), 3) == order
    np.testing.assert_allclose(tabulate(order, nodes)[0], np.eye(len(nodes)), atol=1e-15)
    cell = vtkLagrangeTetra()
    cell.GetPointIds().SetNumberOfIds(len(nodes))
    cell.GetPoints().SetNumberOfPoints(len(nodes))
    cell.Initialize()
    for k, node in enumerate(nodes):
        index = [0, 0, 0, 0]
        cell.ToBarycentricIndex(k, index)
        assert index[:3] == np.rint(order * node).tolist()


@given(st.tuples(*[st.floats(0.0, 0.33)] * 3).map(np.array))
def test_curved_tetrahedra_know_where_a_point_lies(X: NDArray[np.float64]) -> None:
    nodes = reference_nodes(3, 3)

    def bend(Y: NDArray[np.float64]) -> NDArray[np.float64]:
        return Y + 0.2 * np.stack([Y[..., 1] * Y[..., 2], Y[..., 0] ** 2, Y[..., 0] * Y[..., 1]], axis=-1)

    np.testing.assert_allclose(invert(bend(nodes)[None], bend(X)[None])[0], X, atol=1e-12)


@given(st.sampled_from(ORDERS), inside)
def test_polynomials_and_their_gradients_are_reproduced(order: int, X: NDArray[np.float64]) -> None:
    """(X + 0.3 Y)^order; values and slopes stay below 4."""
    nodes = reference_nodes(order)
    phi, dphi = tabulate(order, X)
    line = nodes @ [1.0, 0.3]
    assert phi @ line**order == pytest.approx((X @ [1.0, 0.3]) ** order, abs=1e-13)
    slope = order * (X @ [1.0, 0.3]) ** (order - 1)
    np.testing.assert_allclose(line**order @ dphi, [slope, 0.3 * slope], atol=1e-12)


@given(st.sampled_from((2, 3, 4)), inside)
def test_curved_cells_know_where_a_point_lies(order: int, X: NDArray[np.float64]) -> None:
    cell = bent(reference_nodes(order))
    np.testing.assert_allclose(invert(cell[None], bent(X)[None])[0], X, atol=1e-12)


@given(inside)
def test_gradient_of_a_linear_field_on_a_curved_cell(X: NDArray[np.float64]) -> None:
    G = np.array([[1.0, -2.0], [0.5, 3.0]])
    cell = bent(reference_nodes(3))
    found = gradient(cell, cell @ G.T, tabulate(3, X)[1])
    np.testing.assert_allclose(found, G, atol=1e-12)


def two_cells() -> NDArray[np.float64]:
    """The bent triangle, and its image beyond the side from vertex 1 to vertex 2."""
    nodes = reference_nodes(3)
    return np.stack([bent(nodes), bent(1.0 - nodes)])


def test_points_are_found_in_their_cells_or_not_at_all() -> None:
    X = np.array([[0.2, 0.3], [0.9, 0.8], [-0.1, 0.5], [1.3, 0.4]])
    cell, found = locate(two_cells(), bent(X), 1e-9)
    assert cell.tolist() == [0, 1, -1, -1]
    np.testing.assert_allclose(found[:2], [X[0], 1.0 - X[1]], atol=1e-12)
    assert np.isnan(found[2:]).all()


@pytest.mark.parametrize(("tolerance", "expected"), [(1e-3, 0), (1e-5, -1)])
def test_the_tolerance_is_in_barycentric_coordinates(tolerance: float, expected: int) -> None:
    cell, _ = locate(two_cells(), bent(np.array([[-1e-4, 0.5]])), tolerance)
    assert cell.tolist() == [expected]


def test_no_points() -> None:
    cell, X = locate(two_cells(), np.empty((0, 2)), 1e-9)
    assert (cell.shape, X.shape) == ((0,), (0, 2))
