"""Lagrange simplices in NumPy: shape functions, gradients and the inverse of the map of curved cells.

Nodes are equispaced, in the order of VTK: vertices, then the inner nodes of the sides, then those inside.
A cell of nodes x_a is the image of the reference simplex X_1, ..., X_d >= 0, sum X_i <= 1 under
`x(X) = sum_a phi_a(X) x_a`, and carries the field `u(X) = sum_a phi_a(X) u_a`. With barycentric coordinates
`l_0 = 1 - sum X_i`, `l_i = X_i` and a node's indices i_v, summing to the order n, its shape function is

    phi = prod_v P_{i_v}(l_v),   P_i(l) = prod_{m < i} (n l - m) / (i - m)          (Silvester 1969)
"""

import itertools
import math

import numpy as np

from fsi.arrays import Array, Indices

type Rows = tuple[tuple[int, ...], ...]
VTK_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
VTK_FACES = ((0, 1, 3), (2, 3, 1), (0, 3, 2), (0, 2, 1))

_NEWTON_STEPS = 30
_CONVERGED = 1e-13  # of a step in reference coordinates
_SLACK = 0.1  # of the size of a cell, by which its box of nodes is enlarged to hold its curved sides
_BLOCK = 4096  # points located at a time


def lattice(order: int) -> list[tuple[int, int]]:
    """Nodes of a triangle in steps of 1 / order: vertices, sides 01, 12, 20, then the triangle inside."""
    if order <= 0:
        return [(0, 0)] if order == 0 else []
    along = range(1, order)
    sides = [(k, 0) for k in along] + [(order - k, k) for k in along] + [(0, order - k) for k in along]
    inside = [(i + 1, j + 1) for i, j in lattice(order - 3)]
    return [(0, 0), (order, 0), (0, order), *sides, *inside]


def lattice_in_space(order: int, edges: Rows = VTK_EDGES, faces: Rows = VTK_FACES) -> list[tuple[int, ...]]:
    """The same of a tetrahedron, to order 4: vertices, edges and faces by their corners, then inside."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    points = [order * corner for corner in corners]
    for i, j in edges:
        points += [(order - k) * corners[i] + k * corners[j] for k in range(1, order)]
    inner = [(order - 2 - i - j, i + 1, j + 1) for i, j in lattice(order - 3)]
    for face in faces:
        points += [np.array(steps) @ corners[[*face]] for steps in inner]
    if order == 4:
        points.append(corners.sum(axis=0))
    return [tuple(int(c) for c in point) for point in points]


def order_of(nodes: int, dimension: int = 2) -> int:
    """The order of a triangle or tetrahedron with so many nodes."""
    return next(n for n in range(nodes) if math.comb(n + dimension, dimension) == nodes)


def small_simplices(order: int, dimension: int = 2) -> Indices:
    """The straight cells between the nodes of a cell, (order^d, d + 1), each oriented as the cell is.

    With the sums y_k = i_k + ... + i_d of a node's indices the cell is order >= y_1 >= ... >= y_d >= 0. Each
    unit cube of the y is cut along its diagonal, axis by axis in each of the d! ways (Freudenthal 1942). On a
    side that two cells share both have the same small ones.
    """
    steps = lattice(order) if dimension == 2 else lattice_in_space(order)
    at = {tuple(np.cumsum(index[::-1])[::-1].tolist()): k for k, index in enumerate(steps)}
    small = []
    for corner in itertools.product(range(order), repeat=dimension):
        for axes in itertools.permutations(np.eye(dimension, dtype=int)):
            numbers = [at.get(tuple(y)) for y in np.cumsum([corner, *axes], axis=0).tolist()]
            if None not in numbers:
                small.append(numbers if np.linalg.det(axes) > 0.0 else [numbers[1], numbers[0], *numbers[2:]])
    return np.array(small, dtype=np.int64)


def reference_nodes(order: int, dimension: int = 2) -> Array:
    """The nodes of the reference triangle or tetrahedron, shape (nodes, dimension)."""
    steps = lattice(order) if dimension == 2 else lattice_in_space(order)
    return np.array(steps, dtype=float) / order


def tabulate(order: int, X: Array) -> tuple[Array, Array]:
    """Shape functions (..., nodes) at points X (..., d), and their gradients d phi / d X (..., nodes, d)."""
    inner = np.rint(order * reference_nodes(order, X.shape[-1])).astype(int)
    indices = np.column_stack([order - inner.sum(axis=1), inner])
    barycentric = np.concatenate([1.0 - X.sum(axis=-1, keepdims=True), X], axis=-1)
    P, slope = _silvester(order, barycentric)
    vertices = range(indices.shape[1])
    value = [P[..., v, indices[:, v]] for v in vertices]
    others = [np.prod([value[w] for w in vertices if w != v], axis=0) for v in vertices]
    by_l = [slope[..., v, indices[:, v]] * others[v] for v in vertices]
    return np.prod(value, axis=0), np.stack([part - by_l[0] for part in by_l[1:]], axis=-1)


def _silvester(order: int, l: Array) -> tuple[Array, Array]:  # noqa: E741  (as in the formula)
    """P_i(l) and P_i'(l) for i = 0 ... order, stacked last."""
    P, slope = [np.ones_like(l)], [np.zeros_like(l)]
    for i in range(1, order + 1):
        factor = (order * l - (i - 1)) / i
        slope.append(slope[-1] * factor + P[-1] * (order / i))
        P.append(P[-1] * factor)
    return np.stack(P, axis=-1), np.stack(slope, axis=-1)


def gradient(x: Array, u: Array, dphi: Array) -> Array:
    """`G[..., i, j] = d u_i / d x_j` of cells with nodes x (..., nodes, d) and values u (..., nodes, c).

    dphi: gradients of the shape functions at a point of each cell, (..., nodes, d), broadcast over cells.
    """
    jacobian = np.einsum("...nd,...nk->...dk", x, dphi)
    by_X = np.einsum("...nc,...nk->...ck", u, dphi)
    G: Array = np.linalg.solve(np.swapaxes(jacobian, -1, -2), np.swapaxes(by_X, -1, -2))
    return np.swapaxes(G, -1, -2)


def invert(x: Array, points: Array) -> Array:
    """Reference coordinates X (n, d) of points (n, d), each in the cell whose nodes x (n, nodes, d) hold.

    Newton's method from the straight cell; NaN where it does not converge, which is far outside the cell.
    """
    d = x.shape[2]
    order = order_of(x.shape[1], d)
    edges = np.swapaxes(x[:, 1 : d + 1] - x[:, :1], 1, 2)
    X = np.linalg.solve(edges, (points - x[:, 0])[..., None])[..., 0]
    size = np.full(len(X), np.inf)  # of the last step
    active = np.arange(len(X))
    for _ in range(_NEWTON_STEPS):
        at = np.clip(X[active], -1.0, 2.0)
        phi, dphi = tabulate(order, at)
        jacobian = np.einsum("pnd,pnk->pdk", x[active], dphi)
        defect = points[active] - np.einsum("pn,pnd->pd", phi, x[active])
        with np.errstate(all="ignore"):
            step = _solve(jacobian, defect)
        X[active], size[active] = at + step, np.abs(step).max(axis=1)
        active = active[size[active] >= _CONVERGED]  # NaN is given up
        if not len(active):
            break
    X[~(size < 1e-9)] = np.nan
    return X


def _solve(A: Array, b: Array) -> Array:
    """Solve d x d systems by Cramer's rule; infinite where singular, where LAPACK would give up on all."""
    if A.shape[-1] == 2:
        det = A[:, 0, 0] * A[:, 1, 1] - A[:, 0, 1] * A[:, 1, 0]
        first = b[:, 0] * A[:, 1, 1] - b[:, 1] * A[:, 0, 1]
        second = A[:, 0, 0] * b[:, 1] - A[:, 1, 0] * b[:, 0]
        return np.stack([first, second], axis=1) / det[:, None]
    x, y, z = np.moveaxis(A, 2, 0)
    minors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)
    solution: Array = np.einsum("pkd,pd->pk", minors, b) / np.einsum("pd,pd->p", minors[:, 0], x)[:, None]
    return solution


def locate(x: Array, points: Array, tolerance: float) -> tuple[Indices, Array]:
    """The cell that holds each point, (n,), -1 outside all of them, and where in it, X (n, d), NaN there.

    Args:
        x: nodes of the cells, (cells, nodes, d).
        points: (n, d).
        tolerance: how far outside a cell, in barycentric coordinates, a point still counts as inside.
    """
    cell, X = np.full(len(points), -1), np.full(points.shape, np.nan)
    low, high = x.min(axis=1), x.max(axis=1)
    slack = _SLACK * (high - low).max(axis=1, keepdims=True)
    low, high = low - slack, high + slack
    order = np.argsort(points[:, 0])
    for block in (order[k : k + _BLOCK] for k in range(0, len(order), _BLOCK)):
        x_block = points[block]
        near = np.flatnonzero(np.all((low <= x_block.max(axis=0)) & (high >= x_block.min(axis=0)), axis=1))
        inside = np.all((x_block[:, None] >= low[near]) & (x_block[:, None] <= high[near]), axis=2)
        which, candidate = np.nonzero(inside)
        candidate = near[candidate]
        inner = invert(x[candidate], x_block[which])
        depth = np.minimum(inner.min(axis=1), 1.0 - inner.sum(axis=1))
        best = np.lexsort((-depth, which))  # of each point the deepest candidate first; NaN last
        best = best[depth[best] >= -tolerance]
        first = best[np.unique(which[best], return_index=True)[1]]
        cell[block[which[first]]], X[block[which[first]]] = candidate[first], inner[first]
    return cell, X
