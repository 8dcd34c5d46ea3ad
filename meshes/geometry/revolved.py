"""Bodies of revolution: an outline that is symmetric about the axis r = 0 of points (r, z).

Its right half, from the lower end on the axis to the upper one, has

    volume  V = pi int r^2 dz        centre on the axis  (pi / V) int r^2 z dz

by Gauss's rule on the pieces of its sample. The gaps of such bodies on one axis, to each other and to walls
of revolution, are those of their outlines: the nearest points lie on one side of the axis.

Beside a slender body the flow varies with log r, r the distance from its axis. Sizes of elements therefore
follow the larger of two curvatures, that of the outline and a part of that around the axis, n_r / r.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import override

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.jets import circle
from fsi.meshes.geometry.outline import Outline

SYMMETRIC = 1e-9  # of the radius, by which the mirror image of an outline may be off it
# Elements along prolate spheroids, a tenth to a hundredth as wide as long, err by 4e-6 to 8e-3 of the force
# with none of the curvature around the axis, by less than 1e-6 with this part; all of it doubles the cells.
AROUND = 0.25
ON_AXIS = 1e-6  # of the radius: at such r both curvatures are those of the outline


@dataclass(frozen=True, eq=False)
class BodyOfRevolution(Outline):
    """An outline on an axis, its centre of volume at the origin.

    Attributes:
        angle: by which it is turned where it stands: then the axis is that of z.
    """

    angle: float = 0.0

    @classmethod
    def about_axis(cls, outline: Outline, angle: float) -> BodyOfRevolution:
        """The curve of a formula, whose origin is on the axis, moved along that."""
        body = cls(outline.formula, outline.joints, fewest=outline.fewest, angle=angle)
        if np.isnan(body.poles[0]):
            return body  # on no axis; who asks for it sees that it is not symmetric
        (r, z), weights = body._half()
        swept = weights * r**2
        return replace(body, shift=float(swept @ z / swept.sum()) * body._frame[1])

    @classmethod
    def sphere(cls, radius: float, angle: float = 0.0) -> BodyOfRevolution:
        """A circle, whose poles are on the axis however it is turned."""
        return cls(circle(radius), angle=angle)

    @property
    def _frame(self) -> Array:
        """The directions of r and z before it is turned, as rows."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, -s], [s, c]])

    @cached_property
    @override
    def poles(self) -> tuple[float, float]:
        """Where r changes its sign, the second after the first; NaN of a curve that stays on one side."""
        r = self.sample.x @ self._frame[0]
        low, high = (np.flatnonzero((s * r <= 0.0) & (s * np.roll(r, -1) > 0.0)) for s in (1.0, -1.0))
        if not (len(low) and len(high)):
            return np.nan, np.nan
        bottom, top = self._root(int(low[0])), self._root(int(high[0]))
        return bottom, top + float(top < bottom)

    def _root(self, k: int) -> float:
        """Where r is zero between the points k and k + 1 of the sample."""
        import scipy  # late: `fsi check` does without

        def r(t: float) -> float:
            return float((self.jet(np.array([t])).x @ self._frame[0])[0])

        low, high = float(self.t[k]), float(np.append(self.t, 1.0)[k + 1])
        if r(low) * r(high) >= 0.0:  # a point of the sample is the pole, where rounding makes the sign
            return min(low, high, key=lambda t: abs(r(t)))
        return float(scipy.optimize.brentq(r, low, high, xtol=1e-16))

    @override
    def followed(self, t: Array) -> Array:
        """The larger one of that of the outline and AROUND that around the axis."""
        x, dx, _ = self.jet(t)
        r, swept = np.abs(x @ self._frame[0]), np.abs(dx @ self._frame[1])
        around = np.zeros_like(r)
        np.divide(AROUND * swept, r * np.hypot(*dx.T), out=around, where=r > ON_AXIS * self.radius)
        larger: Array = np.maximum(np.abs(self.curvature(t)), around)
        return larger

    def _half(self) -> tuple[Array, Array]:
        """r and z at points of Gauss's rule on the right half, (2, n), and the weights of dz, (n,)."""
        bottom, top = self.poles
        between = np.sort(bottom + (self.t - bottom) % 1.0)
        ends = np.concatenate([[bottom], between[(between > bottom) & (between < top)], [top]])
        curve, weights = self._between(ends)
        return self._frame @ curve.x.T, weights * (curve.dx @ self._frame[1])

    @cached_property
    @override
    def volume(self) -> float:
        """V."""
        (r, _), weights = self._half()
        return np.pi * float(weights @ r**2)

    @property
    def is_symmetric(self) -> bool:
        """Whether its two halves are mirror images."""
        x, (across, _) = self.sample.x, self._frame
        mirrored = x - 2.0 * (x @ across)[:, None] * across
        off, _ = self.signed_distance(mirrored)
        return bool(np.abs(off).max() <= SYMMETRIC * self.radius)
