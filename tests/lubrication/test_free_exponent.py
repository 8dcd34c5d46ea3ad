"""Leading exponents that are not known before, from samples of series whose exponents are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.lubrication.expansions import Shape
from fsi.lubrication.fitting import CONFIDENCE, Fit, band, design, design_with_exponent
from fsi.lubrication.free_exponent import PLANAR, REVOLVED, FreeSeries, fit_exponent
from fsi.lubrication.named_laws import exact_resistance

S = np.geomspace(1e-6, 1e-2, 16)


@settings(max_examples=8, deadline=None)
@given(
    m=st.floats(0.4, 1.5),
    c=st.tuples(*[st.floats(-3.0, 3.0)] * 3),
    seed=st.integers(0, 1000),
)
def test_the_exponent_of_a_series_is_found_within_its_interval(
    m: float, c: tuple[float, ...], seed: int
) -> None:
    """s^-m + c_2 s^(-m/3) + c_3 + c_4 s^(m/3), off by its bars: within four of their deviations.

    So is the law, with bars that are no longer than those of single samples (`test_a_law_is_known_...`).
    """
    noise = 1e-6 * np.random.default_rng(seed).standard_normal(len(S))
    K = (S[:, None] ** (m * np.array([-1.0, -1.0 / 3.0, 0.0, 1.0 / 3.0])) * [1.0, *c]).sum(axis=1)
    if np.any(K <= 0.0):
        return
    fit = fit_exponent(S, K * (1.0 + noise), 1e-6 * K)
    assert abs(fit.exponent + m) < 4.0 * fit.exponent_error
    assert abs(fit.coefficients[0] - 1.0) < 4.0 / CONFIDENCE * fit.intervals[0]
    off = np.abs(design(fit.terms, S) @ fit.coefficients - K)[fit.used]
    assert np.all(off < 4.0 / CONFIDENCE * width_of_law(fit, S[fit.used]))
    # Samples of 1e-6 over four decades give it to 1e-7 alone; terms that are close by, to 1e-4 at m = 0.4.
    # Where by chance the widest gaps do not agree (one time of twenty) and are left out, to a few times that.
    assert fit.exponent_error < (3e-4 if fit.used.all() else 3e-3)


@pytest.mark.parametrize("m", [0.5, 0.717, 0.742, 0.767])
def test_a_term_that_follows_is_not_taken_for_the_first(m: float) -> None:
    """Of s^-m alone three times m would do as well, with c_1 = 0, and was found for m of 0.7 to 0.8."""
    noise = 1e-6 * np.random.default_rng(0).standard_normal(len(S))
    fit = fit_exponent(S, S**-m * (1.0 + noise), 1e-6 * S**-m)
    assert fit.exponent == pytest.approx(-m, abs=1e-4)


def test_a_disc_beside_a_plane_has_its_own_exponent() -> None:
    """3/2 and 3 sqrt(2) pi (Jeffrey and Onishi 1981), by a fit that does not know them."""
    K = exact_resistance("discs", "squeeze", S, np.inf)
    fit = fit_exponent(S, K, 1e-6 * K)
    assert fit.exponent == pytest.approx(-1.5, abs=1e-5)
    assert fit.coefficients[0] == pytest.approx(3.0 * np.sqrt(2.0) * np.pi, rel=1e-4)


@pytest.mark.parametrize(
    ("shape", "series", "smallest", "largest", "error"),
    [("discs", PLANAR, 1e-3, 0.9, 3e-8), ("spheres", REVOLVED, 1e-4, 0.3, 1e-7)],
)
def test_wide_gaps_do_not_shift_the_exponent(
    shape: Shape, series: FreeSeries, smallest: float, largest: float, error: float
) -> None:
    """3/2 and 3 sqrt(2) pi, 1 and 6 pi: with series that end at s^m or s 1.6 to 2.9 intervals off."""
    m, first = (1.5, 3.0 * np.sqrt(2.0) * np.pi) if shape == "discs" else (1.0, 6.0 * np.pi)
    s = np.geomspace(smallest, largest, 14)
    K = exact_resistance(shape, "squeeze", s, np.inf)
    fit = fit_exponent(s, K, error * K, series)
    assert fit.used.all()
    assert abs(fit.exponent + m) < 0.5 * fit.exponent_interval < 15.0 * error
    assert abs(fit.coefficients[0] - first) < 0.5 * fit.intervals[0] < 100.0 * error * first


def film_of_an_ellipse(d: Array, b: float) -> Array:
    """12 int x^2/h^3 dx below the flat side of half axes 1 and b, h = d + b (1 - cos t), x = sin t."""
    u = np.linspace(-12.0, 12.0, 4001)
    t = np.sqrt(d[:, None] / b) * np.sinh(u)
    t, weight = np.clip(t, -np.pi / 2.0, np.pi / 2.0), np.where(np.abs(t) < np.pi / 2.0, np.cosh(u), 0.0)
    h = d[:, None] + b * (1.0 - np.cos(t))
    inside = np.sin(t) ** 2 * np.cos(t) / h**3 * weight * np.sqrt(d[:, None] / b)
    return np.asarray(12.0 * (u[1] - u[0]) * inside.sum(axis=1))


def test_samples_beyond_the_film_are_left_aside() -> None:
    """3/2 and 3 sqrt(2) pi R^(3/2), R = 1/b; by samples up to the larger half axis 3.3 intervals off."""
    b, d = 0.15, np.geomspace(1e-3, 0.5, 12)
    K = film_of_an_ellipse(d, b)
    fit = fit_exponent(d, K, 1e-7 * K, PLANAR.within(8.0 / 9.0 * b))
    assert fit.range[1] < 8.0 / 9.0 * b
    first = 3.0 * np.sqrt(2.0) * np.pi / b**1.5
    assert abs(fit.exponent + 1.5) < fit.exponent_interval < 1e-4
    assert abs(fit.coefficients[0] - first) < fit.intervals[0] < 1e-3 * first
    with pytest.raises(ValueError, match="4 samples: a fit needs more than 4"):
        fit_exponent(d, K, 1e-7 * K, PLANAR.within(d[4]))


@pytest.mark.parametrize("lengths", [40.0, 100.0])
def test_gaps_may_be_given_by_a_length_far_above_that_of_the_film(lengths: float) -> None:
    """A disc's, 3 sqrt(2) pi / l^(3/2); with priors of c_1 at any l 1.9 intervals off."""
    s = np.geomspace(5e-6, 5e-3, 8)
    series = PLANAR.within(1.0 / lengths)
    K = exact_resistance("discs", "squeeze", lengths * s, np.inf)
    fit = fit_exponent(s, K, 1e-7 * K, series)
    first = 3.0 * np.sqrt(2.0) * np.pi / lengths**1.5
    assert fit.used.all()
    assert abs(fit.exponent + 1.5) < fit.exponent_interval < 1e-5
    assert abs(fit.coefficients[0] - first) < fit.intervals[0] < 1e-4 * first


@pytest.mark.parametrize("m", [0.6, 1.2, 1.5])
def test_what_surroundings_add_is_not_taken_for_the_pairs(m: float) -> None:
    """20/(2 - s)^(3/2), of a wall two lengths away, which is analytic in s."""
    s = np.geomspace(1e-4, 1e-1, 16)
    K = s**-m + 0.8 * s ** (-m / 3.0) + 0.5 * s ** (m / 3.0) + 20.0 / (2.0 - s) ** 1.5
    fit = fit_exponent(s, K, 1e-6 * K, PLANAR.confined())
    assert fit.used.all()
    assert abs(fit.exponent + m) < fit.exponent_interval < 1e-3
    assert abs(fit.coefficients[0] - 1.0) < fit.intervals[0]
    assert min(np.diff(sorted(term.power for term in fit.terms))) > 0.1
    # s is s^(5 m/3), s^2 is s^(10 m/3), or with m = 3/2 s^(2 m/3) and s^(4 m/3); with 6/5 s is no other
    assert len(fit.terms) == (19 if m == 1.2 else 18)


@pytest.mark.parametrize(("low", "high"), [(1e-4, 1e-1), (1e-5, 1e-2)])
def test_a_sphere_beside_a_plane_has_its_own_exponent(low: float, high: float) -> None:
    """1 and 6 pi (Brenner 1961); with the powers of the plane the exponent is three intervals off, 2e-5."""
    s = np.geomspace(low, high, 12)
    K = exact_resistance("spheres", "squeeze", s, np.inf)
    fit = fit_exponent(s, K, 1e-6 * K, REVOLVED)
    assert abs(fit.exponent + 1.0) < 2e-6
    assert abs(fit.exponent + 1.0) < CONFIDENCE * fit.exponent_error
    assert abs(fit.coefficients[0] - 6.0 * np.pi) < fit.intervals[0]
    assert fit.used.all()


def width_of_law(fit: Fit, s: Array) -> Array:
    """Half width of the 95 % interval of K(s)."""
    assert fit.slopes is not None
    return band(design_with_exponent(fit.terms, fit.coefficients, fit.slopes, s), fit.root)


@pytest.mark.parametrize("series", [PLANAR, REVOLVED, PLANAR.confined()])
def test_a_law_is_known_as_well_as_each_of_its_samples(series: FreeSeries) -> None:
    """A sample of the bar b has the variance 2 b^2 (independent and common), a fit to it and others no more.

    By errors of the coefficients alone, which those of the exponent cancel, it was up to 30 times as wide.
    """
    s = np.geomspace(1e-6, 1e-2, 12)
    K = s**-0.75 + 2.0
    bars = 1e-6 * K
    fit = fit_exponent(s, K, bars, series)
    assert fit.used.all()
    width = width_of_law(fit, s)
    assert np.all(width <= CONFIDENCE * np.sqrt(2.0) * bars * (1.0 + 1e-6))
    assert np.all(width >= CONFIDENCE * bars * (1.0 - 1e-6))  # what is common to all is averaged away by none


def test_too_few_samples_are_refused() -> None:
    with pytest.raises(ValueError, match="4 samples: a fit needs more than 4"):
        fit_exponent(S[:4], 1.0 / S[:4], S[:4])
