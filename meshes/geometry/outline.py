"""The outline of a body in the plane: a smooth closed curve around its centre of area.

    area    A = 1/2 int x (x) x' dt          centre   1/(3 A) int x (x (x) x') dt
    second moment   int |x|^2 dA = 1/4 int |x|^2 (x (x) x') dt        with  a (x) b = a_1 b_2 - a_2 b_1

by Gauss's rule on the pieces of a sample of the curve. Points of the curve are always those of its formula:
the sample only says where to look for the nearest one.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from fsi.meshes.geometry.jets import Array, Jet, JetOf, circle, cross

if TYPE_CHECKING:
    import scipy

FEWEST = 128  # pieces of a sample
TURN = 0.1  # of the tangent along a piece, at most, in radians
THIN = 0.2  # longest piece over area / diameter, so that the two sides of a thin body are told apart
ROUNDS = 40
MOST = 20_000  # pieces, beyond which nothing is made finer
GAUSS = 12  # points on a piece
NEWTON = 60
NEIGHBOURS = 16  # of a point in the sample
SHARPEST = 1e-3  # smallest radius of curvature that sizes of elements follow, over the largest radius
ROUND = 1e-14  # of the radius, by which the sample of a circle is off it
LONGER = 1e-6  # by which the larger second moment exceeds the smaller one of a body with a long axis
STRAIGHT = 1e-9  # curvature times radius: what rounding makes of straight sides
AT_JOINT = 1e-6  # of the curve: a place so near to a joint is there
SPREAD = 1.5  # how fast the radius that sizes follow grows along the curve


type Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed curve, once around counterclockwise for 0 <= t <= 1, its centre of area at the origin.

    Attributes:
        formula: the curve before it is moved and enlarged.
        joints: the t where derivatives jump, ascending.
        factor: by which lengths of the formula are multiplied.
        shift: the centre of area of the formula's curve, (2,).
        fewest: pieces of its sample, so many that none of its waves is overlooked.
    """

    formula: JetOf
    joints: tuple[float, ...] = ()
    factor: float = 1.0
    shift: Array = field(default_factory=lambda: np.zeros(2))
    fewest: int = FEWEST

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
    def _others(self) -> dict[float, Self]:
        return {}

    def scaled(self, factor: float) -> Self:
        """With all lengths times a factor; the same object for the same factor."""
        if factor == 1.0:
            return self
        if factor not in self._others:
            self._others[factor] = replace(self, factor=factor * self.factor)
        return self._others[factor]

    def jet(self, t: Array) -> Jet:
        """Points and derivatives at t (n,); any t, the curve is periodic."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            x, dx, ddx = self.formula(np.mod(t, 1.0))
            return Jet(self.factor * (x - self.shift), self.factor * dx, self.factor * ddx)

    @cached_property
    def t(self) -> Array:
        """Where the sample stands, ascending from 0 on, (m,); joints are among it."""
        t = np.unique(np.concatenate([np.arange(self.fewest) / self.fewest, self.joints]))
        for _ in range(ROUNDS):
            closed = np.append(t, 1.0)
            x, dx, _ = self.jet(t)
            to, turn = np.roll(x, -1, axis=0) - x, np.roll(dx, -1, axis=0)
            angle = np.abs(np.arctan2(cross(dx, turn), (dx * turn).sum(axis=1)))
            extent = float(np.hypot(*np.ptp(x, axis=0)))
            area = 0.5 * abs(float(cross(x, np.roll(x, -1, axis=0)).sum()))
            long = (angle > TURN) | (np.hypot(*to.T) > THIN * area / extent)
            if not long.any() or len(t) > MOST:
                break
            t = np.insert(t, np.flatnonzero(long) + 1, 0.5 * (closed[:-1] + closed[1:])[long])
        return t

    @property
    def is_resolved(self) -> bool:
        """Whether the sample is as fine as it shall be: not of what is too slender or too jagged."""
        return len(self.t) <= MOST

    @cached_property
    def sample(self) -> Jet:
        """The curve there, (m, 2)."""
        return self.jet(self.t)

    @cached_property
    def inside(self) -> Array:
        """A point inside the body, (2,): its centre, or if that lies outside the middle of a chord."""
        x = self.sample.x
        middles = np.vstack([np.zeros(2), 0.5 * (x[0] + x[1:])])
        distance, _ = self.signed_distance(middles)
        return np.asarray(middles[0 if distance[0] < 0.0 else int(np.argmin(distance))])

    def snapped(self, t: float) -> float:
        """The joint at which t is, or t itself."""
        away = [abs((t - joint + 0.5) % 1.0 - 0.5) for joint in self.joints]
        return self.joints[int(np.argmin(away))] if min(away, default=1.0) < AT_JOINT else t

    @cached_property
    def spacing(self) -> float:
        """The longest piece of the sample."""
        x = self.sample.x
        return float(np.hypot(*(np.roll(x, -1, axis=0) - x).T).max())

    def _integrated(self) -> tuple[Jet, Array]:
        """The curve at points of Gauss's rule, and their weights."""
        return self._between(np.append(self.t, 1.0))

    def _between(self, ends: Array) -> tuple[Jet, Array]:
        """The same on the pieces between ends."""
        points, weights = np.polynomial.legendre.leggauss(GAUSS)
        half = 0.5 * np.diff(ends)
        t = (0.5 * (ends[:-1] + ends[1:]))[:, None] + half[:, None] * points
        return self.jet(t.ravel()), (half[:, None] * weights).ravel()

    def crosses_itself(self) -> bool:
        """Whether two chords of the sample cross: of a sound outline none do."""
        x, m = self.sample.x, len(self.t)
        pairs = self._tree.query_pairs(self.spacing, output_type="ndarray")
        for one, other in ((0, 0), (0, -1), (-1, 0), (-1, -1)):  # the chords that end or begin there
            i, j = (pairs[:, 0] + one) % m, (pairs[:, 1] + other) % m
            apart = (i - j) % m
            i, j = i[(apart > 1) & (apart < m - 1)], j[(apart > 1) & (apart < m - 1)]
            a, b, c, d = x[i], x[(i + 1) % m], x[j], x[(j + 1) % m]
            splits = cross(b - a, c - a) * cross(b - a, d - a) < 0.0
            if np.any(splits & (cross(d - c, a - c) * cross(d - c, b - c) < 0.0)):
                return True
        return False

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

    @cached_property
    def _tree(self) -> scipy.spatial.cKDTree:
        import scipy  # late: `fsi check` does without

        return scipy.spatial.cKDTree(self.sample.x)

    def coarse_distance(self, x: Array) -> tuple[Array, Array]:
        """Distance of points (n, 2) to the sample, (n,), and the t of its nearest points.

        It is larger than that to the curve by half a spacing.
        """
        away, near = self._tree.query(x)
        return np.asarray(away), self.t[near]

    def nearest(self, x: Array) -> Array:
        """The t of the curve's points that are nearest to points x (n, 2), (n,).

        They are looked for beside the nearest point of the sample, and where another branch of the curve is
        nearly as near, beside the nearest point there.
        """
        m = len(self.t)
        away, near = self._tree.query(x, k=[*range(1, min(NEIGHBOURS, m) + 1)])
        t = self._nearest_beside(x, near[:, 0])
        between = (near - near[:, :1]) % m
        other = np.where((between > 1) & (between < m - 1), away, np.inf)
        could = np.flatnonzero(other.min(axis=1) ** 2 - 0.25 * self.spacing**2 < away[:, 0] ** 2)
        if len(could):
            x, mine = x[could], t[could]
            beside = self._nearest_beside(x, near[could, other[could].argmin(axis=1)])
            one, two = (np.hypot(*(self.jet(at).x - x).T) for at in (mine, beside))
            t[could] = np.where(two < one, beside, mine)
        return t

    def _nearest_beside(self, x: Array, i: Indices) -> Array:
        """The nearest points between the neighbours of points i of the sample, by Newton's method."""
        slope = ((self.sample.x[i] - x) * self.sample.dx[i]).sum(axis=1)
        closed = np.concatenate([[self.t[-1] - 1.0], self.t, [1.0]])
        here = closed[i + 1]
        low, high = np.where(slope > 0.0, closed[i], here), np.where(slope > 0.0, here, closed[i + 2])
        t = 0.5 * (low + high)
        for _ in range(NEWTON):
            curve = self.jet(t)
            off = curve.x - x
            slope = (off * curve.dx).sum(axis=1)
            low, high = np.where(slope < 0.0, t, low), np.where(slope > 0.0, t, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = slope / ((curve.dx**2).sum(axis=1) + (off * curve.ddx).sum(axis=1))
                tried = t - step
            outside = ~((tried >= low) & (tried <= high)) | (step == 0.0)
            after = np.where(outside, 0.5 * (low + high), tried)
            after = np.where(slope == 0.0, t, after)
            moved, t = np.abs(after - t).max(initial=0.0), after
            if moved < 1e-15:
                break
        nearest: Array = t
        return nearest

    def signed_distance(self, x: Array) -> tuple[Array, Array]:
        """Distance of points (n, 2) to the curve, negative inside, (n,), and the normal of the body there."""
        curve = self.jet(self.nearest(x))
        normal = np.column_stack([curve.dx[:, 1], -curve.dx[:, 0]])
        normal /= np.hypot(*normal.T)[:, None]
        off = x - curve.x
        along = (off * normal).sum(axis=1)
        return np.copysign(np.hypot(*off.T), along), normal
