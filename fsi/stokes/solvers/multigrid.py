"""Velocities of all degrees on one mesh, for the multigrid cycle in the preconditioner of `gmres`.

What is approximated is not A itself, the form of strain rates, but that of the gradients of each component:

    L = int mu grad u : grad v,       int 2 mu e(u) : e(u) = int mu |grad u|^2 + int mu (div u)^2

for velocities u that are zero or rigid on the boundary (but for the rotations of bodies, which grad u would
count within them too). So L <= A <= 2 L whatever the mesh, A = L for velocities without divergence and
A = 2 L for gradients: the matrix is MIDDLE L. Its components do not meet each other but on bodies, so that it
has a third of the entries of A.

Every velocity of degree d - 1 on a mesh is one of degree d: its nodal values there are I times its own. With
the constraints of its degree (zero on the walls, rigid on the bodies, images tied) these are P z, where z are
its values at free nodes and the modes of the bodies. So the columns of I P carry one level into the next.
Narrow gaps, where cells are longer than wide, do no harm: what one level does not know of the next is within
single cells. Below the coarsest mesh is a level of aggregates (see `aggregation`) where that has more than
MOST_FACTORISED unknowns.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from types import TracebackType

import fsi.meshes.backend  # noqa: F401

import numpy as np
import scipy  # its modules load when they are used
from dolfinx import fem
from petsc4py import PETSc

from fsi.meshes.build import FunctionSpace
from fsi.stokes.discretisation.constraints import DofLayout, Prolongation, dof_layout, rigid_modes
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.images import tied
from fsi.stokes.discretisation.nodes import locate
from fsi.stokes.pair_laws import PairLaws
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solvers.aggregation import aggregated
from fsi.stokes.solvers.components import COMPONENTS, projected
from fsi.stokes.solvers.reduced import add_to_modes
from fsi.stokes.solvers.transfers import transfer

MIDDLE = 1.5
MOST_FACTORISED = 20_000


@dataclass(frozen=True, slots=True)
class Levels(AbstractContextManager["Levels"]):
    """The hierarchy; z of each level has its free nodal values and, last on rank 0, all modes.

    Attributes:
        matrices: MIDDLE L on each level, the finest first, between modes with what laws below a gap resist
            and with their inertia; ones on the diagonal for modes that are held. Each is T^T A T of the one
            before, but a product of matrices takes longer than to add up its cells, on several ranks many
            times as long.
        transfers: from each level to the next finer one, the finest first.
    """

    matrices: list[PETSc.Mat]
    transfers: list[PETSc.Mat]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for used in (*self.matrices, *self.transfers):
            used.destroy()


def levels(problem: StokesProblem, forms: Forms) -> Levels:
    """The levels of a mesh, with zero velocity on walls with a given one; collective."""
    held, space = problem.motion.held.ravel(), forms.V
    layout, P = _constrained(problem, space)
    matrices, transfers = [_approximate(problem, forms.gradients(space, forms.degree), P, layout)], []
    for degree in range(forms.degree - 1, 0, -1):
        coarser = fem.functionspace(forms.mesh, ("Lagrange", degree, (COMPONENTS,)))
        P.matrix.destroy()
        layout_of_coarser, P = _constrained(problem, coarser)
        transfers.append(transfer(space, layout, coarser, P, held))
        space, layout = coarser, layout_of_coarser
        matrices.append(_approximate(problem, forms.gradients(space, degree), P, layout))
    P.matrix.destroy()
    if matrices[-1].size[0] > MOST_FACTORISED:
        transfers.append(aggregated(matrices[-1], layout.modes_here))
        matrices.append(matrices[-1].ptap(transfers[-1]))
    return Levels(matrices, transfers)


def _approximate(
    problem: StokesProblem, gradients: PETSc.Mat, P: Prolongation, layout: DofLayout
) -> PETSc.Mat:
    """The matrix of a level from that of gradients of one component, which is destroyed; collective."""
    gradients.scale(MIDDLE)
    matrix = projected(gradients, P)
    first_mode = matrix.getOwnershipRange()[1] - layout.modes
    if problem.laws is not None and len(problem.laws.own):
        resisted = _resisted(problem, problem.laws)
        rows = first_mode + np.arange(layout.modes_here)
        add_to_modes(matrix, rows, resisted[: layout.modes_here, : layout.modes_here])
    if problem.inertia is not None:
        for row, D in enumerate(problem.inertia.D.ravel()[: layout.modes_here], first_mode):
            matrix.setValue(row, row, D, PETSc.InsertMode.ADD_VALUES)
        matrix.assemble()
    rows = first_mode + np.flatnonzero(problem.motion.held.ravel())[: layout.modes_here]
    matrix.zeroRowsColumns(rows.astype(PETSc.IntType), diag=1.0)
    return matrix


def _resisted(problem: StokesProblem, laws: PairLaws) -> scipy.sparse.csr_array:
    """The positive part of K between free modes: what laws take away of the mesh is not in L."""
    K, held = laws.K, problem.motion.held.ravel()
    which = np.flatnonzero((laws.G != 0.0).any(axis=0) & ~held)
    size = problem.q.arms.ravel()[which]
    values, vectors = np.linalg.eigh(K[which][:, which].toarray() / np.outer(size, size))
    vectors = vectors * size[:, None]
    positive = scipy.sparse.coo_array((vectors * np.maximum(values, 0.0)) @ vectors.T)
    return scipy.sparse.csr_array(
        (positive.data, (which[positive.coords[0]], which[positive.coords[1]])), shape=K.shape
    )


def _constrained(problem: StokesProblem, space: FunctionSpace) -> tuple[DofLayout, Prolongation]:
    """The rows of velocities of a degree, and their P with all modes."""
    fluid, q = problem.fluid, problem.q
    nodes = locate(fluid, space)
    layout = dof_layout(fluid, nodes, problem.boundary.velocities, 0, None)
    layout = tied(layout, fluid, [(space, nodes.with_ghosts)])
    rigid = rigid_modes(layout, nodes, q, fluid.lattice)
    P = Prolongation(layout, rigid, np.ones(layout.modes, dtype=bool))
    rigid.matrix.destroy()
    return layout, P
