"""The Stokes matrix M = [A B^T; B 0] of all rows, by the loops over cells and by DOLFINx."""

from __future__ import annotations

import fsi.meshes.backend  # noqa: F401

import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from petsc4py import PETSc

from fsi.stokes.discretisation.cells import StokesCells
from fsi.stokes.discretisation.constraints import DofLayout, Prolongation, RigidModes
from fsi.stokes.discretisation.forms import Coordinates, Forms, points_degree
from fsi.stokes.solvers.assembly import CellSum


def added_up(forms: Forms) -> sp.csr_matrix:
    """By the loops, with no row constrained."""
    V, Q, none = forms.V.dofmap, forms.Q.dofmap, np.empty(0, dtype=np.int64)
    nodes, pressures = V.index_map.size_local, Q.index_map.size_local
    layout = DofLayout(
        MPI.COMM_WORLD, V.index_map_bs, nodes, pressures, none, none, none, 0, forms.axisymmetric
    )
    still = RigidModes(PETSc.Mat(), none, none.reshape(0, 1), np.empty((0, 1)))
    every = Prolongation(layout, still, np.empty(0, dtype=bool))
    return _rows(CellSum(StokesCells(forms, condensed=False), every).matrix)


def assembled(forms: Forms) -> sp.csr_matrix:
    """A: int 2 mu e(u) : e(v) and B: - int q div u, as a textbook has them, with the points of the loops."""
    geometry, omega = forms.mesh.geometry, forms.mesh.ufl_domain()
    degree = points_degree(geometry.cmaps[0].degree, forms.degree, geometry.dim, forms.axisymmetric)
    assert omega is not None
    space = Coordinates(omega, forms.axisymmetric)
    w, dx = space.weight, ufl.dx(domain=omega, metadata={"quadrature_degree": degree})
    u, v, q = ufl.TrialFunction(forms.V), ufl.TestFunction(forms.V), ufl.TestFunction(forms.Q)
    a = 2 * forms.viscosity * ufl.inner(space.strain_rate(u), space.strain_rate(v)) * w * dx
    b = -q * space.div(u) * w * dx
    A, B = (assemble_matrix(fem.form(form)) for form in (a, b))
    for matrix in (A, B):
        matrix.assemble()
    A, B = map(_rows, (A, B))
    return sp.block_array([[A, B.T], [B, None]], format="csr")


def _rows(matrix: PETSc.Mat) -> sp.csr_matrix:
    indptr, column, value = matrix.getValuesCSR()
    return sp.csr_matrix((value, column, indptr), matrix.size)
