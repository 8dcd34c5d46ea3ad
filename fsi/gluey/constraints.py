"""The rows of one step's projection: gaps, the viscous slip of films, Coulomb's friction at solid contact.

Normal impulses p satisfy p >= 0 (any sign where the gap is held closed). A film resists slip by the impulse
`p_t = -h k slip` with `k = c |gamma| / a`, in the dual a row with compliance 1/(h k). Coulomb's impulse obeys
`|p_t| <= mu_f p_solid` and takes the slip away as far as it can: with p_solid given this is a projection,
too, and p_solid is found by repeating it (the fixed point of Tresca's friction: J. Haslinger, Math. Methods
Appl. Sci. 5 (1983) 422).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.errors import SolveError
from fsi.gluey.augmented_lagrangian import Impulses, Program
from fsi.gluey.contacts import Contacts, gap_rows, slip_rows
from fsi.gluey.qp_solver import ContactResponse, project
from fsi.gluey.system import System

# Of the largest impulse: how far friction may miss the bound that its own solid impulse sets.
BOUND, TRIES = 1e-9, 500


@dataclass(frozen=True, slots=True)
class Rows:
    """The constraints of one step, normal rows first, then those of films, then those of friction.

    Attributes:
        J: shape (rows, N modes).
        b: `b + J u` is the rate that p keeps >= 0, (rows,).
        compliance: (rows,).
        p: where to begin, (rows,).
        least: smallest normal impulse, -inf where the gap stays closed, (C,).
        friction: true with rows of friction, of all contacts.
        first: the first of them.
        of_wall: rows between a body and a wall, (rows,).
    """

    J: sp.csr_matrix
    b: Array
    compliance: Array
    p: Array
    least: Array
    friction: bool
    first: int
    of_wall: NDArray[np.bool_]

    @property
    def rubbing(self) -> NDArray[np.bool_]:
        """The contacts whose slip some mode moves, (C,): friction does nothing at others, and is 0 there."""
        moving = np.asarray(abs(self.J[self.first :]).sum(axis=1)) > 0.0
        across = len(moving) // max(len(self.least), 1)
        moved: NDArray[np.bool_] = moving.reshape(len(self.least), across).any(axis=1)
        return moved


def make_rows(system: System, contacts: Contacts, gamma: Array, h: float) -> Rows:
    """The rows for contacts with the memories gamma, shape (C,), and a step h."""
    law, across, modes = system.law, system.dimension - 1, system.mass.shape[1]
    shift = law.shift(gamma)
    films = np.flatnonzero(gamma < 0.0) if law.tangential > 0.0 else np.empty(0, dtype=np.intp)
    blocks = [gap_rows(contacts, *system.mass.shape)]
    if len(films):
        blocks.append(slip_rows(contacts[films], system.radii, modes))
    if law.friction > 0.0:
        blocks.append(slip_rows(contacts, system.radii, modes))
    J = sp.csr_matrix(sp.vstack(blocks))
    C, first = len(contacts), len(contacts) + across * len(films)
    b, p, compliance = np.zeros((3, J.shape[0]))
    b[:C] = contacts.D / h
    p[:C] = -shift  # what a contact that lasts without a load will find
    k = law.tangential * -gamma[films] * _curvature(contacts[films], system.radii)
    compliance[C:first] = np.repeat(1.0 / (h * k), across)
    least = np.where(gamma < shift, -np.inf, 0.0)  # a memory that no shift takes holds the gap closed
    at_wall = contacts.i >= len(system.radii)
    rubs = law.friction > 0.0
    sides = [at_wall, np.repeat(at_wall[films], across), np.repeat(at_wall, across if rubs else 0)]
    return Rows(J, b, compliance, p, least, rubs, first, np.concatenate(sides))


def _curvature(contacts: Contacts, radii: Array) -> Array:
    """`1/a_i + 1/a_j`, a wall being flat."""
    inverse = np.append(1.0 / radii, 0.0)
    curvature: Array = inverse[np.minimum(contacts.i, len(radii))] + inverse[contacts.j]
    return curvature


def solve_rows(rows: Rows, program: Program, tolerance: float, bound: Callable[[Array], Array]) -> Impulses:
    """The impulses and the velocity after them; tolerance: of the residual, a velocity.

    `bound` gives the largest friction of each contact, (C,), by the normal impulses, (C,). Raises SolveError:
    friction does not settle.
    """
    C = len(rows.least)
    p, iterations, steps = rows.p, 0, 0
    moved = rows.rubbing if rows.friction else np.zeros(0)
    limits = bound(p[:C]) * moved if rows.friction else np.zeros(0)
    for _ in range(TRIES):
        response = ContactResponse(rows.least, limits, rows.first, rows.compliance)
        solved = project(program, p, response, tolerance)
        p, iterations, steps = solved.p, iterations + solved.iterations, steps + solved.steps
        new = bound(p[:C]) * moved if rows.friction else limits
        if np.abs(new - limits).max(initial=0.0) <= BOUND * np.abs(p).max(initial=0.0):
            return replace(solved, iterations=iterations, steps=steps)
        limits = new
    raise SolveError(f"friction does not settle in {TRIES} tries; lower time.step or gluey.friction")
