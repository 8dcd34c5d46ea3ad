"""The grand resistance matrix R of rigid bodies, F = R U, its inverse, and what it must satisfy.

U stacks the velocities (V_x, V_y, omega) of every body, F their loads (F_x, F_y, T); with an axis V_z and F_z
alone, in space all six. F are the EXTERNAL loads that the motion needs in fluid between resting walls; the
fluid exerts -F. R is symmetric (Lorentz reciprocity), and positive unless everything can move rigidly at no
cost.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array
from fsi.bodies.configuration import LOADS, MODES, arms
from fsi.errors import RefusedError, apart

BOUND = 1e-9
# What the factorisation leaves of an entry over sqrt(R_ii R_jj), of the inverse likewise.
FACTORISATION = 1e-11
# Errors of entries, velocities or loads may cancel, in the estimate by chance more than in truth: it is known
# to this part of the largest.
KNOWN_TO = 0.03
# What is left of an entry over sqrt(R_ii R_jj) as it is summed, if all else is exact.
LAST_DIGIT = 2.0 * float(np.finfo(float).eps)
# Of an eigenvalue of unit diagonal below this part of the largest no digit is known.
ROUNDING = 1e-14


@dataclass(frozen=True, slots=True)
class Modes:
    """The modes of all bodies, in the order of rows and columns.

    Attributes:
        velocities: labels of the columns, "disc.V_x".
        loads: labels of the rows, "disc.F_x".
        scale: s with R_ij / (s_i s_j) dimensionless, sqrt(mu) for a translation in the plane, a sqrt(mu) for
            a rotation, both times sqrt(a) for spheres, (n,).
    """

    velocities: tuple[str, ...]
    loads: tuple[str, ...]
    scale: Array


@dataclass(frozen=True, slots=True)
class Resistance:
    """A resistance matrix, whose arrays are read-only, and how it was computed.

    Attributes:
        modes: of its rows and columns.
        R: symmetric, (n, n).
        mobility: its inverse, U = mobility F, None where no wall is at rest and R is singular.
        eigenvalues: of R made dimensionless, increasing, (n,).
        checks: worst relative defects of all columns; `reciprocity` is the asymmetry of R as computed.
        dofs: unknowns (u, p).
        pieces: how many the fluid is cut into.
        seconds: CPU seconds of this process by phase.
        mesh_instead: the size that was taken as those of the case gave no valid mesh, "" where they did.
        kind: what these are called.
    """

    modes: Modes
    R: Array
    mobility: Array | None
    eigenvalues: Array
    checks: dict[str, float]
    dofs: int
    pieces: int
    seconds: dict[str, float]
    mesh_instead: str = ""
    kind: str = "cells"

    def __post_init__(self) -> None:
        """Let nobody write to R, of which the mobility would no longer be the inverse."""
        for values in (self.R, self.mobility, self.eigenvalues):
            if values is not None:
                values.flags.writeable = False


@dataclass(frozen=True, slots=True)
class ResistanceErrors:
    """Estimated errors of a resistance matrix.

    Attributes:
        R: of each entry, absolute, (n, n).
        mobility: likewise, None where there is none.
        largest: of R, as `difference`.
    """

    R: Array
    mobility: Array | None
    largest: float


def all_modes(names: Sequence[str], radii: Array, viscosity: float, dimension: int) -> Modes:
    """All M modes of every body."""
    scale = np.sqrt(viscosity) * arms(radii, dimension)
    if dimension == 3:
        scale *= np.sqrt(radii)[:, None]
    return Modes(_labels(names, MODES[dimension]), _labels(names, LOADS[dimension]), scale.ravel())


def axial_modes(names: Sequence[str], radii: Array, viscosity: float) -> Modes:
    """V_z of every body on an axis."""
    return Modes(_labels(names, ("V_z",)), _labels(names, ("F_z",)), np.sqrt(viscosity * radii))


def _labels(names: Sequence[str], parts: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{name}.{part}" for name in names for part in parts)


def symmetrised(columns: Array, scale: Array) -> tuple[Array, float]:
    """The symmetric part of the columns (n, n), and their asymmetry. Raises SolveError: it exceeds 1e-9."""
    asymmetry = difference(columns, columns.T, scale)
    if not asymmetry <= BOUND:
        defect = f"relative asymmetry {apart(asymmetry, BOUND)}, bound {BOUND:g}"
        raise RefusedError(f"the resistance matrix violates reciprocity: {defect}")
    return 0.5 * (columns + columns.T), asymmetry


def positive_eigenvalues(R: Array, scale: Array, *, resting: bool) -> Array:
    """The eigenvalues of R made dimensionless, increasing, shape (n,).

    Signs are looked at with a unit diagonal (Sylvester's law of inertia): modes may differ by 1e16.

    resting: whether a wall is at rest. If not, rigid motions of everything cost nothing, and their
    eigenvalues are zero but for rounding. Raises SolveError: one is negative, or zero to rounding although a
    wall is at rest. That of bodies in touch which move as one is some (gap / a)^3/2.
    """
    size = np.sqrt(np.maximum(np.diag(R), scale**2))
    of_unit_diagonal = np.linalg.eigvalsh(R / np.outer(size, size))
    bound = ROUNDING if resting else -BOUND
    if not of_unit_diagonal[0] > bound * max(1.0, of_unit_diagonal[-1]):
        least, most = f"{of_unit_diagonal[0]:.2g}", f"{of_unit_diagonal[-1]:.2g}"
        what = f"with a unit diagonal it has the eigenvalue {least}, the largest is {most}"
        raise RefusedError(f"the resistance matrix is not positive to rounding: {what}")
    if not resting:
        return np.asarray(np.linalg.eigvalsh(R / np.outer(scale, scale)))
    # One-sided Jacobi on the factor keeps the digits of small ones, in a corner 1e-16 of the largest.
    singular, *_, work, _, _ = scipy.linalg.lapack.dgejsv(
        np.linalg.cholesky(R / np.outer(scale, scale)), jobu=3, jobv=3
    )
    eigenvalues: Array = np.sort((singular * (work[0] / work[1])) ** 2)
    return eigenvalues


def inverse(R: Array) -> Array:
    """The mobility matrix: inverse of a symmetric positive matrix, symmetric itself.

    Cholesky's factors bear rows of any size, so that units and small gaps cost no digits.
    """
    mobility: Array = scipy.linalg.cho_solve(scipy.linalg.cho_factor(R), np.eye(len(R)))
    return 0.5 * (mobility + mobility.T)


def difference(R: Array, other: Array, scale: Array) -> float:
    """Largest |R_ij - other_ij| / sqrt(R_ii R_jj), which |R_ij| itself never exceeds.

    A diagonal entry counts at least s_i^2, so that bodies which nothing resists compare as well.
    """
    size = np.sqrt(np.maximum(np.diag(R), scale**2))
    return float(np.max(np.abs(R - other) / np.outer(size, size)))


def estimated_errors(
    found: Resistance, others: Sequence[tuple[float, Resistance]], rounding: float
) -> ResistanceErrors:
    """The sum of factors times the differences from others, at least what rounding and chance leave.

    rounding: the part of a result that rounding of gaps makes (see `fsi.observables.bars.rounding_of`).

    R and its error are positive matrices, so that |E_ij| <= sqrt(E_ii E_jj), of the mobility likewise: that
    is the scale of what cancels in E_ij. The mobility M is known to |M| |dR| |M| at best, dR what rounding
    leaves of R: of two bodies that nearly touch they move as one by the difference of large entries.
    """

    def bound(A: Array, compared: Sequence[tuple[float, Array]]) -> Array:
        error, size = sum((factor * np.abs(A - B) for factor, B in compared), 0.0 * A), np.sqrt(np.diag(A))
        cancelling = np.sqrt(np.diag(error))
        least = known * np.outer(size, size) + KNOWN_TO * np.outer(cancelling, cancelling)
        return np.asarray(np.maximum(error, least))

    known = max(rounding, FACTORISATION, found.checks.get("reciprocity", 0.0))  # the last of R as computed
    of_mobility = None
    inverses = [(factor, other.mobility) for factor, other in others if other.mobility is not None]
    if found.mobility is not None and len(inverses) == len(others):
        reach = np.abs(found.mobility) @ np.sqrt(np.diag(found.R))
        of_mobility = np.maximum(bound(found.mobility, inverses), LAST_DIGIT * np.outer(reach, reach))
    largest = sum(factor * difference(found.R, other.R, found.modes.scale) for factor, other in others)
    return ResistanceErrors(bound(found.R, [(f, other.R) for f, other in others]), of_mobility, largest)
