"""The discrete Stokes system of a problem, and its nodal solution: loads, forces of walls, friction, laws.

    M x = b + lambda,      x = (u, p)

with the nodal reaction lambda as in `fsi.stokes.solvers.elimination`, which solves it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import scipy  # its modules load when they are used
from dolfinx import fem, la
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array
from fsi.stokes.discretisation.cells import StokesCells
from fsi.stokes.discretisation.constraints import DofLayout, RigidModes
from fsi.stokes.discretisation.forms import Form, Forms
from fsi.stokes.discretisation.nodes import BoundaryNodes
from fsi.stokes.discretisation.slip import SlidingFacets
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solvers.extended import multiply, multiply_transpose
from fsi.stokes.solvers.gmres import TOLERANCE
from fsi.stokes.solvers.mumps import REFINE_ABOVE
from fsi.stokes.solvers.workspace import Workspace


@dataclass(frozen=True, slots=True)
class StokesSystem:
    """The discrete system of a problem.

    Attributes:
        problem: what it is of.
        forms: bound to the mesh.
        nodes: the velocity nodes on bodies and walls.
        layout: how the rows of x = (u, p) are shared out.
        cells: the Stokes matrices of all cells; the workspace's.
        rigid: rigid modes at the nodes on bodies.
        b: loads, this rank's rows.
        g: given velocities of walls and of what moves along bodies, this rank's rows.
        weights: int q over the fluid for each of this rank's rows of p.
        mass: M / (2 mu) for the iterative solver, None for the direct one.
        workspace: whose cells these are, and that keeps the factors.
        facets: along which fluid slides, None where it sticks everywhere.
        tolerance: of residuals of the iterative solver.
        refine_above: residuals of the direct solver above that are refined.
    """

    problem: StokesProblem
    forms: Forms
    nodes: BoundaryNodes
    layout: DofLayout
    cells: StokesCells
    rigid: RigidModes
    b: Array
    g: Array
    weights: Array
    mass: PETSc.Mat | None
    workspace: Workspace
    facets: SlidingFacets | None = None
    tolerance: float = TOLERANCE
    refine_above: float = REFINE_ABOVE

    @property
    def unknown_modes(self) -> NDArray[np.bool_]:
        """The modes that stand in y, (M N,)."""
        held = self.problem.motion.held.ravel()
        return ~held if self.mass is None else np.ones_like(held)

    @property
    def modes_here(self) -> int:
        """How many modes stand in this rank's part of y: all on rank 0, where they come last."""
        return int(self.unknown_modes.sum()) if self.layout.comm.rank == 0 else 0


@dataclass(frozen=True, slots=True)
class NodalSolution:
    """What the linear system gives.

    Attributes:
        x: values of (u, p), this rank's rows.
        reaction: lambda, this rank's rows; not on those of masters, being minus that of their slaves.
        load: (F, T) = rigid^T lambda, (N, M), on all ranks.
        U: velocities of the bodies, (N, M), on all ranks.
        residual: relative residual of the linear system.
        iterations: most of them, 0 by the direct solver.
        pressure_gradient: G of a periodic flow, (d,).
        flux: of fluid and bodies along a channel whose dp/dx is given, else None.
        wall_speeds: along x, of the walls that a stress moves.
        shear_rate: of a cell that a stress shears, else None.
        law_forces: of the laws of the problem, (R,).
    """

    x: Array
    reaction: Array
    load: Array
    U: Array
    residual: float
    iterations: int = 0
    pressure_gradient: Array | None = None
    flux: float | None = None
    wall_speeds: Mapping[str, float] = field(default_factory=dict)
    shear_rate: float | None = None
    law_forces: Array = field(default_factory=lambda: np.empty(0))


type Solver = Callable[..., list[NodalSolution]]  # of systems (see `fsi.stokes.solvers.elimination`)


def nodal_vector(form: Form) -> Array:
    """A linear form on the velocity space, summed over ranks; this rank's rows of u."""
    vector = fem.assemble_vector(form)
    vector.scatter_reverse(la.InsertMode.add)
    return np.asarray(vector.array[: vector.index_map.size_local * vector.block_size].copy())


def load_of(system: StokesSystem, nodal: Array) -> Array:
    """(F, T) = rigid^T lambda of a nodal reaction, (N, M), on all ranks."""
    load = system.layout.comm.bcast(multiply_transpose(system.rigid.matrix, nodal))
    return np.asarray(load, dtype=float).reshape(-1, system.layout.modes_of_each)


def body_velocity(system: StokesSystem, U: Array) -> Array:
    """Nodal values rigid U on this rank's rows, for modes (N, M) known on all ranks."""
    return multiply(system.rigid.matrix, U.ravel() if system.layout.comm.rank == 0 else np.empty(0))


def wall_force(system: StokesSystem, reaction: Array, wall: str) -> Array:
    """The force of a channel's wall on the fluid along it, of a nodal reaction, (d - 1,); collective."""
    layout = system.layout
    of_nodes = reaction[: layout.velocities].reshape(-1, layout.dimension)[system.nodes.wall_nodes[wall], :-1]
    return np.asarray(layout.comm.allreduce(of_nodes.sum(axis=0)))


def slip_of(system: StokesSystem, nodal: NodalSolution) -> Array:
    """s = u - w of the rows of x that have one, zero elsewhere; collective."""
    rows, slip = system.layout.slip, np.zeros(system.layout.rows)
    slip[rows] = (nodal.x - body_velocity(system, nodal.U) - system.g)[rows]
    return slip


def friction_power(system: StokesSystem, nodal: NodalSolution) -> float:
    """(mu / b) int |s|^2 over all surfaces; collective."""
    if system.facets is None:
        return 0.0
    _, of_rank = system.facets.forces(slip_of(system, nodal))
    return float(system.layout.comm.allreduce(of_rank))


def law_loads(system: StokesSystem, nodal: NodalSolution) -> Array:
    """What laws below a gap add to the loads of the bodies, (N, M)."""
    laws = system.problem.laws
    return np.zeros_like(nodal.U) if laws is None else laws.loads(nodal.law_forces, nodal.U.shape)


def law_dissipation(system: StokesSystem, nodal: NodalSolution) -> float:
    """What they dissipate."""
    laws = system.problem.laws
    return 0.0 if laws is None else laws.dissipation(nodal.law_forces, nodal.U)


def mode_equations(system: StokesSystem) -> tuple[Array, Array]:
    """D and F + D U0 of all modes, (M N,), of the balance `rigid^T lambda + D U = F + D U0`; 0 if held."""
    free = ~system.problem.motion.held.ravel()
    load = system.problem.motion.F.ravel() * free
    inertia = system.problem.inertia
    if inertia is None:
        return np.zeros(len(load)), load
    D = inertia.D.ravel() * free
    return D, load + D * inertia.U0.ravel()


def law_equations(system: StokesSystem) -> tuple[scipy.sparse.csr_array | None, Array]:
    """K of all modes, (M N, M N), None without laws, and the load that it has from what is given, (M N,)."""
    laws, motion = system.problem.laws, system.problem.motion
    if laws is None or not len(laws.own):
        return None, np.zeros(motion.U.size)
    return laws.K, -laws.G.T @ (laws.in_matrix * laws.rates(np.where(motion.held, motion.U, 0.0)))
