"""The Lagrange cells of the field files: their nodes, and the straight pieces that stand for them.

A cell of the fluid has 3 vertices (in space 4), then the inner nodes of its edges, in the plane 01, 12, 20,
then its inner nodes; a curve has both ends, then its inner nodes along it.
"""

from __future__ import annotations

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from fsi.meshes.cells.lagrange import lattice

Indices = NDArray[np.intp]


def nodes(grid: pv.UnstructuredGrid) -> Indices:
    """Node numbers of each cell, in a grid of cells of one kind, shape (cells, nodes of one)."""
    numbers: Indices = grid.cell_connectivity.reshape(grid.n_cells, -1)
    return numbers


def small_triangles(order: int) -> Indices:
    """The triangles between the nodes of a cell, (order^2, 3), as it is oriented itself."""
    at = {index: k for k, index in enumerate(lattice(order))}
    up = [(at[i, j], at[i + 1, j], at[i, j + 1]) for i in range(order) for j in range(order - i)]
    down = [
        (at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]) for i in range(order) for j in range(order - i - 1)
    ]
    return np.array(up + down, dtype=np.intp)


def along_curves(curves: Indices) -> Indices:
    """The nodes of curves (cells, order + 1) from end to end."""
    return curves[:, [0, *range(2, curves.shape[1]), 1]]


def counted(cells: Indices) -> Indices:
    """VTK's list of cells: each row led by its length."""
    return np.insert(cells, 0, cells.shape[1], axis=1).ravel()
