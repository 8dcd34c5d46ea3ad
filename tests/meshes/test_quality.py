"""The Bezier bound of the Jacobian: rigorous, sharp where it can be, and what it refuses."""

import basix
import numpy as np
import pytest

from fsi.arrays import Array
from fsi.meshes.cells.curved import reference_points, require_valid, scaled_jacobian
from fsi.meshes.errors import MeshError

ORDERS = [1, 2, 3, 4, 5, 6]


def straight(order: int) -> Array:
    """Nodes of one stretched straight cell, (1, nodes, 2)."""
    x: Array = reference_points(order) @ np.array([[2.0, 0.3], [-0.1, 1.0]]) + [5.0, -1.0]
    return x[None]


def sampled(x: Array, order: int) -> Array:
    """Smallest over largest determinant of each cell at many points: an upper bound of the true ratio."""
    element = basix.create_element(
        basix.ElementFamily.P, basix.CellType.triangle, order, basix.LagrangeVariant.equispaced
    )
    points = basix.create_lattice(basix.CellType.triangle, 40, basix.LatticeType.equispaced, True)
    J = np.einsum("aqn,tnd->tqda", element.tabulate(1, points)[1:, :, :, 0], x)
    determinant = np.linalg.det(J)
    ratio: Array = determinant.min(axis=1) / np.abs(determinant).max(axis=1)
    return ratio


@pytest.mark.parametrize("order", ORDERS)
def test_a_straight_cell_gives_1(order: int) -> None:
    np.testing.assert_allclose(scaled_jacobian(straight(order), order), 1.0, rtol=1e-10)


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
def test_bound_is_rigorous(order: int) -> None:
    """Random wobbles: a positive bound is below the sampled ratio, no inversion is missed."""
    cells = np.repeat(straight(order), 400, axis=0)
    wobble = np.random.default_rng(order).uniform(-1.0, 1.0, cells.shape)
    cells += np.geomspace(1e-4, 1.0, 400)[:, None, None] * wobble
    bound, seen = scaled_jacobian(cells, order), sampled(cells, order)
    valid = bound > 0.0
    assert np.all(bound[valid] <= seen[valid] + 1e-12)
    assert np.all(bound[seen <= 0.0] <= 0.0)
    assert np.count_nonzero(valid) > 100
    assert np.count_nonzero(seen <= 0.0) > 30


def test_sharp_for_a_bent_side() -> None:
    """The node (1/2, 0), of shape function 4 x (1 - x - y), moved up by 0.1: det J = 1 - 0.4 x."""
    x = reference_points(2).copy()
    x[np.flatnonzero((x == [0.5, 0.0]).all(axis=1))] += [0.0, 0.1]
    np.testing.assert_allclose(scaled_jacobian(x[None], 2), 0.6, rtol=1e-12)


def test_an_inverted_cell_is_refused_with_its_place() -> None:
    mirrored = straight(3)[:, :, ::-1] * [-1.0, 1.0] * [-1.0, 1.0]
    cells = np.concatenate([straight(3), mirrored])
    assert scaled_jacobian(cells, 3)[1] == pytest.approx(-1.0)
    place = mirrored[0].mean(axis=0)
    with pytest.raises(MeshError, match=rf"\({place[0]:.6g}, {place[1]:.6g}\) has scaled Jacobian -1"):
        require_valid(cells, 3)


def test_not_a_number_is_refused() -> None:
    cells = straight(2)
    cells[0, 1] = np.nan
    with pytest.raises(MeshError, match="nan"):
        require_valid(cells, 2)
