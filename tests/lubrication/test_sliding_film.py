"""Films between surfaces with slip: the integrals of Reynolds, and their limits."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from fsi.lubrication import exact, spheres
from fsi.lubrication.sliding_film import disc_resistance, sphere_resistance


@pytest.mark.parametrize(("q", "b"), [(1e-3, 0.1), (0.1, 1e-3), (0.02, 0.02)])
def test_closed_forms_are_the_integrals(q: float, b: float) -> None:
    """With a = 2 and mu = 0.7, x = sqrt(2 a q) tan t."""
    a, mu = 2.0, 0.7

    def film(t: float) -> tuple[float, float, float]:
        x = np.sqrt(2.0 * a * q) * np.tan(t)
        H = q + x**2 / (2.0 * a)
        return x, H, np.sqrt(2.0 * a * q) / np.cos(t) ** 2

    def of_sphere(t: float) -> float:
        x, H, dx = film(t)
        return float(6.0 * np.pi * mu * x**3 / (H**2 * (H + 6.0 * b)) * dx)

    def of_disc(t: float) -> float:
        x, H, dx = film(t)
        return float(24.0 * mu * x**2 / (H**2 * (H + 6.0 * b)) * dx)

    assert_allclose(sphere_resistance(q, a, b, mu), quad(of_sphere, 0.0, np.pi / 2)[0], rtol=1e-8)
    assert_allclose(disc_resistance(q, a, b, mu), quad(of_disc, 0.0, np.pi / 2)[0], rtol=1e-8)


def test_little_slip_is_none() -> None:
    """The leading terms 6 pi mu a^2 / q and 3 sqrt 2 pi mu (a / q)^(3/2)."""
    q = 1e-6
    assert_allclose(sphere_resistance(q, 1.0, 1e-12, 1.0), spheres.normal_resistance(q, 1.0, 1.0), rtol=2e-5)
    assert_allclose(disc_resistance(q, 1.0, 1e-12, 1.0), exact.normal_resistance(q, 1.0, 1.0), rtol=2e-5)


def test_the_stretching_of_plugs_is_b_over_a_times_their_friction() -> None:
    """2 mu int H e : e of u = U x / 2H (spheres) and U x / H (discs), x = sqrt(2 a q) tan t, H = q / cos^2 t.

    Of discs e : e = 2 u'^2; of spheres u'^2 + (u/x)^2 + (u' + u/x)^2, whose integral has its logarithm in q.
    """
    a, b, mu = 2.0, 0.3, 0.7

    def disc(t: float, q: float) -> float:
        c = np.cos(t) ** 2
        rate = c / q * (1.0 - 2.0 * np.sin(t) ** 2)
        return float(2.0 * mu * q / c * 2.0 * rate**2 * np.sqrt(2.0 * a * q) / c)

    def sphere(log_H: float, q: float) -> float:
        H = np.exp(log_H)
        along, round_it = 0.5 / H - (H - q) / H**2, 0.5 / H
        rates = along**2 + round_it**2 + (along + round_it) ** 2
        return float(2.0 * mu * H * rates * 2.0 * np.pi * a * H)  # x dx = a dH

    q = 1e-12
    stretched = 2.0 * quad(disc, 0.0, np.pi / 2.0, args=(q,))[0]
    assert_allclose(stretched, b / a * disc_resistance(q, a, b, mu), rtol=1e-4)
    one, other = (quad(sphere, np.log(q), np.log(1e-6), args=(q,))[0] for q in (1e-12, 1e-14))
    grown = np.diff(sphere_resistance(np.array([1e-12, 1e-14]), a, b, mu))[0]
    assert_allclose(other - one, b / a * grown, rtol=1e-4)


def test_exponents() -> None:
    """A logarithm for spheres, and q^(-1/2) for discs, below the slip length."""
    q = np.array([1e-14, 1e-16])
    one, other = sphere_resistance(q, 1.0, 0.1, 1.0)
    assert_allclose((other - one) / np.log(100.0), 20.0 * np.pi, rtol=1e-9)
    one, other = disc_resistance(q, 1.0, 0.1, 1.0)
    assert_allclose(other / one, 10.0, rtol=1e-5)
