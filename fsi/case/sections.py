"""The sections of a case file below the top, but for domain, bodies, forces and the models without fluid."""

from collections.abc import Collection
from typing import Any, Literal, NamedTuple, Self, get_args, override

from pydantic import Field, ValidationInfo, field_validator, model_validator

from fsi.case.quantities import is_quantity, names_of_quantities
from fsi.case.section import CaseContext, Fraction, Positive, Section, Text, nearest_word, told


class Fluid(Section):
    """The fluid."""

    viscosity: Positive
    """the dynamic viscosity mu, a number > 0"""


type Interior = Literal["graded", "sparse"]


class _Sizes(NamedTuple):
    """What the mesh is like unless the case says otherwise."""

    cells_per_gap: float
    cells_per_circle: int
    growth: float
    degree: int = 3
    interior: Interior = "graded"


# Errors of the forces and of the apparent viscosity: 1e-5 or less, 5e-5, and in space 2e-3. In the plane and
# with an axis quartic elements have a third to three quarters of the unknowns of cubic ones on a mesh that
# errs as little; the two meshes do not mix, so that who names one size gets the others of the cubic one.
_FEW, _MANY = _Sizes(0.45, 32, 0.33, 4), _Sizes(0.3, 20, 0.3, 4, "sparse")
_FEW_CUBIC, _MANY_CUBIC, _SPATIAL = _Sizes(1.0, 48, 0.2), _Sizes(0.5, 24, 0.5), _Sizes(0.75, 16, 0.5)
MOST_FEW = 20
NARROWEST_RANGE = 1.01  # of a calibration, its ends over each other
HIGHEST_DEGREE = {2: 6, 3: 4}  # by the dimension of the mesh


def _sizes(case: CaseContext, named: Collection[str]) -> _Sizes:
    if case.geometry == "spatial":
        return _SPATIAL
    quartic, cubic = (_FEW, _FEW_CUBIC) if case.bodies <= MOST_FEW else (_MANY, _MANY_CUBIC)
    return quartic if set(_Sizes._fields).isdisjoint(named) else cubic


class Discretisation(Section):
    """The mesh and the finite elements; with many bodies and in space, others by default."""

    degree: int = Field(ge=2, le=max(HIGHEST_DEGREE.values()))
    """the degree of the velocity, 2 to 6, in space 2 to 4; by the case if not given"""
    cells_per_gap: Positive
    """the number of cells across a gap of 0.012 radii, a number > 0; by the case if not given"""
    cells_per_circle: int = Field(ge=6)
    """the number of cells around a lone body, at least 6; by the case if not given"""
    growth: float = Field(gt=0.0, le=1.0)
    """the cell size over the distance to the nearest body, in (0, 1]; by the case if not given"""
    interior: Interior
    '"graded" or, in the plane, "sparse"; by the case if not given'
    tolerance: Fraction | None = None
    """the estimated relative error below which the mesh is refined, in (0, 1), or leave it out"""
    formulation: Literal["eliminated", "multiplier"] = "eliminated"
    '"eliminated" or "multiplier"'
    solver: Literal["automatic", "direct", "iterative"] = "automatic"
    '"automatic", "direct" or, in space, "iterative"'

    @model_validator(mode="before")
    @classmethod
    def _as_fine_as_the_case_needs(cls, data: Any, info: ValidationInfo) -> Any:
        if not isinstance(data, dict):
            return data
        return _sizes(told(info), data)._asdict() | data


class Time(Section):
    """How the motion is stepped."""

    end: Positive
    """the time at which the run ends, a number > 0"""
    scheme: Text | None = None
    """the name of a time scheme; one that suits model and masses if not given"""
    step: Positive | None = Field(
        default=None,
        description="the length of a step, a number > 0, for models and schemes that do not choose their "
        'own: gluey, macroscopic, "distance", "backward-euler"',
    )
    first_step: Positive | None = None
    """the first step to try, a number > 0"""
    smallest_step: Positive = Field(default_factory=lambda known: 1e-9 * known.get("end", 1.0))
    """the step below which the run stops, a number > 0 (1e-9 of `end` if not given)"""
    tolerance: Fraction = 1e-4
    """the error of a step over the gap, in (0, 1)"""
    gap_loss: Fraction = 0.2
    """the part of a gap that a step may close, in (0, 1)"""
    contact_gap: Positive | None = None
    """the smallest gap, a number > 0, or leave it out: a run that comes to it ends, and says when there is
    contact"""
    remesh: Literal["always", "when-needed"] = "always"
    '"always" or "when-needed"'


class Output(Section):
    """What a run writes."""

    interval: Positive | None = None
    """the time between field files, and in gluey runs between rows of `bodies.csv`, a number > 0"""
    fields: bool = True
    """true to write field files, false for tables only"""
    error_estimates: bool = False
    """true to estimate the discretisation error of each step, false not to"""


class Calibration(Section):
    """For `fsi calibrate`: which resistance is sampled, at which gaps, and what becomes of it."""

    pair: tuple[str, str]
    """two names, ["ball", "plane"]: a body, and a body or plane wall, or in the plane any shapes"""
    mode: Literal["squeeze", "shear", "rotation"] = "squeeze"
    '"squeeze", "shear" or, of a body beside a wall or two equal ones, "rotation"'
    range: tuple[float, float]
    """the smallest and the largest gap, increasing numbers > 0, at least 1.01 times each other"""
    samples: int = Field(default=20, ge=6)
    """the number of gaps in the range, at least 6, equal in the logarithm"""
    held_out: int = Field(default=4, ge=0)
    """the number of gaps between these that test the law, at least 0, fewer than `samples`"""
    form: Literal["series", "table"] = "series"
    '"series" or "table"'

    @field_validator("range")
    @classmethod
    def _increasing(cls, range: tuple[float, float]) -> tuple[float, float]:  # noqa: A002
        if not 0.0 < range[0] < range[1]:
            raise ValueError("is not a range of positive gaps")
        if range[1] < NARROWEST_RANGE * range[0]:
            raise ValueError(
                f"tells no terms apart; give an upper end {NARROWEST_RANGE} times the lower, or more"
            )
        return range

    @field_validator("held_out")
    @classmethod
    def _between_samples(cls, held_out: int, info: ValidationInfo) -> int:
        if held_out >= (samples := info.data.get("samples", held_out + 1)):
            raise ValueError(f"there are {samples - 1} gaps between {samples} samples")
        return held_out


class PoreResolution(Section):
    """The model of pores: how finely the stream function is resolved."""

    modes: Literal[0, 1, 2, 4, 6, 8, 10, 12, 16] = 1
    """the number of modes an edge, 0, 1, 2, 4, 6, 8, 10, 12 or 16"""
    tolerance: Fraction | None = None
    """the estimated relative error down to which modes are added, in (0, 1), or leave it out"""

    @field_validator("modes", mode="before")
    @classmethod
    def _number(cls, modes: Any) -> Any:
        if isinstance(modes, bool):  # which are 0 and 1 to Python
            raise ValueError("is no number; give one")
        return modes


EDGE_MODES: tuple[int, ...] = get_args(PoreResolution.model_fields["modes"].annotation)


class Lubrication(Section):
    """Laws in place of cells in the narrowest gaps of the resolved model."""

    below: Positive | None = None
    """the gap below which the mesh has this one and the exact laws add the rest, a length > 0, or leave it
    out"""


class Expected(Section):
    """A number that the case must give: a value, or the name of an entry of `fsi.lubrication.exact_results`.

    quantity: a number of the flow, like the `dissipation`, or of a body `disc.velocity.x`, `disc.force.y` (by
    the fluid on the body), `disc.angular_velocity`, `disc.torque`, at the end of a run `disc.position.y`; for
    a run also `time at gap 0.1`, the first time at which the smallest gap is 0.1. A value may be 0 of a
    load or velocity: its tolerance is then relative to the largest load, or velocity, of bodies or of what
    drives them; torques count over the radius, rotations times it.
    """

    quantity: str
    value: float | None = None
    """the expected number, or give `exact`"""
    exact: str | None = None
    rtol: Positive
    """the relative tolerance, a number > 0; of a value 0 relative to the largest load, or velocity"""
    source: Text
    """where the number comes from"""

    @field_validator("quantity")
    @classmethod
    def _is_one(cls, quantity: str) -> str:
        if not is_quantity(quantity):
            raise ValueError("no such number")
        return quantity

    @field_validator("exact")
    @classmethod
    def _known(cls, exact: str | None) -> str | None:
        if exact is not None:
            from fsi.lubrication.exact_results import EXACT

            if exact not in EXACT:
                raise ValueError(f"no such exact result; the nearest is {nearest_word(exact, EXACT)!r}")
        return exact

    @classmethod
    @override
    def describe(cls, key: str) -> str | None:
        if key == "quantity":
            return names_of_quantities()
        if key != "exact":
            return super().describe(key)
        from fsi.lubrication.exact_results import EXACT

        return f"one of {', '.join(EXACT)}, or give `value`"

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.value is None) == (self.exact is None):
            raise ValueError("needs either a value or the name of an exact result")
        return self


class Sweep(Section):
    """For `fsi validate`: the same case with one number changed, for each of several values."""

    key: str = Field(pattern=r"^[\w.-]+$")
    'the dotted key of a number, like "bodies.0.position.1"'
    values: tuple[float, ...] = Field(min_length=1)
    """the values of that key, at least one"""
