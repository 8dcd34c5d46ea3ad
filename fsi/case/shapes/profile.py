"""Bodies by one half of them: of revolution by their profile."""

from typing import Literal, override

import numpy as np
from pydantic import Field, model_validator

from fsi.case.section import unfit
from fsi.case.shapes.shape import register_shape
from fsi.case.shapes.spline import Place, ShapeThroughPoints


@register_shape
class HalfOutline(ShapeThroughPoints):
    """The spline through the points of its right half and their mirror images at x = 0 (r = 0)."""

    kind: Literal["profile"]
    points: tuple[Place, ...] = Field(min_length=3)
    """the points [x, y] (with an axis [r, z]) from the lower end at x = 0 to the upper one, three or more, or
    the path of a CSV file of x, y without a header"""

    @model_validator(mode="after")
    def _right_half(self) -> "HalfOutline":
        x, y = np.array(self.points).T
        if x[0] != 0.0 or x[-1] != 0.0 or x[1:-1].min() <= 0.0:
            what = "do not go from x = 0 to x = 0 with x > 0 between"
            raise unfit("points", what, "give the right half, both its ends at x = 0")
        if not y[0] < y[-1]:
            raise unfit("points", "the first is not below the last", "turn their order round")
        return self

    @property
    @override
    def around(self) -> tuple[tuple[float, ...], ...]:
        """The lower end, the right half, the upper end, the left half."""
        return self.points + tuple((-x, y) for x, y in self.points[-2:0:-1])
