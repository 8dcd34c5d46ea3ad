"""Ellipses and rods by their support functions, and how far two of them are apart.

A convex body with its centre at the origin reaches h(phi) = max n . x along n = (cos phi, sin phi).
Two of them, with d from the second centre to the first, are apart by

    s = max over phi of  n . d - h_1(phi) - h_2(phi)        (h(phi + pi) = h(phi) here)

which is the distance of their closest points where it is positive, and minus how deep they overlap elsewhere.
Every phi bounds s from below: what is found apart is apart. Where s > 0 no other maximum is above zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array

SAMPLES = 32  # directions that are looked at first
GOLDEN, NARROWINGS = 0.5 * (sqrt(5.0) - 1.0), 36  # 2 * 2 pi / 32 * 0.618^36 = 1e-8: s to its square


@dataclass(frozen=True, slots=True)
class ConvexShape:
    """An ellipse or a rod whose area is pi; bodies of the radius a have all lengths times a.

    Attributes:
        kind: "ellipse", or "rod", a rectangle with half a disc at either end.
        ratio: of its length to its width, above 1.
    """

    kind: Literal["ellipse", "rod"]
    ratio: float

    @property
    def half_width(self) -> float:
        """Of an ellipse sqrt(1 / ratio); a rod has the area w^2 (pi + 4 (ratio - 1))."""
        if self.kind == "ellipse":
            return sqrt(1.0 / self.ratio)
        return sqrt(pi / (pi + 4.0 * (self.ratio - 1.0)))

    @property
    def half_length(self) -> float:
        """The radius of the circle that holds it."""
        return self.ratio * self.half_width

    def support(self, psi: Array) -> tuple[Array, Array]:
        """h and h' at angles psi from its long axis."""
        a, b = self.half_length, self.half_width
        c, s = np.cos(psi), np.sin(psi)
        if self.kind == "ellipse":
            h = np.sqrt((a * c) ** 2 + (b * s) ** 2)
            return h, (b**2 - a**2) * s * c / h
        return b + (a - b) * np.abs(c), -(a - b) * s * np.sign(c)

    def rim(self, points: int) -> Array:
        """Some points around it, h n + h' n', (points, 2)."""
        psi = 2.0 * pi * (np.arange(points) + 0.5) / points
        h, slope = self.support(psi)
        c, s = np.cos(psi), np.sin(psi)
        return np.column_stack([h * c - slope * s, h * s + slope * c])

    def described(self, radius: float) -> dict[str, Any]:
        """The key `shape` of a body of this radius."""
        a, b = radius * self.half_length, radius * self.half_width
        if self.kind == "ellipse":
            return {"kind": "ellipse", "axes": (a, b)}
        return {"kind": "stadium", "length": 2.0 * (a - b), "radius": b}


@dataclass(frozen=True, slots=True)
class Couples:
    """Pairs of bodies, P.

    Attributes:
        d: from the second centre to the first, (P, 2).
        radii: of both, (P, 2).
        angles: of both, (P, 2).
    """

    d: Array
    radii: Array
    angles: Array

    def of(self, some: NDArray[np.intp] | NDArray[np.bool_]) -> Couples:
        """Some of them."""
        return Couples(self.d[some], self.radii[some], self.angles[some])


def _apart_along(shape: ConvexShape, couples: Couples, phi: Array) -> Array:
    """n . d - h_1 - h_2 in directions phi (P, m), (P, m)."""
    d, a, theta = couples.d[:, None], couples.radii[:, None], couples.angles[:, None]
    h, _ = shape.support(phi[..., None] - theta)
    along: Array = np.cos(phi) * d[..., 0] + np.sin(phi) * d[..., 1] - (a * h).sum(axis=2)
    return along


def apart(shape: ConvexShape, couples: Couples, enough: float = np.inf) -> tuple[Array, Array]:
    """s and the direction phi, (P,) each; where s is `enough` anyway some that is less.

    The best of some directions, those across a rod among them, then by golden section.
    """
    turn = np.linspace(0.0, 2.0 * pi, SAMPLES, endpoint=False)
    towards = np.arctan2(couples.d[:, 1], couples.d[:, 0])
    across = couples.angles + 0.5 * pi
    phi = np.concatenate([towards[:, None] + turn, across, across + pi], axis=1)
    s = _apart_along(shape, couples, phi)
    best = s.argmax(axis=1)
    rows = np.arange(len(best))
    s, phi = s[rows, best], phi[rows, best]
    unsure = np.flatnonzero(s < enough)
    if len(unsure):
        near, middle = couples.of(unsure), phi[unsure]
        width = 2.0 * pi / SAMPLES
        low, high = middle - width, middle + width
        for _ in range(NARROWINGS):
            one, other = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            both = _apart_along(shape, near, np.column_stack([one, other]))
            left = both[:, 0] > both[:, 1]
            low, high = np.where(left, low, one), np.where(left, other, high)
        found = 0.5 * (low + high)
        refined = _apart_along(shape, near, found[:, None])[:, 0]
        better = refined > s[unsure]
        s[unsure] = np.where(better, refined, s[unsure])
        phi[unsure] = np.where(better, found, middle)
    return s, phi
