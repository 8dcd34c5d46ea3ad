"""The coarse space of the two-level preconditioner: velocities of degree 1 that are rigid on the bodies.

Every velocity of degree 1 on the same mesh is one of degree k: its nodal values there are I times its values
at the vertices. With the constraints of degree 1 (zero on the walls, rigid on the bodies) these are P_1 z,
where z are the values at free vertices and the modes of the bodies. The columns of I P_1 so carry the
coarse space into the fine one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from dolfinx.fem.petsc import interpolation_matrix
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.bodies.configuration import Array, rigid_motion
from fsi.stokes.discretisation.boundary import locate
from fsi.stokes.discretisation.constraints import Prolongation, dof_layout, rigid_modes
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.problem import StokesProblem


@dataclass(frozen=True, slots=True)
class Coarse:
    """Velocities of degree 1.

    Attributes:
        nodal: I P_1, (rows of u, free values z and, last on rank 0, the modes of all bodies).
        rigid: the rigid motions of everything in the rows of z that this rank owns, (rows, 6).
    """

    nodal: PETSc.Mat
    rigid: Array


def coarse_velocities(problem: StokesProblem, forms: Forms) -> Coarse:
    """The coarse space of a mesh, with zero velocity on walls with a given one; collective."""
    fluid, q = problem.fluid, problem.q
    vertices = fem.functionspace(fluid.mesh, ("Lagrange", 1, (fluid.dimension,)))
    nodes = locate(fluid, vertices)
    layout = dof_layout(fluid, nodes, problem.boundary.velocities, 0, None)
    rigid = rigid_modes(layout, nodes, q, fluid.lattice)
    P = Prolongation(layout, rigid, np.ones(layout.modes, dtype=bool)).matrix
    interpolation = interpolation_matrix(vertices, forms.V)
    interpolation.assemble()
    nodal = interpolation.matMult(P)
    for used in (rigid.matrix, P, interpolation):
        used.destroy()
    of_vertices = rigid_motion(nodes.x)[:, : layout.dimension].reshape(layout.rows, -1)[layout.free]
    of_bodies = rigid_motion(q.centres).reshape(layout.modes, -1)[: layout.modes_here]
    return Coarse(nodal, np.concatenate([of_vertices, of_bodies]))


def transfer(coarse: Coarse, free: NDArray[np.bool_], held: NDArray[np.bool_]) -> PETSc.Mat:
    """T: from z to the velocities and modes of the reduced system; collective.

    Args:
        coarse: the coarse space.
        free: which rows of u are unknowns of the reduced system, this rank's, (rows,).
        held: which modes are held: they move nothing but themselves, (M N,).
    """
    nodal = coarse.nodal
    indptr, column, value = nodal.getValuesCSR()
    first_mode = nodal.getOwnershipRangesColumn()[1] - len(held)
    value[np.isin(column, first_mode + np.flatnonzero(held))] = 0.0
    T = sp.csr_matrix((value, column, indptr), shape=(len(free), nodal.size[1]))[free]
    if nodal.comm.rank == 0:
        modes = sp.eye_array(len(held), nodal.size[1], k=first_mode, format="csr")
        T = sp.vstack([T, modes], "csr")
    return PETSc.Mat().createAIJ(
        size=((T.shape[0], None), (nodal.getLocalSize()[1], None)),
        csr=(T.indptr.astype(PETSc.IntType), T.indices.astype(PETSc.IntType), T.data),
        comm=nodal.comm,
    )
