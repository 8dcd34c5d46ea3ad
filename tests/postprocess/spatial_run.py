"""A run folder in space: a ball in a box, with an analytic flow on a few quadratic tetrahedra."""

from pathlib import Path

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from fsi.meshes.cells.lagrange import reference_nodes

CASE = """
name = "ball"
geometry = "spatial"
fluid.viscosity = 1.0
domain.lower = [-2.0, -2.0, -2.0]
domain.upper = [2.0, 2.0, 2.0]
[[bodies]]
name = "ball"
radius = 0.5
position = [0.0, 0.0, 0.0]
"""


def velocity(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """A quadratic flow without divergence."""
    return np.column_stack([x[:, 1] * x[:, 2], x[:, 2] ** 2, x[:, 0] * x[:, 1]])


def rates(x: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Its vorticity, (n, 3), and its strain rate sqrt(2 e:e), (n,)."""
    curl = np.column_stack([x[:, 0] - 2.0 * x[:, 2], np.zeros(len(x)), -x[:, 2]])
    squared = x[:, 2] ** 2 + 4.0 * x[:, 1] ** 2 + (2.0 * x[:, 2] + x[:, 0]) ** 2
    return {"vorticity": curl, "strain_rate": np.sqrt(squared)}


def write_spatial_run(folder: Path) -> Path:
    """The fields fill the box, the ball too; inner nodes are moved by a map that keeps its faces."""
    (folder / "fields").mkdir()
    (folder / "case.toml").write_text(CASE)
    side = np.linspace(-2.0, 2.0, 4)
    x = np.stack(np.meshgrid(side, side, side), axis=-1).reshape(-1, 3)
    cells = Delaunay(x + 1e-3 * np.sin(7.0 * np.arange(x.size)).reshape(x.shape)).simplices
    bary = reference_nodes(2, 3)
    bary = np.column_stack([1.0 - bary.sum(axis=1), bary])
    volume = np.linalg.det(x[cells[:, 1:]] - x[cells[:, :1]])
    cells = cells[np.abs(volume) > 1e-6]
    flip = np.linalg.det(x[cells[:, 1:]] - x[cells[:, :1]]) < 0.0
    cells[flip] = cells[flip][:, [0, 2, 1, 3]]
    nodes = np.einsum("kv,cvd->ckd", bary, x[cells]).reshape(-1, 3)
    nodes += 0.03 * np.prod(4.0 - nodes**2, axis=1, keepdims=True) / 16.0
    grid = pv.UnstructuredGrid(
        {pv.CellType.LAGRANGE_TETRAHEDRON: np.arange(len(nodes)).reshape(-1, len(bary))}, nodes
    )
    grid["velocity"] = velocity(nodes)
    grid["pressure"] = nodes[:, 0]
    grid.point_data.update(rates(nodes))
    grid.save(folder / "fields" / "fluid_000000.vtu")
    entry = '<DataSet timestep="0.0" part="0" file="fields/fluid_000000.vtu"/>'
    (folder / "fluid.pvd").write_text(f"<VTKFile><Collection>{entry}</Collection></VTKFile>")
    head = "step,t,body,x,y,z,angle_x,angle_y,angle_z"
    (folder / "bodies.csv").write_text(f"{head}\n0,0.0,ball,0,0,0,0,0,0\n")
    return folder
