"""The section [[bodies]] of a case file, and [[grids]], rows of like bodies."""

import itertools
import math
from collections.abc import Callable, Mapping
from functools import cached_property
from math import nan
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from fsi.bodies.configuration import Array
from fsi.case.complaints import explain
from fsi.case.section import (
    Geometry,
    Name,
    NotNegative,
    Positive,
    Section,
    all_components,
    require_components,
    told,
    toml_text,
    tuples,
)
from fsi.case.series import Angle, Component, Series, Spin, Torque
from fsi.case.shapes.shape import Shape
from fsi.errors import InputError
from fsi.machine.resources import require_memory
from fsi.meshes.geometry.ellipsoid import Ellipsoid
from fsi.meshes.geometry.outline import Outline

if TYPE_CHECKING:
    from fsi.meshes.geometry.revolved import BodyOfRevolution

FREE: Literal["free"] = "free"
_LOAD = "a number or a table {times = [...], values = [...]}"
_TOUCHING = 1e-9  # of the smallest radius: an overlap by less is rounding
_BYTES = 4000.0  # of a body of a case: measured 3 kB
_MOTION = f'"free", {_LOAD}'


class Body(Section):
    """A rigid disc or sphere: where it starts, what moves it, what it weighs.

    In space what turns (angle, angular_velocity, torque) is a vector of three.
    """

    name: Name
    """a name of letters, digits, blanks, - and _, neither blank nor - first"""
    shape: Shape | None = None
    """the shape of a body, a table with its kind; a disc or sphere if not given"""
    angle: Angle
    """the angle at time 0 in radians (in space a rotation vector), 0 if not given"""
    radius: Positive = Field(default=None, validate_default=True)
    """the radius, a number > 0, of all but a body with a shape"""
    position: tuple[float, ...]
    """the centre [x, y] (in space [x, y, z]) at time 0, finite numbers"""
    velocity: tuple[Component, ...] = Field(
        description=f"the prescribed velocity, two components (in space three), each {_MOTION}; free if not "
        f"given"
    )
    angular_velocity: Spin = Field(
        description=f"the prescribed angular velocity, (in space three times) {_MOTION}; free if not given"
    )
    initial_velocity: tuple[float, ...] | None = None
    """the velocity at time 0 of a body with a mass, two numbers (in space three); at rest if not given"""
    initial_angular_velocity: Angle | None = None
    """the angular velocity at time 0 of a body with a mass, a number (in space three); 0 if not given"""
    force: tuple[Series, ...] = Field(
        description=f"the external force, two components (in space three), each {_LOAD}; 0 if not given"
    )
    torque: Torque = Field(description=f"the external torque, (in space three times) {_LOAD}; 0 if not given")
    slip_length: NotNegative | None = None
    """the slip length of the surface, a number >= 0; 0, fluid sticks to it, if not given"""
    surface_velocity: tuple[float, ...] | None = None
    """the modes [B_1, B_2, ...] of the velocity along the surface of a swimmer; none if not given"""
    mass: Positive | None = None
    """the mass (in the plane per unit length), a number > 0, or none"""
    moment_of_inertia: Positive | None = Field(
        default=None,
        description="the moment of inertia (in the plane per unit length), a number > 0, or none; of a shape "
        "with a mass that of a uniform body",
    )

    @model_validator(mode="before")
    @classmethod
    def _as_many_components_as_the_case_has(cls, data: Any, info: ValidationInfo) -> Any:
        """What is not given is free and without a load, in the dimension of the case."""
        if not isinstance(data, dict):
            return data
        case = told(info)
        d = case.dimension
        turning = (lambda value: (value,) * 3) if case.geometry == "spatial" else (lambda value: value)
        return {
            "angle": turning(0.0),
            "velocity": (FREE,) * d,
            "angular_velocity": turning(FREE),
            "force": (0.0,) * d,
            "torque": turning(0.0),
        } | data

    _all_components = field_validator("position", "velocity", "force", "initial_velocity")(all_components)

    @field_validator("angle", "angular_velocity", "torque", "initial_angular_velocity")
    @classmethod
    def _turns_in_its_dimension(cls, turning: Any, info: ValidationInfo) -> Any:
        if turning is None:
            return None
        spatial, vector = told(info).geometry == "spatial", isinstance(turning, tuple)
        if spatial and vector:
            return require_components(turning, 3, "a vector")
        if spatial != vector:
            raise ValueError("must be a vector of three in space" if spatial else "must not be a vector")
        return turning

    @field_validator("radius", mode="before")
    @classmethod
    def _by_the_shape(cls, radius: Any, info: ValidationInfo) -> Any:
        """Of a body with a shape that of the smallest circle around its centre that holds it."""
        if info.data.get("shape") is not None:
            if radius is not None:
                raise ValueError("the shape says how large the body is; drop one of them")
            shape, angle = info.data["shape"], info.data.get("angle", 0.0)
            forms: dict[Geometry, Callable[[], Outline | Ellipsoid]] = {
                "planar": lambda: shape.outline,
                "axisymmetric": lambda: shape.revolved(angle),
                "spatial": lambda: shape.ellipsoid,
            }
            return forms[told(info).geometry]().radius
        if radius is None and "shape" in info.data:
            raise PydanticCustomError("missing", "missing")
        return 1.0 if radius is None else radius  # the shape is refused already

    @model_serializer(mode="wrap")
    def _as_given(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """A shape stands without the radius that follows from it."""
        data: dict[str, Any] = dump(self)
        return {key: value for key, value in data.items() if key != "radius" or self.shape is None}

    @property
    def outline(self) -> Outline:
        """Of a body of the plane."""
        return Outline.disc(self.radius) if self.shape is None else self.shape.outline

    @cached_property
    def revolved(self) -> "BodyOfRevolution":
        """Of a body on an axis."""
        if self.shape is None:
            from fsi.meshes.geometry.revolved import BodyOfRevolution

            return BodyOfRevolution.sphere(self.radius)
        assert isinstance(self.angle, float)  # it is none in space
        return self.shape.revolved(self.angle)

    @property
    def ellipsoid(self) -> Ellipsoid:
        """Of a body in space."""
        return Ellipsoid(np.full(3, self.radius)) if self.shape is None else self.shape.ellipsoid

    @property
    def half_axes(self) -> tuple[float, float, float]:
        """Of an ellipsoid along x, y and z, of a spheroid on an axis with that last; NaN of other bodies."""
        if self.shape is None:
            return (self.radius,) * 3
        return (nan,) * 3 if np.any(self.angle) else self.shape.half_axes

    @property
    def inertia(self) -> tuple[float, float] | None:
        """Mass and moment of inertia; None without."""
        if self.mass is None:
            return None
        moment = self.moment_of_inertia
        if self.shape is not None and moment is None:
            moment = self.mass * self.shape.outline.second_moment / self.shape.outline.area
        return self.mass, moment or 0.0

    @property
    def swims(self) -> bool:
        """Whether its surface moves along itself."""
        return any(self.surface_velocity or ())

    @property
    def motion(self) -> tuple[Component, ...]:
        """What is prescribed for each mode, (M,)."""
        turning = self.angular_velocity
        return (*self.velocity, *(turning if isinstance(turning, tuple) else (turning,)))

    @property
    def loads(self) -> tuple[Series, ...]:
        """The external load on each mode, (M,)."""
        turning = self.torque
        return (*self.force, *(turning if isinstance(turning, tuple) else (turning,)))

    @property
    def initial_motion(self) -> tuple[float, ...]:
        """The velocity of each mode at time 0, (M,); 0 where none is given."""
        turning = self.initial_angular_velocity or (0.0,) * (len(self.motion) - len(self.velocity))
        velocity = self.initial_velocity or (0.0,) * len(self.velocity)
        return (*velocity, *(turning if isinstance(turning, tuple) else (turning,)))

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the loads on each mode: `force.0`, ..., `torque` (in space `torque.2`), (M,)."""
        turning = [f"torque.{k}" for k in range(3)] if isinstance(self.torque, tuple) else ["torque"]
        return (*(f"force.{k}" for k in range(len(self.force))), *turning)


class Grid(Section):
    """Rows of like bodies, a little disturbed; the case holds them one by one, named `NAME k` from 0."""

    name: Name
    """a name of letters, digits, blanks, - and _, neither blank nor - first"""
    counts: tuple[Annotated[int, Field(ge=1)], ...] = Field(min_length=2, max_length=3)
    """how many in each direction, at least 1"""
    lower: tuple[float, ...]
    """the centre of the first, a point"""
    spacing: Positive
    """the distance between neighbours' centres, a number > 0"""
    radius: tuple[Positive, Positive]
    """the smallest and the largest radius, two numbers > 0"""
    jitter: NotNegative = 0.0
    """the largest disturbance of a coordinate, >= 0"""
    seed: int = Field(default=0, ge=0)
    """of the random numbers, a whole number >= 0"""
    initial_velocity: tuple[float, ...] | None = None
    """their velocity at time 0, as in [[bodies]]; at rest if not given"""

    _all_components = field_validator("counts", "lower", "initial_velocity")(all_components)

    @field_validator("radius")
    @classmethod
    def _in_order(cls, radius: tuple[float, float]) -> tuple[float, float]:
        if radius[0] > radius[1]:
            raise ValueError("has the largest before the smallest")
        return radius

    def bodies(self, here: str) -> list[dict[str, Any]]:
        """Its members as entries of [[bodies]], the last coordinate running first; here: the grid's key.

        Raises InputError: neighbours in a row overlap.
        """
        random = np.random.default_rng(self.seed)
        places = np.array(list(itertools.product(*map(range, self.counts))), dtype=float)
        disturbance = random.uniform(-self.jitter, self.jitter, places.shape)
        centres = np.array(self.lower) + self.spacing * places + disturbance
        radii = random.uniform(*self.radius, len(places))
        self._require_room(here, centres, radii)
        moving = {} if self.initial_velocity is None else {"initial_velocity": self.initial_velocity}
        return [
            {"name": f"{self.name} {k}", "radius": float(a), "position": tuple(x.tolist())} | moving
            for k, (x, a) in enumerate(zip(centres, radii, strict=True))
        ]

    def _require_room(self, here: str, centres: Array, radii: Array) -> None:
        """Neighbours may touch; whatever else overlaps, and where they may not, the whole case tells."""
        x, a = centres.reshape(*self.counts, -1), radii.reshape(self.counts)
        for axis in range(a.ndim):
            x_along, a_along = np.moveaxis(x, axis, 0), np.moveaxis(a, axis, 0)
            with np.errstate(over="ignore", invalid="ignore"):  # of what is too large the schema tells
                gaps = np.linalg.norm(np.diff(x_along, axis=0), axis=-1) - a_along[1:] - a_along[:-1]
            if (least := gaps.min(initial=0.0)) < -_TOUCHING * self.radius[0]:
                raise InputError(
                    f"{here}.spacing = {self.spacing}: neighbours overlap by {-least:.3g}; widen it, or "
                    "lower radius or jitter"
                )


def with_grids(data: Mapping[str, Any], context: object) -> dict[str, Any]:
    """The data of a case with the members of its [[grids]] after its bodies. Raises InputError."""
    grids, bodies = data.get("grids", ()), data.get("bodies", ())
    if not (isinstance(grids, list | tuple) and isinstance(bodies, list | tuple)):
        return dict(data)  # the schema says what is wrong
    members: list[dict[str, Any]] = []
    names: set[str] = set()
    for i, grid in enumerate(grids):
        try:
            sound = Grid.model_validate(tuples(grid), context=context)
        except ValidationError as error:
            raise InputError(f"grids.{i}.{explain(error, Grid, grid)}") from None
        if sound.name in names:
            raise InputError(f'grids.{i}.name = "{sound.name}": given twice; give each its own')
        names.add(sound.name)
        count = math.prod(sound.counts)
        what = f"grids.{i}.counts = {toml_text(sound.counts)}: makes {count:.3g} bodies"
        require_memory(what, count * _BYTES, "give fewer")
        members += sound.bodies(f"grids.{i}")
    rest = {key: value for key, value in data.items() if key != "grids"}
    return rest | {"bodies": (*bodies, *members)} if members else rest
