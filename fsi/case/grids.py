"""The section [[grids]] of a case file: rows of like bodies."""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError, field_validator

from fsi.arrays import Array
from fsi.case.complaints import explain
from fsi.case.section import Name, NotNegative, Positive, Section, all_components, toml_text, tuples
from fsi.errors import InputError
from fsi.machine.resources import require_memory

_TOUCHING = 1e-9  # of the smallest radius: an overlap by less is rounding
_BYTES = 4000.0  # of a body of a case: measured 3 kB


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
        jitter = abs(self.jitter)  # NumPy takes 0 to -0.0 for upside down
        disturbance = random.uniform(-jitter, jitter, places.shape)
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


def members(grids: Sequence[Mapping[str, Any]], first: int) -> str:
    """Which bodies of a case are those of each grid, in words; first: of the first of them."""
    counts = [math.prod(grid["counts"]) for grid in grids]
    begins = itertools.accumulate(counts, initial=first)
    ranges = enumerate(zip(begins, counts, strict=False))
    return ", ".join(f"bodies.{k} to {k + count - 1} are those of grids.{i}" for i, (k, count) in ranges)


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
            raise InputError(explain(error, Grid, grid, ("grids", i))) from None
        if sound.name in names:
            raise InputError(f'grids.{i}.name = "{sound.name}": given twice; give each its own')
        names.add(sound.name)
        count = math.prod(sound.counts)
        what = f"grids.{i}.counts = {toml_text(sound.counts)}: makes {count:.3g} bodies"
        require_memory(what, count * _BYTES, "give fewer")
        members += sound.bodies(f"grids.{i}")
    rest = {key: value for key, value in data.items() if key != "grids"}
    return rest | {"bodies": (*bodies, *members)} if members else rest
