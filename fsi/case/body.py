"""The section [[bodies]] of a case file."""

from collections.abc import Callable
from functools import cached_property
from math import nan
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from fsi.case.section import (
    Geometry,
    Name,
    NotNegative,
    Positive,
    Section,
    all_components,
    require_components,
    told,
)
from fsi.case.series import Angle, Component, Series, Spin, Torque, kinks
from fsi.case.shapes.shape import Shape

if TYPE_CHECKING:
    from fsi.meshes.geometry.ellipsoid import Ellipsoid
    from fsi.meshes.geometry.outline import Outline
    from fsi.meshes.geometry.revolved import BodyOfRevolution

FREE: Literal["free"] = "free"
_LARGEST_ANGLE = 1e8  # radians: its neighbours among floating-point numbers are 1.5e-8 away
_LOAD = "a number or a table {times = [...], values = [...]}"
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
    """the mass (in the plane per unit length), a number > 0, or leave it out"""
    moment_of_inertia: Positive | None = Field(
        default=None,
        description="the moment of inertia (in the plane per unit length), a number > 0, or leave it out; "
        "of a shape with a mass that of a uniform body",
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

    @field_validator("angle")
    @classmethod
    def _has_a_direction(cls, angle: float | tuple[float, ...]) -> float | tuple[float, ...]:
        if np.abs(angle).max() > _LARGEST_ANGLE:
            known = f"is rounded too much beyond {_LARGEST_ANGLE:g} to tell a direction"
            raise ValueError(f"{known}; give it without its whole turns, 2 pi each")
        return angle

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
    def outline(self) -> "Outline":
        """Of a body of the plane."""
        if self.shape is None:
            from fsi.meshes.geometry.outline import Outline

            return Outline.disc(self.radius)
        return self.shape.outline

    @cached_property
    def revolved(self) -> "BodyOfRevolution":
        """Of a body on an axis."""
        assert isinstance(self.angle, float)  # it is none in space
        if self.shape is None:
            from fsi.meshes.geometry.revolved import BodyOfRevolution

            return BodyOfRevolution.sphere(self.radius, self.angle)
        return self.shape.revolved(self.angle)

    @property
    def ellipsoid(self) -> "Ellipsoid":
        """Of a body in space."""
        if self.shape is None:
            from fsi.meshes.geometry.ellipsoid import Ellipsoid

            return Ellipsoid(np.full(3, self.radius))
        return self.shape.ellipsoid

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
    def masses(self) -> tuple[float, ...]:
        """m or I of each mode, (M,); 0 of a body without."""
        mass, moment = self.inertia or (0.0, 0.0)
        turning = len(self.motion) - len(self.velocity)
        return len(self.velocity) * (mass,) + turning * (moment,)

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

    def kinks(self) -> set[float]:
        """The times at which what is prescribed or a load has a kink."""
        return {time for part in (*self.motion, *self.loads) for time in kinks(part)}

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
