"""Tips on walls: surfaces that meet in finite time."""

from typing import Literal, override

import numpy as np
import scipy  # its modules load when they are used
from pydantic import Field, model_validator

from fsi.arrays import Array
from fsi.case.profiles.profile import WallProfile, register_profile
from fsi.case.section import Positive
from fsi.case.tip_profile import TipProfile
from fsi.meshes.geometry.relief import Heights


@register_profile
class TipOfWall(WallProfile):
    """A tip height - length |x / length|^(1 + alpha) on a wall, x seen from its place.

    Arcs lead on both sides from the slopes of the tip down to the wall.
    """

    kind: Literal["tip"]
    place: float
    """where along the wall it stands, a coordinate"""
    height: Positive
    """the height of its end over the wall, a number > 0"""
    alpha: float = Field(gt=0.0, le=1.0)
    """the exponent of the profile less 1, a number > 0 and up to 1, where it is a parabola"""
    length: Positive
    """the unit of the profile, a number > 0"""
    rounding: Positive
    """the radius of the arcs at its foot, a number > 0"""

    @model_validator(mode="after")
    def _is_high_enough(self) -> "TipOfWall":
        if not np.isfinite(self._foot) or self._foot <= 0.0:
            raise ValueError("has a tip whose height is far from its length; give another height")
        return self

    @property
    def _profile(self) -> TipProfile:
        return TipProfile(self.length, self.alpha)

    @property
    def _foot(self) -> float:
        """The x at which the arc begins: what both go down is the height."""
        profile = self._profile

        def over(x: float) -> float:
            down = self.length * (x / self.length) ** (1.0 + self.alpha)
            return float(down + self.rounding * (1.0 - 1.0 / np.hypot(1.0, profile.slope(x))) - self.height)

        highest = self.length * (self.height / self.length) ** (1.0 / (1.0 + self.alpha))
        return float(scipy.optimize.brentq(over, 0.0, highest, xtol=1e-16 * highest, rtol=1e-15))

    @override
    def heights(self) -> Heights:
        w, R, profile = self._foot, self.rounding, self._profile
        slope = profile.slope(w)
        end = w + R * slope / float(np.hypot(1.0, slope))

        def at(x: Array) -> tuple[Array, Array, Array]:
            side, x = np.sign(x - self.place), np.abs(x - self.place)
            left = np.clip(end - x, 0.0, None)  # from where the wall is straight again
            down, steep, bend = profile.at(x)
            arc = np.sqrt(np.maximum(R**2 - left**2, 0.0))
            on_tip = (self.height - down, -steep, -bend)
            with np.errstate(divide="ignore"):
                on_arc = (left**2 / (R + arc), -left / arc, R**2 / arc**3)
            h, dh, ddh = (np.where(x < w, one, other) for one, other in zip(on_tip, on_arc, strict=True))
            return h, side * dh, ddh

        ends = (self.place - end, self.place + end)
        return Heights(ends, (self.place - w, self.place, self.place + w), at)
