"""Lubrication laws by name, as cases (`reduced.law = "exact"`) and law files (`form = "exact"`) call them.

One more law is one more function here, or anywhere that is imported, which `named` enters: it takes the film
between a pair and gives the law of its gap. The schema's choices, its help and its complaints follow.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import inf, pi

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrays import Array
from fsi.errors import refuse_taken
from fsi.lubrication import sphere_beside_plane, spheres
from fsi.lubrication.disc_profiles import disc_profile
from fsi.lubrication.exact import gap_ratio
from fsi.lubrication.expansions import EXPONENTS, MODES, Mode, Shape, expansion
from fsi.lubrication.laws import LubricationLaw, ScaledLaw
from fsi.lubrication.profiles import Profile, Series, TabulatedProfile, Term

# A spline of degree 5 through so many points per factor of ten is good to 1e-9 (see the tests).
_POINTS = 30
# Of s. The series of a sphere along or turning beside a plane has 1/sqrt(s) terms; at 1e-8 it takes 0.05 s.
_NEAREST: dict[Mode, float] = {"squeeze": 1e-9, "shear": 1e-8, "rotation": 1e-8}
# Farther K - limit goes as 1/s to 1e-6 of itself, that of rotation as 1/s^3 and is 3e-10 of K.
_FARTHEST: dict[Mode, float] = {"squeeze": 1e6, "shear": 1e6, "rotation": 1e3}
# What K of spheres tends to: the drag of a lone one that moves, or turns.
_LIMITS: dict[Mode, float] = {"squeeze": 6.0 * pi, "shear": 6.0 * pi, "rotation": 8.0 * pi}
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
        beyond_drag: whether the drag of lone spheres, which an exact law of squeeze tends to, is left out.
    """

    shape: Shape
    viscosity: float
    ratio: float = inf
    extrapolate: bool = False
    mode: Mode = "squeeze"
    beyond_drag: bool = False


@dataclass(frozen=True, slots=True)
class NamedLaw:
    """One entry of the registry: the law of a film, of each by itself unless it says otherwise.

    Attributes:
        of: film -> law. Raises ValueError: none is known.
        any_shape: whether it is the same for spheres and discs.
        any_ratio: whether it is the same for all ratios of the radii of two bodies, and for all walls.
        modes: for which it is known.
        closed: shapes of which the law of one film is, by its `at`, that of films of any ratio.
    """

    of: Callable[[GapFilm], LubricationLaw]
    any_shape: bool
    any_ratio: bool
    modes: tuple[Mode, ...]
    closed: tuple[Shape, ...] = ()


LAWS: dict[str, NamedLaw] = {}


def named[F: Callable[[GapFilm], LubricationLaw]](
    name: str,
    *,
    any_shape: bool = False,
    any_ratio: bool = False,
    modes: tuple[Mode, ...] = ("squeeze",),
    closed: tuple[Shape, ...] = (),
) -> Callable[[F], F]:
    """Enter a law under a name. Raises ValueError: another law has it."""

    def enter(law: F) -> F:
        if name in LAWS:
            refuse_taken(name, LAWS[name].of, law)
        LAWS[name] = NamedLaw(law, any_shape, any_ratio, modes, closed)
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


@named("exact", modes=MODES, closed=("discs",))
def exact_law(film: GapFilm) -> ScaledLaw:
    """The exact law: of discs in closed form, of spheres within 1e-9 through a table of exact values.

    For spheres inside a round wall of more than 100 radii it is that of a plane, within 1 %.

    The table is of gaps from 1e-9 to 1e6 reduced radii, of shear from 1e-8, of rotation from there to 1000.
    Extrapolated, it goes on with a power of the gap: below, that is the leading term, and above it leads to
    the drag of a lone sphere. The logarithms of shear and rotation are 10 % too large at 1e-12.

    Raises ValueError: as `exact_resistance`, but for the round walls that are taken for planes.
    """
    profile: Profile
    if film.shape == "discs":
        profile = disc_profile(film.mode, film.ratio)
    else:
        ratio = inf if film.ratio < -_LARGE else film.ratio
        profile = _table_of_spheres(film.mode, ratio, film.beyond_drag and film.mode == "squeeze")
    return ScaledLaw(profile, film.viscosity, EXPONENTS[film.shape, film.mode], film.extrapolate)


@cache
def _table_of_spheres(mode: Mode, ratio: float, beyond_limit: bool) -> TabulatedProfile:
    decades, limit = round(np.log10(_FARTHEST[mode] / _NEAREST[mode])), _LIMITS[mode]
    s = np.geomspace(_NEAREST[mode], _FARTHEST[mode], decades * _POINTS + 1)
    # By parts, as all gaps that are summed together take as many terms as the smallest.
    K = np.concatenate(
        [exact_resistance("spheres", mode, part, ratio) for part in np.array_split(s, decades)]
    )
    return TabulatedProfile(s, K - limit if beyond_limit else K, True, 0.0 if beyond_limit else limit)


def exact_resistance(shape: Shape, mode: Mode, gap: ArrayLike, ratio: float) -> Array:
    """K(s) of spheres or discs at gaps s in units of the reduced radius, mu = 1.

    ratio: b/a, infinite for a plane, -R/a inside a round wall.

    Of discs all are known, but for shear and rotation inside a round wall.

    Raises ValueError: those; shear or rotation of two spheres, or a sphere inside a round wall: no closed
    form here; or a gap is not positive.
    """
    if shape == "discs":
        return disc_profile(mode, ratio).value(gap_ratio(gap, 1.0))
    if ratio < 0.0:
        raise ValueError(f"none of a sphere is known here within a round wall of {-ratio:g} radii")
    if ratio == inf:
        return np.asarray(_BESIDE_PLANE[mode](gap, 1.0, 1.0))
    if mode != "squeeze":
        raise ValueError(f"no exact resistance to {mode} of two spheres is known here")
    return spheres.relative_resistance(gap, 1.0 + 1.0 / ratio, 1.0 + ratio, 1.0)


_BESIDE_PLANE: dict[Mode, Callable[[ArrayLike, float, float], Array]] = {
    "squeeze": spheres.normal_resistance,
    "shear": sphere_beside_plane.parallel_resistance,
    "rotation": sphere_beside_plane.rotation_resistance,
}
