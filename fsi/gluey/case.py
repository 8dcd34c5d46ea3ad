"""The case file of a gluey run: bodies with mass, walls, what drives them, what happens where they touch."""

from __future__ import annotations

from typing import Literal

import numpy as np
import tomli_w
from pydantic import Field, model_validator

from fsi.bodies import MODES, Array, Configuration
from fsi.errors import InputError
from fsi.gluey.contacts import Room, find_contacts
from fsi.gluey.history import History, polynomial
from fsi.gluey.system import GlueyState, Law, System
from fsi.section import Section, toml_text

Vector = tuple[float, ...]
_POINT = "two or three finite numbers, as many as for all others"


class Cell(Section):
    """A box: walls at its sides, or periodic."""

    lower: Vector = Field(min_length=2, max_length=3, description=f"the lower corner, {_POINT}")
    upper: Vector = Field(min_length=2, max_length=3, description=f"the upper corner, {_POINT}")
    periodic: tuple[Literal["x", "y", "z"], ...] = Field(
        default=(), description='the periodic directions, like ["x"]'
    )


class Wall(Section):
    """A plane wall."""

    name: str = Field(pattern=r"^\w[\w -]*$", description="a name of letters, digits, blanks, - and _")
    point: Vector = Field(min_length=2, max_length=3, description=f"a point of the wall, {_POINT}")
    normal: Vector = Field(min_length=2, max_length=3, description="its normal, into the room, not zero")


class GlueyBody(Section):
    """A disc or sphere."""

    name: str = Field(pattern=r"^\w[\w -]*$", description="a name of letters, digits, blanks, - and _")
    radius: float = Field(gt=0.0, description="the radius, a number > 0")
    position: Vector = Field(min_length=2, max_length=3, description=f"the centre at time 0, {_POINT}")
    velocity: Vector | None = Field(default=None, description="the velocity at time 0, 0 if not given")
    mass: float | None = Field(
        default=None, gt=0.0, description="the mass, a number > 0 (density times volume if not given)"
    )
    force: tuple[History, ...] | None = Field(
        default=None, description="components, each a number or a table {times = [...], values = [...]}"
    )


class Grid(Section):
    """Rows of like bodies, a little disturbed."""

    name: str = Field(pattern=r"^\w[\w -]*$", description="a name of letters, digits, blanks, - and _")
    counts: tuple[int, ...] = Field(min_length=2, max_length=3, description="how many in each direction")
    lower: Vector = Field(min_length=2, max_length=3, description="the centre of the first, a point")
    spacing: float = Field(gt=0.0, description="the distance between neighbours' centres, a number > 0")
    radius: tuple[float, float] = Field(description="the smallest and the largest radius, two numbers > 0")
    velocity: Vector | None = Field(default=None, description="their velocity at time 0, 0 if not given")
    jitter: float = Field(default=0.0, ge=0.0, description="the largest disturbance of a coordinate, >= 0")
    seed: int = Field(default=0, ge=0, description="of the random numbers, a whole number >= 0")


class Contact(Section):
    """What happens where surfaces touch."""

    variant: Literal["shifted", "cone", "film"] = Field(
        default="shifted", description='"shifted" or "cone" (gluey), or "film": viscosity eps > 0'
    )
    gamma_min: float | None = Field(
        default=None, le=0.0, description="the memory at which contact is solid, <= 0 (none if not given)"
    )
    eps: float | None = Field(
        default=None,
        gt=0.0,
        description="the viscosity's coefficient in gamma = eps ln(gap/reference_gap), > 0",
    )
    reference_gap: float | None = Field(default=None, gt=0.0, description="the gap at which gamma is 0, > 0")
    roughness: float | None = Field(
        default=None, gt=0.0, description="the gap at which contact is solid, > 0, with eps and reference_gap"
    )
    friction: float = Field(default=0.0, ge=0.0, description="Coulomb's coefficient at solid contact, >= 0")
    tangential: float = Field(
        default=0.0,
        ge=0.0,
        description="the viscous slip resistance over |gamma|/a, >= 0; 1/3 for equal spheres",
    )

    @model_validator(mode="after")
    def _whole(self) -> Contact:
        film = (self.eps, self.reference_gap, self.roughness)
        if self.gamma_min is not None and film != (None, None, None):
            raise ValueError("gives gamma_min and what it follows from; drop one of them")
        if self.variant == "film":
            if self.eps is None or self.reference_gap is None:
                raise ValueError('has variant = "film", which needs eps and reference_gap')
            if (self.gamma_min, self.roughness, self.friction, self.tangential) != (None, None, 0.0, 0.0):
                raise ValueError(
                    'has variant = "film": never solid; drop gamma_min, roughness, friction, tangential'
                )
            return self
        if film != (None, None, None) and None in film:
            raise ValueError("needs all of eps, reference_gap and roughness, or none")
        if self.roughness is not None and self.roughness >= (self.reference_gap or 0.0):
            raise ValueError("has a roughness that is not below reference_gap")
        if self.friction > 0.0 and not np.isfinite(self.least):
            raise ValueError("has friction, but no solid contact; give gamma_min or the roughness")
        return self

    @property
    def least(self) -> float:
        """gamma_min, `eps ln(roughness/reference_gap)`, or -inf."""
        if self.eps is not None and self.roughness is not None and self.reference_gap is not None:
            return self.eps * float(np.log(self.roughness / self.reference_gap))
        return -np.inf if self.gamma_min is None else self.gamma_min

    def law(self) -> Law:
        """As the step takes it."""
        eps, delta0 = (self.eps, self.reference_gap) if self.variant == "film" else (None, None)
        return Law(self.variant, self.least, self.friction, self.tangential, eps or 0.0, delta0 or 0.0)


class Steps(Section):
    """How the motion is stepped."""

    end: float = Field(gt=0.0, description="the time at which the run ends, a number > 0")
    step: float = Field(gt=0.0, description="the length of a step, a number > 0")


class Frames(Section):
    """What a run writes beyond steps.csv."""

    interval: float | None = Field(
        default=None, gt=0.0, description="the time between rows of bodies, contacts and files, a number > 0"
    )
    fields: bool = Field(default=True, description="true to write files for ParaView, false for tables only")


class GlueyCase(Section):
    """Bodies that stick: no fluid but in the memory of contacts."""

    name: str = Field(min_length=1, description="a few words that name the case")
    model: Literal["gluey"] = Field(description='"gluey"')
    cell: Cell | None = Field(default=None, description="a section [cell] with lower and upper")
    walls: tuple[Wall, ...] = Field(default=(), description="one section [[walls]] for each plane")
    bodies: tuple[GlueyBody, ...] = Field(default=(), description="one section [[bodies]] for each body")
    grids: tuple[Grid, ...] = Field(default=(), description="one section [[grids]] for each crowd")
    density: float = Field(default=1.0, gt=0.0, description="the density of the bodies, a number > 0")
    gravity: tuple[History, ...] | None = Field(
        default=None, description="components, each a number or a table {times = [...], values = [...]}"
    )
    contact: Contact = Field(default_factory=Contact, description="a section [contact]")
    time: Steps = Field(description="a section [time] with end and step")
    output: Frames = Field(default_factory=Frames, description="a section [output]")

    @model_validator(mode="after")
    def _sound(self) -> GlueyCase:
        _check(self)
        return self

    @property
    def dimension(self) -> int:
        """2 for discs, 3 for spheres."""
        return len(self.bodies[0].position if self.bodies else self.grids[0].counts)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies, then those of the grids' members."""
        members = (f"{grid.name} {k}" for grid in self.grids for k in range(int(np.prod(grid.counts))))
        return (*(body.name for body in self.bodies), *members)

    def room(self) -> Room:
        """Walls and periods."""
        d = self.dimension
        points, normals, period = [], [], np.zeros(d)
        if self.cell is not None:
            for axis, letter in enumerate("xyz"[:d]):
                if letter in self.cell.periodic:
                    period[axis] = self.cell.upper[axis] - self.cell.lower[axis]
                    continue
                e = np.eye(d)[axis]
                points += [self.cell.lower, self.cell.upper]
                normals += [e, -e]
        for wall in self.walls:
            points.append(wall.point)
            normals.append(np.array(wall.normal) / np.linalg.norm(wall.normal))
        return Room(np.array(points).reshape(-1, d), np.array(normals).reshape(-1, d), period)

    def configuration(self) -> Configuration:
        """Where the bodies are at time 0."""
        d = self.dimension
        listed = np.array([body.position for body in self.bodies]).reshape(-1, d)
        radii = [np.array([body.radius for body in self.bodies])]
        centres = [listed]
        for grid in self.grids:
            random = np.random.default_rng(grid.seed)
            places = np.stack(np.meshgrid(*map(np.arange, grid.counts), indexing="ij"), axis=-1).reshape(
                -1, d
            )
            disturbance = random.uniform(-grid.jitter, grid.jitter, places.shape)
            centres.append(np.array(grid.lower) + grid.spacing * places + disturbance)
            radii.append(random.uniform(*grid.radius, len(places)))
        return Configuration.unturned(np.concatenate(centres), np.concatenate(radii))

    def system(self) -> System:
        """What moves, and what acts on it."""
        q, d = self.configuration(), self.dimension
        volume = np.pi * q.radii**2 if d == 2 else 4.0 / 3.0 * np.pi * q.radii**3
        m = self.density * volume
        given = [(i, body.mass) for i, body in enumerate(self.bodies) if body.mass is not None]
        for i, mass in given:
            m[i] = mass
        inertia = (0.5 if d == 2 else 0.4) * m * q.radii**2
        modes = len(MODES[d])
        mass_matrix = np.repeat(np.column_stack([m, inertia]), [d, modes - d], axis=1)
        gravity = [polynomial(part, self.time.end).antiderivative() for part in self.gravity or (0.0,) * d]
        forces = [
            (i, axis, polynomial(part, self.time.end).antiderivative())
            for i, body in enumerate(self.bodies)
            for axis, part in enumerate(body.force or ())
        ]

        def impulse(t0: float, t1: float) -> Array:
            load = np.zeros((len(m), modes))
            for axis, integral in enumerate(gravity):
                load[:, axis] = m * float(integral(t1) - integral(t0))
            for i, axis, integral in forces:
                load[i, axis] += float(integral(t1) - integral(t0))
            return load

        return System(q.radii, mass_matrix, self.room(), impulse, self.contact.law())

    def state(self) -> GlueyState:
        """The state at time 0."""
        q, modes = self.configuration(), len(MODES[self.dimension])
        U = np.zeros((len(q), modes))
        for i, body in enumerate(self.bodies):
            U[i, : self.dimension] = body.velocity or 0.0
        first = len(self.bodies)
        for grid in self.grids:
            last = first + int(np.prod(grid.counts))
            U[first:last, : self.dimension] = grid.velocity or 0.0
            first = last
        return GlueyState.at(q.centres, U)

    def as_toml(self) -> str:
        """The case with every default filled in; reads back as an equal case."""
        return tomli_w.dumps(self.model_dump(exclude_none=True))


def _check(case: GlueyCase) -> None:
    """Raise InputError for the first thing that cannot be."""
    if not case.bodies and not case.grids:
        raise InputError("bodies: missing; give [[bodies]] or [[grids]]")
    _check_dimensions(case)
    for i, name in enumerate(case.names):
        if name in case.names[:i] and len(case.bodies) > 0 and i < len(case.bodies):
            raise InputError(f"bodies.{i}.name = {toml_text(name)}: given twice; give each body its own")
    if case.time.step > case.time.end:
        raise InputError(
            f"time.step = {case.time.step!r}: longer than time.end = {case.time.end!r}; make it shorter"
        )
    room, q = case.room(), case.configuration()
    if np.any((room.period > 0.0) & (room.period < 8.0 * q.radii.max())):
        raise InputError(
            "cell.upper: a period is below four diameters, so that bodies meet their own images; widen it"
        )
    touching = find_contacts(q.centres, q.radii, room, 0.0)
    deepest = int(np.argmin(touching.D)) if len(touching) else 0
    if len(touching) and touching.D[deepest] < -1e-10 * q.radii.min():
        names = (*case.names, *("a wall" for _ in room.points))
        raise InputError(
            f"bodies: {names[touching.j[deepest]]} and {names[touching.i[deepest]]} overlap by "
            f"{-touching.D[deepest]:.3g}; move them apart"
        )


def _check_dimensions(case: GlueyCase) -> None:
    """All points and vectors have as many components as the first body's."""
    d = case.dimension
    given: list[tuple[str, tuple[object, ...] | None]] = [("gravity", case.gravity)]
    if case.cell is not None:
        given += [("cell.lower", case.cell.lower), ("cell.upper", case.cell.upper)]
    for i, wall in enumerate(case.walls):
        given += [(f"walls.{i}.point", wall.point), (f"walls.{i}.normal", wall.normal)]
    for i, body in enumerate(case.bodies):
        given += [(f"bodies.{i}.{key}", getattr(body, key)) for key in ("position", "velocity", "force")]
    for i, grid in enumerate(case.grids):
        given += [(f"grids.{i}.lower", grid.lower), (f"grids.{i}.counts", grid.counts)]
        given += [(f"grids.{i}.velocity", grid.velocity)]
    for key, value in given:
        if value is not None and len(value) != d:
            raise InputError(f"{key} = {toml_text(value)}: has {len(value)} components, others {d}; give {d}")
    for i, wall in enumerate(case.walls):
        if not any(wall.normal):
            raise InputError(f"walls.{i}.normal = {toml_text(wall.normal)}: is zero; give a direction")
    if case.cell is not None and not all(
        a < b for a, b in zip(case.cell.lower, case.cell.upper, strict=True)
    ):
        raise InputError(f"cell.upper = {toml_text(case.cell.upper)}: not above cell.lower; exchange them")
