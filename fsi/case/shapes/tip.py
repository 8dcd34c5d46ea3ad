"""Discs with a tip: the theorem of no contact wants smoother surfaces."""

from typing import Literal, override

import numpy as np
import scipy  # its modules load when they are used
from pydantic import Field, model_validator

from fsi.arrays import Array
from fsi.case.section import Positive, unfit
from fsi.case.shapes.shape import BodyShape, register_shape
from fsi.case.tip_profile import TipProfile
from fsi.meshes.geometry.jets import ArcChain, Jet, JetOf

_NARROWEST = 1e-14  # of the radius: the half width of a tip that is one
_ROUNDING = 1e-9  # of the largest length, which is computed in another way than the width


@register_shape
class Tip(BodyShape):
    """A disc that ends below in a tip of the profile y = length |x / length|^(1 + alpha).

    The arc of the disc begins on both sides where it has the slope of the profile.
    """

    kind: Literal["tip"]
    radius: Positive
    """the radius of the disc, a number > 0"""
    alpha: float = Field(gt=0.0, le=1.0)
    """the exponent of the profile less 1, a number > 0 and up to 1, where it is a parabola"""
    length: Positive
    """the unit of the profile, a number > 0, below 2 radii where alpha = 1"""

    @model_validator(mode="after")
    def _meets_the_disc(self) -> "Tip":
        """Where the arc begins x / slope(x) is the radius, if x is small: the more the smaller the length."""
        with np.errstate(over="ignore"):
            of_radius = _NARROWEST * np.power((1.0 + self.alpha) / _NARROWEST, 1.0 / self.alpha)
        if self.length >= (1.0 - _ROUNDING) * of_radius * self.radius:
            what = "makes a tip that is flatter than the disc"
            raise unfit("length", what, f"give one below {of_radius * self.radius:g}")
        return self

    @property
    def _profile(self) -> TipProfile:
        return TipProfile(self.length, self.alpha)

    @property
    def _end(self) -> float:
        """The x at which the arc begins: its centre is on the axis, at a radius along the normal."""

        def off(x: float) -> float:
            return float(x * np.hypot(1.0, 1.0 / self._profile.slope(x)) - self.radius)

        return float(
            scipy.optimize.brentq(off, _NARROWEST * self.radius, self.radius, xtol=1e-16, rtol=1e-15)
        )

    @property
    def _parts(self) -> tuple[float, float]:
        """t where the arc begins and ends; by lengths, in which the tip counts its width."""
        w = self._end
        arc = 2.0 * (np.pi - np.arctan(self._profile.slope(w))) * self.radius
        return w / (2.0 * w + arc), (w + arc) / (2.0 * w + arc)

    @property
    @override
    def joints(self) -> tuple[float, ...]:
        return (0.0, *self._parts)

    @override
    def curve(self) -> JetOf:
        w, (begin, end), profile = self._end, self._parts, self._profile
        heading = float(np.arctan(profile.slope(w)))
        turn = 2.0 * (np.pi - heading)
        start = np.array([w, profile.at(np.array(w))[0]])
        arc = ArcChain(np.array([turn * self.radius]), np.array([1.0 / self.radius]), start, heading)
        rate = w / begin

        def tip(t: Array) -> Jet:
            x = rate * t
            y, slope, ddy = profile.at(np.abs(x))
            dy = np.sign(x) * slope
            one, zero = np.full_like(x, rate), np.zeros_like(x)
            return Jet(np.column_stack([x, y]), np.column_stack([one, rate * dy]),
                       np.column_stack([zero, rate**2 * ddy]))  # fmt: skip

        def jet(t: Array) -> Jet:
            on_arc = (t >= begin) & (t <= end)
            around = 1.0 / (end - begin)
            x, dx, ddx = arc(np.clip((t - begin) * around, 0.0, 1.0))
            parts = zip((x, around * dx, around**2 * ddx), tip(np.where(t > 0.5, t - 1.0, t)), strict=True)
            return Jet(*(np.where(on_arc[:, None], round_, sharp) for round_, sharp in parts))

        return jet
