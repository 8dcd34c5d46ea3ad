"""The resistance matrix of all bodies in the model of pores, by one factorisation of K.

With walls at rest and all other numbers free, the load of mode i at a unit motion of mode j is

    R = K_bb - K_bf K_ff^-1 K_fb,

b the velocities of bodies, f all numbers that are free. At given velocities the dissipation U^T R U is an
upper bound.
"""

from dataclasses import dataclass, replace
from time import process_time
from typing import NamedTuple

import numpy as np

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.checks.determined import require_still
from fsi.observables import resistance as matrix
from fsi.observables.bars import DrivenBodies
from fsi.observables.resistance import Resistance, ResistanceErrors
from fsi.pores.accuracy import missed, with_modes
from fsi.pores.adapt import finer
from fsi.pores.bars import bar_factor, reference_modes
from fsi.pores.definite import Cholesky
from fsi.pores.fineness import Fineness
from fsi.pores.model import make_system
from fsi.pores.orders import RIGID
from fsi.pores.solve import EPSILON
from fsi.pores.system import PoreSystem


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
    while modes is not None:
        chosen, other = with_modes(case, modes), with_modes(case, reference_modes(modes))
        found = case_resistance(chosen)
        errors = matrix.estimated_errors(found, [(bar_factor(modes), case_resistance(other))])
        if case.tolerance is None or errors.largest <= case.tolerance:
            return PoreResistance(chosen, found, errors)
        modes = finer(modes)
    raise missed(case, errors.largest)


def case_resistance(case: Case) -> Resistance:
    """R of the bodies of a case at time 0, between its walls at rest. Raises as `resistance_with_error`.

    Along a periodic channel the mean pressure gradient is zero.
    """
    require_still(case)
    began, q = process_time(), case.configuration()
    bodies = DrivenBodies(case, q, 0.0, case.motion(0.0))
    system = make_system(bodies, Fineness.even(case.pores.modes))
    assembled = process_time()
    columns, checked = _schur_complement(system)
    seconds = {"assemble": assembled - began, "solve": process_time() - assembled}
    labels = matrix.all_modes(case.names, q.radii, system.viscosity, 2)
    R, asymmetry = matrix.symmetrised(columns, labels.scale)
    eigenvalues = matrix.positive_eigenvalues(R, labels.scale, resting=True)
    checks = {"residual": checked.residual, "reciprocity": asymmetry}
    size = (system.unknowns, len(system.pores))
    mobility = matrix.inverse(R)
    found = Resistance(labels, R, mobility, eigenvalues, checks, *size, seconds, pieces="pores")
    return replace(found, rounding=checked.rounding)


class Checked(NamedTuple):
    """The largest relative residual of columns, and what rounding may leave of diagonal entries, (3 N,)."""

    residual: float
    rounding: Array


def _schur_complement(system: PoreSystem) -> tuple[Array, Checked]:
    """R as computed, (3 N, 3 N), and how well."""
    K, first = system.viscosity * system.assembly.K, system.assembly.numbering.surface
    discs, surfaces = system.pores.surfaces.discs, len(system.pores.surfaces)
    free = np.ones(system.size, dtype=bool)
    body = (first[: system.bodies, None] + np.arange(3)).ravel()
    walls = first[discs:surfaces, None] + np.arange(RIGID)
    free[body] = free[system.strains] = free[walls.ravel()] = False
    if len(walls) == 2:
        free[walls[1, 3]] = True  # the flux through a channel is a result
    f = np.flatnonzero(free)
    B = K[f][:, body].toarray()
    factors, inner = Cholesky(system.viscosity * system.assembly.lower, free), K[f][:, f]
    X = factors.solve(B)
    X += factors.solve(B - inner @ X)
    R = K[body][:, body].toarray() - B.T @ X
    x = np.zeros((system.size, len(body)))
    x[f], x[body] = np.abs(X), np.eye(len(body))
    terms = np.einsum("nj,nj->j", x, abs(K) @ x)
    with np.errstate(divide="ignore"):  # where all digits have cancelled
        rounding = EPSILON * terms / np.diag(R)
    return R, Checked(factors.residual(B - inner @ X, B), rounding)
