"""Discs in closed form: at any gap, in round walls, for many k at once, and their integrals."""

from __future__ import annotations

from math import inf, log, pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.lubrication import exact, two_discs
from fsi.lubrication.disc_profiles import disc_profile
from fsi.lubrication.expansions import MODES, Mode
from fsi.lubrication.named_laws import GapFilm, exact_law

S = np.geomspace(1e-12, 1e9, 90)


@pytest.mark.parametrize("ratio", [1.0, 3.0, 50.0])
def test_pairs_have_the_closed_forms_of_their_radii(ratio: float) -> None:
    """From gaps of 1e-12 to 1e9 reduced radii; the power of the gap at 100 would be off by 5 % at 400."""
    a, b = 1.0 + 1.0 / ratio, 1.0 + ratio
    resistances = (exact.relative_resistance, two_discs.sliding_resistance, two_discs.rolling_resistance)
    for mode, resistance in zip(MODES, resistances, strict=True):
        law = exact_law(GapFilm("discs", 1.0, ratio, mode=mode))
        assert_allclose(law.kappa(S, 1.0), resistance(S, a, b, 1.0), rtol=1e-12)


def test_a_disc_beside_a_plane_has_the_closed_forms_at_any_gap() -> None:
    """At 200 radii squeeze is 2.5150556 = 4 pi/(al - tanh al), cosh al = 201, and not 2.487."""
    resistances = (exact.normal_resistance, exact.parallel_resistance, exact.rotation_resistance)
    for mode, resistance in zip(MODES, resistances, strict=True):
        law = exact_law(GapFilm("discs", 1.0, mode=mode))
        assert_allclose(law.kappa(S, 1.0), resistance(S, 1.0, 1.0), rtol=1e-12)
    al = np.arccosh(201.0)
    K = 4.0 * pi / (al - np.tanh(al))
    assert pytest.approx(2.5150556, rel=1e-7) == K
    assert exact_law(GapFilm("discs", 1.0)).kappa(200.0, 1.0) == pytest.approx(K, rel=1e-12)


@pytest.mark.parametrize("R", [1.01, 1.5, 3.0, 99.0, 1e6])
def test_a_disc_in_a_round_wall_has_its_law_up_to_the_centre(R: float) -> None:
    """a = 1: by both radii, and at the centre that of the annulus; a spline is off by 5e-7 near the end."""
    a_r = R / (R - 1.0)
    law = exact_law(GapFilm("discs", 1.0, -R))
    gap = (R - 1.0) * np.concatenate([np.geomspace(1e-9, 0.9, 50), 1.0 - np.geomspace(0.1, 1e-9, 50)])
    assert_allclose(law.kappa(gap, a_r), exact.relative_resistance(gap, 1.0, -R, 1.0), rtol=1e-11)
    annulus = 4.0 * pi / (log(R) - (R**2 - 1.0) / (R**2 + 1.0))
    assert law.range[1] * a_r == pytest.approx(R - 1.0, rel=1e-12)
    beyond = exact_law(GapFilm("discs", 1.0, -R, extrapolate=True))  # as a cutoff may be
    assert_allclose(beyond.kappa([R - 1.0, 3.0 * R], a_r), annulus, rtol=1e-7 if R < 1.1 else 1e-10)


def test_many_films_at_once_are_each_its_own() -> None:
    """k of pairs, of a plane and of round walls in one array."""
    k = np.array([0.25, 0.1, 1e-4, 0.0, -0.2, -3.0])
    s = np.array([0.1, 1.0, 30.0, 2.0, 4.0, 0.3])
    for mode in MODES:
        profile, some = disc_profile(mode, 1.0), slice(None) if mode == "squeeze" else slice(3)
        together = profile.at(k[some])
        for n, (one_k, one_s) in enumerate(zip(k[some], s[some], strict=True)):
            alone = profile.at(np.array([one_k]))
            assert_allclose(together.value(s[some])[n], alone.value(np.array([one_s]))[0], rtol=1e-15)


CASES = [(mode, ratio) for mode in MODES for ratio in (1.0, 4.0, 1e3, inf)] + [
    ("squeeze", -R) for R in (1.05, 3.0, 200.0)
]


@pytest.mark.parametrize(("mode", "ratio"), CASES)
def test_the_integral_is_that_of_the_resistance(mode: Mode, ratio: float) -> None:
    """By Gauss's rule in ln s on a third of a decade each, from 1e-12 as far as there are gaps, or to 1e6."""
    profile = disc_profile(mode, ratio)
    ends = np.geomspace(1e-12, min(1e6, profile.range[1]), 55)
    x, w = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.log(ends[1:] / ends[:-1])[:, None]
    at = ends[:-1, None] * np.exp(half * (x + 1.0))
    expected = (half * profile.value(at) * at) @ w
    values = profile.integral(ends)
    error = np.abs(np.diff(values) - expected)
    assert np.all(error <= 1e-10 * expected + 2e-12 * np.abs(values[1:]))


def test_the_integral_of_small_gaps_is_that_of_the_leading_term() -> None:
    """-6 sqrt2 pi s^(-1/2), down to gaps that are continued in logarithms, 1e-150."""
    s = np.array([1e-150, 1e-75, 1e-30])
    assert_allclose(disc_profile("squeeze", 1.0).integral(s), -6.0 * 2**0.5 * pi / np.sqrt(s), rtol=1e-13)


@pytest.mark.parametrize("mode", ["shear", "rotation"])
def test_no_disc_slides_in_a_round_wall(mode: Mode) -> None:
    with pytest.raises(ValueError, match=f"no exact resistance to {mode} is known here within a round wall"):
        disc_profile(mode, -3.0)
