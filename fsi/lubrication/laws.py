"""Lubrication laws: the resistance kappa = F/U of a pair whose gap d changes at the speed U, F against it.

A pair of bodies of radii a and b enters by its reduced radius a_r = a b/(a + b), a wall by b = inf, a_r = a.
Stokes flow has no length but these, so that for one ratio b/a

    kappa(d, a_r) = mu a_r^n K(s),   s = d/a_r,   n = 1 for spheres, 0 for discs (per unit length)

with a dimensionless profile K, a series, a table (`fsi.lubrication.profiles`), or a closed form. At small
gaps K tends to 6 pi/s for spheres and to 3 sqrt2 pi s^(-3/2) for discs, whatever b/a is. A law also has the
antiderivative of kappa in d, the `ln d` or `-2 d^(-1/2)` of the distance equation; its constant is the law's.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.lubrication.profiles import Profile, distinct

# Of the ends of a range: gaps are differences, and those that were meant to be at an end may be beyond it.
ROUNDING = 1e-9


class RangeError(InputError, ValueError):
    """A law was asked for a gap outside its range."""


class LubricationLaw(Protocol):
    """What the reduced models need to know of a pair; gaps d > 0 and reduced radii broadcast."""

    @property
    def range(self) -> tuple[float, float]:
        """The smallest and largest d/a_r for which the law holds."""

    def kappa(self, d: ArrayLike, radius: ArrayLike) -> Array:
        """The resistance F/U at the gap d of a pair of this reduced radius. Raises RangeError."""

    def integral(self, d: ArrayLike, radius: ArrayLike) -> Array:
        """An antiderivative of kappa in d, increasing. Raises RangeError."""

    def at(self, overlap: Array) -> "LubricationLaw":
        """The law of films of these k, (P,): itself unless it is one of any k."""


@dataclass(frozen=True, slots=True)
class ScaledLaw:
    """The law kappa = mu a_r^n K(d/a_r).

    Raises RangeError for gaps outside the range of the profile where they are not allowed, and for gaps that
    are not positive in any case.

    Attributes:
        profile: K.
        viscosity: mu.
        exponent: n.
        extrapolate: whether gaps outside the range of the profile are allowed.
    """

    profile: Profile
    viscosity: float
    exponent: int
    extrapolate: bool = False

    @property
    def range(self) -> tuple[float, float]:
        """The smallest and largest d/a_r for which the law holds."""
        return self.profile.range

    def kappa(self, d: ArrayLike, radius: ArrayLike) -> Array:
        """mu a_r^n K(d/a_r)."""
        a, s = self._ratio(d, radius)
        return np.asarray(self.viscosity * a**self.exponent * self.profile.value(s))

    def integral(self, d: ArrayLike, radius: ArrayLike) -> Array:
        """mu a_r^(n+1) times the antiderivative of K."""
        a, s = self._ratio(d, radius)
        return np.asarray(self.viscosity * a ** (self.exponent + 1) * self.profile.integral(s))

    def at(self, overlap: Array) -> "ScaledLaw":
        """With the profile of films of these k."""
        return replace(self, profile=self.profile.at(overlap))

    def _ratio(self, d: ArrayLike, radius: ArrayLike) -> tuple[Array, Array]:
        a = np.asarray(radius, dtype=np.float64)
        s = np.asarray(d, dtype=np.float64) / a
        smallest, largest = (0.0, np.inf) if self.extrapolate else self.range
        outside = ~((s > 0.0) & (s >= smallest * (1.0 - ROUNDING)) & (s <= largest * (1.0 + ROUNDING)))
        if np.any(outside):
            here = f"gap / reduced radius = {s[outside].flat[0]:.6g}: the lubrication law holds from"
            remedy = "keep gaps positive and in this range, or ask for extrapolation"
            raise RangeError(f"{here} {self.range[0]:.6g} to {self.range[1]:.6g}; {remedy}")
        return a, s


@dataclass(frozen=True, slots=True)
class CutLaw:
    """A law less its value at the gap d_c, and zero beyond, so that far drag is not counted twice.

    kappa is continuous, never negative if that of `law` decreases; the integral is that from d_c = cut > 0.
    """

    law: LubricationLaw
    cut: float

    @property
    def range(self) -> tuple[float, float]:
        """The smallest d/a_r is that of the law; every larger one will do."""
        return self.law.range[0], np.inf

    def kappa(self, d: ArrayLike, radius: ArrayLike) -> Array:
        """The law at d less the law at d_c where d < d_c, else 0."""
        near = np.minimum(d, self.cut)
        rise = self.law.kappa(near, radius) - self.law.kappa(self.cut, distinct(radius))
        return np.where(np.less(d, self.cut), rise, 0.0)  # powers of arrays and of numbers round differently

    def integral(self, d: ArrayLike, radius: ArrayLike) -> Array:
        """The integral of `kappa` from d_c to d, so 0 beyond d_c."""
        near, of_law = np.minimum(d, self.cut), distinct(radius)
        constant = self.law.kappa(self.cut, of_law) * (near - self.cut)
        integral = self.law.integral(near, radius) - self.law.integral(self.cut, of_law) - constant
        return np.where(np.less(d, self.cut), integral, 0.0)

    def at(self, overlap: Array) -> "CutLaw":
        """That of films of these k, cut at the same gap."""
        return replace(self, law=self.law.at(overlap))
