"""What a reduced run writes for ParaView: the bodies as points, the lubricated gaps as lines."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration
from fsi.errors import SolveError
from fsi.reduced.pairs import Pairs


def write_bodies(folder: Path, step: int, q: Configuration, U: Array, F: Array) -> str:
    """Write `bodies_<step>.vtu`: a point for each body with radius, velocity, force, both of (N, modes)."""
    d = q.centres.shape[1]
    data = {"radius": q.radii, "velocity": _in_space(U[:, :d]), "force": _in_space(F[:, :d])}
    vertices = np.arange(len(q))[:, None]
    return _write(folder, f"bodies_{step:06d}.vtu", q.centres, "vertex", vertices, data, {})


def write_contacts(
    folder: Path, step: int, q: Configuration, pairs: Pairs, x: Array, force: Array, gamma: Array
) -> str:
    """Write `contacts_<step>.vtu`: a line for each pair from centre to centre, or to the wall.

    Its data, (P,): gap (that of the model, which may be stored), force (lambda, positive where the gap
    opens), and gamma, the stored impulse.
    """
    start = q.centres[pairs.i]
    other = np.where(pairs.is_wall, 0.0, q.radii[np.where(pairs.is_wall, 0, pairs.j)])
    end = start - (q.radii[pairs.i] + pairs.gap + other)[:, None] * pairs.n
    P = len(pairs)
    lines = np.column_stack([np.arange(P), P + np.arange(P)])
    data = {"gap": [np.exp(x)], "force": [force], "gamma": [gamma]}
    return _write(folder, f"contacts_{step:06d}.vtu", np.vstack([start, end]), "line", lines, {}, data)


def _in_space(vectors: Array) -> Array:
    """Vectors (n, d) with three components."""
    return np.column_stack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])


def _write(
    folder: Path,
    name: str,
    points: Array,
    cell: str,
    cells: NDArray[np.int64],
    data: dict[str, Array],
    cell_data: dict[str, list[Array]],
) -> str:
    mesh = meshio.Mesh(_in_space(points), [(cell, cells)], point_data=data, cell_data=cell_data)
    path = folder / name
    temporary = path.with_name(f".{name}.partial")
    try:
        meshio.write(temporary, mesh, file_format="vtu")
        temporary.replace(path)
    except OSError as error:
        raise SolveError(f"cannot write {path}: {error.strerror}") from error
    return name
