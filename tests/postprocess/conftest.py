"""A small run folder with an analytic flow on cubic cells, in two parts as two ranks write it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from numpy.typing import NDArray

RADIUS, HEIGHT, FAR = 1.0, 1.2, 6.0
AROUND, OUTWARD = 24, 5
CASE = f"""
name = "analytic"
geometry = "planar"
fluid.viscosity = 1.0
domain.shape = "half-plane"
domain.radius = {FAR}
[[bodies]]
name = "disc"
radius = {RADIUS}
position = [0.0, {HEIGHT}]
force = [0.0, -1.0]
[time]
end = 2.0
"""
# Where the nodes of a cubic triangle lie: vertices, edges 01, 12, 20, centre.
THIRDS = np.array([[0, 0], [3, 0], [0, 3], [1, 0], [2, 0], [2, 1], [1, 2], [0, 2], [0, 1], [1, 1]]) / 3.0


def psi(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """A stream function."""
    return np.asarray(np.sin(0.5 * x[:, 0]) * x[:, 1] ** 2)


def velocity(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Its flow, (d psi / dy, -d psi / dx, 0)."""
    u_x = 2.0 * x[:, 1] * np.sin(0.5 * x[:, 0])
    u_y = -0.5 * np.cos(0.5 * x[:, 0]) * x[:, 1] ** 2
    return np.column_stack([u_x, u_y, np.zeros(len(x))])


def position(turn: NDArray[np.float64], out: NDArray[np.float64]) -> NDArray[np.float64]:
    """Point at the part `turn` of the way around the disc and the part `out` of the way to the walls."""
    ray = np.stack([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)], axis=-1)
    with np.errstate(divide="ignore"):
        to_plane = np.where(ray[..., 1] < 0.0, -HEIGHT / ray[..., 1], np.inf)
    along = HEIGHT * ray[..., 1]
    to_arc = -along + np.sqrt(along**2 + FAR**2 - HEIGHT**2)
    end = np.minimum(to_plane, to_arc)
    distance = RADIUS + out * (end - RADIUS)
    return np.asarray([0.0, HEIGHT] + distance[..., None] * ray)


def cubic_mesh() -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Points (n, 3) and cells (m, 10) around the disc."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(AROUND), np.arange(OUTWARD), indexing="ij"))
    corners = np.stack(
        [np.stack([i, j]), np.stack([i + 1, j]), np.stack([i, j + 1]), np.stack([i + 1, j + 1])]
    )
    nodes = []
    for a, b, c in ((0, 1, 2), (3, 2, 1)):
        origin, first, second = corners[a], corners[b] - corners[a], corners[c] - corners[a]
        nodes.append(origin[None] + THIRDS[:, 0, None, None] * first + THIRDS[:, 1, None, None] * second)
    turn, out = np.concatenate(nodes, axis=2).transpose(1, 2, 0)
    keys = np.column_stack([np.rint(3 * turn.ravel()) % (3 * AROUND), np.rint(3 * out.ravel())])
    unique, cells = np.unique(keys, axis=0, return_inverse=True)
    x = position(unique[:, 0] / (3 * AROUND), unique[:, 1] / (3 * OUTWARD))
    return np.column_stack([x, np.zeros(len(x))]), cells.reshape(-1, 10)


def write_fields(run: Path, time: float, step: int) -> list[str]:
    """Write one step in two parts; the lines for the .pvd file."""
    points, cells = cubic_mesh()
    lines = []
    for part, chosen in enumerate(np.array_split(cells, 2)):
        grid = pv.UnstructuredGrid({pv.CellType.LAGRANGE_TRIANGLE: chosen}, points)
        grid.point_data["velocity"] = (1.0 + time) * velocity(points)
        grid.point_data["pressure"] = points[:, 0]
        name = f"fields/fluid_{step:06d}_{part}.vtu"
        grid.clean().save(run / name)
        lines.append(f'<DataSet timestep="{time!r}" group="" part="{part}" file="{name}"/>')
    return lines


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """The run folder, with field files at t = 0 and t = 2 and table rows at t = 0, 1, 2."""
    folder = tmp_path / "run"
    (folder / "fields").mkdir(parents=True)
    (folder / "case.toml").write_text(CASE)
    lines = write_fields(folder, 0.0, 0) + write_fields(folder, 2.0, 2)
    (folder / "fluid.pvd").write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1"><Collection>\n'
        + "\n".join(lines)
        + "\n</Collection></VTKFile>\n"
    )
    write_bodies(folder, [0.0, 1.0, 2.0], [HEIGHT, HEIGHT, HEIGHT])
    return folder


def write_bodies(folder: Path, times: list[float], heights: list[float]) -> None:
    """The table of the only disc."""
    rows = [
        f"{n},{t!r},disc,0.0,{y!r},{0.1 * n},0,0,0,0,-1,0"
        for n, (t, y) in enumerate(zip(times, heights, strict=True))
    ]
    head = "step,t,body,x,y,angle,V_x,V_y,omega,F_x,F_y,T"
    (folder / "bodies.csv").write_text("\n".join([head, *rows]) + "\n")


@pytest.fixture
def settling_run(run: Path) -> Callable[[list[float], list[float]], Path]:
    """Gives the run folder the heights that the disc has at the given times."""

    def fill(times: list[float], heights: list[float]) -> Path:
        write_bodies(run, times, heights)
        return run

    return fill
