"""A smooth closed curve in the plane, and the points of it that are nearest to others.

Points of the curve are always those of its formula: a sample only says where to look for the nearest one.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.geometry.jets import Jet, JetOf, cross, inconsistency

if TYPE_CHECKING:
    import scipy

FEWEST = 128  # pieces of a sample
TURN = 0.1  # of the tangent along a piece, at most, in radians
THIN = 0.2  # longest piece over area / diameter, so that the two sides of a thin body are told apart
ROUNDS = 40
MOST = 20_000  # pieces, beyond which nothing is made finer
NEWTON = 60
ROUNDING = 5e-16  # of t
NEIGHBOURS = 16  # of a point in the sample
AT_JOINT = 1e-6  # of the curve: a place so near to a joint is there


type Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class ClosedCurve:
    """A curve that goes once around counterclockwise for 0 <= t <= 1.

    Attributes:
        formula: the curve before it is moved and enlarged.
        joints: the t where derivatives jump, ascending.
        factor: by which lengths of the formula are multiplied.
        shift: the point of the formula's plane that becomes the origin, (2,).
        fewest: pieces of its sample, so many that none of its waves is overlooked.
    """

    formula: JetOf
    joints: tuple[float, ...] = ()
    factor: float = 1.0
    shift: Array = field(default_factory=lambda: np.zeros(2))
    fewest: int = FEWEST

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
    def spacing(self) -> float:
        """The longest piece of the sample."""
        x = self.sample.x
        return float(np.hypot(*(np.roll(x, -1, axis=0) - x).T).max())

    @cached_property
    def inconsistency(self) -> float:
        """Of its derivatives with its points, on the sample."""
        return inconsistency(self.jet, np.append(self.t, 1.0))

    def snapped(self, t: float) -> float:
        """The joint at which t is, or t itself."""
        away = [abs((t - joint + 0.5) % 1.0 - 0.5) for joint in self.joints]
        return self.joints[int(np.argmin(away))] if min(away, default=1.0) < AT_JOINT else t

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
        """The nearest points between the neighbours of points i of the sample, by Newton's method.

        Where its first step leads out, it goes on beside that end: if the distance falls all along, the
        nearest point is there, and halving would take forty rounds to it.
        """
        slope = ((self.sample.x[i] - x) * self.sample.dx[i]).sum(axis=1)
        closed = np.concatenate([[self.t[-1] - 1.0], self.t, [1.0]])
        here = closed[i + 1]
        low, high = np.where(slope > 0.0, closed[i], here), np.where(slope > 0.0, here, closed[i + 2])
        t = 0.5 * (low + high)
        for k in range(NEWTON):
            curve = self.jet(t)
            off = curve.x - x
            slope = (off * curve.dx).sum(axis=1)
            low, high = np.where(slope < 0.0, t, low), np.where(slope > 0.0, t, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = slope / ((curve.dx**2).sum(axis=1) + (off * curve.ddx).sum(axis=1))
                tried = t - step
            outside = ~((tried >= low) & (tried <= high)) | (step == 0.0)
            beside = np.where(tried > high, high - ROUNDING, low + ROUNDING)
            after = np.where(outside, 0.5 * (low + high) if k else beside, tried)
            after = np.where(slope == 0.0, t, after)
            moved, t = np.abs(after - t).max(initial=0.0), after
            if moved < 2.0 * ROUNDING:
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
