"""Field files as pyvista grids; damaged ones are refused before VTK, which would not survive them."""

import logging
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from vtkmodules.vtkCommonCore import vtkLogger

from fsi.errors import InputError

Indices = NDArray[np.intp]
_SAME_NODE = 1e-13  # of the size of the domain: ranks agree on the nodes that they share to rounding
_REMEDY = "run the case again"  # `fsi resume` does not look at field files


def read_grid(path: Path, names: Sequence[str]) -> pv.UnstructuredGrid:
    """The grid of a .vtu file, with these values at its nodes. Raises InputError: it is damaged."""
    if not path.is_file():
        raise InputError(f"{path}: is not there, or no file; {_REMEDY}")
    try:
        with _quiet_vtk(), warnings.catch_warnings(action="error"):  # pyvista only warns of a broken file
            grid = pv.read(path)
    except (OSError, RuntimeError, ValueError, AttributeError, UserWarning):  # in words of VTK's own
        raise InputError(f"{path}: is damaged; {_REMEDY}") from None
    try:
        _require_sound(grid, names)
    except ValueError as error:
        raise InputError(f"{path}: is damaged ({error}); {_REMEDY}") from None
    return grid


def _require_sound(grid: pv.UnstructuredGrid, names: Sequence[str]) -> None:
    """Raise ValueError unless cells of one kind join nodes that are there, with finite values at them."""
    if not isinstance(grid, pv.UnstructuredGrid):
        raise ValueError("it has no such grid")
    corners = grid.cell_connectivity
    if corners.min(initial=0) < 0 or corners.max(initial=-1) >= grid.n_points:
        raise ValueError("its cells join nodes that it has not")
    if len(np.unique(grid.celltypes)) > 1 or (grid.n_cells and len(corners) % grid.n_cells):
        raise ValueError("its cells are of several kinds")
    for name in names:
        if name not in grid.point_data:
            raise ValueError(f"it has no {name}")
    for name, values in (("place", grid.points), *grid.point_data.items()):
        if not np.isfinite(values).all():
            raise ValueError(f"a {name} in it is not finite")


@contextmanager
def _quiet_vtk() -> Iterator[None]:
    """VTK prints what it then raises, and pyvista logs it."""
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    logging.disable(logging.CRITICAL)
    try:
        yield
    finally:
        logging.disable(logging.NOTSET)
        vtkLogger.SetStderrVerbosity(verbosity)


def joined(parts: list[pv.UnstructuredGrid]) -> pv.UnstructuredGrid:
    """One grid, in which nodes that parts share are one."""
    if len(parts) == 1:
        return parts[0]
    grid = pv.merge(parts, merge_points=False)
    pairs = cKDTree(grid.points).query_pairs(_SAME_NODE * grid.length, output_type="ndarray")
    same = np.arange(grid.n_points)
    np.minimum.at(same, pairs.max(axis=1), pairs.min(axis=1))
    first, number = np.unique(same, return_inverse=True)
    whole = pv.UnstructuredGrid(counted(number[nodes(grid)]), grid.celltypes, grid.points[first])
    whole.point_data.update({name: values[first] for name, values in grid.point_data.items()})
    whole.cell_data.update(grid.cell_data)
    return whole


def nodes(grid: pv.UnstructuredGrid) -> Indices:
    """Node numbers of each cell, in a grid of Lagrange cells of one kind, shape (cells, nodes of one).

    A cell of the fluid has 3 vertices (in space 4), then the inner nodes of its edges, in the plane 01, 12,
    20, then its inner nodes; a curve has both ends, then its inner nodes along it.
    """
    numbers: Indices = grid.cell_connectivity.reshape(grid.n_cells, -1)
    return numbers


def along_curves(curves: Indices) -> Indices:
    """The nodes of curves (cells, order + 1) from end to end."""
    return curves[:, [0, *range(2, curves.shape[1]), 1]]


def counted(cells: Indices) -> Indices:
    """VTK's list of cells: each row led by its length."""
    return np.insert(cells, 0, cells.shape[1], axis=1).ravel()
