"""The places where a gap is narrowest: of surfaces that are not convex several.

Along the outline x(t) of a body the distance f to what is opposite, with its gradient n, has its local minima
where  n(x(t)) . x'(t) = 0. They count as several gaps if f rises between them, above the wider one by at
least RISE of it: along straight sides that face each other, and over waves that are low beside the gap, there
is one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array

ROUNDS = 30
ZERO, SHORT = 1e-14, 1e-15  # of the values where a root is looked for, and of t
RISE = 0.01
SAME = 1e-6  # of the larger coordinate: two points so near to each other are one

type Opposite = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True, slots=True, eq=False)
class Foot:
    """Where a gap is narrowest.

    Attributes:
        gap: its width, negative where the two overlap.
        t: of the point on the body's outline, NaN in space.
        x: that point, (d,).
        normal: of what is opposite, towards the body, (d,).
    """

    gap: float
    t: float
    x: Array
    normal: Array

    @property
    def opposite(self) -> Array:
        """The point opposite, (d,)."""
        return np.asarray(self.x - self.gap * self.normal)

    def mirrors(self, other: Foot) -> bool:
        """Whether the two are one of a body of revolution: the same, or on both sides of the axis x = 0."""
        off = np.abs(np.abs(self.x) - np.abs(other.x))
        return bool(off.max() <= SAME * np.abs(self.x).max())


def root(rising: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Where functions that rise through zero between two arguments each have it, (n,).

    By the method of false position with halved ends (Illinois), and by bisection each third time.
    """
    below, above = -np.abs(rising(low)), np.abs(rising(high))
    smallest, found = np.where(-below < above, -below, above), np.where(-below < above, low, high)
    enough = ZERO * np.maximum(-below, above)
    for k in range(ROUNDS):
        with np.errstate(invalid="ignore", divide="ignore"):
            falsi = (low * above - high * below) / (above - below)
        after = np.where((falsi >= low) & (falsi <= high) & (k % 3 < 2), falsi, 0.5 * (low + high))
        value = rising(after)
        up = value > 0.0
        above, below = np.where(up, value, 0.5 * above), np.where(up, 0.5 * below, value)
        low, high = np.where(up, low, after), np.where(up, after, high)
        better = np.abs(value) < smallest
        smallest, found = np.where(better, np.abs(value), smallest), np.where(better, after, found)
        if np.all((smallest <= enough) | (high - low < SHORT)):
            break
    return found


def low_points(distance: Array, highest: float) -> NDArray[np.intp]:
    """Where samples (m,) around a closed curve are no higher than beside, and than this."""
    low = (distance <= np.roll(distance, 1)) & (distance <= np.roll(distance, -1))
    return np.flatnonzero(low & (distance <= highest))


class Sampled(NamedTuple):
    """Distances at points of an outline.

    Attributes:
        t: where on it, ascending from 0 on, (m,).
        distance: to what is opposite, infinite where it is not asked for, (m,).
    """

    t: Array
    distance: Array


def separate(narrowest: Foot, feet: Sequence[Foot], sampled: Sampled) -> Iterator[Foot]:
    """The narrowest and then those of others between which the distance rises, ascending."""
    chosen = list[Foot]()
    for foot in (narrowest, *sorted(feet, key=lambda foot: foot.gap)):
        over = sampled.t[sampled.distance > (1.0 + RISE) * foot.gap]
        if all(_rises(over, foot.t, other.t) for other in chosen):
            chosen.append(foot)
            yield foot


def _rises(over: Array, one: float, other: float) -> bool:
    """Whether some t of these lie on either way round from the one to the other."""
    low, high = sorted((one, other))
    between = (over > low) & (over < high)
    return bool(between.any() and not between.all())
