"""Two free spheres in a linear flow: published limits, forces by other series, paths that can be reversed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fsi.lubrication.spheres import line_forces
from fsi.lubrication.spheres_in_shear import (
    mobility_in_strain,
    multipoles_along,
    relative_path,
    relative_velocity,
)
from fsi.lubrication.two_spheres import orders

SHEAR = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])


@pytest.mark.parametrize("gap", [0.01, 0.3, 4.0])
def test_forces_along_the_line_of_centres(gap: float) -> None:
    """6 pi mu a p_1 is the force of Maude's series in bispherical coordinates."""
    p = multipoles_along(orders(gap, (1.0, 1.0)), 1.0 / (2.0 + gap))
    force, _ = line_forces(gap, (1.0, 1.0), 1.0, (1.0, -1.0))
    assert_allclose(6.0 * np.pi * p[0], force, rtol=1e-11)


def test_far_apart() -> None:
    """Batchelor and Green 1972: A = 5 t^3 - 8 t^5 + 25 t^6, B = 16 t^5 / 3, what is left falls off by t^8."""
    for r in (10.0, 20.0):
        A, B = mobility_in_strain(r - 2.0, 1.0)
        assert pytest.approx(5.0 / r**3 - 8.0 / r**5 + 25.0 / r**6, abs=100.0 / r**8) == A
        assert pytest.approx(16.0 / (3.0 * r**5), abs=100.0 / r**8) == B


def test_nearly_touching() -> None:
    """Kim and Karrila 1991, section 11.4: A = 1 - 4.077 s; B tends to 0.406 as slowly as 0.78 / ln(1 / s).

    The next term of A is like s^2: taken off by two gaps it leaves 1.2e-3 of 4.077.
    """
    slopes = []
    for s in (1e-3, 2e-3):
        A, B = mobility_in_strain(s, 1.0)
        slopes.append((1.0 - A) / s)
        assert pytest.approx(0.406 - 0.78 / np.log(1.0 / s), abs=3e-3) == B
    assert pytest.approx(4.077, rel=2e-3) == 2.0 * slopes[0] - slopes[1]


@settings(max_examples=10, deadline=None)
@given(st.floats(0.05, 3.0), st.floats(0.2, 5.0))
def test_lengths_scale(gap: float, radius: float) -> None:
    assert_allclose(mobility_in_strain(gap * radius, radius), mobility_in_strain(gap, 1.0), rtol=1e-11)


def test_without_strain_spheres_turn_as_one() -> None:
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    r = np.array([1.0, 2.0, 0.5])
    assert_allclose(relative_velocity(r, 1.0, turn), turn @ r, rtol=1e-14)


def test_a_path_is_the_same_backwards() -> None:
    """From the middle, where x = 0, one half is the mirror image of the other."""
    times, middle = np.linspace(0.0, 3.0, 4), [0.0, 0.3, 2.1]
    there, back = (relative_path(middle, 1.0, sign * SHEAR, times) for sign in (1.0, -1.0))
    assert_allclose(back * [-1.0, 1.0, 1.0], there, atol=1e-6)
    assert np.all(np.diff(there[:, 0]) > 0.0)
    assert np.all(np.diff(there[:, 2]) < 0.0)
