"""Polygons of bodies that reach far beyond the window: close-ups of gaps of 1e-8 radii."""

import numpy as np
import pytest

from fsi.bodies.configuration import Configuration
from fsi.case.shapes.ellipse import Ellipse
from fsi.meshes.geometry.outline import Outline
from fsi.postprocess.render.body_polygons import body_polygons
from fsi.postprocess.render.canvas import new_panel
from fsi.postprocess.render.view import View

WIDTH, HALF, SEEN = 1.1e-8, 6.6e-8, np.ones(1, dtype=bool)


def above(outline: Outline, lowest: float, turn: float) -> Configuration:
    """A body, turned, whose lowest point stands half a gap above the origin; `lowest` below its centre."""
    centre, turns, radii = (
        np.array([[0.3, lowest + 0.5 * WIDTH]]),
        np.array([turn]),
        np.array([outline.radius]),
    )
    return Configuration(centre, turns, radii, (outline,))


DISC = Configuration.unturned(np.array([[0.3, 1.0 + 0.5 * WIDTH]]), np.ones(1))
# The lowest point of an ellipse with half axes a, b, turned by c: sqrt(a^2 sin^2 c + b^2 cos^2 c) below.
TURNED = above(
    Ellipse(kind="ellipse", axes=(1.0, 0.5)).outline, float(np.sqrt(0.25 + 0.75 * np.sin(0.4) ** 2)), 0.4
)
# x = -(a^2 - b^2) sin c cos c / that depth from its centre.
ASIDE = -0.75 * np.sin(0.4) * np.cos(0.4) / np.sqrt(0.25 + 0.75 * np.sin(0.4) ** 2)


@pytest.mark.parametrize(("q", "place"), [(DISC, 0.3), (TURNED, 0.3 + ASIDE)])
def test_a_surface_next_to_a_narrow_gap_is_where_it_is(q: Configuration, place: float) -> None:
    """Level, half a gap above the middle, as curvature is 1e-8 of the window; nothing is far away."""
    view = View(np.array([place, 0.0]), HALF, 0.4)
    (polygon,) = body_polygons(q, SEEN, view, 1000)
    assert np.abs(polygon).max() <= 4.0
    near = polygon[np.abs(polygon[:, 0]) < 1.0]
    assert len(near) > 10
    # Double precision is 3e-9 of the window here; polygons of 4000 sides are up to 5 off.
    np.testing.assert_allclose(near[:, 1], 0.5 * WIDTH / HALF, atol=1e-6)


def test_what_the_window_does_not_show_has_no_polygon() -> None:
    """Next to the corner of the square around a disc."""
    (polygon,) = body_polygons(DISC, SEEN, View(np.array([1.3, 0.0]), HALF), 1000)
    assert len(polygon) == 0
    panel = new_panel(View(np.array([1.3, 0.0]), HALF), 100)
    panel.bodies(DISC, turning=False)


@pytest.mark.usefixtures("drawing")
def test_a_narrow_gap_is_drawn_as_wide_as_it_is() -> None:
    """In a strip 0.8 HALF high, the body begins 1/12 HALF above its middle; single precision: at 0."""
    panel = new_panel(View(np.array([0.3, 0.0]), HALF, 0.4), 400)
    panel.bodies(DISC, turning=False)
    body = np.all(np.abs(panel.image().astype(int) - (0xF3, 0xEF, 0xE6)) <= 2, axis=2)
    assert body.mean() == pytest.approx((0.4 - 1.0 / 12.0) / 0.8, abs=0.01)
