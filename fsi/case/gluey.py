"""The sections of a gluey case file: room, bodies, contact, steps, output."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from fsi.case.section import Section
from fsi.gluey.history import History
from fsi.gluey.system import Law

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
    counts: tuple[Annotated[int, Field(ge=1)], ...] = Field(
        min_length=2, max_length=3, description="how many in each direction, at least 1"
    )
    lower: Vector = Field(min_length=2, max_length=3, description="the centre of the first, a point")
    spacing: float = Field(gt=0.0, description="the distance between neighbours' centres, a number > 0")
    radius: tuple[Annotated[float, Field(gt=0.0)], Annotated[float, Field(gt=0.0)]] = Field(
        description="the smallest and the largest radius, two numbers > 0"
    )
    velocity: Vector | None = Field(default=None, description="their velocity at time 0, 0 if not given")
    jitter: float = Field(default=0.0, ge=0.0, description="the largest disturbance of a coordinate, >= 0")
    seed: int = Field(default=0, ge=0, description="of the random numbers, a whole number >= 0")

    @field_validator("radius")
    @classmethod
    def _in_order(cls, radius: tuple[float, float]) -> tuple[float, float]:
        if radius[0] > radius[1]:
            raise ValueError("has the largest before the smallest")
        return radius


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
