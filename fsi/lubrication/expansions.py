"""The expansions at small gaps of the resistances K(s), s = d/a_r, their bases and exact coefficients.

The pair is two spheres or two discs of radii a, b; `ratio` is b/a, infinite for a plane, -R/a inside a round
wall; a_r = a b/(a + b). K is the resistance over mu a_r^n (see `fsi.lubrication.laws`), n of `EXPONENTS`.

    squeeze, spheres   K = c1/s + c2 ln(1/s) + c3 + c4 s ln(1/s) + c5 s + ...
    squeeze, discs     K = c1 s^(-3/2) + c2 s^(-1/2) + c4 s^(1/2) + ..., a constant c3 = 0
    shear, rotation    of a disc K = c1 s^(-1/2) + c3 s^(1/2) + ..., a constant c2 = 0,
                       of a sphere K = c1 ln(1/s) + c2 + c3 s ln(1/s) + ...

Squeeze is relative motion along the line of centres without net force. Beside a wall shear is translation
along it without rotation, and rotation is turning in place. Of two bodies shear is their surfaces sliding
past each other without a couple, and rotation is rolling without sliding, in the relative rate of rotation
(see `fsi.lubrication.two_discs`); the first terms of both are those of Reynolds' equation.

Sources: D. J. Jeffrey and Y. Onishi, J. Fluid Mech. 139 (1984) 261 for squeezed spheres (g_1, g_2, g_3); A.
J. Goldman, R. G. Cox and H. Brenner, Chem. Eng. Sci. 22 (1967) 637 for a sphere along a plane; S. Kim and S.
J. Karrila, Microhydrodynamics (1991), section 9.3, for the logarithms of two spheres; for discs the closed
forms of `fsi.lubrication.exact` and `two_discs`. Tests compare them with the exact functions.
"""

from dataclasses import dataclass
from math import inf, pi, sqrt
from typing import Literal

from fsi.lubrication.profiles import Series, Term

type Shape = Literal["spheres", "discs"]
type LawShape = Shape | Literal["shapes"]  # of a pair of which one is of another shape, or a wall is
type Mode = Literal["squeeze", "shear", "rotation"]

SHAPES: tuple[Shape, ...] = ("spheres", "discs")
MODES: tuple[Mode, ...] = ("squeeze", "shear", "rotation")

# k of the last terms: s^k beside s^k ln(1/s) or s^(k + 1/2), and s^(k + 1/2) alone. They take up what is left
# out, up to where no series converges.
_HIGHEST, _HIGHEST_ALONE = 4, 7

EXPONENTS: dict[tuple[LawShape, Mode], int] = {
    ("spheres", "squeeze"): 1,
    ("spheres", "shear"): 1,
    ("spheres", "rotation"): 3,
    ("discs", "squeeze"): 0,
    ("discs", "shear"): 0,
    ("discs", "rotation"): 2,
    ("shapes", "squeeze"): 0,
}


@dataclass(frozen=True, slots=True)
class PairSeries:
    """The terms of one pair that a fit may use.

    Attributes:
        terms: phi_k, in the order of their size at small s.
        reach: the s below which there is a series: that of d = 2 a, a the smaller radius.
        confined: whether surroundings add what is analytic in s: a constant, one of the first terms, and
            later terms of its size.
    """

    terms: tuple[Term, ...]
    reach: float
    confined: bool = False


def pair_series(shape: Shape, mode: Mode, ratio: float, *, confined: bool = False) -> PairSeries:
    """Those of a pair with this b/a >= 1, infinite beside a plane."""
    return PairSeries(basis(shape, mode, confined=confined), 2.0 * (1.0 + 1.0 / ratio), confined)


def basis(shape: Shape, mode: Mode, *, confined: bool = False) -> tuple[Term, ...]:
    """The terms that a fit may use, in the order of their size at small s.

    Those of discs include a constant, which the exact expansion has not: a container that stands for infinity
    may add a little. Where the pair is confined, what surroundings add is analytic in s: 1, s, s^2, ...
    """
    if shape == "discs":
        singular = (-1.5, -0.5) if mode == "squeeze" else (-0.5,)
        whole, halves = (_HIGHEST, _HIGHEST) if confined else (0, _HIGHEST_ALONE)
        powers = sorted([*range(whole + 1), *(k + 0.5 for k in range(halves + 1))])
        return tuple(Term(float(power)) for power in (*singular, *powers))
    regular = tuple(Term(float(k), log) for k in range(_HIGHEST + 1) for log in (True, False))
    return (Term(-1.0), *regular) if mode == "squeeze" else regular


def is_singular(term: Term) -> bool:
    """Whether a term grows without bound as the gap closes: its coefficient is that in any surroundings."""
    return term.power < 0.0 or (term.power == 0.0 and term.log)


def coefficients(shape: Shape, mode: Mode, ratio: float) -> dict[Term, float]:
    """The coefficients that are known in closed form; of shear and rotation inside a round wall the first."""
    if mode == "squeeze":
        return _squeezed_spheres(ratio) if shape == "spheres" else _squeezed_discs(ratio)
    if ratio != inf and ratio > 0.0:
        return _sliding_spheres(mode) if shape == "spheres" else _sliding_discs(mode, ratio)
    known = _beside_a_plane(shape, mode)
    return known if ratio == inf else dict([next(iter(known.items()))])


def _beside_a_plane(shape: Shape, mode: Mode) -> dict[Term, float]:
    if shape == "discs":  # 4 pi/al and 4 pi coth al, cosh al = 1 + s
        unit, following = sqrt(2.0) * pi, sqrt(2.0) * pi / 6.0 if mode == "shear" else 1.5 * sqrt(2.0) * pi
        return {Term(-0.5): 2.0 * unit, Term(0.0): 0.0, Term(0.5): following}
    log, constant, later = (8 / 15, 0.954294, 64 / 375) if mode == "shear" else (2 / 5, 0.370893, 66 / 125)
    unit = 6.0 * pi if mode == "shear" else 8.0 * pi
    return {Term(0.0, True): unit * log, Term(0.0): unit * constant, Term(1.0, True): unit * later}


def expansion(shape: Shape, mode: Mode, ratio: float, terms: int) -> Series:
    """K(s) by the first terms that are known, of the `basis`."""
    known = coefficients(shape, mode, ratio)
    leading = tuple(term for term in basis(shape, mode) if term in known)[:terms]
    return Series(leading, tuple(known[term] for term in leading))


def _squeezed_spheres(ratio: float) -> dict[Term, float]:
    """6 pi (1/s + g2 ln(1/s) + ... + g3 s ln(1/s)); with k = a b/(a + b)^2 instead of the ratio."""
    k = overlap_of(ratio)
    g2 = (1.0 + 5.0 * k) / 5.0  # (1 + 7 l + l^2) / (5 (1 + l)^2)
    g3 = (1.0 + 14.0 * k - 63.0 * k**2) / 21.0  # (1 + 18 l - 29 l^2 + 18 l^3 + l^4) / (21 (1 + l)^4)
    known = {Term(-1.0): 1.0, Term(0.0, True): g2, Term(1.0, True): g3}
    if ratio == inf:
        known[Term(0.0)] = 0.97127993103572
    elif ratio == 1.0:
        known[Term(0.0)] = 1.34558019978 + 0.45 * 0.6931471805599453  # ln(1/s) counts d/(a/2) here, not d/a
    return {term: 6.0 * pi * value for term, value in known.items()}


def _squeezed_discs(ratio: float) -> dict[Term, float]:
    """4 pi/(L - tanh L) with cosh L = 1 + s + k s^2/2, k = a b/(a + b)^2."""
    k, unit = overlap_of(ratio), 3.0 * sqrt(2.0) * pi
    return {Term(-1.5): unit, Term(-0.5): unit * (21.0 / 20.0 - 0.75 * k), Term(0.0): 0.0}


def _sliding_spheres(mode: Mode) -> dict[Term, float]:
    """Of the surfaces' speeds U_i and U_j, 2 pi mu a_r ln(1/s) ((U_i - U_j)^2 + 3/5 (U_i + U_j)^2)."""
    return {Term(0.0, True): 2.0 * pi if mode == "shear" else 24.0 / 5.0 * pi}


def _sliding_discs(mode: Mode, ratio: float) -> dict[Term, float]:
    """sqrt2 pi s^(-1/2) and four times that; what follows is of `two_discs`, k = a b/(a + b)^2."""
    k, unit = overlap_of(ratio), sqrt(2.0) * pi
    first, next_over_it = (unit, 5 / 12 - 9 / 4 * k) if mode == "shear" else (4.0 * unit, (5 + 13 * k) / 12)
    return {Term(-0.5): first, Term(0.0): 0.0, Term(0.5): first * next_over_it}


def overlap_of(ratio: float) -> float:
    """k = a b/(a + b)^2, from 0 beside a plane to 1/4 of equal bodies; negative inside a round wall."""
    return 0.0 if ratio == inf else ratio / (1.0 + ratio) ** 2


def ratio_of(overlap: float) -> float:
    """b/a of k, |b/a| >= 1."""
    if overlap == 0.0:
        return inf
    return (1.0 - 2.0 * overlap + sqrt(max(1.0 - 4.0 * overlap, 0.0))) / (2.0 * overlap)
