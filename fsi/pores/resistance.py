"""The resistance matrix of all bodies in the model of pores, by one factorisation of K.

With walls at rest and all other numbers free, the load of mode i at a unit motion of mode j is

    R = K_bb - K_bf K_ff^-1 K_fb,

b the velocities of bodies, f all numbers that are free, and the multipliers of narrow necks. At given
velocities the dissipation U^T R U is an upper bound.
"""

from dataclasses import dataclass
from time import process_time

import numpy as np
import scipy.sparse as sp

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.checks.determined import require_still
from fsi.errors import RefusedError, SolveError, apart
from fsi.observables import resistance as matrix
from fsi.observables.bars import DrivenBodies, rounding_of
from fsi.observables.resistance import Resistance, ResistanceErrors
from fsi.pores.adapt import finer
from fsi.pores.bars import bar_factor, reference_modes
from fsi.pores.fineness import Fineness
from fsi.pores.model import make_system
from fsi.pores.orders import RIGID
from fsi.pores.system import PoreSystem
from fsi.pores.tied import factors_of


@dataclass(frozen=True, slots=True)
class PoreResistance:
    """R of a case with its estimated errors.

    Attributes:
        case: with the modes that were used.
        resistance: the matrix.
        errors: of its entries.
    """

    case: Case
    resistance: Resistance
    errors: ResistanceErrors


def resistance_with_error(case: Case) -> PoreResistance:
    """R with its estimated errors; modes are added until its tolerance is reached.

    Raises InputError: bodies alone determine no flow; SolveError: no pores, or the tolerance is not reached.
    """
    modes: int | None = case.pores.modes
    rounding = rounding_of(DrivenBodies(case, case.configuration(), 0.0, case.motion(0.0)))
    while modes is not None:
        chosen, other = with_modes(case, modes), with_modes(case, reference_modes(modes))
        found = case_resistance(chosen)
        errors = matrix.estimated_errors(found, [(bar_factor(modes), case_resistance(other))], rounding)
        if case.tolerance is None or errors.largest <= case.tolerance:
            return PoreResistance(chosen, found, errors)
        modes = finer(modes)
    raise _missed(case, errors.largest)


def _missed(case: Case, error: float) -> SolveError:
    """The error of a tolerance that is not reached with the most modes."""
    tolerance = case.pores.tolerance or 0.0
    return SolveError(
        f"pores.tolerance = {tolerance!r}: with the most modes the estimated error is "
        f'{apart(error, tolerance)}; raise it, or give model = "resolved"'
    )


def with_modes(case: Case, modes: int) -> Case:
    """The case with so many modes."""
    return case.model_copy(update={"pores": case.pores.model_copy(update={"modes": modes})})


def case_resistance(case: Case) -> Resistance:
    """R of the bodies of a case at time 0, between its walls at rest.

    Along a periodic channel the mean pressure gradient is zero. Raises as `resistance_with_error`, and
    RefusedError where rounding spoils R in narrow gaps.
    """
    require_still(case)
    began, q = process_time(), case.configuration()
    bodies = DrivenBodies(case, q, 0.0, case.motion(0.0))
    system = make_system(bodies, Fineness.even(case.pores.modes))
    assembled = process_time()
    columns, residual = _schur_complement(system)
    seconds = {"assemble": assembled - began, "solve": process_time() - assembled}
    labels = matrix.all_modes(case.names, q.radii, system.viscosity, 2)
    remedy = 'widen the narrowest gaps, or try model = "resolved"'
    try:
        R, asymmetry = matrix.symmetrised(columns, labels.scale)
        remedy = "widen the narrowest gaps"  # what R cannot hold it cannot hold of elements either
        eigenvalues = matrix.positive_eigenvalues(R, labels.scale, resting=True)
    except RefusedError as error:
        raise RefusedError(f'model = "pores": {error}; {remedy}') from None
    checks = {"residual": residual, "reciprocity": asymmetry}
    size = (system.unknowns, len(system.pores))
    mobility = matrix.inverse(R)
    return Resistance(labels, R, mobility, eigenvalues, checks, *size, seconds, kind="pores")


def _schur_complement(system: PoreSystem) -> tuple[Array, float]:
    """R as computed, (3 N, 3 N), and the largest relative residual of its columns."""
    K, B = system.viscosity * system.assembly.K, system.assembly.ties
    first = system.assembly.numbering.surface
    discs, surfaces = system.pores.surfaces.discs, len(system.pores.surfaces)
    free = np.ones(system.size, dtype=bool)
    body = (first[: system.bodies, None] + np.arange(3)).ravel()
    walls = first[discs:surfaces, None] + np.arange(RIGID)
    free[body] = free[system.strains] = free[walls.ravel()] = False
    if len(walls) == 2:
        free[walls[1, 3]] = True  # the flux through a channel is a result
    f = np.flatnonzero(np.append(free, np.ones(B.shape[0], dtype=bool)))
    tied = sp.csr_matrix(sp.block_array([[K, B.T], [B, None]])) if B.shape[0] else K
    of_bodies, inner = tied[f][:, body].toarray(), tied[f][:, f]
    factors = factors_of(system.viscosity * system.assembly.lower, free, np.zeros(system.size), B)
    X = factors.solve(of_bodies)
    X += factors.solve(of_bodies - inner @ X)
    R = K[body][:, body].toarray() - of_bodies.T @ X
    return R, factors.residual(of_bodies - inner @ X, of_bodies)
