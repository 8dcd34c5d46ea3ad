"""Resistance problem: the loads of every unit motion of rigid bodies, by one factorisation.

All modes are held and the walls rest, so that x_j = P y_j + rigid e_j for the motion of mode j alone, and

    P^T M P y_j = - P^T M rigid e_j,    R e_j = rigid^T lambda_j,    lambda_j = M x_j

with one matrix P^T M P for all modes (see `system`).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import batched

import numpy as np
from mpi4py import MPI

from fsi.bodies.configuration import Array, Configuration, Motion
from fsi.case.case import Case
from fsi.case.domains.box import ChannelDomain
from fsi.case.domains.cell import CellDomain
from fsi.errors import InputError
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.containers import Container
from fsi.observables.resistance import (
    Resistance,
    all_modes,
    axial_modes,
    difference,
    inverse,
    positive_eigenvalues,
    symmetrised,
)
from fsi.stokes.adapt import refine
from fsi.stokes.clock import Clock
from fsi.stokes.discretisation.boundary import Boundary, BoundaryNodes
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.error import other_degree_of
from fsi.stokes.evaluate import fill
from fsi.stokes.identities import identities, require
from fsi.stokes.model import StokesModel
from fsi.stokes.solve import assembled
from fsi.stokes.solvers.elimination import NodalSolution, System, factorised, load_of, multiply

AXIAL_MODE = 1
# Right-hand sides solved at once: more are hardly faster, and each takes as much memory as the unknowns.
BLOCK = 32


@dataclass(frozen=True, slots=True)
class SolvedResistance:
    """A case with the sizes that were used, its R, and the estimated error: `difference` of R."""

    case: Case
    resistance: Resistance
    error: float

    @property
    def dofs(self) -> int:
        """Number of unknowns."""
        return self.resistance.dofs


def resistance_with_error(case: Case) -> SolvedResistance:
    """R of a case with its estimated error, refined to the tolerance of the case if it has one.

    Raises:
        InputError, MeshError, SolveError: as `case_resistance`; or the tolerance is not reached.
    """
    tolerance = case.discretisation.tolerance
    return _solved(case) if tolerance is None else refine(case, _solved, tolerance)


def _solved(case: Case) -> SolvedResistance:
    """With elements of another degree R differs by its error, as forces do (see `error`)."""
    found, given = case_resistance(case), case.discretisation
    degree, factor = other_degree_of(given.degree, case.dimension)
    changed = given.model_copy(update={"degree": degree})
    other = case_resistance(case.model_copy(update={"discretisation": changed}))
    return SolvedResistance(case, found, factor * difference(found.R, other.R, found.modes.scale))


def case_resistance(case: Case) -> Resistance:
    """R of the bodies of a case at time 0, between its walls at rest; open walls are open without pressure.

    Along a periodic channel the mean pressure gradient is zero.

    Raises:
        InputError: the domain has no walls, or a given net flux.
        MeshError: no valid mesh can be made.
        SolveError: a solve fails, or violates an identity.
    """
    _require_still(case)
    clock = Clock()
    q = case.configuration()
    fluid = StokesModel(case).mesh(q)
    clock.lap("mesh")
    return solve_resistance(
        fluid,
        case.container(),
        q,
        case.names,
        open_walls=case.wall_pressure(),
        viscosity=case.fluid.viscosity,
        degree=case.discretisation.degree,
        solver=case.discretisation.solver,
        clock=clock,
    )


def _require_still(case: Case) -> None:
    """F = R U alone: no mean flow, and no mean pressure gradient that would be a result too."""
    if isinstance(case.domain, CellDomain):
        raise InputError(
            'domain.shape = "cell": without walls bodies alone do not determine the flow, so it has no '
            'resistance matrix; give a box with periodic = ["x"]'
        )
    if isinstance(case.domain, ChannelDomain) and case.domain.net_flux is not None:
        raise InputError(
            f"domain.net_flux = {case.domain.net_flux!r}: a resistance matrix is that at a mean pressure "
            "gradient of zero; drop it"
        )


def solve_resistance(
    fluid: FluidMesh,
    container: Container,
    q: Configuration,
    names: Sequence[str],
    *,
    open_walls: Collection[str] = (),
    viscosity: float = 1.0,
    degree: int = 3,
    solver: str = "automatic",
    clock: Clock | None = None,
) -> Resistance:
    """R of the bodies at q; collective.

    Args:
        fluid: mesh of the fluid around the bodies at q.
        container: what encloses the fluid.
        q: the bodies.
        names: of the bodies, for the labels.
        open_walls: walls without traction; all others are at rest.
        viscosity: mu.
        degree: of the velocity, at least the order of the mesh.
        solver: "direct", "iterative" (in space), or "automatic" by size.
        clock: takes the CPU seconds by phase; may have some already.

    Raises:
        SolveError: singular system, large residual, or an identity violated.
    """
    clock = clock or Clock()
    rest = np.zeros_like(q.arms)
    all_held = Motion(np.ones(rest.shape, dtype=bool), rest, rest)
    walls = {wall: np.zeros_like for wall in container.walls if wall not in open_walls}
    boundary = Boundary(walls, dict.fromkeys(open_walls, 0.0))
    units = np.eye(rest.size)
    modes = all_modes(names, q.radii, viscosity, q.dimension)
    if fluid.axisymmetric:
        units, modes = units[AXIAL_MODE :: rest.shape[1]], axial_modes(names, q.radii, viscosity)
    columns, worst, periodic = [], dict[str, float](), fluid.lattice.dimension > 0
    given = assembled(fluid, container, q, all_held, boundary, viscosity, degree, None, clock, solver)
    with given as (system, forms, nodes), factorised(system) as responses:
        clock.lap("factorise")
        for block in batched(units, BLOCK):
            for nodal in responses(np.reshape(block, (-1, *rest.shape))):
                clock.lap("solve")
                F = load_of(system, nodal.reaction)
                defects = _defects(system, forms, nodes, nodal, F, viscosity, q, periodic)
                worst = {name: max(defect, worst.get(name, 0.0)) for name, defect in defects.items()}
                columns.append(units @ F.ravel())
                clock.lap("checks")
        dofs = forms.dofs
    require(worst)
    R, asymmetry = symmetrised(np.column_stack(columns), modes.scale)
    eigenvalues = positive_eigenvalues(R, modes.scale, resting=bool(walls))
    mobility = inverse(R) if walls else None
    checks = worst | {"reciprocity": asymmetry}
    return Resistance(modes, R, mobility, eigenvalues, checks, dofs, fluid.cells(), clock.seconds)


def _defects(
    system: System, forms: Forms, nodes: BoundaryNodes, nodal: NodalSolution, F: Array, viscosity: float,
    q: Configuration, periodic: bool,
) -> dict[str, float]:  # fmt: skip
    """What one unit motion violates of the identities, but for the balance of free modes: there are none."""
    fill(forms, nodal.x)
    dissipation = _dissipation(system, nodal.x)
    defects = identities(system, forms, nodal, F, dissipation, viscosity, q, nodes.x, periodic)
    del defects["balance"]
    return defects


def _dissipation(system: System, x: Array) -> float:
    """u^T A u, which is int 2 mu e : e, from the matrix at hand."""
    u = x.copy()
    u[system.shares.velocities :] = 0.0
    return float(system.shares.comm.allreduce(u @ multiply(system.M, u), op=MPI.SUM))
