"""The case file of a gluey run: bodies with mass, walls, what drives them, what happens where they touch."""

from __future__ import annotations

from typing import Literal

import numpy as np
import tomli_w
from pydantic import Field, model_validator

from fsi.bodies.configuration import MODES, Array, Configuration
from fsi.case.gluey import Cell, Contact, Frames, GlueyBody, Grid, Steps, Wall
from fsi.case.section import Section, toml_text
from fsi.errors import InputError
from fsi.gluey.contacts import Room, find_contacts
from fsi.gluey.history import History, polynomial
from fsi.gluey.system import GlueyState, System


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
    _check_names(case)
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
    if not len(touching):
        return
    names = (*case.names, *("a wall" for _ in room.points))
    between = f"bodies: {names[touching.j[deepest]]} and {names[touching.i[deepest]]}"
    if touching.D[deepest] < -1e-10 * q.radii.min():
        raise InputError(f"{between} overlap by {-touching.D[deepest]:.3g}; move them apart")
    if case.contact.variant == "film":
        raise InputError(
            f'{between} touch, where contact.variant = "film" needs a gap; move them apart or give "shifted"'
        )


def _check_names(case: GlueyCase) -> None:
    """Each body and each grid has a name of its own, also as seen in tables."""
    given = [(f"bodies.{i}", body.name) for i, body in enumerate(case.bodies)]
    given += [(f"grids.{i}", grid.name) for i, grid in enumerate(case.grids)]
    taken: set[str] = set()
    for key, name in given:
        if name in taken:
            raise InputError(f"{key}.name = {toml_text(name)}: given twice; give each its own")
        taken.add(name)
    if len(set(case.names)) < len(case.names):
        raise InputError("bodies: one is named like a member of a grid, `NAME k`; rename it")


def _check_dimensions(case: GlueyCase) -> None:
    """All points and vectors have as many components as the first body's."""
    d = case.dimension
    given: list[tuple[str, tuple[object, ...] | None]] = [("gravity", case.gravity)]
    if case.cell is not None:
        given += [("cell.lower", case.cell.lower), ("cell.upper", case.cell.upper)]
        directions = case.cell.periodic
        if not set(directions) <= set("xyz"[:d]) or len(set(directions)) < len(directions):
            raise InputError(
                f"cell.periodic = {toml_text(directions)}: give each direction of {', '.join('xyz'[:d])} once"
            )
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
