"""Vorticity and strain rate at the nodes, for the field files.

Gradients of finite elements jump from cell to cell. At a node that cells share the file has the mean of
their values: continuous, as drawings want it, and the same on any number of ranks. `fsi probe` gives the
values of each cell itself.
"""

from __future__ import annotations

import basix
import numpy as np
from dolfinx import la

from fsi.bodies.configuration import Array
from fsi.meshes.cells.lagrange import gradient
from fsi.observables.velocity_gradient import hoop_rate, strain_rate, vorticity
from fsi.stokes.fields.flow import Flow


def nodal_rates(flow: Flow) -> dict[str, Array]:
    """`vorticity`, (n,) or in space (n, 3), and `strain_rate` (n,) at this rank's nodes; collective."""
    x, u = flow.x[flow.cells], flow.u[flow.cells]
    G = gradient(x[:, None], u[:, None], _slopes(flow.degree, x.shape[2]))
    hoop = hoop_rate(x[..., 0], u[..., 0], G) if flow.axisymmetric else 0.0
    values = np.concatenate(
        [np.atleast_3d(vorticity(G)), strain_rate(G, hoop)[..., None], np.ones((*flow.cells.shape, 1))],
        axis=2,
    )
    sums = la.vector(flow.nodes, bs=values.shape[2])
    table = sums.array.reshape(-1, values.shape[2])
    for k in range(values.shape[2]):
        table[:, k] = np.bincount(flow.cells.ravel(), values[..., k].ravel(), minlength=len(table))
    sums.scatter_reverse(la.InsertMode.add)
    sums.scatter_forward()
    means = table[:, :-1] / np.maximum(table[:, -1:], 1.0)
    curl = means[:, 0] if means.shape[1] == 2 else means[:, :-1]
    return {"vorticity": curl, "strain_rate": means[:, -1]}


def _slopes(degree: int, dimension: int) -> Array:
    """Gradients of the shape functions at the nodes, (nodes, nodes, d), both in the order of basix."""
    cell = {2: basix.CellType.triangle, 3: basix.CellType.tetrahedron}[dimension]
    element = basix.create_element(basix.ElementFamily.P, cell, degree, basix.LagrangeVariant.equispaced)
    slopes: Array = element.tabulate(1, element.points)[1:, :, :, 0]
    return np.moveaxis(slopes, 0, -1)
