"""Is every cell valid? Bounds of the Jacobian determinant, rigorous by its Bezier coefficients.

The determinant of a triangle of order k is a polynomial of degree 2 (k - 1), that of a tetrahedron one of
degree 3 (k - 1); it lies between the smallest and the largest of its Bezier coefficients.
"""

from __future__ import annotations

from functools import cache
from itertools import product
from math import factorial, prod

import basix
import numpy as np

from fsi.meshes.cells.curved import SIMPLEX, reference_points
from fsi.meshes.errors import MeshError, at
from fsi.meshes.geometry.containers import Array

WORST_ACCEPTED = 0.1


def scaled_jacobian(x: Array, order: int) -> Array:
    """Smallest over largest Jacobian determinant of each cell, (T,): 1 for a straight cell.

    Where it is positive it is a lower bound, and the cell is valid; an inverted cell has it <= 0.

    Args:
        x: nodes of the cells in the order of basix, shape (T, nodes, dimension).
        order: of the cells.
    """
    derivatives, to_bezier = _tables(order, x.shape[2])
    J = np.tensordot(derivatives, x.transpose(1, 0, 2), axes=1)  # (a, q, cell, d)
    bezier = np.tensordot(to_bezier, determinant(J.transpose(1, 2, 3, 0)), axes=1)
    largest = np.abs(bezier).max(axis=0)
    ratio: Array = bezier.min(axis=0) / np.maximum(largest, np.finfo(float).tiny)
    return ratio


def determinant(J: Array) -> Array:
    """Determinants of matrices (..., dimension, dimension)."""
    if J.shape[-1] == 2:
        area: Array = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
        return area
    volume: Array = (
        J[..., 0, 0] * (J[..., 1, 1] * J[..., 2, 2] - J[..., 1, 2] * J[..., 2, 1])
        - J[..., 0, 1] * (J[..., 1, 0] * J[..., 2, 2] - J[..., 1, 2] * J[..., 2, 0])
        + J[..., 0, 2] * (J[..., 1, 0] * J[..., 2, 1] - J[..., 1, 1] * J[..., 2, 0])
    )
    return volume


def require_valid(x: Array, order: int) -> float:
    """The worst scaled Jacobian of all cells.

    Raises:
        MeshError: a cell is inverted or nearly so.
    """
    quality = scaled_jacobian(x, order)
    worst = int(np.argmin(quality))
    if not quality[worst] > WORST_ACCEPTED:
        place = x[worst].mean(axis=0)
        raise MeshError(
            f"the cell at {at(place)} has scaled Jacobian {quality[worst]:.3g},"
            f" at most {WORST_ACCEPTED:g} is refused; raise discretisation.cells_per_circle or cells_per_gap"
        )
    return float(quality[worst])


@cache
def _tables(order: int, dimension: int) -> tuple[Array, Array]:
    """Derivatives of the nodal basis (dimension, q, nodes) at the sample points; matrix samples -> Bezier."""
    degree = dimension * (order - 1)
    middle = np.full((1, dimension), 1.0 / (dimension + 1))
    samples = reference_points(degree, dimension) if degree else middle
    element = basix.create_element(
        basix.ElementFamily.P, SIMPLEX[dimension], order, basix.LagrangeVariant.equispaced
    )
    derivatives = element.tabulate(1, samples)[1:, :, :, 0]
    return derivatives, np.linalg.inv(_bernstein(degree, samples))


def _bernstein(degree: int, X: Array) -> Array:
    """Bernstein polynomials of the simplex at points X, shape (points, polynomials)."""
    barycentric = np.column_stack([1 - X.sum(axis=1), X])
    columns = []
    for powers in product(range(degree + 1), repeat=X.shape[1]):
        first = degree - sum(powers)
        if first >= 0:
            weight = factorial(degree) / prod(factorial(p) for p in (first, *powers))
            columns.append(weight * np.prod(barycentric ** np.array([first, *powers]), axis=1))
    return np.column_stack(columns)
