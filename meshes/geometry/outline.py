"""The outline of a body in the plane: a smooth closed curve around its centre of area.

    area    A = 1/2 int x (x) x' dt          centre   1/(3 A) int x (x (x) x') dt
    second moment   int |x|^2 dA = 1/4 int |x|^2 (x (x) x') dt        with  a (x) b = a_1 b_2 - a_2 b_1

by Gauss's rule on the pieces of a sample of the curve.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.closed_curve import FEWEST, ClosedCurve
from fsi.meshes.geometry.jets import Jet, JetOf, circle, cross

GAUSS = 12  # points on a piece
SHARPEST = 1e-3  # smallest radius of curvature that sizes of elements follow, over the largest radius
ROUND = 1e-14  # of the radius, by which the sample of a circle is off it
LONGER = 1e-6  # by which the larger second moment exceeds the smaller one of a body with a long axis
STRAIGHT = 1e-9  # curvature times radius: what rounding makes of straight sides
SPREAD = 1.5  # how fast the radius that sizes follow grows along the curve


@dataclass(frozen=True, eq=False)
class Outline(ClosedCurve):
    """The closed curve around a body, whose centre of area is the origin."""

    @classmethod
    def of(cls, formula: JetOf, joints: tuple[float, ...] = (), fewest: int = FEWEST) -> Outline:
        """The curve of a formula, moved so that its centre of area is the origin."""
        curve, weights = cls(formula, joints, fewest=fewest)._integrated()
        swept = weights * cross(curve.x, curve.dx)
        return cls(formula, joints, shift=(swept @ curve.x) / (1.5 * swept.sum()), fewest=fewest)

    @classmethod
    def disc(cls, radius: float) -> Outline:
        """A circle."""
        return cls(circle(radius))

    @property
    def poles(self) -> tuple[float, float] | None:
        """The t of the lower and the upper end of a body of revolution on its axis; None in the plane."""
        return None

    @cached_property
    def inside(self) -> Array:
        """A point inside the body, (2,): its centre, or if that lies outside the middle of a chord."""
        x = self.sample.x
        middles = np.vstack([np.zeros(2), 0.5 * (x[0] + x[1:])])
        distance, _ = self.signed_distance(middles)
        return np.asarray(middles[0 if distance[0] < 0.0 else int(np.argmin(distance))])

    def _integrated(self) -> tuple[Jet, Array]:
        """The curve at points of Gauss's rule, and their weights."""
        return self._between(np.append(self.t, 1.0))

    def _between(self, ends: Array) -> tuple[Jet, Array]:
        """The same on the pieces between ends."""
        points, weights = np.polynomial.legendre.leggauss(GAUSS)
        half = 0.5 * np.diff(ends)
        t = (0.5 * (ends[:-1] + ends[1:]))[:, None] + half[:, None] * points
        return self.jet(t.ravel()), (half[:, None] * weights).ravel()

    @cached_property
    def area(self) -> float:
        """A; negative where the curve runs clockwise."""
        curve, weights = self._integrated()
        return 0.5 * float(weights @ cross(curve.x, curve.dx))

    @property
    def volume(self) -> float:
        """Of the body: in the plane its area."""
        return self.area

    @cached_property
    def second_moment(self) -> float:
        """int |x|^2 dA around its centre; times mass over area the moment of inertia of a uniform body."""
        curve, weights = self._integrated()
        return 0.25 * float((weights * (curve.x**2).sum(axis=1)) @ cross(curve.x, curve.dx))

    @cached_property
    def long_axis(self) -> float | None:
        """The angle of the axis along which int x x^T dA is largest; None of squares, which have none."""
        curve, weights = self._integrated()
        swept = weights * cross(curve.x, curve.dx)
        moments = 0.25 * np.einsum("n,ni,nj->ij", swept, curve.x, curve.x)
        least, most = np.linalg.eigvalsh(moments)
        if self.poles is not None or most - least < LONGER * most:
            return None
        return float(0.5 * np.arctan2(2.0 * moments[0, 1], moments[0, 0] - moments[1, 1]))

    @cached_property
    def radius(self) -> float:
        """Of the smallest circle around the centre that holds the body."""
        import scipy  # late: `fsi check` does without

        x = self.sample.x
        k = int(np.argmax((x**2).sum(axis=1)))
        around = self.t[k - 1] - float(k == 0), np.append(self.t, 1.0)[k + 1]
        if float(np.ptp(np.hypot(*x.T))) < ROUND * float(np.hypot(*x[k])):
            return float(np.hypot(*x[k]))

        def inside(t: float) -> float:
            return -float(np.hypot(*self.jet(np.array([t])).x[0]))

        found = scipy.optimize.minimize_scalar(inside, bounds=around, method="bounded")
        return max(-float(found.fun), float(np.hypot(*x[k])))

    def curvature(self, t: Array) -> Array:
        """At t (n,), positive where the body is convex; infinite at the end of a tip."""
        _, dx, ddx = self.jet(t)
        with np.errstate(divide="ignore", invalid="ignore"):
            kappa = cross(dx, ddx) / np.hypot(dx[:, 0], dx[:, 1]) ** 3
        bent: Array = np.where(np.isnan(kappa), np.inf, kappa)
        return bent

    @cached_property
    def is_convex(self) -> bool:
        """Whether it is bent inwards nowhere."""
        return bool(np.all(self.radius * self.curvature(self.t) >= -STRAIGHT))

    def followed(self, t: Array) -> Array:
        """The curvature that sizes of elements follow at t, (n,), of either sign."""
        return self.curvature(t)

    def bend(self, t: Array) -> Array:
        """The radius that sizes of elements follow at t, (n,): that of the curvature, but near tighter bends.

        It is at least SHARPEST of the largest radius and at most that.
        """
        own = self._bend(self.followed(t))
        near = np.interp(np.mod(t, 1.0), np.append(self.t, 1.0), np.append(self._bends, self._bends[0]))
        least: Array = np.minimum(own, near)
        return least

    def _bend(self, curvature: Array) -> Array:
        with np.errstate(divide="ignore"):
            bend: Array = np.clip(1.0 / np.abs(curvature), SHARPEST * self.radius, self.radius)
        return bend

    @cached_property
    def tips(self) -> tuple[float, ...]:
        """The t, ascending, of tips sharper than SHARPEST, where sizes do not follow the curvature.

        Of each stretch that bends so much it is the point of the sample that bends most. Stretches with
        joints have none.
        """
        sharpness = SHARPEST * self.radius * np.abs(self.curvature(self.t))
        order = np.roll(np.arange(len(self.t)), -int(np.argmin(sharpness)))
        ends = np.flatnonzero(np.diff(sharpness[order] > 1.0)) + 1
        stretches = [some for some in np.split(order, ends) if sharpness[some[0]] > 1.0]
        smooth = [some for some in stretches if not np.isin(self.t[some], self.joints).any()]
        return tuple(sorted(float(self.t[some[np.argmax(sharpness[some])]]) for some in smooth))

    @cached_property
    def _bends(self) -> Array:
        """Of the sample, growing no faster along the curve than SPREAD."""
        x, bends = self.sample.x, self._bend(self.followed(self.t))
        piece = SPREAD * np.hypot(*(np.roll(x, -1, axis=0) - x).T)
        for _ in range(2):  # twice around in either direction
            for k in range(len(bends)):
                bends[k] = min(bends[k], bends[k - 1] + piece[k - 1])
            for k in range(len(bends) - 1, -1, -1):
                bends[k - 1] = min(bends[k - 1], bends[k] + piece[k - 1])
        return bends
