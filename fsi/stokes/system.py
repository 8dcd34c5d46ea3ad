"""The discrete Stokes system around rigid bodies, and its solution by elimination.

Without constraints, for nodal values x = (u, p), the rows of u read

    M x = b + lambda      M = [A B^T; B 0],   b = loads (f, v) and <t, v> on open walls,

where lambda, the nodal reaction, is zero inside and unknown on bodies and walls. With x = P y + g
(see `constraints`), rigid^T lambda = (F, T) for every free mode closes the system:

    P^T M P y = P^T (b - M g) + (F, T)

and lambda comes back as M x - b. This is EXACTLY the saddle-point system of `saddle`, with its
multiplier and the rigid boundary values eliminated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from dolfinx import fem, la
from dolfinx.fem.petsc import assemble_matrix
from petsc4py import PETSc

from fsi.bodies import Array, Inertia, Motion
from fsi.stokes.constraints import Layout, prolongation
from fsi.stokes.forms import Forms
from fsi.stokes.linear import Factorisation
from meshes.aliases import Form


@dataclass(frozen=True, slots=True)
class System:
    """Everything that a solve needs on one mesh at one instant.

    M: Stokes matrix of all unknowns; rigid: rigid modes at the nodes on bodies, (rows, M N); b: loads,
    g: given wall velocities, arrays over this rank's rows; motion, inertia: what drives the bodies.
    """

    shares: Layout
    M: PETSc.Mat
    rigid: PETSc.Mat
    b: Array
    g: Array
    motion: Motion
    inertia: Inertia | None


@dataclass(frozen=True, slots=True)
class NodalSolution:
    """What the linear system gives.

    x: values of (u, p), and reaction: lambda, arrays over this rank's rows; U: (N, M) on all ranks;
    residual: relative residual of the linear system.
    """

    x: Array
    reaction: Array
    U: Array
    residual: float


def stokes_matrix(forms: Forms) -> PETSc.Mat:
    """M = [A B^T; B 0] over all nodes, in the order of `Layout`."""
    blocks = [[forms.bind("a"), forms.bind("b^T")], [forms.bind("b"), forms.bind("zero")]]
    M = assemble_matrix(blocks, kind="aij")
    M.assemble()
    return M


def nodal_vector(form: Form) -> Array:
    """A linear form on the velocity space, summed over ranks; this rank's rows of u."""
    vector = fem.assemble_vector(form)
    vector.scatter_reverse(la.InsertMode.add)
    owned: Array = vector.array[: vector.index_map.size_local * vector.block_size].copy()
    return owned


def multiply(matrix: PETSc.Mat, values: Array) -> Array:
    """This rank's rows of a matrix times a vector given by this rank's values."""
    x, y = matrix.createVecs()
    x.array[:] = values
    matrix.mult(x, y)
    return _taken(y, x)


def multiply_transpose(matrix: PETSc.Mat, values: Array) -> Array:
    """This rank's rows of a transposed matrix times a vector given by this rank's values."""
    x, y = matrix.createVecs()
    y.array[:] = values
    matrix.multTranspose(y, x)
    return _taken(x, y)


def _taken(vector: PETSc.Vec, used: PETSc.Vec) -> Array:
    """The values of a vector; both are destroyed."""
    values: Array = vector.array.copy()
    vector.destroy()
    used.destroy()
    return values


def load_of(system: System, nodal: Array) -> Array:
    """(F, T) = rigid^T lambda of a nodal reaction, (N, M), on all ranks."""
    load: Array = system.shares.comm.bcast(multiply_transpose(system.rigid, nodal))
    return load.reshape(-1, system.shares.modes_of_each)


def body_velocity(system: System, U: Array) -> Array:
    """Nodal values rigid U on this rank's rows, for modes (N, M) known on all ranks."""
    return multiply(system.rigid, U.ravel() if system.shares.comm.rank == 0 else np.empty(0))


def mode_equations(system: System) -> tuple[Array, Array]:
    """D and F + D U0 of the free modes, from their balance `rigid^T lambda + D U = F + D U0`."""
    free = ~system.motion.held.ravel()
    load = system.motion.F.ravel()[free]
    if system.inertia is None:
        return np.zeros(len(load)), load
    D = system.inertia.D.ravel()[free]
    return D, load + D * system.inertia.U0.ravel()[free]


def solve_eliminated(system: System) -> NodalSolution:
    """Solve for y, then x = P y + g and lambda = M x - b.

    Raises:
        SolveError: the system is singular, or its residual is not small.
    """
    with factorised(system) as responses:
        return next(responses(system.motion.U[None]))


@contextmanager
def factorised(system: System) -> Iterator[Callable[[Array], Iterator[NodalSolution]]]:
    """Factorise P^T M P once: gives the solutions for any velocities (k, N, M) of the held modes; collective.

    Raises:
        SolveError: the system is singular, or the residual of a solution is not small.
    """
    P = prolongation(system.shares, system.rigid, system.motion.held)
    reduced = system.M.ptap(P)
    own = _own_modes(system)
    D, _ = mode_equations(system)
    _add_to_diagonal(reduced, reduced.getLocalSize()[0] - own, D[:own])
    try:
        with Factorisation(reduced) as factors:
            yield lambda U: _respond(system, P, factors, U)
    finally:
        P.destroy()
        reduced.destroy()


def _respond(system: System, P: PETSc.Mat, factors: Factorisation, held_U: Array) -> Iterator[NodalSolution]:
    """The solutions with velocities held_U (k, N, M) of the held modes, zero on the free ones."""
    free, own = ~system.motion.held, _own_modes(system)
    g = [system.g + body_velocity(system, U) for U in held_U]
    rhs = np.column_stack([multiply_transpose(P, system.b - multiply(system.M, offset)) for offset in g])
    first_mode = len(rhs) - own
    rhs[first_mode:] += mode_equations(system)[1][:own, None]
    solutions, residuals = factors.solve(rhs)
    for U, offset, y, residual in zip(held_U, g, solutions.T, residuals, strict=True):
        x = multiply(P, y) + offset
        moved = U.copy()
        moved[free] = system.shares.comm.bcast(y[first_mode:])
        yield NodalSolution(x, multiply(system.M, x) - system.b, moved, float(residual))


def _own_modes(system: System) -> int:
    """Free modes among this rank's unknowns y: all on rank 0, where they come last."""
    return int((~system.motion.held).sum()) if system.shares.comm.rank == 0 else 0


def _add_to_diagonal(matrix: PETSc.Mat, first: int, values: Array) -> None:
    """Add to this rank's rows from `first` on."""
    start, _ = matrix.getOwnershipRange()
    for k, value in enumerate(values):
        row = start + first + k
        matrix.setValue(row, row, value, PETSc.InsertMode.ADD_VALUES)
    matrix.assemble()
