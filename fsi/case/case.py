"""The case file: what the user asks for, checked before anything is computed.

`load_case` reads a TOML file into a frozen `Case` or raises `InputError` with one line that names
the key, its value and the remedy. Lengths, times and loads are in the user's own consistent units;
loads are EXTERNAL and per unit length in the plane.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tomli_w
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, ValidationError, model_validator

from fsi.bodies.configuration import MODES, Array, Configuration, Motion
from fsi.bodies.forces import external_forces, moment_of_forces
from fsi.case.body_file import with_bodies
from fsi.case.checks.sound import check_case
from fsi.case.domains import Domain
from fsi.case.force_laws import Force
from fsi.case.overrides import override
from fsi.case.reduced import Reduced
from fsi.case.section import Section, explain, toml_text, tuples
from fsi.case.sections import Body, Calibration, Discretisation, Expected, Fluid, Output, Sweep, Time
from fsi.case.series import kinks, value_at
from fsi.case.walls import WallVelocity
from fsi.errors import InputError
from fsi.geometry import BODIES, GEOMETRY, Geometry, dimension_of
from fsi.meshes.geometry.containers import Container


def _rows(value: Any) -> Any:
    """A single table [expected] is one row, an empty one none."""
    return tuple([value] if value else []) if isinstance(value, dict) else value


class Case(Section):
    """One problem: fluid, domain, bodies, and how to compute it."""

    name: str = Field(min_length=1, description="a few words that name the case")
    geometry: Geometry = Field(default="planar", description='"planar", "axisymmetric" or "spatial"')
    model: Literal["resolved", "reduced"] = Field(default="resolved", description='"resolved" or "reduced"')
    fluid: Fluid = Field(description="a section [fluid] with its viscosity")
    domain: Domain = Field(description='a section [domain] of shape "box", "half-plane" or "round"')
    bodies: tuple[Body, ...] = Field(default=(), description="one section [[bodies]] for each body")
    # The next two are None in a sound case: what they give is in `bodies`, so that a case stands alone.
    bodies_from: str | None = Field(
        default=None,
        description="the path of a .json or .csv file of bodies, seen from the case file's folder",
    )
    body_defaults: dict[str, Any] | None = Field(
        default=None, description="a section [body_defaults] with keys of [[bodies]] for all that lack them"
    )
    forces: tuple[Force, ...] = Field(
        default=(), description="one section [[forces]] for gravity and each law of force between bodies"
    )
    discretisation: Discretisation = Field(
        default_factory=Discretisation, description="a section [discretisation]"
    )
    reduced: Reduced = Field(default_factory=Reduced, description="a section [reduced]")
    time: Time | None = Field(default=None, description="a section [time] with its end")
    output: Output = Field(default_factory=Output, description="a section [output]")
    expected: Annotated[tuple[Expected, ...], BeforeValidator(_rows)] = Field(
        default=(), description="one section [[expected]] for each number"
    )
    sweep: Sweep | None = Field(
        default=None, description="a section [sweep] with key and values, for `fsi validate`"
    )

    calibration: Calibration | None = Field(
        default=None, description="a section [calibration] with pair and range, for `fsi calibrate`"
    )

    @model_validator(mode="before")
    @classmethod
    def _tell_the_sections(cls, data: Any) -> Any:
        """Walls, vectors and sizes of the mesh depend on the geometry, the sizes on the number of bodies."""
        if not isinstance(data, dict):
            return data
        told = {GEOMETRY: data["geometry"]} if data.get("geometry") in ("axisymmetric", "spatial") else {}
        sections, bodies = dict(data), data.get("bodies")
        if isinstance(data.get("domain"), dict):
            sections["domain"] = data["domain"] | told
        given = data.get("discretisation", {})
        if isinstance(given, dict):
            number = len(bodies) if isinstance(bodies, tuple | list) else 0
            sections["discretisation"] = given | told | {BODIES: number}
        if isinstance(bodies, tuple):
            sections["bodies"] = tuple(b | told if isinstance(b, dict) else b for b in bodies)
        return sections

    @model_validator(mode="before")
    @classmethod
    def _list_the_bodies(cls, data: Any) -> Any:
        """Those of a file stand after those of the case itself."""
        return with_bodies(data, tuple(Body.model_fields)) if isinstance(data, dict) else data

    @model_validator(mode="after")
    def _sound(self) -> Case:
        check_case(self)
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies, in the order of every array over bodies."""
        return tuple(body.name for body in self.bodies)

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
        found = np.ones(len(MODES[self.dimension]), dtype=bool)
        return np.array([False, True, False]) if self.axisymmetric else found

    @property
    def drag(self) -> float:
        """The drag of a lone body in the reduced model, over mu V, for spheres over mu a V."""
        if self.reduced.drag is not None:
            return self.reduced.drag
        if not self.spheres:
            raise InputError(
                "reduced.drag: missing; give the drag of a disc over mu V, some 10: a lone disc in unbounded "
                "fluid has none (Stokes's paradox)"
            )
        return 6.0 * np.pi

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
        return Configuration(q.centres, angles.reshape(q.angles.shape), q.radii)

    def motion(self, t: float) -> Motion:
        """What holds the bodies, and their own loads, at time t; `forces` are not in it."""
        held = np.array(
            [[part != "free" for part in body.motion] for body in self.bodies], dtype=bool
        ).reshape(-1, len(self.modes))
        U = self._modes(lambda body: [0.0 if part == "free" else value_at(part, t) for part in body.motion])
        F = self._modes(lambda body: [value_at(part, t) for part in body.loads])
        held |= ~self.modes
        return Motion(held, U, F)

    def motion_at(self, q: Configuration, t: float) -> Motion:
        """What holds and drives the bodies at q and time t, with the `forces` on free components."""
        return self.with_forces(self.motion(t), q, t)

    def with_forces(self, own: Motion, q: Configuration, t: float) -> Motion:
        """The motion at time t with the `forces` at q on its free components."""
        if not self.forces:
            return own
        masses = np.array([body.mass or 0.0 for body in self.bodies])
        spheres = self.geometry != "planar"
        F = np.zeros_like(own.F)
        F[:, : self.dimension] = external_forces(self.forces, q, self.container().at(t), masses, spheres)
        return Motion(own.held, own.U, own.F + np.where(own.held, 0.0, F))

    def interaction_moment(self, q: Configuration, t: float) -> Array:
        """Sum of r (x) F of the `forces` between bodies, and bodies and walls, at q and time t, (d, d)."""
        return moment_of_forces(self.forces, q, self.container().at(t))

    def masses(self) -> Array | None:
        """m or I of each mode, 0 for bodies without, shape (N, M); None when no body has inertia."""
        if all(body.mass is None for body in self.bodies):
            return None
        d, M = self.dimension, len(self.modes)
        return self._modes(lambda body: d * [body.mass or 0.0] + (M - d) * [body.moment_of_inertia or 0.0])

    def _modes(self, values: Callable[[Body], Sequence[float]]) -> Array:
        return np.array([values(body) for body in self.bodies], dtype=float).reshape(-1, len(self.modes))

    def wall_velocity(self, t: float) -> dict[str, WallVelocity]:
        """The velocity at time t on the walls where it is given."""
        found = {name: wall.velocity(t, self.dimension) for name, wall in self.domain.walls.items()}
        return {name: velocity for name, velocity in found.items() if velocity is not None}

    def wall_pressure(self) -> dict[str, float]:
        """The outside pressure on the open walls."""
        found = {name: wall.outside_pressure for name, wall in self.domain.walls.items()}
        return {name: pressure for name, pressure in found.items() if pressure is not None}

    def knots(self) -> tuple[float, ...]:
        """The times at which a table has a kink, increasing."""
        times = {time for body in self.bodies for part in (*body.motion, *body.loads) for time in kinks(part)}
        return tuple(sorted(times.union(*(wall.kinks() for wall in self.domain.walls.values()))))

    def as_toml(self) -> str:
        """The case with every default filled in; reads back as an equal Case."""
        return tomli_w.dumps(self.model_dump(exclude_none=True))


def load_case(path: Path, overrides: Sequence[str] = ()) -> Case:
    """Read a case file.

    Args:
        path: the TOML file.
        overrides: `key=value` with a dotted key (`bodies.0.radius=2`) and a TOML value, applied in order.

    Raises:
        InputError: the file cannot be read or the case is not sound; nothing has been written.
    """
    data = read_toml(path)
    if not data:
        raise InputError(f"{path}: the case is empty; give at least name, [fluid] and [domain]")
    _check_model(path, data.get("model"))
    for text in overrides:
        override(data, text)
    for section, keys in _PATHS.items():
        _resolve(data.get(section), keys, path.parent)
    if isinstance(data.get("bodies_from"), str):
        data["bodies_from"] = str((path.parent / data["bodies_from"]).resolve())
    return parse_case(data)


# Models whose cases have other keys (`fsi.evolutions`), and what takes them.
_WITHOUT_FLUID = {"gluey": "fsi run", "macroscopic": "fsi run", "limit": "fsi limit"}


def _check_model(path: Path, model: Any) -> None:
    """Raise InputError if the case is of another kind, whose keys are others."""
    if not isinstance(model, str) or model in ("resolved", "reduced"):
        return
    if model in _WITHOUT_FLUID:
        raise InputError(f'{path}: model = "{model}": has no fluid to look at; use `{_WITHOUT_FLUID[model]}`')
    choices = '"resolved", "reduced", "gluey", "macroscopic" or "limit"'
    raise InputError(f"{path}: model = {toml_text(model)}: there is no such model; give {choices}")


# Keys that are paths of files, seen from the folder of the case; words without a suffix are none.
_PATHS = {"domain": ("mesh",), "reduced": ("law", "wall_law")}


def _resolve(section: Any, keys: Sequence[str], folder: Path) -> None:
    """Make the paths of files in a section absolute, in place."""
    for key in keys if isinstance(section, dict) else ():
        value = section.get(key)
        if isinstance(value, str) and (key == "mesh" or Path(value).suffix):
            section[key] = str((folder / value).resolve())


def parse_case(data: Mapping[str, Any]) -> Case:
    """The case that nested dictionaries, lists and numbers describe. Raises InputError."""
    try:
        return Case.model_validate(tuples(data))
    except ValidationError as error:
        raise InputError(explain(error, Case)) from None


def read_toml(path: Path) -> dict[str, Any]:
    """The data of a case file. Raises InputError."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not TOML: {error}; correct the file there") from None
    except OSError as error:
        raise InputError(
            f"{path}: {error.strerror or error}; give the path of a case file, `fsi cases` writes some"
        ) from None
