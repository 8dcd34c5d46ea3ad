"""A case as data and arrays: what the user asks for. `fsi.case.load` reads and checks it.

Lengths, times and loads are in the user's own consistent units; loads are EXTERNAL and per unit length in
the plane.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, get_args, override

import numpy as np
import tomli_w
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field

from fsi.arrays import Array
from fsi.bodies.configuration import MODES, Configuration, Motion, volumes
from fsi.bodies.forces import Bulk, external_forces, moment_of_forces
from fsi.bodies.opened import opened
from fsi.case.body import FREE, Body
from fsi.case.domains.domain import Domain, Walled
from fsi.case.force_laws.law import Force
from fsi.case.gluey import Gluey, LimitStudy
from fsi.case.macroscopic import Macroscopic
from fsi.case.reduced import Reduced
from fsi.case.section import Geometry, Late, Section, Text, dimension_of
from fsi.case.sections import (
    Calibration,
    Discretisation,
    Expected,
    Fluid,
    Lubrication,
    Output,
    PoreResolution,
    Sweep,
    Time,
)
from fsi.case.series import value_at
from fsi.case.wall_velocity import WallVelocity
from fsi.errors import InputError
from fsi.levels import LEVELS, ModelLevel
from fsi.meshes.geometry.container import Container

if TYPE_CHECKING:  # schemes take long to load, and an instant has none
    from fsi.integration.schemes import SchemeKind

type ModelName = Literal["resolved", "pores", "reduced", "gluey", "macroscopic"]
MODELS: tuple[str, ...] = get_args(ModelName.__value__)


def _rows(value: Any) -> Any:
    """A single table [expected] is one row, an empty one none."""
    return tuple([value] if value else []) if isinstance(value, dict) else value


class Case(Section):
    """One problem: fluid, domain, bodies, and how to compute it at one of five levels."""

    renamed: ClassVar[dict[str, str]] = {
        "cell": "use [domain] with lower, upper and periodic",
        "walls": "use the walls of [domain], or [[gluey.walls]]",
        "contact": "use [gluey]",
        "gravity": 'use [[forces]] with kind = "gravity" and acceleration',
        "density": "use gluey.density",
        "parcels": "use macroscopic.parcels",
        "blocks": "use [[macroscopic.blocks]]",
        "force": "use macroscopic.force_per_mass",
        "q0": "use [[bodies]] above a half-plane",
        "u0": "use bodies.0.initial_velocity",
        "end": "use time.end",
        "eps": "use limit.eps",
        "steps": "use limit.steps",
    }

    name: Text
    """a few words that name the case"""
    geometry: Geometry = "planar"
    '"planar", "axisymmetric" or "spatial"'
    model: ModelName = "resolved"
    '"resolved", "pores", "reduced", "gluey" or "macroscopic": the level'
    fluid: Fluid = Field(default_factory=lambda: Fluid(viscosity=1.0))
    """a section [fluid] with its viscosity; 1 in gluey and macroscopic cases if not given, others need it"""
    domain: Domain
    bodies: tuple[Body, ...] = ()
    """one section [[bodies]] for each body"""
    # The next four are None in a sound case: what they give is in `bodies`, so that a case stands alone.
    bodies_from: str | None = None
    """the path of a .json or .csv file of bodies, seen from the case file's folder"""
    body_defaults: dict[str, Any] | None = None
    """a section [body_defaults] with keys of [[bodies]] for all that lack them"""
    grids: None = None
    """one section [[grids]] for rows of like bodies"""
    arrangement: None = None
    """a section [arrangement] with kind, number and area_fraction, for bodies as by `fsi pack`"""
    forces: tuple[Force, ...] = ()
    """one section [[forces]] for gravity and each law of force between bodies"""
    discretisation: Discretisation
    """a section [discretisation]"""
    pores: Annotated[PoreResolution, Late()] = Field(default_factory=PoreResolution.model_construct)
    """a section [pores]"""
    reduced: Annotated[Reduced, Late()] = Field(default_factory=Reduced.model_construct)
    """a section [reduced]"""
    lubrication: Annotated[Lubrication, Late()] = Field(default_factory=Lubrication.model_construct)
    """a section [lubrication]"""
    gluey: Annotated[Gluey, Late()] = Field(default_factory=Gluey.model_construct)
    """a section [gluey]"""
    macroscopic: Annotated[Macroscopic, Late()] = Field(default_factory=Macroscopic.model_construct)
    """a section [macroscopic]"""
    limit: Annotated[LimitStudy, Late()] | None = None
    """a section [limit], for `fsi limit`"""
    time: Annotated[Time, Late()] | None = None
    """a section [time] with its end"""
    output: Annotated[Output, Late()] = Field(default_factory=Output.model_construct)
    """a section [output]"""
    expected: Annotated[tuple[Annotated[Expected, Late()], ...], BeforeValidator(_rows)] = ()
    """one section [[expected]] for each number"""
    sweep: Annotated[Sweep, Late()] | None = None
    """a section [sweep] with key and values, for `fsi validate`"""
    calibration: Annotated[Calibration, Late()] | None = None
    """a section [calibration] with pair and range, for `fsi calibrate`"""

    @classmethod
    @override
    def describe(cls, key: str) -> str | None:
        shapes = "a section [domain] of shape "
        return shapes + Walled.registry.choices if key == "domain" else super().describe(key)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies, in the order of every array over bodies."""
        return tuple(body.name for body in self.bodies)

    @property
    def level(self) -> ModelLevel:
        """What its model has."""
        return LEVELS[self.model]

    @property
    def tolerance(self) -> float | None:
        """The estimated relative error to which its level is refined, or none."""
        section = self.level.accuracy
        tolerance: float | None = getattr(self, section).tolerance if section else None
        return tolerance

    @property
    def axisymmetric(self) -> bool:
        """True where positions are (r, z)."""
        return self.geometry == "axisymmetric"

    @property
    def dimension(self) -> int:
        """d: how many coordinates a point has."""
        return dimension_of(self.geometry)

    @property
    def spheres(self) -> bool:
        """True where bodies are spheres, false where they are discs."""
        return self.geometry != "planar"

    @property
    def modes(self) -> NDArray[np.bool_]:
        """Which of its M modes a body has: all, or with an axis V_z alone, which stands second."""
        every = np.ones(len(MODES[self.dimension]), dtype=bool)
        return np.array([False, True, False]) if self.axisymmetric else every

    @property
    def drag(self) -> float:
        """The drag of a body by itself in the reduced model, over mu V, for spheres over mu a V."""
        return self.reduced.drag_of_bodies(spheres=self.spheres)

    @property
    def fraction(self) -> float:
        """The part of the domain that is bodies."""
        return float(self.bulk().volumes.sum()) / self.container().volume_in_space

    @property
    def timing(self) -> Time:
        """The section [time]. Raises InputError if there is none."""
        if self.time is None:
            instead = ", or use `fsi solve`" if self.level.viscous else ""
            raise InputError(f"time: missing; add a section [time] with its end{instead}")
        return self.time

    @property
    def scheme(self) -> "SchemeKind":
        """The scheme by which the case is stepped. Raises InputError if there is no [time]."""
        from fsi.integration.schemes import scheme_for

        return scheme_for(self.timing.scheme, inertia=self.masses() is not None)

    def container(self) -> Container:
        """What encloses the fluid."""
        return self.domain.container()

    def configuration(self) -> Configuration:
        """Where the bodies are at time 0."""
        q = Configuration.unturned(
            np.array([body.position for body in self.bodies], dtype=float).reshape(-1, self.dimension),
            np.array([body.radius for body in self.bodies], dtype=float),
        )
        angles = np.array([body.angle for body in self.bodies], dtype=float)
        placed = replace(q, angles=angles.reshape(q.angles.shape))
        if all(body.shape is None for body in self.bodies) and not self.domain.profiled:
            return placed
        if self.dimension == 3:
            return replace(placed, ellipsoids=tuple(body.ellipsoid for body in self.bodies))
        outlines = tuple(body.revolved if self.axisymmetric else body.outline for body in self.bodies)
        return replace(placed, outlines=outlines)

    def meshed_at(self, q: Configuration, t: float) -> Configuration:
        """Where a mesh has the bodies that are at q at time t: apart where laws take over from it."""
        if (below := self.lubrication.below) is None:
            return q
        return opened(q, self.container().at(t, q.strain), below, tuple(self.wall_velocity(t)))

    def held(self) -> NDArray[np.bool_]:
        """Which modes are prescribed, or not there, at all times, (N, M)."""
        prescribed = [[part != FREE for part in body.motion] for body in self.bodies]
        return np.array(prescribed, dtype=bool).reshape(-1, len(self.modes)) | ~self.modes

    def motion(self, t: float) -> Motion:
        """What holds the bodies, and their own loads, at time t; `forces` are not in it."""
        U = self._modes(lambda body: [0.0 if part == FREE else value_at(part, t) for part in body.motion])
        F = self._modes(lambda body: [value_at(part, t) for part in body.loads])
        return Motion(self.held(), U, F)

    def motion_at(self, q: Configuration, t: float) -> Motion:
        """What holds and drives the bodies at q and time t, with the `forces` on free components."""
        return self.with_forces(self.motion(t), q, t)

    def with_forces(self, motion: Motion, q: Configuration, t: float) -> Motion:
        """The motion at time t with the `forces` at q on its free components."""
        if not self.forces:
            return motion
        F, container = np.zeros_like(motion.F), self.container().at(t, q.strain)
        F[:, : self.dimension] = external_forces(self.forces, q, container, self.bulk(), t)
        return Motion(motion.held, motion.U, motion.F + np.where(motion.held, 0.0, F))

    def interaction_moment(self, q: Configuration, t: float) -> Array:
        """Sum of r (x) F of the `forces` between bodies, and bodies and walls, at q and time t, (d, d)."""
        return moment_of_forces(self.forces, q, self.container().at(t, q.strain))

    def masses(self) -> Array | None:
        """m or I of each mode, 0 for bodies without, shape (N, M); None when no body has inertia."""
        if all(body.mass is None for body in self.bodies):
            return None
        return self._modes(lambda body: body.masses)

    def initial_velocity(self) -> Array:
        """The velocity of each mode at time 0, (N, M): prescribed, that of a body with inertia, or 0."""
        motion = self.motion(0.0)
        return np.where(motion.held, motion.U, self._modes(lambda body: body.initial_motion))

    def _modes(self, values: Callable[[Body], Sequence[float]]) -> Array:
        return np.array([values(body) for body in self.bodies], dtype=float).reshape(-1, len(self.modes))

    def wall_velocity(self, t: float) -> dict[str, WallVelocity]:
        """The velocity at time t on the walls where it is given."""
        velocities = {name: wall.velocity_at(t, self.dimension) for name, wall in self.domain.walls.items()}
        return {name: velocity for name, velocity in velocities.items() if velocity is not None}

    def wall_pressure(self) -> dict[str, float]:
        """The outside pressure on the open walls."""
        pressures = {name: wall.outside_pressure for name, wall in self.domain.walls.items()}
        return {name: pressure for name, pressure in pressures.items() if pressure is not None}

    def wall_stress(self, t: float) -> dict[str, float]:
        """The tangential traction at time t of the walls that it moves, along x."""
        stresses = {name: wall.shear_stress(t) for name, wall in self.domain.walls.items()}
        return {name: stress for name, stress in stresses.items() if stress is not None}

    def wall_slip(self) -> dict[str, float]:
        """The slip length of the walls along which fluid slides."""
        return {name: wall.slip for name, wall in self.domain.walls.items() if wall.slip}

    def bulk(self) -> Bulk:
        """What gravity acts on."""
        masses, q = np.array([body.mass or 0.0 for body in self.bodies]), self.configuration()
        return Bulk(masses, q.volumes if q.shaped else volumes(q.radii, spheres=self.spheres))

    def kinks(self) -> tuple[float, ...]:
        """The times at which a table has a kink, increasing."""
        of_bodies = (body.kinks() for body in self.bodies)
        of_forces = (force.kinks(self.bulk()) for force in self.forces)
        of_walls = (wall.kinks() for wall in self.domain.walls.values())
        return tuple(sorted(set[float]().union(*of_bodies, *of_forces, *of_walls)))

    def __repr__(self) -> str:
        """What it is, in one line."""
        what = f"{self.model}, {self.geometry}, {len(self.bodies)} bodies, {self.domain.shape}"
        return f"<Case {self.name!r}: {what}>"

    def as_data(self) -> dict[str, Any]:
        """The case as nested dictionaries with every default filled in; `parse_case` gives an equal Case."""
        not_given = set() if "fluid" in self.model_fields_set else {"fluid"}
        return self.model_dump(exclude_none=True, exclude=not_given)

    def as_toml(self) -> str:
        """The same as a case file."""
        return tomli_w.dumps(self.as_data())
