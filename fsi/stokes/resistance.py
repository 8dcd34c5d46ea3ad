"""Resistance problem: the loads of every unit motion of rigid bodies, by one factorisation.

All modes are held and the walls rest, so that x_j = P y_j + rigid e_j for the motion of mode j alone, and

    P^T M P y_j = - P^T M rigid e_j,    R e_j = rigid^T lambda_j,    lambda_j = M x_j

with one matrix P^T M P for all modes (see `system`).
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import batched

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Motion
from fsi.case.case import Case
from fsi.case.checks.determined import require_still
from fsi.errors import InputError, RefusedError
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.container import Container
from fsi.observables import resistance as matrix
from fsi.observables.bars import DrivenBodies, rounding_of
from fsi.observables.resistance import Modes, Resistance, ResistanceErrors
from fsi.stokes.adapt import Refinement, refine
from fsi.stokes.comparisons import comparisons
from fsi.stokes.identities import identities, require
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.problem import Boundary, SolverOptions, StokesProblem
from fsi.stokes.refusal import explained
from fsi.stokes.solve import DEFAULT, Clock, assembled
from fsi.stokes.solvers.elimination import factorised
from fsi.stokes.solvers.gmres import SHARPER
from fsi.stokes.solvers.system import NodalSolution, StokesSystem
from fsi.stokes.units import Units
from fsi.stokes.walls import surfaces_of

AXIAL_MODE = 1
# Right-hand sides solved at once: more are hardly faster, and each takes as much memory as the unknowns.
BLOCK = 32

type Mesher = Callable[[Configuration], FluidMesh]


@dataclass(frozen=True, slots=True)
class SolvedResistance(Refinement):
    """R of a case with its accuracy: the error is the largest of `errors`."""

    resistance: Resistance
    errors: ResistanceErrors


def resistance_with_error(case: Case) -> SolvedResistance:
    """R of a case with its estimated error, refined to its tolerance if it has one. Raises as `refine`."""
    tolerance = case.discretisation.tolerance
    return _solved(case) if tolerance is None else refine(case, _solved, tolerance)


def _solved(case: Case) -> SolvedResistance:
    """R of other elements or meshes differs by its error, as forces do (see `comparisons`)."""
    still, others = _between_resting_walls(case), list[tuple[float, Resistance]]()
    computed, meshes = case_resistance(case), CaseMeshes(still)
    for comparison in comparisons(still):
        mesh = partial(meshes.compared_mesh, comparison)
        others.append((comparison.factor, _resistance(case, meshes.units, mesh, comparison.degree)))
    q = case.configuration()
    bodies = DrivenBodies(case, q, 0.0, case.motion(0.0), meshes.rounded(q, 0.0))
    errors = matrix.estimated_errors(computed, others, rounding_of(bodies))
    return SolvedResistance(case, errors.largest, computed.dofs, computed, errors)


def case_resistance(case: Case) -> Resistance:
    """R of the bodies of a case at time 0, between its walls at rest; open walls are open without pressure.

    Along a periodic channel the mean pressure gradient is zero. Raises InputError: the domain has no walls,
    or a given net flux. MeshError, SolveError: as `StokesModel`.
    """
    meshes = CaseMeshes(_between_resting_walls(case))
    return _resistance(case, meshes.units, meshes.scaled_mesh, case.discretisation.degree)


def _between_resting_walls(case: Case) -> Case:
    """The case whose walls do not move, so that no data jump where they meet."""
    given = case.domain.walls.items()
    walls = {name: wall.resting(case.dimension) for name, wall in given}
    return case.model_copy(update={"domain": case.domain.model_copy(update={"walls": walls})})


def _resistance(case: Case, units: Units, mesh: Mesher, degree: int) -> Resistance:
    """With elements of this degree on a mesh in these units."""
    container, q, clock = case.container(), case.configuration(), Clock()
    require_still(case)
    if case.lubrication.below is not None:
        raise InputError(
            f"lubrication.below = {case.lubrication.below!r}: a resistance matrix is that of resolved gaps; "
            "drop it"
        )
    fluid = mesh(q)
    clock.lap("mesh")
    problem = held_at_rest(fluid, container, q, case.fluid.viscosity, case.wall_pressure())
    boundary = replace(problem.boundary, slip_lengths=case.wall_slip())
    problem = replace(problem, boundary=boundary, surfaces=surfaces_of(case).still)
    options = SolverOptions(degree, solver=case.discretisation.solver)
    with explained(problem, case.names):
        found = solve_resistance(units.scaled(problem), case.names, options, clock)
    return units.user_resistance(found, _modes_of(problem, case.names))


def held_at_rest(
    fluid: FluidMesh, container: Container, q: Configuration, viscosity: float = 1.0,
    open_walls: Collection[str] = (),
) -> StokesProblem:  # fmt: skip
    """The problem of bodies that are held at rest; open walls have no traction, all others are at rest."""
    rest = np.zeros_like(q.arms)
    walls = {wall: np.zeros_like for wall in container.walls if wall not in open_walls}
    boundary = Boundary(walls, dict.fromkeys(open_walls, 0.0))
    motion = Motion(np.ones(rest.shape, dtype=bool), rest, rest)
    return StokesProblem(fluid, container, q, motion, boundary, viscosity)


def solve_resistance(
    problem: StokesProblem, names: Sequence[str], options: SolverOptions = DEFAULT, clock: Clock | None = None
) -> Resistance:
    """R of the bodies of a problem; collective.

    The bodies are held at rest, and the formulation is the eliminated one; names are for the labels. What an
    iteration misses is solved again, to SHARPER. Raises SolveError: singular system, large residual, or an
    identity violated.
    """
    clock, fluid, modes = clock or Clock(), problem.fluid, _modes_of(problem, names)
    with assembled(problem, options, clock) as system:
        try:
            R, checks = _symmetric(system, modes, clock)
        except RefusedError:
            if system.mass is None:  # no iteration is to blame
                raise
            R, checks = _symmetric(replace(system, tolerance=SHARPER), modes, clock)
        dofs = system.forms.dofs
    resting = bool(problem.boundary.velocities)
    eigenvalues = matrix.positive_eigenvalues(R, modes.scale, resting=resting)
    mobility = matrix.inverse(R) if resting else None
    size = (dofs, fluid.cells())
    return Resistance(modes, R, mobility, eigenvalues, checks, *size, clock.seconds, fluid.instead)


def _symmetric(system: StokesSystem, modes: Modes, clock: Clock) -> tuple[Array, dict[str, float]]:
    """R (n, n) of an assembled system, and the worst defects of its columns. Raises RefusedError."""
    shape, columns, worst = system.problem.q.arms.shape, list[Array](), dict[str, float]()
    units = np.eye(system.problem.q.arms.size)
    if system.problem.container.axisymmetric:
        units = units[AXIAL_MODE :: shape[1]]
    with factorised(system) as responses:
        clock.lap("factorise")
        for block in batched(units, BLOCK):
            for nodal in responses([_moving(system, U) for U in np.reshape(block, (-1, *shape))]):
                clock.lap("solve")
                defects = _defects(system, nodal)
                worst = {name: max(defect, worst.get(name, 0.0)) for name, defect in defects.items()}
                columns.append(units @ nodal.load.ravel())
                clock.lap("checks")
    require(worst)
    R, asymmetry = matrix.symmetrised(np.column_stack(columns), modes.scale)
    return R, worst | {"reciprocity": asymmetry}


def _moving(system: StokesSystem, U: Array) -> StokesSystem:
    """The system with other velocities (N, M) of the bodies, all held."""
    problem = system.problem
    return replace(system, problem=replace(problem, motion=replace(problem.motion, U=U)))


def _modes_of(problem: StokesProblem, names: Sequence[str]) -> Modes:
    radii, viscosity = problem.q.radii, problem.viscosity
    if problem.container.axisymmetric:
        return matrix.axial_modes(names, radii, viscosity)
    return matrix.all_modes(names, radii, viscosity, problem.q.dimension)


def _defects(system: StokesSystem, nodal: NodalSolution) -> dict[str, float]:
    """What one unit motion violates of the identities, but for the balance of free modes: there are none."""
    system.forms.fill(nodal.x)
    defects = identities(system, nodal, nodal.load, system.cells.dissipation())
    del defects["balance"]
    return defects
