"""What moves in the gluey model, and its state: masses, walls, loads, what is held, also from a case."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, turned
from fsi.bodies.forces import Bulk, between_bodies, finite, on_each_body
from fsi.case.case import Case
from fsi.case.gluey import ContactLaw, Gluey
from fsi.case.series import Table, is_zero, polynomial
from fsi.gluey.contacts import Room
from fsi.gluey.film import DiscFilm, Film, SphereFilm


@dataclass(frozen=True, slots=True)
class Held:
    """What is prescribed.

    Attributes:
        modes: which modes of which bodies, bool, shape (N, modes).
        velocity: `(t0, t1) -> int U dt / (t1 - t0)`, shape (N, modes), 0 where free.
    """

    modes: NDArray[np.bool_]
    velocity: Callable[[float, float], Array]


@dataclass(frozen=True, slots=True)
class System:
    """The bodies and what acts on them.

    Attributes:
        radii: shape (N,).
        mass: `(m, .., I, ..)` of each body's modes, shape (N, modes).
        room: walls and periods.
        impulse: `(t0, t1) -> int (F, T) dt` of the loads that depend on time alone, shape (N, modes).
        law: what happens where surfaces touch.
        films: the kind of those between surfaces.
        held: what is prescribed; nothing if None.
        forces: F of the bodies at centres (N, d) and a time, shape (N, d); none if None.
    """

    radii: Array
    mass: Array
    room: Room
    impulse: Callable[[float, float], Array]
    law: ContactLaw
    films: type[Film]
    held: Held | None = None
    forces: Callable[[Array, float], Array] | None = None

    def film(self, h: float) -> Film | None:
        """What the rows answer in a step h: None in the limit, where gamma says it all."""
        return self.films(self.law.eps, self.law.delta0, h) if self.law.variant == "film" else None

    def load(self, centres: Array, t0: float, t1: float) -> Array:
        """`int (F, T) dt` over a step, forces between bodies taken where it begins, shape (N, modes)."""
        load = self.impulse(t0, t1)
        if self.forces is not None:
            load[:, : self.dimension] += (t1 - t0) * self.forces(centres, t0)
        return load

    @property
    def dimension(self) -> int:
        """The number d of coordinates of a centre."""
        return self.room.container.dimension


@dataclass(frozen=True, slots=True)
class GlueyState:
    """All that the next step depends on.

    Attributes:
        centres: shape (N, d).
        angles: turned since the start, shape (N, r), in space rotation vectors.
        U: velocities, shape (N, d + r).
        key: the pairs that remember, by `Contacts.key`, increasing.
        gamma: what they remember, an impulse < 0.
    """

    centres: Array
    angles: Array
    U: Array
    key: NDArray[np.int64]
    gamma: Array

    @classmethod
    def at(cls, centres: Array, U: Array) -> GlueyState:
        """Bodies that have not met yet."""
        spins = U.shape[1] - centres.shape[1]
        return cls(centres, np.zeros((len(centres), spins)), U, np.empty(0, dtype=np.int64), np.empty(0))

    def remembered(self, key: NDArray[np.int64]) -> Array:
        """gamma of the pairs with these keys; 0 for those that have not met, or have parted."""
        if len(self.key) == 0:
            return np.zeros(len(key))
        at = np.minimum(np.searchsorted(self.key, key), len(self.key) - 1)
        return np.where(self.key[at] == key, self.gamma[at], 0.0)

    def moved(self, U: Array, h: float, key: NDArray[np.int64], gamma: Array) -> GlueyState:
        """The state after a step h at the velocities U; pairs with gamma = 0 are forgotten."""
        d, kept = self.centres.shape[1], gamma != 0.0
        angles = turned(self.angles, h * U[:, d:])
        return GlueyState(self.centres + h * U[:, :d], angles, U, key[kept], gamma[kept])


def gluey_system(case: Case) -> System:
    """What moves, and what acts on it."""
    q, mass, held = case.configuration(), _masses(case), case.held()
    loads = _integrals(case, [(body.loads, held[i]) for i, body in enumerate(case.bodies)])
    bulk = Bulk(mass[:, 0], case.bulk().volumes)
    weights = [weight for force in case.forces if (weight := force.weight(bulk)) is not None]
    weightless = [(k, force) for k, force in enumerate(case.forces) if force.weight(bulk) is None]
    gravities = [
        (heavy, [polynomial(part, case.timing.end).antiderivative() for part in acceleration])
        for heavy, acceleration in weights
    ]

    def impulse(t0: float, t1: float) -> Array:
        load, free = loads(t0, t1), ~held[:, : case.dimension]
        for heavy, parts in gravities:
            g = np.array([float(part(t1) - part(t0)) for part in parts])
            load[:, : case.dimension] += free * (heavy[:, None] * g)
        middle = 0.5 * (t0 + t1)  # no integral is known of those forces
        for k, force in weightless:
            F = finite(on_each_body(force, k, bulk, middle, case.dimension), k, middle)
            load[:, : case.dimension] += free * ((t1 - t0) * F)
        return load

    films = SphereFilm if case.spheres else DiscFilm
    law = _contact_law(case.gluey, films)
    return System(q.radii, mass, room(case), impulse, law, films, _held(case), _forces(case))


def _contact_law(gluey: Gluey, films: type[Film]) -> ContactLaw:
    """What happens where surfaces touch: solid contact with the memory of a film as thin as the roughness."""
    eps, delta0, roughness = gluey.eps or 0.0, gluey.reference_gap or 0.0, gluey.roughness
    least = -np.inf if gluey.gamma_min is None else gluey.gamma_min
    if roughness is not None:
        least = eps * float(films.memory(np.array(roughness / delta0)))
    film = (eps, delta0) if gluey.variant == "film" else (0.0, 0.0)
    return ContactLaw(gluey.variant, least, gluey.friction, gluey.tangential, *film)


def gluey_state(case: Case) -> GlueyState:
    """The state at time 0."""
    q = case.configuration()
    state = GlueyState.at(q.centres, case.initial_velocity())
    return GlueyState(q.centres, q.angles.reshape(state.angles.shape), state.U, state.key, state.gamma)


def wall_names(case: Case) -> tuple[str, ...]:
    """Names of the walls in the order of the room."""
    of_domain = (name for name in case.container().walls if name not in case.container().far_walls)
    return (*of_domain, *(wall.name for wall in case.gluey.walls))


def room(case: Case) -> Room:
    """Walls and periods."""
    container, d = case.container(), case.dimension
    origin = np.zeros((1, d))
    near = [k for k, name in enumerate(container.walls) if name not in container.far_walls]
    normals = [*container.normals(origin)[0, near]]
    points = [-away * n for away, n in zip(container.distances(origin)[0, near], normals, strict=True)]
    further_points, further_normals = _planes(case)
    return Room(
        np.append(np.reshape(points, (-1, d)), further_points, axis=0),
        np.append(np.reshape(normals, (-1, d)), further_normals, axis=0),
        container,
    )


def _planes(case: Case) -> tuple[Array, Array]:
    """Points and unit normals of the walls besides those of the domain, (W, d) each."""
    walls, shape = case.gluey.walls, (-1, case.dimension)
    points = np.reshape([wall.point for wall in walls], shape)
    return points, np.reshape([wall.unit_normal for wall in walls], shape)


def _masses(case: Case) -> Array:
    """m and I of each mode, those of uniform bodies where none are given, (N, M)."""
    q, d = case.configuration(), case.dimension
    masses, volumes = [body.mass for body in case.bodies], case.bulk().volumes
    m = np.array([case.gluey.density * V if m is None else m for m, V in zip(masses, volumes, strict=True)])
    uniform = (0.4 if case.spheres else 0.5) * m * q.radii**2
    moments = [body.moment_of_inertia for body in case.bodies]
    inertia = [uniform[i] if moment is None else moment for i, moment in enumerate(moments)]
    return np.repeat(np.column_stack([m, inertia]), [d, len(case.modes) - d], axis=1)


def _held(case: Case) -> Held | None:
    held = case.held()
    if not held.any():
        return None
    motions = ([0.0 if part == "free" else part for part in body.motion] for body in case.bodies)
    travelled = _integrals(case, list(zip(motions, ~held, strict=True)))
    return Held(held, lambda t0, t1: travelled(t0, t1) / (t1 - t0))


def _integrals(
    case: Case, parts: Sequence[tuple[Sequence[float | Table], Sequence[bool]]]
) -> Callable[[float, float], Array]:
    """`(t0, t1) -> int dt` of what bodies have for each mode, but 0 for the modes that are marked, (N, M)."""
    end, shape = case.timing.end, (len(case.bodies), len(case.modes))

    def nonzero() -> Iterator[tuple[int, int, PPoly]]:
        for i, (series, dropped) in enumerate(parts):
            for k, (part, drop) in enumerate(zip(series, dropped, strict=True)):
                if not (drop or is_zero(part)):
                    yield i, k, polynomial(part, end).antiderivative()

    integrals = list(nonzero())

    def integral(t0: float, t1: float) -> Array:
        total = np.zeros(shape)
        for i, k, primitive in integrals:
            total[i, k] = float(primitive(t1) - primitive(t0))
        return total

    return integral


def _forces(case: Case) -> Callable[[Array, float], Array] | None:
    """Of attraction and repulsion, also from the walls besides those of the domain; None without."""
    acting = [(k, force) for k, force in enumerate(case.forces) if force.reach > 0.0]
    if not acting:
        return None
    radii, container = case.configuration().radii, case.container()
    points, normals = _planes(case)
    free = ~case.held()[:, : case.dimension]

    def forces(centres: Array, t: float) -> Array:
        q = Configuration.unturned(centres, radii)
        to_planes = np.einsum("iwd,wd->iw", centres[:, None] - points, normals) - radii[:, None]
        total = np.zeros_like(centres)
        for k, force in acting:
            F = between_bodies(force, q, container.at(t)) + force.wall_repulsion(to_planes) @ normals
            total += finite(F, k, t)
        return free * total

    return forces
