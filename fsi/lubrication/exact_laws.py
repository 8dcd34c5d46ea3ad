"""Laws that hold for one ratio of radii: the exact resistances, tabulated, and their expansions."""

from __future__ import annotations

from functools import cache
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fsi.lubrication import exact, sphere_beside_plane, spheres
from fsi.lubrication.expansions import EXPONENTS, Mode, Shape, coefficients
from fsi.lubrication.laws import ScaledLaw, Series, Term
from fsi.lubrication.tables import Table

Array = NDArray[np.float64]

# A spline of degree 5 through so many points per factor of ten is good to 1e-9 (see the tests).
_POINTS = 30
_RANGE = (1e-9, 1e2)
_EXPANSION_UP_TO = 0.1


def exact_resistance(shape: Shape, mode: Mode, gap: ArrayLike, ratio: float) -> Array:
    """K(s) of spheres or discs at gaps s in units of the reduced radius, mu = 1; ratio is b/a, inf a plane.

    Raises:
        ValueError: shear or rotation of two bodies: there is no closed form here.
    """
    a = 1.0 if ratio == inf else 1.0 + 1.0 / ratio
    b = inf if ratio == inf else 1.0 + ratio
    if mode == "squeeze":
        if shape == "discs":
            return exact.relative_resistance(gap, a, b, 1.0)
        if ratio == inf:
            return spheres.normal_resistance(gap, a, 1.0)
        return spheres.relative_resistance(gap, a, b, 1.0)
    if ratio != inf:
        raise ValueError(f"{mode} of two {shape}: no exact resistance is known here; only beside a plane")
    module = exact if shape == "discs" else sphere_beside_plane
    resistance = module.parallel_resistance if mode == "shear" else module.rotation_resistance
    found: Array = resistance(gap, 1.0, 1.0)
    return found


def exact_law(shape: Shape, ratio: float, viscosity: float, *, extrapolate: bool = False) -> ScaledLaw:
    """The exact squeeze law from gaps of 1e-9 to 100 reduced radii, within 1e-9.

    Extrapolated, it goes on with the power of the gap of its ends: below, that is the leading term.

    Args:
        shape: of the bodies.
        ratio: b/a of every pair; infinite for a plane.
        viscosity: mu.
        extrapolate: whether gaps outside the range are allowed.
    """
    return ScaledLaw(_exact_table(shape, ratio), viscosity, EXPONENTS[shape, "squeeze"], extrapolate)


@cache
def _exact_table(shape: Shape, ratio: float) -> Table:
    decades = round(np.log10(_RANGE[1] / _RANGE[0]))
    s = np.geomspace(*_RANGE, decades * _POINTS + 1)
    return Table(s, exact_resistance(shape, "squeeze", s, ratio), smooth=True)


def expansion_law(shape: Shape, ratio: float, viscosity: float, *, extrapolate: bool = False) -> ScaledLaw:
    """The squeeze law of the first terms of the expansion, up to gaps of 0.1 reduced radii; 0.2 % off there.

    Of spheres c1 to c4, of discs c1 and c2. A constant c3 not known in closed form is read off the exact law.
    """
    known = coefficients(shape, "squeeze", ratio)
    if shape == "spheres":
        known.setdefault(Term(0.0), _constant(known, ratio))
    series = Series(tuple(known), tuple(known.values()), (0.0, _EXPANSION_UP_TO))
    return ScaledLaw(series, viscosity, EXPONENTS[shape, "squeeze"], extrapolate)


def _constant(known: dict[Term, float], ratio: float) -> float:
    """The limit of K less its known terms as s -> 0, at two gaps and extrapolated: what follows is c5 s."""
    s = np.array([1e-4, 2e-4])
    terms = Series(tuple(known), tuple(known.values()))
    rest = exact_resistance("spheres", "squeeze", s, ratio) - terms.value(s)
    return float(2.0 * rest[0] - rest[1])
