"""One step of many gluey bodies: a predictor shifted by the memory, and a projection.

    1.  u* = u^n + M^-1 (h Phi + sum gamma_ij^n G_ij)
    2.  u^{n+1} = argmin 1/2 |u - u*|_M^2   with   D^n + h G.u >= 0,   impulses p >= 0
    3.  gamma^{n+1} = max(-p, gamma_min),   q^{n+1} = q^n + h u^{n+1}

D is convex in q between discs or spheres, so that a gap is never less than its linearisation: no overlap. The
cone variant takes u* without memory, asks for D^n + h G.u = 0 where gamma < 0, and
`gamma^{n+1} = min(max(gamma^n - p, gamma_min), 0)`: a step that releases a contact may pull by more than was
stored, by at most its load h Phi, but in an impulse by O(1) for any h, as where what is held turns at once;
with p >= gamma^n it would be 1. to 3. Where gamma = gamma_min the contact is solid: `p +
gamma_min` is its impulse, which bounds Coulomb's friction.

The film variant has a viscosity eps > 0: 2. is `min 1/2 |u - u*|_M^2 + (1/h) sum eps Psi(D^n + h G.u)`
instead, a film in each gap below delta0 (`fsi.gluey.film`), whose gaps stay positive.

Source: A. Lefebvre, Numerical simulation of gluey particles, M2AN 43 (2009) 53; B. Maury & A. Lefebvre,
Direct simulation of dense suspensions (slides, 2008).
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.gaps import OVERLAP
from fsi.case.gluey import ContactLaw
from fsi.errors import SolveError
from fsi.gluey.augmented_lagrangian import Impulses, Program, minimise
from fsi.gluey.constraints import Rows, make_rows, solve_rows
from fsi.gluey.contacts import Contacts, find_contacts, gap_rows
from fsi.gluey.film import Film
from fsi.gluey.held import is_given, why_no_room
from fsi.gluey.passing import require_met, require_seen
from fsi.gluey.system import GlueyState, System

# Of the largest velocity: the residual at which the projection stops, and the one that a step may leave.
TOLERANCE, ACCEPTED = 5e-9, 1e-8
# Residuals are measured by the largest velocity there is, before or after the step, but at least by this
# part of |u*|, which memories would make if contacts let go. In a pile at rest there is no other: impulses
# cancel to the rounding of u*, and the certificate, 1e-8 of that, asks for them to 1e-12 of their size, 1e4
# times above rounding. Where anything moves faster the memories do not count.
AT_REST = 1e-4
# Of the smallest radius: how deep an overlap the projection aims at; a step may leave OVERLAP.
DEPTH = 0.8 * OVERLAP
# Of the smallest radius: gaps between neighbours.
NEIGHBOURS = 0.1
# Of the momentum that there is and that is exchanged: what rounding may leave.
MOMENTUM = 1e-12


@dataclass(frozen=True, slots=True)
class Touching:
    """What a step found at its contacts, all of shape (C,).

    contacts: with normals and gaps at its beginning; p: impulses; gamma: at its end; solid: the part of the
    impulse that solid contact carried.
    """

    contacts: Contacts
    p: Array
    gamma: Array
    solid: Array


@dataclass(frozen=True, slots=True)
class Checks:
    """How good a step is.

    kkt: residual of the optimality conditions over the largest velocity; momentum: what M (u^{n+1} - u^n)
    misses of load and walls, over what was exchanged; overlap: the deepest over the smallest radius, 0
    without; iterations: of the projection's gradient; newton: steps of Newton's method.
    """

    kkt: float
    momentum: float
    overlap: float
    iterations: int
    newton: int


@dataclass(frozen=True, slots=True)
class _Found:
    """A projection.

    contacts, rows, impulses; gamma: memories at the beginning, (C,); program: what the impulses solve; speed:
    what the residual is measured by.
    """

    contacts: Contacts
    gamma: Array
    rows: Rows
    program: Program
    impulses: Impulses
    speed: float


def advance(system: System, state: GlueyState, t: float, h: float) -> tuple[GlueyState, Touching, Checks]:
    """The state after a step from t to t + h, what touched on the way, and how good it is.

    Raises SolveError: friction does not settle, or a check fails, as the projection has not converged, or as
    what is held leaves no room, or as bodies push each other that never meet.
    """
    load = system.load(state.centres, t, t + h)
    free = state.U + load / system.mass
    if system.held is not None:
        free = np.where(system.held.modes, system.held.velocity(t, t + h), free)
    found = _project_far_enough(system, state, free, h)
    contacts, rows, u = found.contacts, found.rows, found.impulses.u
    p, U = found.impulses.p[: len(contacts)], u.reshape(load.shape)
    gamma = _memory(system.law, found.gamma, p)
    if system.law.variant == "shifted":
        # what is left of p at an open gap is within the tolerance, and no memory
        rate = (rows.b + rows.J @ u)[: len(p)]
        gamma[rate > p * (rows.J.multiply(rows.J) @ (1.0 / system.mass.ravel()))[: len(p)]] = 0.0
    new = state.moved(U, h, contacts.key, gamma)
    checks = Checks(
        found.impulses.kkt / max(_speed(system, U), found.speed, np.finfo(float).tiny),
        _momentum_defect(system, state.U, U, load, found),
        _overlap(system, new),
        found.impulses.iterations,
        found.impulses.steps,
    )
    if (failure := _failure(checks, t + h)) is not None:
        raise SolveError(why_no_room(system, new, found.program, len(contacts), t + h) or failure)
    require_seen(system, U, h, t + h)
    require_met(system, contacts, p, U, h, t + h)
    film = system.film(h)
    if film is not None:  # a gap that its places lose to rounding is positive
        contacts = replace(contacts, D=np.where(found.gamma < 0.0, film.gap(found.gamma), contacts.D))
    return new, Touching(contacts, p, gamma, _solid(system.law, found.gamma, p)), checks


def _project_far_enough(system: System, state: GlueyState, free: Array, h: float) -> _Found:
    """The projection with all pairs for rows that can meet.

    Pairs are looked for as far as bodies travel; of them, those are rows that have met before or that free
    motion could bring together, and those that turn out to meet when the others are solved for.
    """
    smallest = float(system.radii.min())
    reach = max(2.0 * h * _speed(system, free), 1e-6 * smallest)
    known = np.empty(0, dtype=np.int64)
    while True:
        pairs = find_contacts(state.centres, system.radii, system.room, reach + system.law.delta0)
        pairs = pairs[np.flatnonzero(~is_given(system, pairs))]
        near = _approach(system, pairs, free, h) >= pairs.D
        near |= (state.remembered(pairs.key) < 0.0) | np.isin(pairs.key, known)
        found = _project(system, state, pairs[np.flatnonzero(near)], free, h)
        far, u = pairs[np.flatnonzero(~near)], found.impulses.u
        meet = far.D + h * (gap_rows(far, *system.mass.shape) @ u) < system.law.delta0
        needed = 2.0 * h * _speed(system, u.reshape(free.shape))
        if needed <= reach and not meet.any():
            return found
        known = np.concatenate([known, far.key[meet]])
        if needed > reach:  # something has been thrown faster than anything moved before: look further
            reach = 2.0 * needed


def _approach(system: System, pairs: Contacts, free: Array, h: float) -> Array:
    """Gaps below which a pair may close or come into a film, (C,).

    Those that twice its free motion crosses, and twice that of neighbours, as they push it.
    """
    v = np.vstack([free[:, : system.dimension], np.zeros((1, system.dimension))])
    apart = np.linalg.norm(v[pairs.j] - v[np.minimum(pairs.i, len(free))], axis=1)
    smallest = float(system.radii.min())
    of_neighbours = apart[pairs.D / smallest <= NEIGHBOURS]
    pushed = np.sqrt(np.square(of_neighbours).mean()) if len(of_neighbours) else 0.0
    found: Array = system.law.delta0 + 1e-6 * smallest + 2.0 * h * (apart + pushed)
    return found


def _project(system: System, state: GlueyState, contacts: Contacts, free: Array, h: float) -> _Found:
    """The projection with these contacts for rows."""
    inverse_mass, film = (1.0 / system.mass).ravel(), system.film(h)
    gamma = state.remembered(contacts.key)
    if film is not None:
        contacts, gamma = _in_films(film, contacts, gamma)
    rows = make_rows(system, contacts, gamma, h)
    if system.held is not None:
        rows = _past_held(rows, system.held.modes, free, system.dimension)
    u_star = free.ravel() + inverse_mass * (rows.J.T @ _shift(system, gamma, rows))
    speed = max(AT_REST * _speed(system, u_star.reshape(free.shape)), _speed(system, free))
    tolerance = min(TOLERANCE * speed, DEPTH * float(system.radii.min()) / h)
    program = Program(rows.J, rows.b, system.mass.ravel(), u_star)
    if film is None:
        mu_f = system.law.friction  # Coulomb's bound mu_f p_solid of each contact
        impulses = solve_rows(rows, program, tolerance, lambda p: mu_f * _solid(system.law, gamma, p))
    else:
        impulses = minimise(program, rows.p, film, tolerance)
    return _Found(contacts, gamma, rows, program, impulses, speed)


def _past_held(rows: Rows, held: NDArray[np.bool_], free: Array, d: int) -> Rows:
    """The rows for the free modes: what is held moves as prescribed, and takes up impulses like a wall."""
    prescribed = held.ravel()
    b = rows.b + rows.J @ np.where(prescribed, free.ravel(), 0.0)
    centres = held & (np.arange(held.shape[1]) < d)
    touches = abs(rows.J) @ centres.ravel().astype(float) > 0.0
    J = sp.csr_matrix(rows.J @ sp.diags((~prescribed).astype(float)))
    return replace(rows, J=J, b=b, of_wall=rows.of_wall | touches)


def _in_films(film: Film, contacts: Contacts, gamma: Array) -> tuple[Contacts, Array]:
    """Gaps and memories that agree: gamma tells the gap where it is known, as a gap loses digits.

    But an overlap that the tolerance of earlier steps has left counts as such, and this one undoes it: else
    they would add up.
    """
    known = gamma < 0.0
    D = np.where(known & (contacts.D >= 0.0), film.gap(gamma), contacts.D)
    return replace(contacts, D=D), np.where(known, gamma, film.gamma(np.where(known, film.delta0, D)))


def _speed(system: System, U: Array) -> float:
    """The largest velocity of a centre."""
    return float(np.sqrt(np.square(U[:, : system.dimension]).sum(axis=1).max(initial=0.0)))


def _shift(system: System, gamma: Array, rows: Rows) -> Array:
    """The memory as impulses of all rows: that of the predictor."""
    shift = np.zeros(rows.J.shape[0])
    shift[: len(gamma)] = system.law.shift(gamma)
    return shift


def _stored(law: ContactLaw, gamma: Array, p: Array) -> Array:
    """What p leaves of the memory, without bounds: the predictor has taken the shift, p the rest."""
    return gamma - law.shift(gamma) - p


def _memory(law: ContactLaw, gamma: Array, p: Array) -> Array:
    """gamma^{n+1}."""
    return np.maximum(np.minimum(_stored(law, gamma, p), 0.0), law.gamma_min)


def _solid(law: ContactLaw, gamma: Array, p: Array) -> Array:
    """The impulse of solid contact: what p stores beyond gamma_min."""
    return np.maximum(law.gamma_min - _stored(law, gamma, p), 0.0)


def _momentum_defect(system: System, U: Array, U_new: Array, load: Array, found: _Found) -> float:
    """`sum M (u^{n+1} - u^n) - load - impulses of the walls` over the sizes of u^n, load and impulses."""
    d, shape, rows = system.dimension, system.mass.shape, found.rows
    p, shift = found.impulses.p, _shift(system, found.gamma, rows)
    of_walls = rows.J[rows.of_wall].T @ (p + shift)[rows.of_wall]
    defect = system.mass * (U_new - U) - load - of_walls.reshape(shape)
    if system.held is not None:
        defect[system.held.modes] = 0.0
    defect = defect[:, :d].sum(axis=0)
    exchanged = (abs(rows.J).T @ (np.abs(p) + np.abs(shift))).reshape(shape)[:, :d].sum()
    scale = exchanged + np.abs(load[:, :d]).sum() + np.abs((system.mass * U)[:, :d]).sum()
    return float(np.abs(defect).max() / scale) if scale > 0.0 else 0.0


def _overlap(system: System, state: GlueyState) -> float:
    """The deepest overlap over the smallest radius, of all pairs, not only of those that were looked at."""
    gaps = find_contacts(state.centres, system.radii, system.room, 0.0).D
    return abs(float(gaps.min(initial=0.0))) / float(system.radii.min())


def _failure(checks: Checks, t: float) -> str | None:
    """The first check that fails in the step to t."""
    for name, limit in (("kkt", ACCEPTED), ("momentum", MOMENTUM), ("overlap", OVERLAP)):
        value = getattr(checks, name)
        if not value <= limit:
            return f"{name} = {value:.3g} in the step to t = {t:.9g}: more than {limit:g}; lower time.step"
    return None
