"""Is every cell valid? Bounds of the Jacobian determinant, rigorous by its Bezier coefficients.

The determinant of a triangle of order k is a polynomial of degree 2 (k - 1); it lies between the
smallest and the largest of its Bezier coefficients.
"""

from __future__ import annotations

from functools import cache
from math import factorial

import basix
import numpy as np

from meshes.curved import reference_points
from meshes.errors import MeshError
from meshes.geometry import Array

WORST_ACCEPTED = 0.1


def scaled_jacobian(x: Array, order: int) -> Array:
    """Smallest over largest Jacobian determinant of each cell, (T,): 1 for a straight cell.

    Where it is positive it is a lower bound, and the cell is valid; an inverted cell has it <= 0.

    Args:
        x: nodes of the cells in the order of basix, shape (T, nodes, 2).
        order: of the cells.
    """
    derivatives, to_bezier = _tables(order)
    J = np.einsum("aqn,tnd->tqda", derivatives, x)
    determinant = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
    bezier = determinant @ to_bezier.T
    largest = np.abs(bezier).max(axis=1)
    ratio: Array = bezier.min(axis=1) / np.maximum(largest, np.finfo(float).tiny)
    return ratio


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
            f"the cell at ({place[0]:.6g}, {place[1]:.6g}) has scaled Jacobian {quality[worst]:.3g},"
            f" at most {WORST_ACCEPTED:g} is refused; raise discretisation.cells_per_circle or cells_per_gap"
        )
    return float(quality[worst])


@cache
def _tables(order: int) -> tuple[Array, Array]:
    """Derivatives of the nodal basis (2, q, nodes) at the sample points, and the matrix samples -> Bezier."""
    degree = 2 * (order - 1)
    samples = reference_points(degree) if degree else np.array([[1 / 3, 1 / 3]])
    element = basix.create_element(
        basix.ElementFamily.P, basix.CellType.triangle, order, basix.LagrangeVariant.equispaced
    )
    derivatives = element.tabulate(1, samples)[1:, :, :, 0]
    return derivatives, np.linalg.inv(_bernstein(degree, samples))


def _bernstein(degree: int, X: Array) -> Array:
    """Bernstein polynomials of the triangle at points X, shape (points, polynomials)."""
    a, b, c = 1 - X.sum(axis=1), X[:, 0], X[:, 1]
    columns = []
    for i in range(degree + 1):
        for j in range(degree + 1 - i):
            k = degree - i - j
            weight = factorial(degree) / (factorial(i) * factorial(j) * factorial(k))
            columns.append(weight * a**k * b**i * c**j)
    return np.column_stack(columns)
