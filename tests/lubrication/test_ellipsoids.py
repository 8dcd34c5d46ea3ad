"""Ellipsoids in unbounded fluid against spheres, discs, closed forms of spheroids, and each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsi.lubrication.ellipsoids import (
    free_rotation,
    in_far_ball,
    rotation_resistance,
    spheroid_axis,
    translation_resistance,
)
from fsi.lubrication.spheres import concentric_resistance


def test_a_sphere_is_an_ellipsoid() -> None:
    axes = np.full(3, 2.0)
    np.testing.assert_allclose(translation_resistance(axes, 3.0), 6.0 * np.pi * 3.0 * 2.0, rtol=1e-14)
    np.testing.assert_allclose(rotation_resistance(axes, 3.0), 8.0 * np.pi * 3.0 * 8.0, rtol=1e-14)


def test_a_thin_disc_has_the_limits_of_happel_and_brenner() -> None:
    """16 mu a broadside, 32/3 mu a edgewise, and 32/3 mu a^3 turning (1965, sections 5-11, 5-12)."""
    axes = np.array([1.0, 1.0, 1e-8])
    np.testing.assert_allclose(translation_resistance(axes, 1.0), [32.0 / 3.0, 32.0 / 3.0, 16.0], rtol=1e-7)
    np.testing.assert_allclose(rotation_resistance(axes, 1.0), 32.0 / 3.0, rtol=1e-7)


def test_a_prolate_spheroid_has_its_closed_forms() -> None:
    """Along the axis and across it with L = ln((1 + e)/(1 - e)) (Kim and Karrila 1991, table 3.4)."""
    axes, e = np.array([0.2, 0.2, 1.0]), np.sqrt(1.0 - 0.04)
    L = np.log((1.0 + e) / (1.0 - e))
    along = 8.0 / 3.0 * e**3 / (-2.0 * e + (1.0 + e**2) * L)
    across = 16.0 / 3.0 * e**3 / (2.0 * e + (3.0 * e**2 - 1.0) * L)
    expected = 6.0 * np.pi * np.array([across, across, along])
    np.testing.assert_allclose(translation_resistance(axes, 1.0), expected, rtol=1e-12)
    turning = 4.0 / 3.0 * e**3 * (1.0 - e**2) / (2.0 * e - (1.0 - e**2) * L)
    assert rotation_resistance(axes, 1.0)[2] == pytest.approx(8.0 * np.pi * turning, rel=1e-12)


def test_free_spheroids_turn_on_jefferys_orbit() -> None:
    """In u = y e_x: omega_z = -(a^2 sin^2 + b^2 cos^2) / (a^2 + b^2) at the angle of the long axis a to x."""
    a, b = 2.0, 0.5
    for angle in (0.0, 0.4, 1.3):
        c, s = np.cos(angle), np.sin(angle)
        rows = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])  # own axes
        shear = rows @ np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]) @ rows.T
        omega = free_rotation(np.array([a, b, b]), shear)
        exact = -((a * s) ** 2 + (b * c) ** 2) / (a**2 + b**2)
        np.testing.assert_allclose(omega, [0.0, 0.0, exact], atol=1e-15)


@given(st.permutations([0, 1, 2]), st.floats(0.2, 5.0), st.floats(0.2, 5.0))
def test_axes_may_be_named_in_any_order(order: list[int], b: float, c: float) -> None:
    axes = np.array([1.0, b, c])
    for law in (translation_resistance, rotation_resistance):
        np.testing.assert_allclose(law(axes[order], 1.0), law(axes, 1.0)[order], rtol=1e-13)


def test_a_far_ball_counts_as_it_does_for_a_sphere() -> None:
    """Cunningham's sphere, but for (a / R)^3: 2.25 of it without the correction, a thousand times as much."""
    exact, R = float(concentric_resistance(99.0, 1.0, 1.0)), 6.0 * np.pi
    assert in_far_ball(R, 100.0, 1.0) == pytest.approx(exact, rel=5e-6)
    assert exact / R > 1.02


def test_the_axis_of_a_spheroid_in_shear_comes_back_after_jefferys_period() -> None:
    """In 2 pi (r + 1/r) / gamma, after half of it the other way round; in the plane by its tangent.

    It begins to turn as the free rotation of its half axes says.
    """
    shear, r = np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]), 3.0
    d, period = np.array([0.6, 0.0, 0.8]), np.pi * (r + 1.0 / r)
    np.testing.assert_allclose(spheroid_axis(r, shear, d, period), d, atol=1e-12)
    np.testing.assert_allclose(spheroid_axis(r, shear, d, 0.5 * period), -d, atol=1e-12)
    x, _, z = spheroid_axis(r, shear, np.array([1.0, 0.0, 0.0]), 0.3)
    assert -z / x == pytest.approx(np.tan(0.6 / (r + 1.0 / r)) / r, rel=1e-12)
    own = np.array([[0.6, 0.0, -0.8], [0.0, 1.0, 0.0], [0.8, 0.0, 0.6]])  # d and two axes across
    omega = own @ free_rotation(np.array([3.0, 1.0, 1.0]), own.T @ shear @ own)
    moved = (spheroid_axis(r, shear, d, 1e-5) - spheroid_axis(r, shear, d, -1e-5)) / 2e-5
    np.testing.assert_allclose(moved, np.cross(omega, d), atol=1e-8)
