"""Laws: their leading terms, integrals, dimensions, ranges, the cut, and the interpolated exact ones."""

from __future__ import annotations

from math import inf, log, pi, sqrt

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from fsi.errors import InputError
from fsi.lubrication import exact, spheres
from fsi.lubrication.expansions import MODES, SHAPES, Shape
from fsi.lubrication.laws import CutLaw, LubricationLaw, RangeError, ScaledLaw
from fsi.lubrication.named_laws import GapFilm, exact_law, exact_resistance, leading_law, slides_law
from fsi.lubrication.profiles import Series, TabulatedProfile, Term

MU = 0.7
SPHERES, DISCS = GapFilm("spheres", MU), GapFilm("discs", MU)
RATIOS = (1.0, 2.5, inf)
gaps = st.floats(-6.0, -1.0).map(lambda exponent: 10.0**exponent)
radii = st.floats(0.2, 5.0)


def sampled_law() -> ScaledLaw:
    """A monotone table of a few exact values."""
    s = np.geomspace(1e-7, 10.0, 30)
    return ScaledLaw(TabulatedProfile(s, exact_resistance("spheres", "squeeze", s, 1.0)), MU, 1)


LAWS: dict[str, LubricationLaw] = {
    "slides": slides_law(DISCS),
    "leading spheres": leading_law(SPHERES),
    "leading discs": leading_law(DISCS),
    "exact spheres": exact_law(GapFilm("spheres", MU, 2.5)),
    "exact discs": exact_law(GapFilm("discs", MU, 2.5)),
    "expansion": ScaledLaw(Series((Term(-1.0), Term(0.0, True), Term(1.0, True)), (3.0, 2.0, 1.0)), MU, 1),
    "table": sampled_law(),
    "cut": CutLaw(leading_law(DISCS), 0.05),
}


def test_leading_laws_are_those_of_the_textbook() -> None:
    """Theory of the four pairs, from the radii of the bodies; a forgotten 2^(3/2) or 4 would show."""
    d, a, b = np.array([1e-4, 1e-2]), 2.0, 0.5
    reduced = a * b / (a + b)
    sphere, disc = leading_law(SPHERES), leading_law(DISCS)
    assert_allclose(sphere.kappa(d, a), 6.0 * pi * MU * a**2 / d)
    assert_allclose(sphere.kappa(d, a / 2.0), 1.5 * pi * MU * a**2 / d)
    assert_allclose(sphere.kappa(d, reduced), 6.0 * pi * MU * (a * b / (a + b)) ** 2 / d)
    assert_allclose(disc.kappa(d, a), 3.0 * sqrt(2.0) * pi * MU * (a / d) ** 1.5)
    assert_allclose(disc.kappa(d, a / 2.0), 1.5 * pi * MU * (a / d) ** 1.5)
    assert_allclose(disc.integral(d, a), -6.0 * sqrt(2.0) * pi * MU * a**1.5 * d**-0.5)
    assert_allclose(slides_law(DISCS).kappa(d, a), MU / d)
    assert_allclose(np.diff(slides_law(DISCS).integral(d, a)), MU * np.diff(np.log(d)))


@pytest.mark.parametrize("name", LAWS)
@given(d=gaps, a=radii)
def test_the_integral_is_that_of_kappa(name: str, d: float, a: float) -> None:
    """Gauss's rule from d to 1.3 d: of degree 15, good to 1e-9 on every law; the cut ends the interval."""
    law, end = LAWS[name], 1.3 * d
    if name == "cut" and d < 0.05 < end:
        end = 0.05
    x, w = np.polynomial.legendre.leggauss(8)
    inside = 0.5 * (d + end) + 0.5 * (end - d) * x
    expected = 0.5 * (end - d) * w @ law.kappa(inside, a)
    found = law.integral(end, a) - law.integral(d, a)
    uncut = law.law if isinstance(law, CutLaw) else law
    scale = float(np.abs(uncut.integral(end, a)))  # the difference may cancel its first digits
    rtol = 1e-6 if name == "table" else 1e-8  # a cubic has jumps in its second derivative
    assert_allclose(found, expected, rtol=rtol, atol=1e-13 * scale)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("ratio", RATIOS)
def test_exact_laws_are_exact_between_their_points(shape: Shape, ratio: float) -> None:
    s = np.exp(np.random.default_rng(1).uniform(np.log(1e-9), np.log(100.0), 100))
    a, b = (2.0, inf) if ratio == inf else (2.0, 2.0 * ratio)
    reduced = a if ratio == inf else a * b / (a + b)
    law = exact_law(GapFilm(shape, MU, ratio))
    if shape == "discs":
        expected = exact.relative_resistance(s * reduced, a, b, MU)
    elif ratio == inf:
        expected = spheres.normal_resistance(s * reduced, a, MU)
    else:
        expected = spheres.relative_resistance(s * reduced, a, b, MU)
    assert_allclose(law.kappa(s * reduced, reduced), expected, rtol=1e-9)


@pytest.mark.parametrize("shape", SHAPES)
def test_exact_laws_go_on_as_their_leading_terms(shape: Shape) -> None:
    """At 1e-12 the next term is below 1e-10; the slope at the last point is known to 1e-8."""
    leading = leading_law(GapFilm(shape, MU))
    law = exact_law(GapFilm(shape, MU, 1.0, extrapolate=True))
    d = np.array([1e-14, 1e-12, 3e-12])
    assert_allclose(law.kappa(d, 1.0), leading.kappa(d, 1.0), rtol=2e-7)
    assert_allclose(np.diff(law.integral(d, 1.0)), np.diff(leading.integral(d, 1.0)), rtol=2e-7)


def test_a_table_takes_its_points_and_stays_between_them() -> None:
    s = np.geomspace(1e-7, 10.0, 30)
    K = exact_resistance("discs", "squeeze", s, 1.0)
    table = TabulatedProfile(s, K)
    assert_allclose(table.value(s), K, rtol=1e-13)
    fine = np.geomspace(*table.range, 500)
    assert np.all(np.diff(table.value(fine)) < 0.0)
    assert_allclose(table.value(fine), exact_resistance("discs", "squeeze", fine, 1.0), rtol=5e-3)


def test_the_exact_law_beyond_drag_falls_like_the_next_term() -> None:
    """K - 6 pi of a sphere beside a plane, far away 6 pi 9/8 /(s - 1/8) (H. A. Lorentz, 1907).

    Measured 2e-9 where K cancels, 2e-6 beyond the table; the power of K - 6 pi at s = 100 is off by 2 %.
    """
    s = np.exp(np.random.default_rng(2).uniform(np.log(1e-3), np.log(1e4), 50))
    beyond = exact_law(GapFilm("spheres", 1.0, extrapolate=True, beyond_drag=True))
    assert_allclose(beyond.kappa(s, 1.0), spheres.normal_resistance(s, 1.0, 1.0) - 6.0 * pi, rtol=1e-7)
    far = np.array([1e6, 1e7, 1e9])
    assert_allclose(beyond.kappa(far, 1.0), 6.0 * pi * 9.0 / 8.0 / far, rtol=1e-5)


FAR = np.geomspace(100.0, 1e9, 40)


@pytest.mark.parametrize("ratio", RATIOS)
def test_far_spheres_have_the_exact_law(ratio: float) -> None:
    """Directly by the series at each gap; the power of K at s = 100 would be off by 1e-6 at 1000."""
    law = exact_law(GapFilm("spheres", 1.0, ratio, extrapolate=True))
    expected = np.concatenate([exact_resistance("spheres", "squeeze", [s], ratio) for s in FAR])
    assert_allclose(law.kappa(FAR, 1.0), expected, rtol=1e-9)


def test_far_spheres_move_along_a_plane_as_if_alone() -> None:
    """By powers of 1/h, h = 1 + s (H. Faxen, 1923; A. J. Goldman, R. G. Cox and H. Brenner, 1967)."""
    along, turning = (
        exact_law(GapFilm("spheres", 1.0, mode=mode, extrapolate=True)).kappa(FAR, 1.0) for mode in MODES[1:]
    )
    h = 1.0 + FAR
    expected = 6.0 * pi / (1.0 - 9.0 / 16.0 / h + 1.0 / 8.0 / h**3 - 45.0 / 256.0 / h**4)
    assert_allclose(along, expected, rtol=1e-9)
    assert_allclose(turning, 8.0 * pi * (1.0 + 5.0 / 16.0 / h**3), rtol=1e-9)


def test_the_integral_far_away_is_that_of_the_law() -> None:
    """By Gauss's rule in ln s, of a sphere beside a plane from within its table to beyond it."""
    law = exact_law(GapFilm("spheres", 1.0, extrapolate=True))
    x, w = np.polynomial.legendre.leggauss(20)
    for start, stop in ((3e5, 1e6), (1e6, 3e6), (1e6, 1e9)):
        half = 0.5 * log(stop / start)
        at = start * np.exp(half * (x + 1.0))
        found = np.diff(law.integral(np.array([start, stop]), 1.0))
        assert_allclose(found, half * w @ (law.kappa(at, 1.0) * at), rtol=1e-9)


def test_a_series_goes_on_by_the_power_of_its_end() -> None:
    """The power is (ln K)' at the end in ln s, by hand; integrals are those of K, by Gauss's rule in ln s.

    Of K = 3/s + 2 ln(1/s) + 5 s^2 at s = 1/2: 6 + 2 ln 2 + 5/4, and times s its derivative -6 - 2 + 5/2. The
    sum itself is 10 times as large at s = 5. Below the range it goes on.
    """
    terms = (Term(-1.0), Term(0.0, log=True), Term(2.0))
    everywhere = Series(terms, (3.0, 2.0, 5.0))
    series = Series(terms, (3.0, 2.0, 5.0), (1e-2, 0.5))
    end = 7.25 + 2.0 * log(2.0)
    s = np.array([0.5, 0.8, 5.0, 70.0])
    assert_allclose(series.value(s), end * (s / 0.5) ** (-5.5 / end), rtol=1e-14)
    inside = np.array([1e-6, 1e-2, 0.3, 0.5])
    assert_array_equal(series.value(inside), everywhere.value(inside))
    assert_array_equal(series.integral(inside), everywhere.integral(inside))
    x, w = np.polynomial.legendre.leggauss(20)
    for start, stop in ((0.3, 0.5), (0.5, 0.8), (0.8, 5.0), (5.0, 70.0)):
        half = 0.5 * log(stop / start)
        at = start * np.exp(half * (x + 1.0))
        found = np.diff(series.integral(np.array([start, stop])))
        assert_allclose(found, half * w @ (series.value(at) * at), rtol=1e-12)


def test_a_law_is_not_asked_for_what_it_does_not_know() -> None:
    law = sampled_law()
    with pytest.raises(RangeError, match="radius = 20: the lubrication law holds from 1e-07 to 10"):
        law.kappa([0.1, 40.0], 2.0)
    with pytest.raises(InputError):  # so that the command line ends with exit code 2
        law.integral(1e-9, 2.0)
    beyond = ScaledLaw(law.profile, MU, 1, extrapolate=True)
    assert 0.0 < float(beyond.kappa(40.0, 2.0)) < float(law.kappa(20.0, 2.0))


def test_a_gap_at_the_end_of_a_range_may_be_beyond_it_by_rounding() -> None:
    """Of bodies 60 apart a gap of 1e-4 is known to 1e-10; what is 1e-8 beyond is meant to be."""
    law = sampled_law()
    a, (low, high) = 2.0, law.range
    for end, beyond in ((low, -1e-10), (high, 1e-10)):
        kappa = law.kappa(a * end * (1.0 + beyond), a)
        assert_allclose(kappa, law.kappa(a * end, a), rtol=1e-9)
        with pytest.raises(RangeError):
            law.kappa(a * end * (1.0 + 100.0 * beyond), a)


@pytest.mark.parametrize("gap", [0.0, -1e-3, np.nan])
@pytest.mark.parametrize("name", LAWS)
def test_no_law_for_a_gap_that_is_not_positive(name: str, gap: float) -> None:
    with pytest.raises(ValueError, match="keep gaps positive"):
        LAWS[name].kappa(gap, 1.0)
    with pytest.raises(ValueError, match="keep gaps positive"):
        ScaledLaw(Series((Term(-1.0),), (1.0,)), 1.0, 1, extrapolate=True).integral(gap, 1.0)


@given(d=gaps, a=radii, size=st.floats(0.1, 10.0))
@example(d=0.1, a=0.20000000000000004, size=0.1)
def test_a_cut_law_falls_to_zero_at_the_cut_and_stays_there(d: float, a: float, size: float) -> None:
    law = leading_law(SPHERES)
    cut = CutLaw(law, size)
    assert not np.any(cut.kappa([size, 2.0 * size], a))
    assert not np.any(cut.integral([size, 9.0 * size], a))
    assert_allclose(cut.kappa(d * size, a), law.kappa(d * size, a) - law.kappa(size, a), rtol=1e-12)
    assert float(cut.integral(d * size, a)) < 0.0


def test_a_cut_law_asks_nothing_beyond_the_cut() -> None:
    """A law known up to 10 reduced radii serves any distance, once cut within them."""
    cut = CutLaw(sampled_law(), 3.0)
    assert cut.range == (1e-7, inf)
    assert float(cut.kappa(1e6, 1.0)) == 0.0


def test_arrays_of_gaps_and_radii_broadcast() -> None:
    d, a = np.array([[0.01], [0.02]]), np.array([1.0, 2.0, 3.0])
    for law in LAWS.values():
        assert law.kappa(d, a).shape == law.integral(d, a).shape == (2, 3)
        assert_allclose(law.kappa(d, a)[1, 2], law.kappa(0.02, 3.0))
