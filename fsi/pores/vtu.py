"""The files of ParaView of the model of pores: the flow in curved cells, and necks as lines.

Each patch of a pore is cut into Lagrange triangles of order 6 whose nodes carry velocity, stream function,
vorticity, strain rate and, where there is one, pressure, and which have its mean gradient: a strip into two;
a triangle, a strip that ends in a corner and a sector of a fluid disc are one. All run counterclockwise.
Where patches meet each has nodes of its own, in the same places. In a periodic domain each patch stands where
its middle is in one period.
"""

from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.cells.lagrange import lattice, tabulate
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice
from fsi.observables.bars import DrivenBodies
from fsi.observables.kinematics import strain_rate, vorticity
from fsi.pores.carrier import stream
from fsi.pores.fields import FlowFields, PoreMesh
from fsi.pores.necks import Necks
from fsi.pores.pressure import PressureField
from fsi.run_folder.paraview import in_space, write_lines, write_vtu

ORDER = 6
GRADIENT = ("dp_dx", "dp_dy")  # of cells: the mean pressure gradient, the same one in all
_SIDE = ORDER + 1
_PATCH = _SIDE**2  # points of a patch, row by row


def write_flow(bodies: DrivenBodies, fields: FlowFields, pressure: PressureField | None, path: Path) -> None:
    """Write the flow, with its pressure where there is one. Raises SolveError: the disk refuses."""
    mesh = fields.mesh(ORDER)
    x, u, psi = _in_one_period(
        mesh, bodies.case.container().at(bodies.t, bodies.q.strain), fields.flow.gradient
    )
    G = mesh.field.gradient
    more = [] if pressure is None else [pressure.on_mesh(ORDER) + (x - mesh.points) @ pressure.gradient]
    columns = np.column_stack([x, u, psi, vorticity(G), strain_rate(G), *more])
    known = columns.reshape(-1, _PATCH, columns.shape[1])
    pore, ends = mesh.pore, mesh.ends
    known[mesh.corner, :_SIDE, 5:7] = 0.0  # fluid rests in a corner, where derivatives are quotients of zeros
    nodes, cells = _cells(known, ends)
    cells = _counterclockwise(cells, nodes[:, :2])
    values = {"velocity": in_space(nodes[:, 2:4]), "psi": nodes[:, 4], "vorticity": nodes[:, 5]}
    values["strain_rate"] = nodes[:, 6]
    of_cells = {"pore": [np.concatenate([pore[~ends], pore[~ends], pore[ends]])]}
    if pressure is not None:
        values["pressure"] = nodes[:, 7]
        for name, G in zip(GRADIENT, pressure.gradient, strict=True):
            of_cells[name] = [np.full(len(cells), G)]
    write_vtu(path, meshio.Mesh(in_space(nodes[:, :2]), [("VTK_LAGRANGE_TRIANGLE", cells)], values, of_cells))


def _cells(known: Array, ends: NDArray[np.bool_]) -> tuple[Array, NDArray[np.int64]]:
    """What is known at the nodes of cells, (n, .), and the nodes of each, in the order of VTK, (cells, .).

    known: at the points of patches, (P, _PATCH, .); ends: of which the first row is one point.
    """
    steps = np.array(lattice(ORDER))
    row, column = steps.sum(axis=1), steps[:, 1]
    halves = _SIDE * row + column, _SIDE * column + row
    whole = _resampling(row, column) @ known[ends]
    nodes = np.concatenate([part.reshape(-1, known.shape[2]) for part in (known[~ends], whole)])
    count = np.count_nonzero(~ends)
    starts = _PATCH * np.arange(count)[:, None]
    of_whole = _PATCH * count + np.arange(whole.shape[0] * len(steps)).reshape(-1, len(steps))
    return nodes, np.concatenate([starts + halves[0], starts + halves[1], of_whole])


def _counterclockwise(cells: NDArray[np.int64], x: Array) -> NDArray[np.int64]:
    """The cells, those with a negative Jacobian with their second and third vertex exchanged; x: (n, 2).

    No cell is folded: its middle tells.
    """
    steps = lattice(ORDER)
    exchanged = [steps.index((j, i)) for i, j in steps]
    dphi = tabulate(ORDER, np.full(2, 1.0 / 3.0))[1]
    J = np.einsum("cnd,nk->cdk", x[cells], dphi)
    clockwise = J[:, 0, 0] * J[:, 1, 1] < J[:, 0, 1] * J[:, 1, 0]
    return np.where(clockwise[:, None], cells[:, exchanged], cells)


def _resampling(row: NDArray[np.int64], column: NDArray[np.int64]) -> Array:
    """Values of the polynomial along a row of a patch where the triangle has its nodes, (nodes, _PATCH)."""
    t = np.linspace(0.0, 1.0, _SIDE)
    at = column / np.maximum(row, 1)
    weights = np.zeros((len(row), _SIDE, _SIDE))
    for k in range(_SIDE):
        others = np.delete(t, k)
        weights[np.arange(len(row)), row, k] = np.prod((at[:, None] - others) / (t[k] - others), axis=1)
    return weights.reshape(len(row), _PATCH)


def _in_one_period(mesh: PoreMesh, container: Container, E: Array) -> tuple[Array, Array, Array]:
    """Points, velocities and psi of a mesh of whose patches each stands near one period; E: the mean flow."""
    lattice = Lattice(container.periods)
    if lattice.dimension == 0:
        return mesh.points, mesh.field.u, mesh.field.psi
    middle = mesh.points.reshape(-1, _PATCH, 2).mean(axis=1)
    e = np.repeat(lattice.wrapped(middle) - middle, _PATCH, axis=0)
    x = mesh.points + e
    return x, mesh.field.u + e @ E.T, mesh.field.psi + stream(E, x) - stream(E, mesh.points)


def write_necks(bodies: DrivenBodies, necks: Necks, path: Path) -> None:
    """Lines from centre to centre, or to the wall; gap, what is dissipated, and what flows through."""
    q, container = bodies.q, bodies.case.container().at(bodies.t, bodies.q.strain)
    lattice, i, j = Lattice(container.periods), necks.sides[:, 0], necks.sides[:, 1]
    start = lattice.wrapped(q.centres[i]) if lattice.dimension else q.centres[i]
    wall, image = j >= len(q), lattice.shift(necks.image[:, : lattice.dimension])
    towards = q.centres[np.where(wall, i, j)] + image - q.centres[i]
    at = i[wall], j[wall] - len(q)
    towards[wall] = -container.distances(q.centres)[at][:, None] * container.normals(q.centres)[at]
    values = {"gap": necks.gap, "dissipation": necks.dissipation, "flux": necks.flux}
    sides = {"first": i.astype(float), "second": j.astype(float)}
    write_lines(path, start, start + towards, values | sides)
