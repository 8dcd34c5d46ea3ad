"""The flow as curved cells whose nodes carry velocity and pressure, and its values at any point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from dolfinx.common import IndexMap
from numpy.typing import NDArray

import fsi.parallel as parallel
from fsi.bodies.configuration import Array
from fsi.meshes.cells.lagrange import locate, tabulate
from fsi.meshes.files.write import vtk_order
from fsi.stokes.discretisation.forms import Forms

# How far beyond its cell a point counts as in it, in sizes of the cell: one that is on a body to rounding.
BEYOND = 1e-4


@dataclass(frozen=True, slots=True)
class Flow:
    """This rank's cells: Lagrange triangles or tetrahedra whose nodes carry velocity and pressure.

    Attributes:
        x: nodes, (n, d).
        cells: node numbers in the order of basix, (T, nodes).
        u: velocities, (n, d).
        p: pressures, (n,).
        degree: of the cells.
        nodes: which of the nodes other ranks have too.
        axisymmetric: whether x are (r, z).
    """

    x: Array
    cells: NDArray[np.int64]
    u: Array
    p: Array
    degree: int
    nodes: IndexMap
    axisymmetric: bool


def capture(forms: Forms, x: Array) -> Flow:
    """Copy the flow that stands in `forms`, with its nodes x, which it keeps."""
    V, topology = forms.V, forms.mesh.topology
    d = topology.dim
    cells = V.dofmap.list[: topology.index_map(d).size_local]
    u, p = np.array(forms.u.x.array, dtype=np.float64).reshape(-1, d), _pressure_at_nodes(forms, cells)
    degree = V.element.basix_element.degree
    return Flow(x, cells.astype(np.int64), u, p, degree, V.dofmap.index_map, forms.axisymmetric)


def _pressure_at_nodes(forms: Forms, cells: NDArray[np.int32]) -> Array:
    """The pressure at the nodes of the velocity: exact, since the element of V holds that of Q."""
    points = forms.V.element.basix_element.points
    phi = forms.Q.element.basix_element.tabulate(0, points)[0, :, :, 0]
    p = np.empty(len(forms.u.x.array) // forms.mesh.topology.dim)
    p[cells] = forms.p.x.array[forms.Q.dofmap.list[: len(cells)]] @ phi.T
    return p


def values_at(flow: Flow, points: Array) -> Array:
    """u and p, the elements' own, at points (n, d): (n, d + 1), NaN where there is no cell; collective.

    All ranks ask for the same points and get all values.
    """
    cells = flow.cells[:, vtk_order(flow.cells.shape[1], points.shape[1])]
    cell, X = locate(flow.x[cells], points, BEYOND)
    inside = cell >= 0
    phi, _ = tabulate(flow.degree, X[inside])
    values = np.full((len(points), points.shape[1] + 1), np.nan)
    nodes = cells[cell[inside]]
    values[inside] = np.einsum("pn,pnc->pc", phi, np.column_stack([flow.u, flow.p])[nodes])
    # Where ranks meet, the first that knows a point speaks: all have the same values then.
    first, *others = parallel.gather(values)
    for other in others:
        first = np.where(np.isnan(first), other, first)
    return first
