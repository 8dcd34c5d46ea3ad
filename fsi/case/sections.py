"""The sections of a case file below the top: fluid, bodies, discretisation, time, output, calibration."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from pydantic import Field, field_validator, model_validator

from fsi.case.section import Section
from fsi.case.series import Angle, Component, Series, Spin, Torque
from fsi.geometry import Geometry, dimension_of, require_components

FREE: Literal["free"] = "free"
_LOAD = "a number or a table {times = [...], values = [...]}"
_MOTION = f'"free", {_LOAD}'


class Fluid(Section):
    """The fluid."""

    viscosity: float = Field(gt=0.0, description="the dynamic viscosity mu, a number > 0")


class Body(Section):
    """A rigid disc or sphere: where it starts, what moves it, what it weighs.

    In space what turns (angle, angular_velocity, torque) is a vector of three.
    """

    geometry: Geometry = Field(default="planar", alias="<geometry>", exclude=True)

    name: str = Field(pattern=r"^\w[\w -]*$", description="a name of letters, digits, blanks, - and _")
    radius: float = Field(gt=0.0, description="the radius, a number > 0")
    position: tuple[float, ...] = Field(
        description="the centre [x, y] (in space [x, y, z]) at time 0, finite numbers"
    )
    angle: Angle = Field(
        default_factory=lambda known: _turning(known, 0.0),
        description="the angle at time 0 in radians (in space a rotation vector)",
    )
    velocity: tuple[Component, ...] = Field(
        default_factory=lambda known: (FREE,) * _dimension(known),
        description=f"two components (in space three), each {_MOTION}",
    )
    angular_velocity: Spin = Field(
        default_factory=lambda known: _turning(known, FREE), description=f"(in space three times) {_MOTION}"
    )
    force: tuple[Series, ...] = Field(
        default_factory=lambda known: (0.0,) * _dimension(known),
        description=f"two components (in space three), each {_LOAD}",
    )
    torque: Torque = Field(
        default_factory=lambda known: _turning(known, 0.0), description=f"(in space three times) {_LOAD}"
    )
    mass: float | None = Field(
        default=None, gt=0.0, description="the mass per unit length, a number > 0, or none"
    )
    moment_of_inertia: float | None = Field(
        default=None, gt=0.0, description="the moment of inertia per unit length, a number > 0, or none"
    )

    @field_validator("position", "velocity", "force")
    @classmethod
    def _all_components[T](cls, vector: tuple[T, ...], info: Any) -> tuple[T, ...]:
        return require_components(vector, dimension_of(info.data["geometry"]), "a vector")

    @field_validator("angle", "angular_velocity", "torque")
    @classmethod
    def _turns_in_its_dimension(cls, turning: Any, info: Any) -> Any:
        spatial, vector = info.data["geometry"] == "spatial", isinstance(turning, tuple)
        if spatial and vector:
            return require_components(turning, 3, "a vector")
        if spatial != vector:
            raise ValueError("must be a vector of three in space" if spatial else "must not be a vector")
        return turning

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
    def keys(self) -> tuple[str, ...]:
        """The keys of the loads on each mode: `force.0`, ..., `torque` (in space `torque.2`), (M,)."""
        turning = ["torque"] if self.geometry != "spatial" else [f"torque.{k}" for k in range(3)]
        return (*(f"force.{k}" for k in range(len(self.force))), *turning)


def _dimension(known: dict[str, Any]) -> int:
    return dimension_of(known.get("geometry", "planar"))


class _Sizes(NamedTuple):
    """What the mesh is like unless the case says otherwise."""

    cells_per_gap: float
    cells_per_circle: int
    growth: float


# Errors of the forces and of the apparent viscosity: 1e-5 or less, 5e-5, and in space 2e-3.
_FEW, _MANY, _SPATIAL = _Sizes(1.0, 48, 0.2), _Sizes(0.5, 24, 0.5), _Sizes(0.8, 14, 0.5)
MOST_FEW = 20


def _sizes(known: dict[str, Any]) -> _Sizes:
    if known.get("geometry") == "spatial":
        return _SPATIAL
    return _MANY if known.get("bodies", 0) > MOST_FEW else _FEW


def _turning[T](known: dict[str, Any], value: T) -> T | tuple[T, ...]:
    return (value,) * 3 if known.get("geometry") == "spatial" else value


class Discretisation(Section):
    """The mesh and the finite elements; with many bodies and in space, a coarser mesh by default."""

    geometry: Geometry = Field(default="planar", alias="<geometry>", exclude=True)
    bodies: int = Field(default=0, alias="<bodies>", exclude=True)
    degree: int = Field(default=3, ge=2, le=4, description="the degree of the velocity, 2, 3 or 4")
    cells_per_gap: float = Field(
        default_factory=lambda known: _sizes(known).cells_per_gap,
        gt=0.0,
        description="the number of cells across a gap of 0.012 radii, a number > 0",
    )
    cells_per_circle: int = Field(
        default_factory=lambda known: _sizes(known).cells_per_circle,
        ge=6,
        description="the number of cells around a lone body, at least 6",
    )
    growth: float = Field(
        default_factory=lambda known: _sizes(known).growth,
        gt=0.0,
        le=1.0,
        description="the cell size over the distance to the nearest body, in (0, 1]",
    )
    interior: Literal["graded", "sparse"] = Field(
        default="graded", description='"graded" or, in the plane, "sparse"'
    )
    tolerance: float | None = Field(
        default=None,
        gt=0.0,
        lt=1.0,
        description="the estimated relative error below which the mesh is refined, in (0, 1), or none",
    )
    formulation: Literal["eliminated", "multiplier"] = Field(
        default="eliminated", description='"eliminated" or "multiplier"'
    )
    solver: Literal["automatic", "direct", "iterative"] = Field(
        default="automatic", description='"automatic", "direct" or, in space, "iterative"'
    )


class Time(Section):
    """How the motion is stepped."""

    end: float = Field(gt=0.0, description="the time at which the run ends, a number > 0")
    first_step: float | None = Field(default=None, gt=0.0, description="the first step to try, a number > 0")
    smallest_step: float = Field(
        default_factory=lambda known: 1e-9 * known.get("end", 1.0),
        gt=0.0,
        description="the step below which the run stops, a number > 0 (1e-9 of `end` if not given)",
    )
    tolerance: float = Field(
        default=1e-4, gt=0.0, lt=1.0, description="the error of a step over the gap, in (0, 1)"
    )
    gap_loss: float = Field(
        default=0.2, gt=0.0, lt=1.0, description="the part of a gap that a step may close, in (0, 1)"
    )
    remesh: Literal["always", "when-needed"] = Field(
        default="always", description='"always" or "when-needed"'
    )


class Output(Section):
    """What a run writes."""

    interval: float | None = Field(
        default=None, gt=0.0, description="the time between field files, a number > 0"
    )
    fields: bool = Field(default=True, description="true to write field files, false for tables only")
    error_estimates: bool = Field(
        default=False, description="true to estimate the discretisation error of each step, false not to"
    )


class Calibration(Section):
    """For `fsi calibrate`: which resistance is sampled, at which gaps, and what becomes of it."""

    pair: tuple[str, str] = Field(
        description='two names, ["ball", "plane"]: a body, and a body or plane wall'
    )
    mode: Literal["squeeze", "shear", "rotation"] = Field(
        default="squeeze", description='"squeeze", or beside a wall also "shear" or "rotation"'
    )
    range: tuple[float, float] = Field(description="the smallest and the largest gap, increasing numbers > 0")
    samples: int = Field(
        default=20, ge=6, description="the number of gaps in the range, at least 6, equal in the logarithm"
    )
    held_out: int = Field(
        default=4, ge=0, description="the number of gaps between these that test the law, at least 0"
    )
    form: Literal["series", "table"] = Field(default="series", description='"series" or "table"')

    @field_validator("range")
    @classmethod
    def _increasing(cls, range: tuple[float, float]) -> tuple[float, float]:  # noqa: A002
        if not 0.0 < range[0] < range[1]:
            raise ValueError("is not a range of positive gaps")
        return range

    @model_validator(mode="after")
    def _between_samples(self) -> Calibration:
        if self.held_out >= self.samples:
            raise ValueError(f"has {self.samples} samples and as many between them at most one fewer")
        return self
