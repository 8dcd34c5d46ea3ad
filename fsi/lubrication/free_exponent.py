"""A series whose leading exponent is not known before: of gaps between surfaces of any shape.

In the plane, towards a surface h = q + c |x|^(1 + alpha) the leading term is q^-m, m = 3 alpha / (1 + alpha).
What follows is smaller by the square of the slopes of the film, q^(2 m / 3), and what resists elsewhere adds
a constant:

    K(s) = c_1 s^-m + c_2 s^(-m/3) + c_3 + c_4 s^(m/3) + c_5 s^(2 m/3) + c_6 s^m + ... + c_8 s^(5 m/3)

For smooth surfaces, m = 3/2, these are the powers of `fsi.lubrication.expansions`. Between smooth bodies of
revolution m is 1 and the rest as for spheres,

    K(s) = c_1 s^-m + c_2 ln(1/s) + c_3 + c_4 s ln(1/s) + c_5 s + c_6 s^2 ln(1/s) + c_7 s^2

Where the pair is confined, what surroundings add is analytic in s, and s and s^2 are terms as well, but for
one that is there already: for m = 3/2, s^(2 m / 3).

m is that for which the fit of `fsi.lubrication.fitting` is best, and its error enters those of the
coefficients through dK/dm. Both errors nearly cancel in K, which is known as well as its samples are: so the
covariance is that of m and c together.

A film has a length l, `fsi.calibration.film`, up to which its series converges: in units of it all
coefficients are of the size of c_1, so that of a power p is some NATURAL l^-(p + m) c_1. That is the prior of
those after the third. Samples at gaps from l on are left aside: the flat side of a slender ellipse is its
parabola up to gaps of its thickness alone, and its end has the radius b^2/a. With priors by the nominal size
and samples of any gap, 4 of 10 fits to resolved samples of 20 pairs missed m or its coefficient, by up to a
thousand intervals and more; of 640 fits to 37 pairs none now does, it is off by 0.7 intervals at most (by a
script).
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array
from fsi.lubrication.fitting import FREE, Fit, believable, design, design_with_exponent, regression
from fsi.lubrication.profiles import Term

NATURAL = 10.0  # size of later coefficients over c_1, where gaps are measured in the length of the film
LEAST, MOST, PIECES = 0.05, 2.5, 99  # where m is looked for
CLOSE = 1e-3  # powers that differ by less are one: over four decades of s their terms differ by 1 %
# Of the first sample: with c_1 = 0 three times m would do as well, as what follows has a third of it.
LEADS = 0.01


@dataclass(frozen=True, slots=True)
class FreeSeries:
    """The terms of a series whose m is to be found.

    Attributes:
        ratios: the powers over m of those that change with it, the leading one first.
        others: those that do not.
        reach: the length l of the film, in the unit of s.
    """

    ratios: tuple[float, ...]
    others: tuple[Term, ...] = ()
    reach: float = 1.0

    def terms(self, m: float) -> tuple[Term, ...]:
        """All of them."""
        return (*(Term(ratio * m) for ratio in self.ratios), *self.others)

    @property
    def slopes(self) -> Array:
        """d power / dm of each, (k,)."""
        return np.array([*self.ratios, *(0.0 for _ in self.others)])

    def widths(self, m: float, s: Array, K: Array) -> Array:
        """Of the later coefficients, by the c_1 that the first sample has."""
        rises = np.array([term.power + m for term in self.terms(m)[FREE:]])
        return np.asarray(NATURAL * float(K[0] * s[0] ** m) * self.reach**-rises)

    def within(self, reach: float) -> "FreeSeries":
        """Of a film of this length."""
        return replace(self, reach=reach)

    def confined(self) -> "FreeSeries":
        """With what surroundings add, which is analytic in s: s and s^2, as the constant is there."""
        return replace(self, others=tuple(dict.fromkeys((*self.others, Term(1.0), Term(2.0)))))

    def distinct(self, m: float) -> "FreeSeries":
        """Without those of the others that are at this m among the first: a fit would share c out to both."""
        powers = m * np.array(self.ratios)
        others = (term for term in self.others if term.log or np.all(np.abs(powers - term.power) > CLOSE))
        return replace(self, others=tuple(others))


# Series that end at s^(3 m) and s^3 put exponents up to three intervals off, by samples near the reach.
PLANAR = FreeSeries(tuple(k / 3.0 for k in (-3, -1, *range(16))))
REVOLVED = FreeSeries((-1.0,), tuple(Term(float(k), log) for k in range(6) for log in (True, False)))


def fit_exponent(s: Array, K: Array, bars: Array, series: FreeSeries = PLANAR) -> Fit:
    """Fit the series to the samples of the smallest gaps in its reach, to as many as agree with it.

    s: gaps over a length, increasing, (n,), of which more than FREE + 1 are in reach. K, bars: resistances
    and their errors, positive, (n,). Raises ValueError: too few samples, or not in order.
    """
    near = int(np.sum(s < series.reach))
    if near <= FREE + 1 or np.any(np.diff(s) <= 0.0):
        raise ValueError(f"{near} samples: a fit needs more than {FREE + 1}, at increasing gaps")
    for n in range(near, FREE + 1, -1):
        samples = s[:n], K[:n], bars[:n]
        m, misfit = _best(series, *samples)
        if believable(misfit, n - FREE - 1):
            break
    series = series.distinct(m)
    terms, widths = series.terms(m), series.widths(m, s, K)
    c, misfit = _coefficients(series, m, *samples)
    columns = design_with_exponent(terms, c, series.slopes, s[:n])  # what has no prior comes first
    _, root, _ = regression(columns, K[:n], bars[:n], widths)
    return Fit(
        terms, FREE, c, root, series.slopes, (float(s[0]), float(s[n - 1])), np.arange(len(s)) < n,
        misfit, n - FREE - 1, -m, float(np.linalg.norm(root[0])),
    )  # fmt: skip


def _coefficients(series: FreeSeries, m: float, s: Array, K: Array, bars: Array) -> tuple[Array, float]:
    """Those of this m, and their misfit."""
    c, _, misfit = regression(design(series.terms(m), s), K, bars, series.widths(m, s, K))
    return c, misfit


def _best(series: FreeSeries, s: Array, K: Array, bars: Array) -> tuple[float, float]:
    """The m of the smallest misfit whose first term leads, and that."""

    def misfit(m: float) -> float:
        c, found = _coefficients(series, m, s, K, bars)
        return found if c[0] * s[0] ** -m >= LEADS * K[0] else np.inf

    tried = np.linspace(LEAST, MOST, PIECES)
    k = int(np.argmin([misfit(m) for m in tried.tolist()]))
    bounds, options = (tried[max(k - 1, 0)], tried[min(k + 1, PIECES - 1)]), {"xatol": 1e-11}
    found = scipy.optimize.minimize_scalar(misfit, bounds=bounds, method="bounded", options=options)
    return float(found.x), float(found.fun)
