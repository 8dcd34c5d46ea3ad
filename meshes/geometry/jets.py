"""Closed curves x(t), 0 <= t <= 1, with two derivatives: what outlines of bodies are made from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fsi.arrays import Array


class Jet(NamedTuple):
    """Points x of a curve and the derivatives x' and x'' along its parameter, (n, 2) each."""

    x: Array
    dx: Array
    ddx: Array


type JetOf = Callable[[Array], Jet]

CONSISTENT = 0.1  # of sound curves the `inconsistency` is below a third of it
_LEAST = 1e-9  # over the longest difference: what is shorter is rounding


def inconsistency(jet: JetOf, t: Array) -> float:
    """How far derivatives are from differences between places t (n,), ascending; NaN where there are NaNs.

    The mean of |a - b| / (|a| + |b|) over the pieces, a the difference of x (x') from end to end of a piece
    and b = x' h (x'' h) by the midpoint rule; the larger of both. It is 1 of derivatives that are zero or of
    the wrong sign, 1/3 of those that are twice what they should be.
    """
    x, dx, _ = jet(t)
    between, h = jet(0.5 * (t[:-1] + t[1:])), np.diff(t)[:, None]
    pairs = ((np.diff(x, axis=0), h * between.dx), (np.diff(dx, axis=0), h * between.ddx))
    return float(np.max([_unlike(*pair) for pair in pairs]))


def _unlike(a: Array, b: Array) -> float:
    """That mean, over rows (n, d)."""
    both = np.linalg.norm(a, axis=1) + np.linalg.norm(b, axis=1)
    counts = ~(both <= _LEAST * both.max())
    off = np.linalg.norm((a - b)[counts], axis=1) / both[counts]
    return float(off.mean()) if len(off) else 0.0


def cross(a: Array, b: Array) -> Array:
    """a_1 b_2 - a_2 b_1 of vectors (n, 2), (n,)."""
    area: Array = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return area


def polar(radius: Callable[[Array], tuple[Array, Array, Array]]) -> JetOf:
    """The curve r(theta), theta = 2 pi t, by r and its first two derivatives along theta, (n,) each."""

    def jet(t: Array) -> Jet:
        turn = 2.0 * np.pi
        r, dr, ddr = (value[:, None] for value in radius(turn * t))
        along = np.column_stack([np.cos(turn * t), np.sin(turn * t)])
        across = np.column_stack([-along[:, 1], along[:, 0]])
        dx, ddx = dr * along + r * across, (ddr - r) * along + 2.0 * dr * across
        return Jet(r * along, turn * dx, turn**2 * ddx)

    return jet


def circle(radius: float) -> JetOf:
    """A circle around the origin."""
    return polar(lambda theta: (np.full_like(theta, radius), 0.0 * theta, 0.0 * theta))


@dataclass(frozen=True, eq=False)
class ArcChain:
    """Straight pieces and arcs, one after the other with the same tangent: a curvature for each piece.

    Attributes:
        lengths: of the pieces, (n,).
        curvatures: of these, positive where they turn left, (n,).
        start: where the first begins, (2,).
        heading: the angle of the tangent there.
    """

    lengths: Array
    curvatures: Array
    start: Array
    heading: float

    @cached_property
    def joints(self) -> tuple[float, ...]:
        """Where the pieces begin, over the whole length."""
        return tuple((self._begins / self._whole).tolist())

    @cached_property
    def _whole(self) -> float:
        return float(np.cumsum(self.lengths)[-1])

    @cached_property
    def _begins(self) -> Array:
        return np.append(0.0, np.cumsum(self.lengths)[:-1])

    @cached_property
    def _headings(self) -> Array:
        """At the beginnings of the pieces."""
        return self.heading + np.append(0.0, np.cumsum(self.curvatures * self.lengths)[:-1])

    @cached_property
    def _starts(self) -> Array:
        """Points where the pieces begin, (n, 2)."""
        chords = _chord(self.lengths, self.curvatures, self._headings)
        return np.asarray(self.start + np.vstack([np.zeros(2), np.cumsum(chords, axis=0)[:-1]]))

    def __call__(self, t: Array) -> Jet:
        """The points and derivatives at t; t counts the length."""
        along, whole = t * self._whole, self._whole
        k = np.clip(np.searchsorted(self._begins, along, side="right") - 1, 0, len(self.lengths) - 1)
        s, kappa, heading = along - self._begins[k], self.curvatures[k], self._headings[k]
        x, turned = self._starts[k] + _chord(s, kappa, heading), heading + kappa * s
        tangent = np.column_stack([np.cos(turned), np.sin(turned)])
        normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
        return Jet(x, whole * tangent, whole**2 * kappa[:, None] * normal)


def _chord(s: Array, curvature: Array, heading: Array) -> Array:
    """From the beginning of pieces to the length s along them, (n, 2)."""
    middle, length = heading + 0.5 * curvature * s, s * np.sinc(0.5 * curvature * s / np.pi)
    chord: Array = length[:, None] * np.column_stack([np.cos(middle), np.sin(middle)])
    return chord
