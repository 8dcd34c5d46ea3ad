"""The iterative solver of large systems in space: FGMRES with a block preconditioner.

With the velocities u and the modes of the bodies together in the first block, the reduced system is

    [ A  B^T ] [ u ]   [ f ]
    [ B   0  ] [ p ] = [ 0 ]

and its preconditioner (Elman, Silvester and Wathen, Finite Elements and Fast Iterative Solvers, section 9.2)

    [ A'  B^T ]                 A' approximates A,  S' = mass matrix of the pressure / 2 mu
    [ 0   -S' ]

S' is spectrally equivalent to the Schur complement B A^-1 B^T whatever the mesh size: beside the mass
matrix / mu that has eigenvalues s from the square of the inf-sup constant to 1 for gradients of u in place
of its strain rates, and s / (1 + s) for these, whose energy has the square of div u besides. A' is one cycle
of two
levels: smoothing on the finite elements themselves, and a correction by velocities of degree 1 that are rigid
on the bodies, a tenth of the unknowns and less. So the number of iterations does not grow with the mesh, nor
in narrow gaps, where cells are longer than wide: what the coarse space does not know is within single cells,
and there smoothing is fast. The coarse matrix of up to MOST_FACTORISED unknowns is factorised; beyond, it
gets one cycle of smoothed aggregation, which is told the rigid motions of everything.

Every velocity of degree 1 on the same mesh is one of degree k: its nodal values there are I times its values
at the vertices. With the constraints of degree 1 (zero on the walls, rigid on the bodies) these are P_1 z,
where z are the values at free vertices and the modes of the bodies. The columns of I P_1 so carry the coarse
space into the fine one.
"""

from contextlib import AbstractContextManager
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from dolfinx.fem.petsc import interpolation_matrix
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

import fsi.parallel as parallel
from fsi.bodies.configuration import Array, rigid_motion
from fsi.errors import SolveError, apart
from fsi.stokes.discretisation.constraints import Prolongation, dof_layout, rigid_modes
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.images import tied
from fsi.stokes.discretisation.nodes import locate
from fsi.stokes.problem import StokesProblem


@dataclass(frozen=True, slots=True)
class Coarse:
    """I P_1, (rows of u, free values z and, last on rank 0, all modes), and rigid motions in z, (rows, 6)."""

    nodal: PETSc.Mat
    rigid: Array


def coarse_velocities(problem: StokesProblem, forms: Forms) -> Coarse:
    """The coarse space of a mesh, with zero velocity on walls with a given one; collective."""
    fluid, q = problem.fluid, problem.q
    vertices = fem.functionspace(fluid.mesh, ("Lagrange", 1, (fluid.dimension,)))
    nodes = locate(fluid, vertices)
    layout = dof_layout(fluid, nodes, problem.boundary.velocities, 0, None)
    layout = tied(layout, fluid, [(vertices, nodes.with_ghosts)])
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

    free: which rows of u are its unknowns, this rank's. held: modes that move nothing but themselves, (M N,).
    """
    nodal = coarse.nodal
    indptr, column, value = nodal.getValuesCSR()
    first_mode = nodal.getOwnershipRangesColumn()[1] - len(held)
    value[np.isin(column, first_mode + np.flatnonzero(held))] = 0.0
    T = sp.csr_matrix((value, column, indptr), shape=(len(free), nodal.size[1]))[free]
    if nodal.comm.rank == 0:
        modes = sp.eye_array(len(held), nodal.size[1], k=first_mode, format="csr")
        T = sp.vstack([T, modes], "csr")
    size = ((T.shape[0], None), (nodal.getLocalSize()[1], None))
    csr = (T.indptr.astype(PETSc.IntType), T.indices.astype(PETSc.IntType), T.data)
    return PETSc.Mat().createAIJ(size=size, csr=csr, comm=nodal.comm)


# Of the residual relative to the right-hand side: errors of forces, and of identities, whose bound is 1e-8,
# are up to a few times as large (2e-10 of the force on a sphere beside a plane).
TOLERANCE = 1e-10
MOST_ITERATIONS = 600
RESTART = 150
COMPONENTS = 3

MOST_FACTORISED = 120_000
COARSE = "fieldsplit_u_mg_coarse_pc_"
FACTORS = {f"{COARSE}type": "cholesky", f"{COARSE}factor_mat_solver_type": "mumps"}
MULTIGRID = {f"{COARSE}type": "gamg"}
OPTIONS = {
    "fieldsplit_u_ksp_type": "preonly",
    "fieldsplit_u_pc_type": "mg",
    "fieldsplit_u_mg_levels_pc_type": "bjacobi",
    "fieldsplit_u_mg_levels_sub_pc_type": "icc",
    "fieldsplit_u_mg_levels_ksp_type": "chebyshev",
    "fieldsplit_u_mg_levels_ksp_max_it": 3,
    "fieldsplit_p_ksp_type": "chebyshev",
    "fieldsplit_p_ksp_max_it": 4,
    "fieldsplit_p_pc_type": "jacobi",
}


@dataclass(frozen=True, slots=True)
class SchurBlocks:
    """What the preconditioner knows of a reduced system.

    Attributes:
        u: this rank's rows of velocities and modes, global numbers, three to a node.
        p: its rows of pressures.
        transfer: from the coarse space to the rows u.
        rigid: the rigid motions of everything in the coarse space, this rank's rows, (rows, 6).
        mass: -S'.
        closed: whether a constant pressure changes nothing.
    """

    u: NDArray[np.int64]
    p: NDArray[np.int64]
    transfer: PETSc.Mat
    rigid: Array
    mass: PETSc.Mat
    closed: bool


class Iteration(AbstractContextManager["Iteration"]):
    """FGMRES on a symmetric indefinite matrix of that form; use it in a `with` statement."""

    def __init__(self, matrix: PETSc.Mat, blocks: SchurBlocks) -> None:
        self.matrix, self.iterations = matrix, 0
        self._closed = blocks.closed
        self._constant = matrix.createVecRight()
        self._constant.array[blocks.p - matrix.getOwnershipRange()[0]] = 1.0
        self._constant.normalize()
        if blocks.closed:
            null_space = PETSc.NullSpace().create(vectors=[self._constant], comm=matrix.comm)
            matrix.setNullSpace(null_space)
            null_space.destroy()
        self._ksp = _solver(matrix, blocks)

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        parallel.settle(error)
        self._ksp.destroy()
        self._constant.destroy()

    def solve(self, b: Array) -> tuple[Array, Array]:
        """Solutions of `M x = b` for all columns of b, one after the other; collective.

        b, x: this rank's rows, (rows, k); with x the relative residuals |b - M x| / |b|, (k,), on all ranks.
        Raises SolveError: the iteration stagnates.
        """
        solutions, residuals = zip(*(self._solve_one(column) for column in b.T), strict=True)
        return np.column_stack(solutions), np.array(residuals)

    def _solve_one(self, b: Array) -> tuple[Array, float]:
        x, right = self.matrix.createVecs()
        right.array[:] = b
        if self._closed:
            right.axpy(-right.dot(self._constant), self._constant)
        self._ksp.solve(right, x)
        self.iterations = max(self.iterations, self._ksp.getIterationNumber())
        size = right.norm()
        residual = right.duplicate()
        self.matrix.mult(x, residual)
        residual.axpy(-1.0, right)
        relative = float(residual.norm() / size) if size > 0.0 else 0.0
        if self._ksp.getConvergedReason() <= 0 or not relative <= 2.0 * TOLERANCE:
            raise SolveError(
                f"the iterative solver stagnates: relative residual {apart(relative, TOLERANCE)} after "
                f"{self._ksp.getIterationNumber()} iterations (bound {TOLERANCE:g}); "
                'set discretisation.solver = "direct", or change discretisation.cells_per_gap'
            )
        values: Array = x.array.copy()
        for used in (x, right, residual):
            used.destroy()
        return values, relative


def _solver(matrix: PETSc.Mat, blocks: SchurBlocks) -> PETSc.KSP:
    ksp, prefix = PETSc.KSP().create(matrix.comm), "fsi_stokes_"
    ksp.setOptionsPrefix(prefix)
    ksp.setOperators(matrix)
    ksp.setType(PETSc.KSP.Type.FGMRES)
    ksp.setGMRESRestart(RESTART)
    ksp.setTolerances(rtol=TOLERANCE, max_it=MOST_ITERATIONS)
    pc = ksp.getPC()
    pc.setType(PETSc.PC.Type.FIELDSPLIT)
    numbers = (rows.astype(PETSc.IntType) for rows in (blocks.u, blocks.p))
    u, p = (PETSc.IS().createGeneral(rows, matrix.comm) for rows in numbers)
    u.setBlockSize(COMPONENTS)
    pc.setFieldSplitIS(("u", u), ("p", p))
    pc.setFieldSplitType(PETSc.PC.CompositeType.SCHUR)
    pc.setFieldSplitSchurFactType(PETSc.PC.SchurFactType.UPPER)
    pc.setFieldSplitSchurPreType(PETSc.PC.SchurPreType.USER, blocks.mass)
    options = PETSc.Options(prefix)
    chosen = OPTIONS | (MULTIGRID if blocks.transfer.size[1] > MOST_FACTORISED else FACTORS)
    for name, value in chosen.items():
        options[name] = value
    ksp.setFromOptions()
    pc.setUp()
    of_u, of_p = pc.getFieldSplitSubKSP()
    A = of_u.getOperators()[0]
    A.setOption(PETSc.Mat.Option.SPD, True)
    _two_levels(of_u.getPC(), A, blocks)
    of_p.setOperators(blocks.mass, blocks.mass)
    ksp.setUp()
    of_u.setUp()
    for name in chosen:
        options.delValue(name)
    for used in (u, p, pc):
        used.destroy()
    return ksp


def _two_levels(pc: PETSc.PC, A: PETSc.Mat, blocks: SchurBlocks) -> None:
    """One cycle of A smoothed and corrected on the coarse space, whose matrix is T^T A T."""
    pc.setMGLevels(2)
    pc.setMGInterpolation(1, blocks.transfer)
    coarse = A.ptap(blocks.transfer)
    coarse.setBlockSize(COMPONENTS)
    coarse.setOption(PETSc.Mat.Option.SPD, True)
    _tell_rigid_motions(coarse, blocks.rigid)
    pc.getMGCoarseSolve().setOperators(coarse)
    pc.setFromOptions()
    coarse.destroy()
    blocks.transfer.destroy()


def _tell_rigid_motions(A: PETSc.Mat, rigid: Array) -> None:
    """Give the multigrid its near null space: an orthonormal basis of the rigid motions."""
    gram = np.ascontiguousarray(rigid.T @ rigid)
    A.comm.tompi4py().Allreduce(MPI.IN_PLACE, gram)
    orthonormal = np.linalg.solve(np.linalg.cholesky(gram), rigid.T)
    vectors = []
    for values in orthonormal:
        vector = A.createVecRight()
        vector.array[:] = values
        vectors.append(vector)
    null_space = PETSc.NullSpace().create(vectors=vectors, comm=A.comm)
    A.setNearNullSpace(null_space)
    for used in (*vectors, null_space):
        used.destroy()
