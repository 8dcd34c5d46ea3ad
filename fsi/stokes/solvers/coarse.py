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

from fsi.bodies.configuration import Array, Configuration, rigid_motion
from fsi.meshes.build import FluidMesh
from fsi.stokes.discretisation.boundary import locate
from fsi.stokes.discretisation.constraints import Prolongation, layout, rigid_modes
from fsi.stokes.discretisation.forms import Forms


@dataclass(frozen=True, slots=True)
class Coarse:
    """Velocities of degree 1.

    nodal: I P_1, (rows of u, free values z and, last on rank 0, the modes of all bodies); rigid: the rigid
    motions of everything in the rows of z that this rank owns, (rows, 6).
    """

    nodal: PETSc.Mat
    rigid: Array


def coarse_velocities(fluid: FluidMesh, forms: Forms, walls: tuple[str, ...], q: Configuration) -> Coarse:
    """The coarse space of a mesh, with zero velocity on the given walls; collective."""
    vertices = fem.functionspace(fluid.mesh, ("Lagrange", 1, (fluid.dimension,)))
    nodes = locate(fluid, vertices)
    shares = layout(fluid.mesh.comm, nodes, walls, 0, None, fluid)
    rigid = rigid_modes(shares, nodes, q, fluid.lattice)
    P = Prolongation(shares, rigid, np.ones(shares.modes, dtype=bool)).matrix
    interpolation = interpolation_matrix(vertices, forms.V)
    interpolation.assemble()
    nodal = interpolation.matMult(P)
    for used in (rigid.matrix, P, interpolation):
        used.destroy()
    of_vertices = rigid_motion(nodes.x)[:, : shares.dimension].reshape(shares.rows, -1)[shares.free]
    of_bodies = rigid_motion(q.centres).reshape(shares.modes, -1)[: shares.own_modes]
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
    own = sp.csr_matrix((value, column, indptr), shape=(len(free), nodal.size[1]))[free]
    if nodal.comm.rank == 0:
        modes = sp.eye_array(len(held), nodal.size[1], k=first_mode, format="csr")
        own = sp.vstack([own, modes], "csr")
    return PETSc.Mat().createAIJ(
        size=((own.shape[0], None), (nodal.getLocalSize()[1], None)),
        csr=(own.indptr.astype(PETSc.IntType), own.indices.astype(PETSc.IntType), own.data),
        comm=nodal.comm,
    )
