"""What a reduced run writes for ParaView: the bodies as points, the lubricated gaps as lines."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import meshio
import numpy as np

from fsi.bodies.configuration import Array, Configuration
from fsi.errors import SolveError
from fsi.reduced.pairs import Pairs


def write_bodies(folder: Path, step: int, q: Configuration, U: Array, F: Array) -> str:
    """Write `bodies_<step>.vtu`: a point for each body with radius, velocity, force, both of (N, modes)."""
    d = q.centres.shape[1]
    data = {"radius": q.radii, "velocity": _in_space(U[:, :d]), "force": _in_space(F[:, :d])}
    vertices = [("vertex", np.arange(len(q))[:, None])]
    return _write(
        folder / f"bodies_{step:06d}.vtu", meshio.Mesh(_in_space(q.centres), vertices, point_data=data)
    )


def write_contacts(folder: Path, step: int, q: Configuration, pairs: Pairs, data: Mapping[str, Array]) -> str:
    """Write `contacts_<step>.vtu`: a line for each pair from centre to centre, or to the wall.

    data: what is known of each pair, (P,) by name.
    """
    start = q.centres[pairs.i]
    other = np.where(pairs.is_wall, 0.0, q.radii[np.where(pairs.is_wall, 0, pairs.j)])
    end = start - (q.radii[pairs.i] + pairs.gap + other)[:, None] * pairs.n
    P = len(pairs)
    lines = [("line", np.column_stack([np.arange(P), P + np.arange(P)]))]
    cell_data = {name: [values] for name, values in data.items()}
    mesh = meshio.Mesh(_in_space(np.vstack([start, end])), lines, cell_data=cell_data)
    return _write(folder / f"contacts_{step:06d}.vtu", mesh)


def _in_space(vectors: Array) -> Array:
    """Vectors (n, d) with three components."""
    return np.column_stack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])


def _write(path: Path, mesh: meshio.Mesh) -> str:
    """Write under a temporary name that is then the path's, which is returned."""
    temporary = path.with_name(f".{path.name}.partial")
    try:
        meshio.write(temporary, mesh, file_format="vtu")
        temporary.replace(path)
    except OSError as error:
        raise SolveError(f"cannot write {path}: {error.strerror}") from error
    return path.name
