"""From velocities of one degree to those of the next on a mesh: rows of I P, where both are unknowns.

The nodal values of a velocity of the lower degree are I times its own, which are P z (see `multigrid`). A
node lies in some cell, whichever: its row of I has the values there of this cell's functions. The matrix of
interpolation that DOLFINx makes, and its product with P, take ten times as long.
"""

from __future__ import annotations

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array, Indices
from fsi.meshes.build import FunctionSpace
from fsi.stokes.discretisation.constraints import DofLayout, Prolongation
from fsi.stokes.discretisation.nodal_matrix import NO_COLUMN
from fsi.stokes.discretisation.shared_rows import shared_columns
from fsi.stokes.solvers.components import COMPONENTS

ROUNDING = 1e-12  # what a function that is zero at a node has there


def transfer(
    fine: FunctionSpace, layout: DofLayout, coarse: FunctionSpace, P: Prolongation, held: NDArray[np.bool_]
) -> PETSc.Mat:
    """T, from z of the coarse velocities to those of the fine ones, modes to themselves; collective.

    layout: of the fine ones. P: of the coarse ones, with all modes. held: modes that move nothing but
    themselves, (M N,).
    """
    free = np.flatnonzero(layout.free[::COMPONENTS])
    row, node, value = _interpolated(fine, coarse, free)
    columns, weights = _with_ghosts(coarse, P)
    columns[np.isin(columns, P.modes[held])] = NO_COLUMN
    entry, component, mode = np.nonzero(columns[node] != NO_COLUMN)
    rows, here = COMPONENTS * row[entry] + component, COMPONENTS * len(free)
    values = value[entry] * weights[node[entry], component, mode]
    own = layout.modes_here
    size = here + own, P.matrix.size[1]
    at = (
        np.concatenate([rows, here + np.arange(own)]),
        np.concatenate([columns[node[entry], component, mode], P.modes[:own]]),
    )
    T = scipy.sparse.coo_array((np.concatenate([values, np.ones(own)]), at), size).tocsr()
    csr = (T.indptr.astype(PETSc.IntType), T.indices.astype(PETSc.IntType), T.data)
    return PETSc.Mat().createAIJ(size=((size[0], None), (P.here, None)), csr=csr, comm=P.matrix.comm)


def _interpolated(
    fine: FunctionSpace, coarse: FunctionSpace, nodes: Indices
) -> tuple[Indices, Indices, Array]:
    """I at some of this rank's fine nodes: which of them, the coarse node by its local number, the value."""
    fine_nodes, coarse_nodes = fine.dofmap.list, coarse.dofmap.list
    functions, points = coarse.element.basix_element, fine.element.basix_element.points
    values = functions.tabulate(0, points)[0, :, :, 0]
    values[np.abs(values) < ROUNDING] = 0.0
    cell, place = np.empty((2, fine_nodes.max() + 1), dtype=np.int32)
    cell[fine_nodes] = np.arange(len(fine_nodes))[:, None]
    place[fine_nodes] = np.arange(fine_nodes.shape[1])
    of_nodes = values[place[nodes]]
    row, function = np.nonzero(of_nodes)
    return row, coarse_nodes[cell[nodes][row], function], of_nodes[row, function]


def _with_ghosts(space: FunctionSpace, P: Prolongation) -> tuple[Indices, Array]:
    """The columns of P and weights of each node that this rank's cells meet, (nodes, components, w)."""
    numbers = space.dofmap.index_map
    here = numbers.size_local
    met, shared = shared_columns(numbers.ghosts, here)
    place = np.concatenate([shared.own, np.searchsorted(met, numbers.ghosts)])
    shape = (here, COMPONENTS, P.columns.shape[1])
    columns, weights = (shared.with_ghosts(each.reshape(shape))[place] for each in (P.columns, P.weights))
    return columns, weights
