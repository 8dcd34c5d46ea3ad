"""Points and lines with numbers as VTU files, for ParaView."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array


def write_points(path: Path, x: Array, values: Mapping[str, Array]) -> None:
    """Points (n, d) with numbers (n,) or vectors (n, 3) at each."""
    cells = [("vertex", np.arange(len(x))[:, None])]
    _write(path, x, cells, point_data=dict(values))


def write_lines(path: Path, start: Array, end: Array, values: Mapping[str, Array]) -> None:
    """Straight lines between points (n, d), with numbers (n,) on each."""
    n = len(start)
    cells = [("line", np.column_stack([np.arange(n), n + np.arange(n)]))]
    _write(
        path, np.concatenate([start, end]), cells, cell_data={key: [value] for key, value in values.items()}
    )


def write_polyline(path: Path, x: Array, values: Mapping[str, Array]) -> None:
    """A line through the points (n, d) in their order, with numbers (n,) at each."""
    k = np.arange(len(x) - 1)
    _write(path, x, [("line", np.column_stack([k, k + 1]))], point_data=dict(values))


def _write(
    path: Path, x: Array, cells: list[tuple[str, NDArray[np.intp]]], **data: dict[str, object]
) -> None:
    space = np.pad(x, ((0, 0), (0, 3 - x.shape[1])))
    partial = path.with_name(f".{path.name}")
    meshio.Mesh(space, cells, **data).write(partial, file_format="vtu")
    partial.rename(path)
