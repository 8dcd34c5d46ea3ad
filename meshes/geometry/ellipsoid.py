"""Ellipsoids in space where they stand, and the gaps between them and to walls.

The points of an ellipsoid around c are x = c + M y, |y| = 1, with the half axes for the columns of M. It
reaches h(n) = |M^T n| from c in the direction n. The gap between two is

    max over |n| = 1 of   n.(c_2 - c_1) - h_1(n) - h_2(n),

the distance where they are apart; where they overlap it is negative, and its size the least way that parts
them. Where it is positive the function is concave in the unit ball, and Newton's method on the sphere finds
its only maximum. The gap to a plane wall is that of its normal; in a round container of radius R around the
origin it is R - max |x|, where  (lambda - M^T M) y = M^T c  with lambda above the largest half axis squared.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.curves import Sphere, rescaled
from fsi.meshes.geometry.feet import Foot

ROUNDS, STARTS = 60, 24
ZERO = 1e-15


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """By its half axes (3,), around the origin along x, y and z."""

    half_axes: Array

    @property
    def radius(self) -> float:
        """Of the smallest sphere around it."""
        return float(self.half_axes.max())

    @property
    def volume(self) -> float:
        """4/3 pi a b c."""
        return 4.0 / 3.0 * np.pi * float(self.half_axes.prod())

    def scaled(self, factor: float) -> Ellipsoid:
        """With all lengths times a factor, to 15 digits."""
        return self if factor == 1.0 else Ellipsoid(rescaled(self.half_axes, factor))


@dataclass(frozen=True, eq=False)
class PlacedEllipsoid:
    """An ellipsoid around a centre (3,), turned by a rotation vector (3,)."""

    form: Ellipsoid
    centre: Array
    angle: Array

    @cached_property
    def rotation(self) -> Array:
        """The directions of its axes, as columns, (3, 3)."""
        import scipy  # late: `fsi check` does without

        return np.asarray(scipy.spatial.transform.Rotation.from_rotvec(self.angle).as_matrix())

    @cached_property
    def axes(self) -> Array:
        """M, the half axes as columns, (3, 3)."""
        return np.asarray(self.rotation * self.form.half_axes)

    def rescaled(self, factor: float) -> PlacedEllipsoid:
        """With all lengths times a factor, its centre's place too."""
        return replace(self, form=self.form.scaled(factor), centre=rescaled(self.centre, factor))

    # As a sphere that is stretched: what the curved sides of cells are made from.

    @property
    def unit(self) -> Sphere:
        """The sphere |y| = 1."""
        return Sphere(np.zeros(3), 1.0)

    def unstretched(self, x: Array) -> Array:
        """y of points x (..., 3)."""
        y: Array = (x - self.centre) @ (self.rotation / self.form.half_axes)
        return y

    def stretched(self, y: Array) -> Array:
        """M y of vectors (..., 3)."""
        x: Array = y @ self.axes.T
        return x

    def project(self, x: Array) -> Array:
        """The points on it on the rays from the centre through x (..., 3)."""
        return self.centre + self.stretched(self.unit.project(self.unstretched(x)))

    def off(self, x: Array) -> Array:
        """About the distance of points (n, 3) near to it, negative inside, (n,)."""
        y = self.unstretched(x)
        k = np.linalg.norm(y, axis=1)
        off: Array = k * (k - 1.0) / np.linalg.norm(y / self.form.half_axes, axis=1)
        return off

    # Gaps.

    def reach(self, n: Array) -> float:
        """h(n)."""
        return float(np.linalg.norm(self.axes.T @ n))

    def foot(self, n: Array) -> Array:
        """The point that lies farthest in the direction n, (3,)."""
        across = self.axes.T @ n
        return np.asarray(self.centre + self.axes @ (across / np.linalg.norm(across)))

    def gap_to(self, other: PlacedEllipsoid) -> Foot:
        """The gap to another one; the normal of its foot is that of the other, towards this one."""
        apart = other.centre - self.centre
        away = float(np.linalg.norm(apart))
        start = apart / away if away > 0.0 else np.eye(3)[0]
        n, gap = _largest(self, other, apart, start)
        if gap <= 0.0:  # then there may be several maxima
            for start in _DIRECTIONS:
                m, better = _largest(self, other, apart, start)
                n, gap = (m, better) if better > gap else (n, gap)
        return Foot(gap, np.nan, self.foot(n), 0.0 - n)

    def gap_to_plane(self, distance: float, normal: Array) -> Foot:
        """The gap to a plane wall by its centre's distance and the normal into the fluid, (3,)."""
        return Foot(distance - self.reach(normal), np.nan, self.foot(0.0 - normal), normal)

    def gap_within(self, sphere: Sphere) -> Foot:
        """The gap to a sphere around it."""
        x = self._farthest_from(sphere.centre)
        away = float(np.linalg.norm(x - sphere.centre))
        return Foot(sphere.radius - away, np.nan, x, (sphere.centre - x) / away)

    def _farthest_from(self, origin: Array) -> Array:
        """Its point that is farthest from another one, (3,)."""
        import scipy  # late: `fsi check` does without

        squares, c = np.square(self.form.half_axes), self.rotation.T @ (self.centre - origin)
        b, largest = self.form.half_axes * c, float(squares.max())

        def excess(above: float) -> float:
            with np.errstate(divide="ignore"):
                return float(np.sum((b / (largest + above - squares)) ** 2)) - 1.0

        least = ZERO * largest
        rest = squares < largest * (1.0 - 1e-14)
        if np.abs(b[~rest]).max() <= least or excess(least) <= 0.0:
            y = np.zeros(3)  # its centre lies on a plane of symmetry across the longest axis
            y[rest] = b[rest] / (largest - squares[rest])
            if (length := float(y @ y)) <= 1.0:
                y[np.argmax(squares)] = np.sqrt(1.0 - length)
                return self.centre + self.axes @ y
        most = float(np.linalg.norm(b)) * 2.0 + largest
        above = scipy.optimize.brentq(excess, least, most, xtol=ZERO * largest, rtol=1e-15)
        y = b / (largest + above - squares)
        farthest: Array = self.centre + self.axes @ (y / np.linalg.norm(y))
        return farthest


def _largest(one: PlacedEllipsoid, other: PlacedEllipsoid, apart: Array, n: Array) -> tuple[Array, float]:
    """n where n.apart - h_1 - h_2 is largest on the unit sphere, from a start, and the value there."""
    A, B = one.axes @ one.axes.T, other.axes @ other.axes.T

    def value(n: Array) -> float:
        return float(n @ apart) - one.reach(n) - other.reach(n)

    best = value(n)
    for _ in range(ROUNDS):
        gradient, hessian = apart.copy(), np.zeros((3, 3))
        for Q in (A, B):
            Qn = Q @ n
            h = float(np.sqrt(n @ Qn))
            gradient -= Qn / h
            hessian -= Q / h - np.outer(Qn, Qn) / h**3
        # On the sphere: across n, less what the sphere bends by.
        P = np.eye(3) - np.outer(n, n)
        across = P @ gradient
        if np.linalg.norm(across) <= ZERO * np.linalg.norm(apart):
            break
        bent = P @ hessian @ P - float(n @ gradient) * P
        values, vectors = np.linalg.eigh(bent)
        down = np.where(np.abs(vectors.T @ n) > 0.5, -np.inf, -np.maximum(np.abs(values), ZERO))
        step = -vectors @ ((vectors.T @ across) / down)
        for k in range(ROUNDS):
            m = n + 0.5**k * step
            m /= np.linalg.norm(m)
            if (found := value(m)) >= best:
                break
        else:
            break
        n, best, before = m, found, best
        if found - before <= ZERO * abs(best) and np.linalg.norm(step) < 1e-7:
            break
    return n, best


def _evenly(count: int) -> Array:
    """Directions spread over the sphere, (count, 3): a spiral of golden angles."""
    k = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    r = np.sqrt(1.0 - z**2)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


_DIRECTIONS = _evenly(STARTS)
