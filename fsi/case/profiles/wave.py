"""Wavy walls."""

from typing import Annotated, Literal, override

import numpy as np
from pydantic import Field

from fsi.arrays import Array
from fsi.case.profiles.profile import WallProfile, register_profile
from fsi.case.section import Positive
from fsi.meshes.geometry.relief import Heights

_MOST = 200


@register_profile
class Wave(WallProfile):
    """height (1 - cos(2 pi (x - start) / length)) / 2, over a number of wave lengths."""

    kind: Literal["wave"]
    height: float
    """the height of the crests over the wall, a number; negative where they are troughs in it"""
    length: Positive
    """the wave length, a number > 0"""
    number: Annotated[int, Field(ge=1, le=_MOST)]
    """how many wave lengths there are, a whole number from 1 to 200"""
    start: float
    """where along the wall the first begins, a coordinate"""

    @override
    def heights(self) -> Heights:
        half, k, start = 0.5 * self.height, 2.0 * np.pi / self.length, self.start

        def at(x: Array) -> tuple[Array, Array, Array]:
            cos, sin = np.cos(k * (x - start)), np.sin(k * (x - start))
            return half * (1.0 - cos), half * k * sin, half * k**2 * cos

        end = start + self.number * self.length
        return Heights((start, end), (), at, min(self.height, 0.0), self.number)
