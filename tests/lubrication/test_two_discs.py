"""Two discs that slide and roll: the resolved flow, the equation of Reynolds, the closed forms of a plane."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from fsi.lubrication import exact, two_discs
from fsi.meshes.geometry.round import Round
from tests.flows import discs, free, solved

lengths = st.floats(-2.0, 2.0).map(lambda exponent: 10.0**exponent)


@pytest.mark.parametrize(("a", "b", "gap"), [(1.0, 1.0, 0.1), (0.5, 1.0, 0.02), (1.0, 0.3, 0.5)])
def test_the_resolved_flow_has_both_resistances(a: float, b: float, gap: float) -> None:
    """Opposite forces where the arms meet, then a couple; the container of 2000 radii changes 1e-6.

    The mobility of both loads: its first entry is one over the resistance to sliding, and the second of its
    inverse is that to rolling. A shift of the arms by half the gap would change the first by 1e-3 or more.
    """
    d = a + b + gap
    arms = np.array([a, b]) * d / (a + b)
    loads = ([(0.0, 1.0, -arms[0]), (0.0, -1.0, -arms[1])], [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)])
    q = discs([(arms[0], 0.0), (-arms[1], 0.0)], [a, b])
    mobility = np.empty((2, 2))
    for k, load in enumerate(loads):
        U = solved(Round(2000.0), q, free(*load)).U
        mobility[:, k] = U[0, 1] - U[1, 1] - arms @ U[:, 2], U[0, 2] - U[1, 2]
    assert_allclose(mobility[0, 1], mobility[1, 0], rtol=1e-5, atol=1e-7)
    assert_allclose(1.0 / mobility[0, 0], two_discs.sliding_resistance(gap, a, b, 1.0), rtol=2e-5)
    found = np.linalg.inv(mobility)[1, 1]
    assert_allclose(found, two_discs.rolling_resistance(gap, a, b, 1.0), rtol=1e-4)
    rolled = -mobility[1, 0] / mobility[0, 0]
    assert_allclose(two_discs.rolling_of_sliding(gap, a, b), rolled, rtol=1e-5, atol=1e-6)


def test_the_limit_of_small_gaps_is_that_of_reynolds() -> None:
    """h = 1 + x^2, mu = 1: sliding dissipates int 1/h, rolling with both surfaces 12 int (h - h*)^2/h^3.

    h* leaves no pressure at infinity. x is counted in sqrt(2 a_r D), so that both have the factor
    sqrt(2 a_r/D); rolling surfaces move by a_r rho.
    """
    infinity = np.inf
    means = [quad(lambda x, k=k: (1.0 + x * x) ** -k, -infinity, infinity)[0] for k in (1, 2, 3)]
    least = means[1] / means[2]
    roll = 12.0 * (means[0] - 2.0 * least * means[1] + least**2 * means[2])
    for a, b in ((1.0, 1.0), (1.0, 4.0), (0.2, 3.0)):
        a_r, s = a * b / (a + b), 1e-8
        scale = np.sqrt(2.0 / s)
        assert_allclose(two_discs.sliding_resistance(s * a_r, a, b, 1.0), scale * means[0], rtol=1e-7)
        assert_allclose(two_discs.rolling_resistance(s * a_r, a, b, 1.0), a_r**2 * scale * roll, rtol=1e-7)


@given(gap=lengths, a=lengths, b=lengths)
def test_the_closed_forms_are_those_of_the_mobility(gap: float, a: float, b: float) -> None:
    """M1, M2, M3 of the module's docstring and their inverse, as they stand; they cancel to 1e-9."""
    d, sinh, cosh, tanh = a + b + gap, np.sinh, np.cosh, np.tanh
    c = np.sqrt(gap * (gap + 2.0 * a + 2.0 * b) * (gap + 2.0 * a) * (gap + 2.0 * b)) / (2.0 * d)
    al, be = np.arcsinh(c / a), np.arcsinh(c / b)
    L, y = al + be, (b * np.hypot(c, a) - a * np.hypot(c, b)) / ((a + b) * c)
    M2 = sinh(L) * sinh(al - be)
    M1, M3 = L + sinh(L) * cosh(al - be), sinh(L) * cosh(al - be) - tanh(L)
    mobility = np.array([[M1 - 2.0 * y * M2 + y**2 * M3, y * M3 - M2], [y * M3 - M2, M3]])
    rolling = 4.0 * np.pi * c**2 * np.linalg.inv(mobility)[1, 1]
    assert_allclose(two_discs.sliding_resistance(gap, a, b, 1.0), 4.0 * np.pi / mobility[0, 0], rtol=1e-7)
    assert_allclose(two_discs.rolling_resistance(gap, a, b, 1.0), rolling, rtol=1e-7)
    rolled = -mobility[0, 1] / (c * mobility[0, 0])
    assert_allclose(two_discs.rolling_of_sliding(gap, a, b), rolled, rtol=1e-7, atol=1e-9 / c)


def test_a_large_disc_is_a_plane() -> None:
    """Without load at the point of contact V and omega add, and the other way round: 1/k = 1/A + a^2/C."""
    gap, a = np.geomspace(1e-4, 3.0, 9), 0.7
    A, C = exact.parallel_resistance(gap, a, 2.0), exact.rotation_resistance(gap, a, 2.0)
    assert_allclose(two_discs.sliding_resistance(gap, a, 1e9, 2.0), 1.0 / (1.0 / A + a**2 / C), rtol=1e-7)
    assert_allclose(two_discs.rolling_resistance(gap, a, 1e9, 2.0), A * a**2 + C, rtol=1e-7)


@given(gap=lengths, a=lengths, b=lengths)
def test_the_order_does_not_matter_and_lengths_have_no_unit(gap: float, a: float, b: float) -> None:
    for law, power in ((two_discs.sliding_resistance, 0), (two_discs.rolling_resistance, 2)):
        value = float(law(gap, a, b, 1.0))
        assert value > 0.0
        assert float(law(gap, b, a, 1.0)) == pytest.approx(value, rel=1e-9)
        assert float(law(3.0 * gap, 3.0 * a, 3.0 * b, 5.0)) == pytest.approx(
            5.0 * 3.0**power * value, rel=1e-9
        )


def test_far_apart_discs_turn_by_themselves() -> None:
    """Each has 4 pi mu a^2, and the rates add; equal discs do not slide on their own."""
    assert_allclose(two_discs.rolling_resistance(1e5, 3.0, 3.0, 1.0), 0.5 * 4.0 * np.pi * 9.0, rtol=1e-4)


def test_overlap_is_refused() -> None:
    with pytest.raises(ValueError, match="need gap > 0"):
        two_discs.sliding_resistance(-0.1, 1.0, 1.0, 1.0)
