"""Bodies of revolution by their outlines: volumes, centres, ends and gaps against formulas."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.case.shapes.ellipse import Ellipse
from fsi.case.shapes.fourier import FourierShape
from fsi.case.shapes.profile import HalfOutline
from fsi.case.shapes.stadium import Stadium
from fsi.case.shapes.tip import Tip
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.revolved import BodyOfRevolution
from fsi.meshes.geometry.wall_feet import wall_feet

TUBE = Box((0.0, -3.0), (2.0, 4.0), axisymmetric=True)  # walls right, bottom, top


@settings(max_examples=10, deadline=None)
@given(st.floats(0.2, 5.0), st.floats(0.2, 5.0))
def test_a_spheroid_has_its_volume_and_its_gaps(a: float, b: float) -> None:
    """4/3 pi a^2 b; it reaches a from the axis and b along it."""
    body = Ellipse(kind="ellipse", axes=(a, b)).revolved(0.0)
    assert body.volume == pytest.approx(4.0 / 3.0 * np.pi * a**2 * b, rel=1e-13)
    assert abs(body.shift).max() < 1e-14 * b
    feet = wall_feet(Placed(body, np.array([0.0, 0.5]), 0.0), TUBE)
    np.testing.assert_allclose([foot.gap for foot in feet], [2.0 - a, 3.5 - b, 3.5 - b], atol=1e-13)


def test_an_egg_stands_at_the_centre_of_its_volume() -> None:
    """Of r = 1 + eps m, m = sin(theta): V = 2 pi/3 int r^3 dm, and its moment pi/2 int r^4 m dm."""
    eps = 0.3
    shape = FourierShape(kind="fourier", radius=1.0, orders=(1,), cosines=(0.0,), sines=(eps,))
    egg, volume = shape.revolved(0.0), 4.0 / 3.0 * np.pi * (1.0 + eps**2)
    assert egg.volume == pytest.approx(volume, rel=1e-13)
    moment = 0.5 * np.pi * (8.0 / 3.0 * eps + 8.0 / 5.0 * eps**3)
    np.testing.assert_allclose(egg.shift, [0.0, moment / volume], atol=1e-13)
    assert abs(egg.shift[1] - shape.outline.shift[1]) > 0.003  # the centre of its area is another point
    bottom, top = egg.jet(np.array(egg.poles)).x
    np.testing.assert_allclose(
        [*bottom, *top], [0.0, -0.7 - egg.shift[1], 0.0, 1.3 - egg.shift[1]], atol=1e-13
    )


def test_a_coin_and_a_rod_are_one_outline_at_two_angles() -> None:
    """Of radius a and length l: a rod pi a^2 l + 4/3 pi a^3; a coin by Pappus's theorem."""
    stadium, a, length = Stadium(kind="stadium", length=2.0, radius=0.5), 0.5, 2.0
    rod, coin = stadium.revolved(0.5 * np.pi), stadium.revolved(0.0)
    assert rod.volume == pytest.approx(np.pi * a**2 * length + 4.0 / 3.0 * np.pi * a**3, rel=1e-13)
    rim = 2.0 * np.pi * (0.5 * np.pi * a**2) * (0.5 * length + 4.0 * a / (3.0 * np.pi))
    assert coin.volume == pytest.approx(np.pi * (0.5 * length) ** 2 * 2.0 * a + rim, rel=1e-13)
    ends = Placed(rod, np.array([0.0, 1.0]), rod.angle).at(np.array(rod.poles)).x
    np.testing.assert_allclose(ends, [[0.0, -0.5], [0.0, 2.5]], atol=1e-13)
    assert rod.is_symmetric
    assert coin.is_symmetric
    assert not stadium.revolved(0.3).is_symmetric


def test_a_profile_is_mirrored() -> None:
    """Through 17 points of a sphere: a spline of chords h errs by some h^4 / 384."""
    theta = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 17)
    points = tuple((abs(float(r)) if 0 < k < 16 else 0.0, float(z)) for k, (r, z) in
                   enumerate(zip(np.cos(theta), np.sin(theta), strict=True)))  # fmt: skip
    body = HalfOutline(kind="profile", points=points).revolved(0.0)
    assert body.is_symmetric
    assert body.volume == pytest.approx(4.0 / 3.0 * np.pi, rel=5e-5)
    assert body.scaled(2.0).volume == pytest.approx(8.0 * body.volume, rel=1e-13)


def test_a_tip_may_be_the_upper_end_of_a_body_of_any_size() -> None:
    """Rounding puts the end of a third of them on the wrong side of the axis."""
    tip = Tip(kind="tip", radius=1.0, alpha=0.5, length=0.64).revolved(np.pi)
    for factor in np.linspace(0.1, 3.0, 30).tolist():
        np.testing.assert_allclose(tip.scaled(factor).poles, [0.5, 1.0], atol=1e-12)


def test_a_tip_is_an_end_and_a_sphere_has_the_ends_of_its_axis() -> None:
    tip = Tip(kind="tip", radius=1.0, alpha=0.5, length=1.0).revolved(0.0)
    assert tip.poles[0] == 0.0
    np.testing.assert_allclose(BodyOfRevolution.sphere(2.0).poles, [0.75, 1.25], atol=1e-15)
