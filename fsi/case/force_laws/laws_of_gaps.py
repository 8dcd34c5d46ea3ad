"""Attraction and repulsion along lines of centres, as laws of the gap."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Literal, override

import numpy as np
from pydantic import Field, model_validator

from fsi.arrays import Array
from fsi.case.force_laws.law import KINDS, ForceSection, register_force
from fsi.case.section import Positive
from fsi.case.series import Increasing, require_pairs
from fsi.errors import InputError


class BetweenSurfaces(ForceSection):
    """A force along the line of centres, on each of two bodies, that depends on their gap d."""

    kind: Literal["attraction", "repulsion"] = Field(description=KINDS)
    law: str
    walls: bool = False
    """true for the same force between bodies and walls"""

    @property
    @override
    @abstractmethod
    def reach(self) -> float:
        """The gap beyond which there is no force."""

    @abstractmethod
    def strength_at(self, d: Array) -> Array:
        """|F| at gaps d up to the reach."""

    @override
    def repulsion(self, d: Array) -> Array:
        """f(d), zero beyond the reach."""
        sign = 1.0 if self.kind == "repulsion" else -1.0
        return np.where(d <= self.reach, sign * self.strength_at(np.minimum(d, self.reach)), 0.0)

    @override
    def wall_repulsion(self, d: Array) -> Array:
        """The same, if it acts from walls at all."""
        return self.repulsion(d) if self.walls else np.zeros_like(d)


class _CutOff(BetweenSurfaces):
    """A force that would never end."""

    reach_key: ClassVar[str] = "cutoff"
    cutoff: Positive
    """the gap beyond which there is no force, a number > 0"""

    @property
    @override
    def reach(self) -> float:
        return self.cutoff


@register_force
class Exponential(_CutOff):
    """|F| = strength exp(-d / length), a screened force."""

    law: Literal["exponential"]
    strength: Positive
    """the force at contact, a number > 0"""
    length: Positive
    """the gap over which the force falls by e, a number > 0"""

    @override
    def strength_at(self, d: Array) -> Array:
        return self.strength * np.exp(-d / self.length)


@register_force
class Power(_CutOff):
    """|F| = strength (length / d)^exponent."""

    law: Literal["power"]
    strength: Positive
    """the force at the gap `length`, a number > 0"""
    length: Positive
    """the gap at which the force is `strength`, a number > 0"""
    exponent: Positive
    """the power of 1/d with which the force falls, a number > 0"""

    @override
    def strength_at(self, d: Array) -> Array:
        power: Array = self.strength * (self.length / d) ** self.exponent
        return power

    @override
    def require_contact(self, key: str) -> None:
        raise InputError(
            f'{key}.law = "{self.law}": is infinite between bodies that touch; give "exponential", or a '
            '"table" with a first gap > 0'
        )


@register_force
class Tabulated(BetweenSurfaces):
    """|F| linear between given gaps, constant below the first and zero beyond the last."""

    reach_key: ClassVar[str] = "gaps"
    law: Literal["table"]
    gaps: Increasing = Field(min_length=1)
    """gaps, increasing"""
    values: tuple[float, ...]
    """one force for each gap; negative ones turn the force round"""

    @model_validator(mode="after")
    def _paired(self) -> Tabulated:
        require_pairs(gaps=self.gaps, values=self.values)
        return self

    @property
    @override
    def reach(self) -> float:
        """The last gap of the table."""
        return self.gaps[-1]

    @override
    def strength_at(self, d: Array) -> Array:
        return np.interp(d, self.gaps, self.values)
