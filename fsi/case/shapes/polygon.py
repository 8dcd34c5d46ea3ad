"""Polygons with rounded corners."""

from typing import Annotated, Literal, override

import numpy as np
from pydantic import Field, model_validator

from fsi.arrays import Array
from fsi.case.section import Positive, toml_text, unfit
from fsi.case.shapes.shape import ShapeOfArcs, register_shape
from fsi.meshes.geometry.jets import ArcChain

_LEAST_TURN = 1e-3  # at a corner, in radians

type Corner = Annotated[tuple[float, ...], Field(min_length=2, max_length=2)]


@register_shape
class Polygon(ShapeOfArcs):
    """A polygon whose corners are arcs that touch both sides."""

    kind: Literal["polygon"]
    corners: tuple[Corner, ...] = Field(min_length=3)
    """the corners [x, y] counterclockwise, three or more"""
    rounding: Positive
    """the radius of the arcs, a number > 0"""

    @model_validator(mode="after")
    def _sides_left(self) -> "Polygon":
        sides, turns = self._sides_and_turns
        if np.abs(turns).min() < _LEAST_TURN:
            here = toml_text(self.corners[int(np.abs(turns).argmin())])
            raise unfit("corners", f"{here} is none, as both sides go the same way there", "drop it")
        if abs(turns.sum() + 2.0 * np.pi) < _LEAST_TURN:
            raise unfit("corners", "go around clockwise", "turn their order round")
        if not abs(turns.sum() - 2.0 * np.pi) < _LEAST_TURN:
            raise unfit("corners", "do not go around once", "give them such that no sides cross")
        cut = np.abs(np.tan(0.5 * turns))
        most = float((np.hypot(*sides.T) / (cut + np.roll(cut, -1))).min())
        if self.rounding >= most:
            raise unfit("rounding", "a side is shorter than the arcs at its ends", f"give less than {most:g}")
        return self

    @property
    def _sides_and_turns(self) -> tuple[Array, Array]:
        """The sides from each corner to the next, (n, 2), and by what they turn at each corner, (n,)."""
        x = np.array(self.corners)
        sides = np.roll(x, -1, axis=0) - x
        before = np.roll(sides, 1, axis=0)
        turns = np.arctan2(
            before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0], (before * sides).sum(axis=1)
        )
        return sides, turns

    @property
    @override
    def chain(self) -> ArcChain:
        sides, turns = self._sides_and_turns
        cut = self.rounding * np.abs(np.tan(0.5 * turns))
        straight = np.hypot(*sides.T) - cut - np.roll(cut, -1)
        ends = np.roll(turns, -1)  # at the end of each side
        lengths = np.column_stack([straight, self.rounding * np.abs(ends)]).ravel()
        curvatures = np.column_stack([0.0 * straight, np.sign(ends) / self.rounding]).ravel()
        along = sides[0] / np.hypot(*sides[0])
        start = np.array(self.corners[0]) + cut[0] * along
        return ArcChain(lengths, curvatures, start, float(np.arctan2(along[1], along[0])))
