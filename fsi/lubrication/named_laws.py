"""Lubrication laws by name, as cases (`reduced.law = "exact"`) and law files (`form = "exact"`) call them.

One more law is one more function here, or anywhere that is imported, which `named` enters: it takes the film
between a pair and gives the law of its gap. The schema's choices, its help and its complaints follow.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from fsi.lubrication import exact, sphere_beside_plane, spheres, two_discs
from fsi.lubrication.expansions import EXPONENTS, MODES, Mode, Shape, expansion, overlap_of
from fsi.lubrication.laws import Array, LubricationLaw, ScaledLaw, Series, TabulatedProfile, Term

# A spline of degree 5 through so many points per factor of ten is good to 1e-9 (see the tests).
_POINTS = 30
_RANGE = (1e-9, 1e2)
# The series of a sphere along or turning beside a plane has 1/sqrt(s) terms; at this gap it takes 0.05 s.
_SMALLEST_SERIES = 1e-8
# Radii of a sphere: a round wall larger than that is flat for it, within 1 %.
_LARGE = 100.0


@dataclass(frozen=True, slots=True)
class GapFilm:
    """The film between a pair whose law is asked for.

    Attributes:
        shape: of the bodies.
        viscosity: mu.
        ratio: b/a of the radii of the pair; infinite beside a plane, -R/a inside a round wall.
        extrapolate: whether gaps outside the range of the law are allowed.
        mode: which relative motion of the pair.
    """

    shape: Shape
    viscosity: float
    ratio: float = inf
    extrapolate: bool = False
    mode: Mode = "squeeze"


@dataclass(frozen=True, slots=True)
class NamedLaw:
    """One entry of the registry: the law of a film, of each by itself unless it says otherwise.

    Attributes:
        of: film -> law. Raises ValueError: none is known.
        any_shape: whether it is the same for spheres and discs.
        any_ratio: whether it is the same for all ratios of the radii of two bodies, and for all walls.
        modes: for which it is known.
    """

    of: Callable[[GapFilm], LubricationLaw]
    any_shape: bool
    any_ratio: bool
    modes: tuple[Mode, ...]


LAWS: dict[str, NamedLaw] = {}


def named[F: Callable[[GapFilm], LubricationLaw]](
    name: str, *, any_shape: bool = False, any_ratio: bool = False, modes: tuple[Mode, ...] = ("squeeze",)
) -> Callable[[F], F]:
    """Enter a law under a name."""

    def enter(law: F) -> F:
        LAWS[name] = NamedLaw(law, any_shape, any_ratio, modes)
        return law

    return enter


def names_of_laws(mode: Mode = "squeeze") -> str:
    """The names for a message, of the laws of a mode: `"slides", "leading", ...`."""
    return ", ".join(f'"{name}"' for name, law in LAWS.items() if mode in law.modes)


@named("slides", any_shape=True, any_ratio=True)
def slides_law(film: GapFilm) -> ScaledLaw:
    """kappa = mu/d for every pair, that of A. Lefebvre and B. Maury: no radius enters.

    So mu lacks a length beside the drag of discs, and the square of one beside that of spheres.
    """
    return ScaledLaw(Series((Term(-1.0),), (1.0,)), film.viscosity, -1)


@named("leading", any_ratio=True, modes=MODES)
def leading_law(film: GapFilm) -> ScaledLaw:
    """The first term of the expansion, the same whatever the ratio of the radii is.

    Of spheres kappa = 6 pi mu a_r^2/d: beside a plane 6 pi mu a^2/d, of equal ones (3/2) pi mu a^2/d; of
    discs kappa = 3 sqrt2 pi mu (a_r/d)^(3/2): of equal ones (3/2) pi mu (a/d)^(3/2). Shear and rotation
    have two such terms, one of two bodies and one beside a wall.
    """
    profile = expansion(film.shape, film.mode, film.ratio, 1)
    return ScaledLaw(profile, film.viscosity, EXPONENTS[film.shape, film.mode])


@named("exact", modes=MODES)
def exact_law(film: GapFilm) -> ScaledLaw:
    """The exact law from gaps of 1e-9 to 100 reduced radii, or as far as a round wall lets, within 1e-9.

    For spheres inside a round wall of more than 100 radii it is that of a plane, within 1 %.

    Extrapolated, it goes on with the power of the gap of its ends: below, that is the leading term. The
    logarithms of spheres that shear or turn beside a plane begin at 1e-8, and are 10 % too large at 1e-12.
    """
    flat = film.shape == "spheres" and film.ratio < -_LARGE
    profile = _exact_profile(film.shape, film.mode, inf if flat else film.ratio)
    return ScaledLaw(profile, film.viscosity, EXPONENTS[film.shape, film.mode], film.extrapolate)


@cache
def _exact_profile(shape: Shape, mode: Mode, ratio: float) -> TabulatedProfile:
    nearest = _RANGE[0] if shape == "discs" or mode == "squeeze" else _SMALLEST_SERIES
    decades = round(np.log10(_RANGE[1] / nearest))
    farthest = min(_RANGE[1], inf if ratio > 0.0 else -1.0 / overlap_of(ratio))  # where a body is concentric
    s = np.geomspace(nearest, farthest, decades * _POINTS + 1)
    return TabulatedProfile(s, exact_resistance(shape, mode, s, ratio), smooth=True)


def exact_resistance(shape: Shape, mode: Mode, gap: ArrayLike, ratio: float) -> Array:
    """K(s) of spheres or discs at gaps s in units of the reduced radius, mu = 1.

    ratio: b/a, infinite for a plane, -R/a inside a round wall.

    Raises ValueError: shear or rotation of two spheres or inside a round wall, or a sphere inside a round
    wall: no closed form here.
    """
    a = 1.0 if ratio == inf else 1.0 + 1.0 / ratio
    b = inf if ratio == inf else 1.0 + ratio
    if mode == "squeeze":
        if shape == "discs":
            return exact.relative_resistance(gap, a, b, 1.0)
        if ratio < 0.0:
            raise ValueError(f"none of a sphere is known here within a round wall of {-ratio:g} radii")
        if ratio == inf:
            return spheres.normal_resistance(gap, a, 1.0)
        return spheres.relative_resistance(gap, a, b, 1.0)
    if ratio < 0.0:
        raise ValueError(f"no exact resistance to {mode} is known here within a round wall")
    if ratio != inf:
        if shape == "spheres":
            raise ValueError(f"no exact resistance to {mode} of two spheres is known here")
        pair = two_discs.sliding_resistance if mode == "shear" else two_discs.rolling_resistance
        return pair(gap, a, b, 1.0)
    module = exact if shape == "discs" else sphere_beside_plane
    resistance = module.parallel_resistance if mode == "shear" else module.rotation_resistance
    return np.asarray(resistance(gap, 1.0, 1.0))
