"""Concentric bodies and containers with slip: the limits that are known from elsewhere."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fsi.lubrication.concentric import Concentric
from fsi.lubrication.spheres import concentric_resistance

FAR = 1e5  # a container of this radius changes drag by some 1e-5, what turns by 1e-10


@pytest.mark.parametrize("b", [0.0, 0.1, 1.0, 50.0])
def test_unbounded_fluid(b: float) -> None:
    """Basset's drag, turning bodies, and Blake's swimmers, faster with slip by 1 + 2 b/a in space."""
    ball, disc = (Concentric(2.0, 2.0 * FAR, 2.0 * b, 0.0, spheres=spheres) for spheres in (True, False))
    drag = 6.0 * np.pi * 0.7 * 2.0 * (1.0 + 2.0 * b) / (1.0 + 3.0 * b)
    assert_allclose(ball.force(1.0, 0.0, 0.7), drag, rtol=3.0 / FAR)
    assert_allclose(disc.torque(1.0, 0.7), 4.0 * np.pi * 0.7 * 4.0 / (1.0 + 2.0 * b), rtol=1e-9)
    assert_allclose(ball.torque(1.0, 0.7), 8.0 * np.pi * 0.7 * 8.0 / (1.0 + 3.0 * b), rtol=1e-9)
    assert_allclose(ball.swimming(3.0) * (1.0 + 2.0 * b), 2.0, rtol=1e-9)
    assert_allclose(disc.swimming(3.0) * (1.0 + 2.0 * b), 1.5, rtol=1e-9)


@given(st.floats(1.05, 20.0), st.floats(0.1, 10.0))
def test_without_slip_it_is_cunninghams_sphere(R: float, a: float) -> None:
    exact = concentric_resistance(a * (R - 1.0), a, 0.3)
    assert_allclose(Concentric(a, a * R, 0.0, 0.0, spheres=True).force(2.0, 0.0, 0.3), 2.0 * exact, rtol=1e-9)


@given(st.floats(1.1, 10.0), st.floats(0.0, 5.0), st.floats(0.0, 5.0), st.floats(0.01, 1.0), st.booleans())
def test_slip_lowers_every_resistance(R: float, b: float, c: float, more: float, spheres: bool) -> None:
    here = Concentric(1.0, R, b, c, spheres=spheres)
    for other in (
        Concentric(1.0, R, b + more, c, spheres=spheres),
        Concentric(1.0, R, b, c + more, spheres=spheres),
    ):
        assert 0.0 < other.force(1.0, 0.0, 1.0) < here.force(1.0, 0.0, 1.0)
        assert 0.0 < other.torque(1.0, 1.0) <= here.torque(1.0, 1.0)
