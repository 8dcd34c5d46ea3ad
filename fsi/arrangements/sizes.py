"""Radii of bodies: all equal, of two sizes, or lognormal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def monodisperse(number: int, mean: float) -> Array:
    """All radii equal."""
    return np.full(number, mean)


def bidisperse(number: int, mean: float, ratio: float) -> Array:
    """Half of the radii, rounded down, `ratio` >= 1 times the others; their mean is exact."""
    large = np.arange(number) < number // 2
    radii = np.where(large, ratio, 1.0)
    scaled: Array = mean * radii / radii.mean()
    return scaled


def lognormal(number: int, mean: float, deviation: float, rng: np.random.Generator) -> Array:
    """Radii whose logarithm is normal; deviation: the standard deviation over the mean, which is exact.

    The deviation is that of the distribution, from which the radii are drawn independently.
    """
    radii = np.exp(np.sqrt(np.log1p(deviation**2)) * rng.standard_normal(number))
    scaled: Array = mean * radii / radii.mean()
    return scaled
