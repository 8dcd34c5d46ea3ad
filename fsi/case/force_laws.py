"""The section [[forces]] of a case: gravity, and attraction or repulsion as a law of the gap."""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from fsi.bodies.configuration import Array
from fsi.case.section import Section, nearest_word
from fsi.case.series import Series

_KINDS = '"gravity", "attraction" or "repulsion"'
_LAWS = '"exponential", "power" or "table"'


class Gravity(Section):
    """A weight: `F = m g`, or `F = (difference of densities) V g`, V the area of a disc or volume of a ball.

    With masses the buoyancy is not taken off.
    """

    kind: Literal["gravity"] = Field(description=_KINDS)
    acceleration: tuple[Series, ...] = Field(
        description="the acceleration g, [g_x, g_y] or [g_x, g_y, g_z], each a number or a table in time"
    )
    density_difference: float | None = Field(
        default=None,
        description="the density of bodies less that of the fluid; their masses act if not given",
    )


class _BetweenBodies(Section, ABC):
    """A force along the line of centres, on each of two bodies, that depends on their gap d."""

    kind: Literal["attraction", "repulsion"] = Field(description=_KINDS)
    walls: bool = Field(default=False, description="true for the same force between bodies and walls")

    @property
    @abstractmethod
    def reach(self) -> float:
        """The gap beyond which there is no force."""

    @abstractmethod
    def strength_at(self, d: Array) -> Array:
        """|F| at gaps d up to the reach."""

    def repulsion(self, d: Array) -> Array:
        """f(d): the force that pushes apart, negative for attraction; zero beyond the reach."""
        sign = 1.0 if self.kind == "repulsion" else -1.0
        return np.where(d <= self.reach, sign * self.strength_at(np.minimum(d, self.reach)), 0.0)


class _CutOff(_BetweenBodies):
    """A force that would never end."""

    law: Literal["exponential", "power"] = Field(description=_LAWS)
    cutoff: float = Field(gt=0.0, description="the gap beyond which there is no force, a number > 0")

    @property
    def reach(self) -> float:
        """The cut-off."""
        return self.cutoff


class Exponential(_CutOff):
    """|F| = strength exp(-d / length), a screened force."""

    law: Literal["exponential"] = Field(description=_LAWS)
    strength: float = Field(gt=0.0, description="the force at contact, a number > 0")
    length: float = Field(gt=0.0, description="the gap over which the force falls by e, a number > 0")

    def strength_at(self, d: Array) -> Array:
        """Strength exp(-d / length)."""
        return self.strength * np.exp(-d / self.length)


class Power(_CutOff):
    """|F| = strength (length / d)^exponent."""

    law: Literal["power"] = Field(description=_LAWS)
    strength: float = Field(gt=0.0, description="the force at the gap `length`, a number > 0")
    length: float = Field(gt=0.0, description="the gap at which the force is `strength`, a number > 0")
    exponent: float = Field(gt=0.0, description="the power of 1/d with which the force falls, a number > 0")

    def strength_at(self, d: Array) -> Array:
        """Strength (length / d)^exponent."""
        power: Array = self.strength * (self.length / d) ** self.exponent
        return power


class Tabulated(_BetweenBodies):
    """|F| linear between given gaps, constant below the first and zero beyond the last."""

    law: Literal["table"] = Field(description=_LAWS)
    gaps: tuple[float, ...] = Field(min_length=1, description="gaps, increasing")
    values: tuple[float, ...] = Field(
        description="one force for each gap; negative ones turn the force round"
    )

    @field_validator("gaps")
    @classmethod
    def _increasing(cls, gaps: tuple[float, ...]) -> tuple[float, ...]:
        for before, after in itertools.pairwise(gaps):
            if not before < after:
                raise ValueError(f"must increase, but {after!r} follows {before!r}")
        return gaps

    @model_validator(mode="after")
    def _paired(self) -> Tabulated:
        if len(self.gaps) != len(self.values):
            raise ValueError(f"has {len(self.gaps)} gaps but {len(self.values)} values")
        return self

    @property
    def reach(self) -> float:
        """The last gap of the table."""
        return self.gaps[-1]

    def strength_at(self, d: Array) -> Array:
        """Linear interpolation."""
        return np.interp(d, self.gaps, self.values)


def _force_kind(value: Any) -> str:
    """Gravity, or the law; for a misspelt one the nearest, which then refuses its name."""
    if not isinstance(value, dict):
        return "<gravity>" if isinstance(value, Gravity) else f"<{getattr(value, 'law', 'gravity')}>"
    if value.get("kind") == "gravity" or ("law" not in value and "acceleration" in value):
        return "<gravity>"
    return f"<{nearest_word(str(value.get('law', 'exponential')), ('exponential', 'power', 'table'))}>"


PairForce = Exponential | Power | Tabulated
Force = Annotated[
    Annotated[Gravity, Tag("<gravity>")]
    | Annotated[Exponential, Tag("<exponential>")]
    | Annotated[Power, Tag("<power>")]
    | Annotated[Tabulated, Tag("<table>")],
    Discriminator(_force_kind),
]
