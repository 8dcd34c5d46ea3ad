"""A lubrication law from samples of a resistance: least squares with the errors of samples and of the model.

Samples K_i at s_i have error bars b_i, and the exact K is the series sum_k c_k phi_k(s) of its geometry,
which a fit must break off. So the coefficients of the first terms are free, and those of later terms are
unknown numbers of natural size. A series converges up to a gap d = 2 a at most, a the smaller radius, as at
d = -2 a it is singular, where a would touch the other from inside; so coefficients fall like powers of
1/(2 a). They are normal, of mean 0 and a standard deviation w_k = 3 |c1| (a_r/2a)^p of a power p (no known
one, in `fsi.lubrication.expansions`, is larger), of confined pairs more. They are estimated with the others,
and what is not known of them is the error of the model, which so enters every confidence interval:

    min over c   (K - Phi c)^T C^-1 (K - Phi c) + sum over later k (c_k/w_k)^2
    C = diag(b^2) + b b^T

Samples at d >= 2 a are left aside. What follows the last terms is taken up by them: of 900 fits to exact
functions (`fsi.lubrication.named_laws`), with bars of 1e-7 to 1e-3 of them and ranges that end at s of 0.3
to 20, 1 in 100 leaves its band anywhere, by half a band at most (by a script). With half powers up to s^4.5,
and samples of any gap, 15 in 100 did, by up to 28 bands.

C counts every bar twice, as independent and as common to all samples: meshes of one kind may err to the same
side at every gap. Bars count as standard deviations; those of resolved forces are bounds, so it is cautious,
but for errors as large as their bars that drift from one side to the other with the gap.
"""

from dataclasses import dataclass

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.lubrication.expansions import PairSeries
from fsi.lubrication.profiles import Term

FREE = 3  # of the terms, the first ones, have no prior
CONFIDENCE = 1.959963984540054  # standard deviations of a 95 % interval
NATURAL = 3.0  # of later coefficients over c1, where gaps are measured in those to which a series converges
CONSISTENT = 0.05  # smallest probability of so large a chi^2 at which a fit is believed
# Of later coefficients over the constant that surroundings add. Boxes that leave a disc half a radius at its
# sides have 4 times the constant, those of two radii 0.6 times.
SURROUNDINGS = 3.0


@dataclass(frozen=True, slots=True)
class Fit:
    """A fitted series.

    Attributes:
        terms: phi_k.
        free: how many of them, the first ones, have no prior.
        coefficients: c, (k,).
        root: A of the covariance A A^T of c, (k, k); of m and c, (1 + k, 1 + k), where powers change with a
            fitted m. The covariance itself, of terms that nearly cancel, would lose what is left of them.
        slopes: d power / dm of each term then, (k,), or None.
        range: the smallest and largest s of the samples that were used.
        used: which samples, (n,).
        chi2, dof: of the used ones.
        exponent, exponent_error: the leading power of s if free, and its standard deviation, or nan.
    """

    terms: tuple[Term, ...]
    free: int
    coefficients: Array
    root: Array
    slopes: Array | None
    range: tuple[float, float]
    used: NDArray[np.bool_]
    chi2: float
    dof: int
    exponent: float
    exponent_error: float

    @property
    def agrees(self) -> bool:
        """Whether so large a chi^2 is believable."""
        return believable(self.chi2, self.dof)

    @property
    def exponent_interval(self) -> float:
        """Half width of the 95 % interval of the exponent."""
        return CONFIDENCE * self.exponent_error

    @property
    def intervals(self) -> Array:
        """Half widths of the 95 % intervals of the coefficients, shape (k,)."""
        return band(np.eye(len(self.root)), self.root)[-len(self.terms) :]


def believable(chi2: float, dof: int) -> bool:
    """Whether samples with these errors have so large a chi^2 with a probability of CONSISTENT at least."""
    return bool(scipy.stats.chi2.sf(chi2, dof) >= CONSISTENT)


def band(rates: Array, root: Array) -> Array:
    """Half width of the 95 % interval of what has these derivatives by p parameters, (..., p): (...).

    root: A of their covariance A A^T, (p, p).
    """
    return np.asarray(CONFIDENCE * np.linalg.norm(rates @ root, axis=-1))


def design(terms: tuple[Term, ...], s: Array) -> Array:
    """phi_k(s), shape (..., k)."""
    return np.stack([term.value(s) for term in terms], axis=-1)


def design_with_exponent(terms: tuple[Term, ...], coefficients: Array, slopes: Array, s: Array) -> Array:
    """dK/dm, where powers change with m by these slopes, (k,), and dK/dc_k = phi_k(s): shape (..., 1 + k)."""
    phi = design(terms, s)
    of_m = phi @ (coefficients * slopes) * np.log(s)  # a power p has the derivative ln s s^p
    return np.concatenate([of_m[..., None], phi], axis=-1)


def fit_series(s: Array, K: Array, bars: Array, series: PairSeries) -> Fit:
    """Fit the series to the samples of the smallest gaps, to as many as agree with it.

    Those beyond its reach are left aside, and the farthest of the others are dropped until chi^2 is
    believable, down to one more than free coefficients, where it may still not be: see `Fit.agrees`.

    s: gaps over the reduced radius, increasing, (n,), of which more than FREE are in reach. K, bars: samples
    of the profile and their errors, positive, (n,). series: the first FREE of its terms have no prior.
    Raises ValueError: too few samples, or not in order.
    """
    near, terms = int(np.sum(s < series.reach)), series.terms
    if near <= FREE or np.any(np.diff(s) <= 0.0):
        raise ValueError(f"{near} samples: a fit needs more than {FREE}, at increasing gaps")
    # |c1| is known well enough by the first sample
    natural = abs(K[0] / terms[0].value(s[:1])[0]) * _sizes(series)
    for n in range(near, FREE, -1):
        phi, widths = design(terms, s[:n]), natural
        c, root, misfit = regression(phi, K[:n], bars[:n], widths)
        if series.confined:
            widths = np.maximum(widths, SURROUNDINGS * abs(c[terms.index(Term(0.0))]))
            c, root, misfit = regression(phi, K[:n], bars[:n], widths)
        if believable(misfit, n - FREE):
            break
    exponent, error = _leading_exponent(s[:n], K[:n], bars[:n], terms, widths)
    return Fit(
        terms, FREE, c, root, None, (float(s[0]), float(s[n - 1])), np.arange(len(s)) < n,
        misfit, n - FREE, exponent, error,
    )  # fmt: skip


def _sizes(series: PairSeries) -> Array:
    """Of the coefficients of later terms, over |c1|."""
    return NATURAL * np.array([series.reach**-term.power for term in series.terms[FREE:]])


def regression(phi: Array, K: Array, bars: Array, widths: Array) -> tuple[Array, Array, float]:
    """c, the root A of its covariance A A^T, and the minimum; `widths` belong to the last columns of phi."""
    of_bars = scipy.linalg.cholesky(np.diag(bars**2) + np.outer(bars, bars), lower=True)
    data = scipy.linalg.solve_triangular(of_bars, np.column_stack([phi, K]), lower=True)
    prior = np.hstack([np.zeros((len(widths), phi.shape[1] - len(widths))), np.diag(1.0 / widths)])
    matrix, right = np.vstack([data[:, :-1], prior]), np.append(data[:, -1], np.zeros(len(widths)))
    size = np.linalg.norm(matrix, axis=0)  # columns of one size: the terms themselves span many decades
    Q, R = np.linalg.qr(matrix / size)
    c = scipy.linalg.solve_triangular(R, Q.T @ right)
    root = scipy.linalg.solve_triangular(R, np.eye(len(size))) / size[:, None]
    return c / size, root, float(np.sum((matrix / size @ c - right) ** 2))


def _leading_exponent(
    s: Array, K: Array, bars: Array, terms: tuple[Term, ...], widths: Array
) -> tuple[float, float]:
    """The power p for which c1 s^p + the other terms fit best, and its standard deviation."""
    if terms[0].log:
        return float("nan"), float("nan")
    others = design(terms[1:], s)

    def misfit(p: float) -> float:
        return regression(np.column_stack([s**p, others]), K, bars, widths)[2]

    bounds, options = (terms[0].power - 0.5, terms[0].power + 0.5), {"xatol": 1e-10}
    p = float(scipy.optimize.minimize_scalar(misfit, bounds=bounds, method="bounded", options=options).x)
    # c1 s^(p + e) = c1 s^p + c1 e s^p ln s: the second coefficient has the variance of c1 e
    c, root, _ = regression(np.column_stack([s**p, s**p * np.log(s), others]), K, bars, widths)
    return p, float(np.linalg.norm(root[1]) / abs(c[0]))
