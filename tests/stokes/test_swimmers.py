"""Bodies that swim: closed forms, bars, and the modes of their surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.arrays import Array
from fsi.lubrication.concentric import Concentric
from fsi.stokes.swimming import tangential
from tests.stokes.sliding_flows import balanced, body, in_ball


def test_a_swimmer_upside_down_on_the_axis_is_the_mirror_image() -> None:
    """Off the centre of its ball, where the two speeds differ by 6 %; the angle was ignored."""
    swimmer = {"surface_velocity": [1.0, 0.5]}
    below, above = (
        balanced(in_ball("axisymmetric", 0.0, body((0.0, z), angle=angle, **swimmer))).solution.U[0, 1]
        for z, angle in ((-0.8, 0.0), (0.8, np.pi))
    )
    assert_allclose(above, -below, rtol=1e-6)


@pytest.mark.parametrize(("b", "c"), [(0.0, 0.0), (0.3, 0.7)])
@pytest.mark.parametrize("geometry", ["planar", "axisymmetric"])
def test_a_free_swimmer(geometry: str, b: float, c: float) -> None:
    """B_1 alone moves it, along its axis; within the bars."""
    angle = {"angle": 0.5} if geometry == "planar" else {}
    swimmer = body(surface_velocity=[1.0, -2.0, 0.5], slip_length=b, **angle)
    solved = balanced(in_ball(geometry, c, swimmer))
    axis = np.array([np.cos(0.5), np.sin(0.5), 0.0]) if angle else np.array([0.0, 1.0, 0.0])
    exact = Concentric(1.0, 3.0, b, c, spheres=geometry != "planar").swimming(1.0) * axis
    assert_allclose(solved.solution.U[0], exact, atol=1e-5)
    assert np.all(np.abs(solved.solution.U[0] - exact)[:2] <= solved.errors.U[0, :2])


@pytest.mark.slow
@pytest.mark.parametrize(("b", "R"), [(0.05, 1.5), (0.5, 2.5), (1.0, 5.0)])
def test_bars_in_space_hold(b: float, R: float) -> None:
    """Of a swimmer with slip in a ball: 0.05, 0.8 and 1.06 of the largest difference to degree 2."""
    swimmer = body((0.0, 0.0, 0.0), surface_velocity=[1.0, -2.0, 0.5], slip_length=b)
    solved = balanced(in_ball("spatial", 0.7, swimmer, R=R))
    U = Concentric(1.0, R, b, 0.7, spheres=True).swimming(1.0) * np.eye(6)[2]
    assert np.all(np.abs(solved.solution.U[0] - U) < solved.errors.U[0])


@pytest.mark.parametrize("d", [2, 3])
def test_modes_of_swimmers(d: int) -> None:
    """Tangential; B_1 and B_2 are sin and sin cos, in the plane sin n theta, about any axis."""
    random = np.random.default_rng(0)
    e, p = random.normal(size=(9, d)), random.normal(size=d)
    e, p = e / np.linalg.norm(e, axis=1)[:, None], p / np.linalg.norm(p)
    cos = e @ p
    sin = np.sqrt(1.0 - cos**2)
    for modes, speed in (([2.0], 2.0 * sin), ([0.0, 1.0], sin * cos * (2.0 if d == 2 else 1.0))):
        w: Array = tangential(e, p, np.array(modes), planar=d == 2)
        assert_allclose(np.sum(w * e, axis=1), 0.0, atol=1e-15)
        assert_allclose(w @ p, -speed * sin, atol=1e-14)
