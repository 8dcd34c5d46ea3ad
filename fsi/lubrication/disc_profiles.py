"""The resistances K(s) of discs in closed form, for films of any k = a b/(a + b)^2 at once.

With h = s + k s^2/2 = cosh L - 1, squeeze is 4 pi/(L - tanh L) of two discs, beside a plane (k = 0), and in a
round wall (k < 0), where gaps end at s = -1/k, with the disc at the centre. Two discs slide and roll by
`fsi.lubrication.two_discs`; beside a plane shear is 4 pi/al and rotation 4 pi coth al, cosh al = 1 + s (see
`fsi.lubrication.exact`).

The integral of K in s is taken over w, cosh w = 1 + s, in which `K sinh w` is even and analytic but for a
pole c/w^2, which is integrated exactly, and for points about pi i, or as far beyond the centre of a round
wall as that is from it. Gauss's rule on panels gives the rest, within 1e-11 (`fsi.lubrication.panels`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil, inf

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrays import Array
from fsi.lubrication.exact import bipolar_angle, less_tanh
from fsi.lubrication.expansions import Mode, overlap_of
from fsi.lubrication.panels import NODES, PANEL, WEIGHTS
from fsi.lubrication.profiles import distinct
from fsi.lubrication.two_discs import rolling, sliding

# c of squeeze: K = 3 sqrt2 pi s^(-3/2) and s = w^2/2 at small gaps.
_POLE = 12.0 * np.pi
_START = 1.0  # s from which the integral counts, where a round wall lets


@dataclass(frozen=True, slots=True)
class DiscProfile:
    """K(s), constant beyond the centre of a round wall.

    Attributes:
        resistance: K of s and k.
        pole: c.
        overlap: k of the films, a number or (P,), for s of shape (P,).
    """

    resistance: Callable[[Array, ArrayLike], Array]
    pole: float
    overlap: Array | float

    @property
    def range(self) -> tuple[float, float]:
        """All gaps, as far as round walls let."""
        return 0.0, float(np.min(self._farthest))

    def value(self, s: Array) -> Array:
        """K(s)."""
        return self.resistance(np.minimum(s, self._farthest), self.overlap)

    def integral(self, s: Array) -> Array:
        """The integral of K from s = 1, or the centre of a narrower round wall."""
        inside = np.minimum(s, self._farthest)
        start, end = bipolar_angle(np.minimum(_START, self._farthest)), bipolar_angle(inside)
        panels = max(1, ceil(float(np.max(np.abs(end - start), initial=0.0)) / PANEL))
        half, total = (0.5 / panels) * (end - start), self.pole * (1.0 / start - 1.0 / end)
        for centre in range(1, 2 * panels, 2):
            for node, weight in zip(NODES, WEIGHTS, strict=True):
                w = start + (centre + node) * half
                total = total + weight * half * self._regular(w)
        return np.asarray(total + self.value(s) * (s - inside))

    def at(self, overlap: Array) -> "DiscProfile":
        """The same of films of these k, (P,)."""
        return replace(self, overlap=distinct(overlap))

    @property
    def _farthest(self) -> Array | float:
        """-1/k inside a round wall, else infinite."""
        k = np.asarray(self.overlap)
        within = k < 0.0
        return np.where(within, -1.0 / np.where(within, k, 1.0), inf) if np.any(within) else inf

    def _regular(self, w: Array) -> Array:
        """K ds/dw less its pole."""
        s = 2.0 * np.sinh(0.5 * w) ** 2
        return self.resistance(s, self.overlap) * np.sinh(w) - self.pole / w**2


def disc_profile(mode: Mode, ratio: float) -> DiscProfile:
    """K(s) of films of the ratio b/a, and by its `at` of others like it: of pairs, or beside a plane.

    Raises ValueError: shear or rotation inside a round wall.
    """
    k = overlap_of(ratio)
    if mode == "squeeze":
        return DiscProfile(_squeeze, _POLE, k)
    if ratio < 0.0:
        raise ValueError(f"no exact resistance to {mode} is known here within a round wall")
    if ratio == inf:
        return DiscProfile(_along_plane if mode == "shear" else _turning, 0.0, k)
    return DiscProfile(sliding if mode == "shear" else rolling, 0.0, k)


def _squeeze(s: Array, k: ArrayLike) -> Array:
    return np.asarray(4.0 * np.pi / less_tanh(bipolar_angle(s * (1.0 + 0.5 * np.asarray(k) * s))))


def _along_plane(s: Array, _: ArrayLike) -> Array:
    return np.asarray(4.0 * np.pi / bipolar_angle(s))


def _turning(s: Array, _: ArrayLike) -> Array:
    return np.asarray(4.0 * np.pi / np.tanh(bipolar_angle(s)))
