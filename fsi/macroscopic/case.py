"""The case file of the macroscopic model: blocks of rods on a line, a force, steps."""

from __future__ import annotations

import itertools
from typing import Literal

import numpy as np
import tomli_w
from pydantic import Field, field_validator, model_validator

from fsi.bodies.configuration import Array
from fsi.case.formula import check, evaluate
from fsi.case.gluey import Frames, Steps
from fsi.case.section import Section, toml_text
from fsi.errors import InputError, SolveError
from fsi.macroscopic.model import Parcels, at_rest_in_memory, blocks


class Block(Section):
    """A stretch of uniform density at time 0."""

    left: float = Field(description="its left end, a number")
    right: float = Field(description="its right end, a number above `left`")
    density: float = Field(gt=0.0, le=1.0, description="rho, in (0, 1]")
    velocity: str = Field(description='u at time 0, a formula of x and m, like "-x"')

    @field_validator("velocity")
    @classmethod
    def _formula(cls, velocity: str) -> str:
        check(velocity, ("x", "m"))
        return velocity

    @model_validator(mode="after")
    def _extended(self) -> Block:
        if not self.left < self.right:
            raise ValueError(f"has right = {self.right!r} not above left = {self.left!r}")
        return self


class MacroscopicCase(Section):
    """A line of gluey matter, at most as dense as 1."""

    name: str = Field(min_length=1, description="a few words that name the case")
    model: Literal["macroscopic"] = Field(description='"macroscopic"')
    parcels: int = Field(ge=2, description="the number of parcels of equal mass, at least 2")
    blocks: tuple[Block, ...] = Field(
        min_length=1, description="one section [[blocks]] each, from left to right"
    )
    force: str = Field(
        default="0", description='the force per mass, a formula of x, m (the mass left of x) and t, like "-x"'
    )
    time: Steps = Field(description="a section [time] with end and step")
    output: Frames = Field(default_factory=Frames, description="a section [output]")

    @field_validator("force")
    @classmethod
    def _formula(cls, force: str) -> str:
        check(force, ("x", "m", "t"))
        return force

    @field_validator("blocks")
    @classmethod
    def _in_order(cls, given: tuple[Block, ...]) -> tuple[Block, ...]:
        for one, other in itertools.pairwise(given):
            if other.left < one.right:
                raise ValueError(
                    f"has a block from {other.left!r} that begins before the one to {one.right!r} ends"
                )
        return given

    def start(self) -> Parcels:
        """The parcels at time 0."""
        m, dm, X = blocks([(block.left, block.right, block.density) for block in self.blocks], self.parcels)
        u = X.copy()
        for i, block in enumerate(self.blocks):
            inside = (block.left <= X) & (block.right >= X)
            u[inside] = evaluate(block.velocity, X, x=X, m=m)[inside]
            if not np.isfinite(u[inside]).all():
                key = f"blocks.{i}.velocity = {toml_text(block.velocity)}"
                raise InputError(f"{key}: is not finite in all of the block; give a formula that is")
        return at_rest_in_memory(m, dm, X, u)

    def f(self, x: Array, m: Array, t: float) -> Array:
        """The force per mass. Raises SolveError where its formula is not finite."""
        force = evaluate(self.force, x, x=x, m=m, t=t)
        if not np.isfinite(force).all():
            at = f"x = {x[~np.isfinite(force)][0]:.6g}, t = {t:.6g}"
            raise SolveError(f"force = {toml_text(self.force)}: is not finite at {at}; change the formula")
        return force

    def as_toml(self) -> str:
        """The case with every default filled in; reads back as an equal case."""
        return tomli_w.dumps(self.model_dump(exclude_none=True))
