"""A series whose leading exponent is not known before: of gaps between surfaces of any shape, in the plane.

Towards a surface h = q + c |x|^(1 + alpha) the leading term is q^-m with m = 3 alpha / (1 + alpha). What
follows is smaller by the square of the slopes of the film, q^(2 m / 3), and what resists elsewhere adds a
constant:

    K(s) = c_1 s^-m + c_2 s^(-m/3) + c_3 + c_4 s^(m/3) + c_5 s^(2 m/3) + c_6 s^m + ...

For smooth surfaces, m = 3/2, these are the powers of `fsi.lubrication.expansions`. m is that for which the
fit of `fsi.lubrication.fitting` is best, and its error enters those of the coefficients through dK/dm.
"""

import numpy as np
import scipy  # its modules load when they are used

from fsi.lubrication.fitting import CONSISTENT, Fit, design, regression
from fsi.lubrication.laws import Array, Term

RATIOS = (-1.0, -1.0 / 3.0, 0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0)  # powers over m
FREE = 3  # of the terms, the first ones, have no prior
NATURAL = 10.0  # size of the others over c_1: of tips c_2 and c_3 come to eight times that
LEAST, MOST, PIECES = 0.05, 2.5, 99  # where m is looked for


def fit_exponent(s: Array, K: Array, bars: Array) -> Fit:
    """Fit the series to the samples of the smallest gaps, to as many as agree with it.

    s: gaps over a length, increasing, (n,), n > 4. K, bars: resistances and their errors, positive, (n,).
    Raises ValueError: too few samples, or not in order.
    """
    if len(s) <= FREE + 1 or np.any(np.diff(s) <= 0.0):
        raise ValueError(f"{len(s)} samples: a fit needs more than {FREE + 1}, at increasing gaps")
    for n in range(len(s), FREE + 1, -1):
        m, misfit = _best(s[:n], K[:n], bars[:n])
        if scipy.stats.chi2.sf(misfit, n - FREE - 1) >= CONSISTENT:
            break
    terms, widths = _terms(m), _widths(m, s, K)
    phi = design(terms, s)
    c, _, _ = regression(phi[:n], K[:n], bars[:n], widths)
    slope = (phi[:n] * c * RATIOS).sum(axis=1) * np.log(s[:n])
    columns = np.column_stack([slope, phi[:n]])  # what has no prior comes first
    _, every, _ = regression(columns, K[:n], bars[:n], widths)
    return Fit(
        terms, FREE, c, every[1:, 1:], (float(s[0]), float(s[n - 1])), np.arange(len(s)) < n,
        (K - phi @ c) / bars, misfit, n - FREE - 1, -m, float(np.sqrt(every[0, 0])),
    )  # fmt: skip


def _terms(m: float) -> tuple[Term, ...]:
    return tuple(Term(ratio * m) for ratio in RATIOS)


def _widths(m: float, s: Array, K: Array) -> Array:
    """Of the later coefficients, by the c_1 that the first sample has."""
    return np.full(len(RATIOS) - FREE, NATURAL * float(K[0] * s[0] ** m))


def _best(s: Array, K: Array, bars: Array) -> tuple[float, float]:
    """The m of the smallest misfit, and that."""

    def misfit(m: float) -> float:
        return regression(design(_terms(m), s), K, bars, _widths(m, s, K))[2]

    tried = np.linspace(LEAST, MOST, PIECES)
    k = int(np.argmin([misfit(m) for m in tried.tolist()]))
    bounds, options = (tried[max(k - 1, 0)], tried[min(k + 1, PIECES - 1)]), {"xatol": 1e-11}
    found = scipy.optimize.minimize_scalar(misfit, bounds=bounds, method="bounded", options=options)
    return float(found.x), float(found.fun)
