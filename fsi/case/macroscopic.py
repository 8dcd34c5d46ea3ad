"""The section [macroscopic] of a case file: blocks of matter on a line, the force on it, its parcels."""

from __future__ import annotations

import itertools

from pydantic import Field, field_validator, model_validator

from fsi.case.formula import check
from fsi.case.section import Section


class Block(Section):
    """A stretch of uniform density at time 0."""

    renamed = {"velocity": "use initial_velocity: a velocity is prescribed"}  # noqa: RUF012

    left: float
    """its left end, a number"""
    right: float
    """its right end, a number above `left`"""
    density: float = Field(gt=0.0, le=1.0)
    """rho, in (0, 1]"""
    initial_velocity: str
    'u at time 0, a formula of x and m, like "-x"'

    @field_validator("initial_velocity")
    @classmethod
    def _formula(cls, velocity: str) -> str:
        check(velocity, ("x", "m"))
        return velocity

    @model_validator(mode="after")
    def _extended(self) -> Block:
        if not self.left < self.right:
            raise ValueError(f"has right = {self.right!r} not above left = {self.left!r}")
        return self


class Macroscopic(Section):
    """A line of gluey matter, at most as dense as 1: blocks of it, or the bodies of the case as such."""

    parcels: int = Field(default=400, ge=2)
    """the number of parcels of equal mass, at least 2"""
    blocks: tuple[Block, ...] = ()
    """one section [[macroscopic.blocks]] each, from left to right; the bodies if not given"""
    force_per_mass: str = "0"
    'the force per mass on blocks, a formula of x, m (the mass left of x) and t, like "-x"'

    @field_validator("force_per_mass")
    @classmethod
    def _formula(cls, force: str) -> str:
        check(force, ("x", "m", "t"))
        return force

    @field_validator("blocks")
    @classmethod
    def _in_order(cls, blocks: tuple[Block, ...]) -> tuple[Block, ...]:
        for one, other in itertools.pairwise(blocks):
            if other.left < one.right:
                raise ValueError(
                    f"has a block from {other.left!r} that begins before the one to {one.right!r} ends"
                )
        return blocks
