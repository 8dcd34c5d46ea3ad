"""Outlines of bodies: their integrals, their nearest points, and gaps by them, against formulas."""

from __future__ import annotations

import fsi.meshes.backend  # noqa: F401

import dolfinx
import numpy as np
import pytest
import ufl
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps, smallest_of_each
from fsi.case.shapes.ellipse import Ellipse
from fsi.case.shapes.fourier import FourierShape
from fsi.case.shapes.polygon import Polygon
from fsi.case.shapes.shape import BodyShape
from fsi.case.shapes.spline import Spline
from fsi.case.shapes.stadium import Stadium
from fsi.case.shapes.superellipse import Superellipse
from fsi.case.shapes.tip import Tip
from fsi.integration.gap_limiter import greatest_approach
from fsi.meshes.build import build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.outline import Outline
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.wall_feet import wall_feet
from fsi.meshes.resolution import Resolution

ELLIPSE = Ellipse(kind="ellipse", axes=(2.0, 1.0))
ROUGH = FourierShape(kind="fourier", radius=1.0, orders=(12,), cosines=(0.05,))
STADIUM = Stadium(kind="stadium", length=2.0, radius=0.5)
SQUARE = Polygon(kind="polygon", corners=((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)), rounding=0.2)
CORNER = Polygon(
    kind="polygon",
    corners=((0.0, 0.0), (2.0, 0.0), (2.0, 0.7), (0.7, 0.7), (0.7, 2.0), (0.0, 2.0)),
    rounding=0.1,
)
TIP = Tip(kind="tip", radius=1.0, alpha=0.5, length=1.0)
BOXED = Superellipse(kind="superellipse", axes=(2.0, 1.0), exponent=5.0)
BEAN = Spline(
    kind="spline",
    points=((1.2, 0.0), (1.0, 0.7), (0.0, 0.4), (-1.0, 0.7), (-1.2, 0.0), (-0.6, -0.6), (0.6, -0.6)),
)
EVERY = [ELLIPSE, ROUGH, STADIUM, SQUARE, CORNER, TIP, BOXED, BEAN]
BOX = Box((-9.0, -8.0), (7.0, 6.0))

each_shape = pytest.mark.parametrize("shape", EVERY, ids=lambda shape: shape.kind)


def test_areas_and_second_moments_are_those_of_formulas() -> None:
    """Of an ellipse, a rod, a rounded rectangle (what corners lose: 4 - pi squares), and r(theta)."""
    assert ELLIPSE.outline.area == pytest.approx(2.0 * np.pi, rel=1e-14)
    assert ELLIPSE.outline.second_moment == pytest.approx(2.5 * np.pi, rel=1e-14)
    assert STADIUM.outline.area == pytest.approx(2.0 + 0.25 * np.pi, rel=1e-14)
    assert SQUARE.outline.area == pytest.approx(2.0 - (4.0 - np.pi) * 0.2**2, rel=1e-14)
    assert ROUGH.outline.area == pytest.approx(np.pi * (1.0 + 0.5 * 0.05**2), rel=1e-14)
    # 1/4 int r^4 dtheta, of (1 + eps cos)^4: 1 + 3 eps^2 + 3/8 eps^4
    moment = 0.5 * np.pi * (1.0 + 3.0 * 0.05**2 + 0.375 * 0.05**4)
    assert ROUGH.outline.second_moment == pytest.approx(moment, rel=1e-14)


def test_bodies_stand_at_the_centre_of_their_area() -> None:
    """Of an L of two rectangles with sharp corners; rounding by 0.1 moves it by less than 0.01."""
    area = 2.0 * 0.7 + 0.7 * 1.3
    centre = (1.4 * 1.0 + 0.91 * 0.35) / area
    np.testing.assert_allclose(CORNER.outline.shift, [centre, centre], atol=0.01)
    assert abs(ELLIPSE.outline.shift).max() < 1e-15


@each_shape
def test_the_outline_is_smooth_and_its_derivatives_are_those_of_the_curve(shape: BodyShape) -> None:
    """By central differences away from joints; at joints points agree, and but for a tip's tangents."""
    outline, h = shape.outline, 1e-6
    t = np.random.default_rng(0).uniform(size=40)
    t = t[[all(abs(k - s) > 1e-3 for k in (*outline.joints, 1.0)) for s in t]]
    less, here, more = (outline.jet(s) for s in (t - h, t, t + h))
    scale = outline.radius * 2.0 * np.pi
    np.testing.assert_allclose((more.x - less.x) / (2.0 * h), here.dx, atol=1e-6 * scale)
    np.testing.assert_allclose((more.dx - less.dx) / (2.0 * h), here.ddx, atol=1e-5 * np.abs(here.ddx).max())
    for joint in outline.joints:
        low, high = (outline.jet(np.array([joint + s])) for s in (-1e-12, 1e-12))
        np.testing.assert_allclose(low.x, high.x, atol=1e-10)
        before, after = (side.dx[0] / np.hypot(*side.dx[0]) for side in (low, high))
        # A tip's slope at the distance x is 1.5 sqrt(x).
        np.testing.assert_allclose(before, after, atol=1e-5 if shape is TIP else 1e-8)


@each_shape
def test_the_nearest_point_is_nearer_than_all_of_a_dense_sample(shape: BodyShape) -> None:
    """And not nearer than the sample's spacing allows; the sign is that of the crossings of a ray."""
    x = np.random.default_rng(1).uniform(-3.0, 3.0, (100, 2))
    dense = shape.outline.jet(np.linspace(0.0, 1.0, 4001)).x
    away = np.hypot(*(x[:, None] - dense).transpose(2, 0, 1)).min(axis=1)
    distance, _ = shape.outline.signed_distance(x)
    assert np.all(np.abs(distance) <= away + 1e-13)
    np.testing.assert_allclose(np.abs(distance), away, atol=2e-4)
    np.testing.assert_array_equal(distance < 0.0, _inside(dense, x))


def _inside(polygon: Array, x: Array) -> Array:
    a, b = polygon[:-1], polygon[1:]
    crosses = (a[:, 1] > x[:, 1:]) != (b[:, 1] > x[:, 1:])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (x[:, 1:] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    odd: Array = np.sum(crosses & (x[:, :1] < at), axis=1) % 2 == 1
    return odd


@settings(max_examples=20, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-0.5, 0.5))
def test_gaps_of_an_ellipse_to_walls_follow_its_support_function(angle: float, y: float) -> None:
    """It reaches sqrt(a^2 cos^2 + b^2 sin^2) along an axis; the gap is what is left."""
    feet = wall_feet(Placed(ELLIPSE.outline, np.array([0.5, y]), angle), BOX)
    c, s = np.cos(angle), np.sin(angle)
    across, up = np.hypot(2.0 * c, s), np.hypot(2.0 * s, c)
    expected = [9.5 - across, 6.5 - across, y + 8.0 - up, 6.0 - y - up]
    np.testing.assert_allclose([foot.gap for foot in feet], expected, rtol=1e-13)


@each_shape
def test_gaps_to_a_disc_are_the_same_by_either_outline(shape: BodyShape) -> None:
    body = Placed(shape.outline, np.array([0.3, -0.2]), 0.7)
    disc = Placed(Outline.disc(0.4), np.array([2.6, 1.1]), 0.0)
    gaps = [body.gap_to(disc).gap, disc.gap_to(body).gap]
    expected = body.signed_distance(disc.centre[None])[0][0] - 0.4
    np.testing.assert_allclose(gaps, expected, atol=1e-13)


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 6.3), st.floats(0.0, 6.3), st.floats(1.0, 5.0), st.floats(0.0, 6.3))
def test_gaps_between_two_shapes_are_least_and_alike_from_both_sides(
    one: float, other: float, apart: float, direction: float
) -> None:
    """Against dense samples; where bodies overlap some point of one lies in the other."""
    away = apart * np.array([np.cos(direction), np.sin(direction)])
    a, b = Placed(CORNER.outline, np.zeros(2), one), Placed(ELLIPSE.outline, away, other)
    there, back = a.gap_to(b), b.gap_to(a)
    dense = np.linspace(0.0, 1.0, 400)
    depth = min(b.signed_distance(a.at(dense).x)[0].min(), a.signed_distance(b.at(dense).x)[0].min())
    assert (there.gap < 0.0) == (back.gap < 0.0) or abs(there.gap) < 1e-12
    if depth > 1e-3:
        assert there.gap == pytest.approx(back.gap, rel=1e-12)
        assert there.gap <= depth + 1e-13
        assert there.gap == pytest.approx(depth, abs=2e-3)
    if depth < 0.0:
        assert there.gap < 0.0


def test_a_body_within_another_overlaps_it() -> None:
    large, small = Placed(ELLIPSE.outline, np.zeros(2), 0.0), Placed(Outline.disc(0.1), np.zeros(2), 0.0)
    assert large.gap_to(small).gap < 0.0
    assert small.gap_to(large).gap < 0.0


def test_gaps_of_a_configuration_turn_with_its_bodies() -> None:
    """Two ellipses side by side, then end to end, and a disc, whose gap is the plain one."""
    outlines = (ELLIPSE.outline, ELLIPSE.outline, Outline.disc(1.0))
    centres = np.array([[0.0, 0.0], [5.0, 0.0], [0.0, 3.0]])
    q = Configuration(centres, np.zeros(3), np.array([2.0, 2.0, 1.0]), outlines)
    np.testing.assert_allclose(find_gaps(q, BOX, 1.5).pair_gaps, [1.0, 1.0], rtol=1e-14)
    upright = q.moved(np.array([[0.0, 0.0, 0.5 * np.pi], [0.0, 0.0, 0.5 * np.pi], [0.0, 0.0, 0.0]]))
    gaps = find_gaps(upright, BOX, 3.5)
    np.testing.assert_allclose(gaps.pair_gaps[0], 3.0, rtol=1e-14)
    assert smallest_of_each(upright, BOX)[0] == pytest.approx(1e-300, abs=1e-12)  # 3 - 2 - 1


def test_a_turning_body_closes_gaps_and_cannot_jump_through_another() -> None:
    """Half a turn ends with the gaps it began with, but on the way an end of the ellipse meets the disc."""
    outlines = (ELLIPSE.outline, Outline.disc(1.0))
    q = Configuration(np.array([[0.0, 0.0], [0.0, 2.5]]), np.zeros(2), np.array([2.0, 1.0]), outlines)
    turn = np.array([[0.0, 0.0, np.pi], [0.0, 0.0, 0.0]])
    assert greatest_approach(q, BOX, turn, 0.5).loss > 0.5
    assert greatest_approach(q, BOX, 0.02 * turn, 0.5).loss < 0.5


def test_curves_that_cross_themselves_are_known() -> None:
    loop = ((0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (1.0, -1.0), (0.5, 2.0), (0.0, 1.0))
    eight = Spline(kind="spline", points=loop)
    assert eight.outline.crosses_itself()
    assert not any(shape.outline.crosses_itself() for shape in EVERY)


def test_gaps_to_images_are_those_across_periods() -> None:
    """Of an ellipse to its own image, and of slanted rods longer than their period: L sin 45 - 2 r."""
    channel = Box((0.0, 0.0), (5.0, 9.0), periodic=("x",))
    q = Configuration(np.array([[0.3, 4.0]]), np.zeros(1), np.array([2.0]), (ELLIPSE.outline,))
    gaps = find_gaps(q, channel)
    np.testing.assert_array_equal(gaps.pairs, [[0, 0]])
    np.testing.assert_allclose(gaps.pair_gaps, [1.0], rtol=1e-14)
    narrow, rod = Box((0.0, 0.0), (2.0, 9.0), periodic=("x",)), STADIUM.outline.scaled(0.8)
    q = Configuration(np.array([[0.3, 4.0]]), np.array([0.25 * np.pi]), np.array([1.2]), (rod,))
    assert find_gaps(q, narrow).smallest() == pytest.approx(2.0 * np.sqrt(0.5) - 0.8, rel=1e-13)


def test_a_gap_to_an_image_that_a_shear_brings_near_is_seen() -> None:
    """An ellipse at rest whose upper image is carried over it: the gap 0.2 is lost on the way."""
    cell = Cell(((8.0, 0.0), (4.0, 2.2)), ((0.0, 1.0), (0.0, 0.0)))
    outline = ELLIPSE.outline
    q = Configuration(np.array([[0.0, 0.0]]), np.zeros(1), np.array([2.0]), (outline,))
    still = np.zeros((1, 3))
    assert find_gaps(q, cell).smallest() > 0.9
    # After the strain 1.8 the image is at (8, 2.2) - (8, 0), straight above: the gap 0.2.
    assert greatest_approach(q, cell, still, 0.5, 4.0 / 2.2).loss > 0.5
    assert greatest_approach(q, cell, still, 0.5, 0.05).loss < 0.2


@each_shape
def test_the_mesh_of_a_periodic_domain_has_the_area_that_bodies_leave(shape: BodyShape) -> None:
    """Its cut goes through the bodies: each arc follows its own image. Order 3: areas of order 6."""
    cell = Cell(((6.0, 0.0), (1.0, 6.0)), ((0.0, 0.0), (0.0, 0.0)))
    placed = (
        Placed(shape.outline, np.array([0.4, 0.3]), 0.7), Placed(Outline.disc(0.6), np.array([3.4, 3.2]), 0.0)
    )  # fmt: skip
    centres, radii = np.array([body.centre for body in placed]), np.array([shape.outline.radius, 0.6])
    domain = FluidDomain(cell, centres, radii, placed=placed)
    fluid = build(domain, Resolution(), 3)
    area = dolfinx.fem.assemble_scalar(dolfinx.fem.form(1.0 * ufl.dx(fluid.mesh)))
    left = 36.0 - shape.outline.area - np.pi * 0.36
    assert area == pytest.approx(left, rel=1e-6)


@settings(max_examples=25, deadline=None)
@given(
    one=st.sampled_from(EVERY), other=st.sampled_from(EVERY), turn=st.floats(-7.0, 7.0),
    angles=st.tuples(st.floats(0.0, 7.0), st.floats(0.0, 7.0)), away=st.floats(2.0, 6.0),
    shift=st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)),
)  # fmt: skip
def test_gaps_are_symmetric_and_do_not_change_when_all_is_moved(
    one: BodyShape,
    other: BodyShape,
    turn: float,
    angles: tuple[float, float],
    away: float,
    shift: tuple[float, float],
) -> None:
    """Of both bodies turned about the origin and shifted; the feet turn along, and lie on both outlines."""
    a, b = (
        Placed(shape.outline, x, angle)
        for shape, x, angle in zip((one, other), (np.zeros(2), np.array([away, 0.3])), angles, strict=True)
    )
    c, s = np.cos(turn), np.sin(turn)
    rows = np.array([[c, s], [-s, c]])
    a2, b2 = (Placed(body.outline, shift + body.centre @ rows, body.angle + turn) for body in (a, b))
    gap = a.gap_to(b).gap
    if gap > 0.0:
        found = [b.gap_to(a).gap, a2.gap_to(b2).gap, b2.gap_to(a2).gap]
        np.testing.assert_allclose(found, gap, rtol=1e-11, atol=1e-13)
        foot = a.gap_to(b)
        assert abs(a.signed_distance(foot.x[None])[0][0]) < 1e-12
        assert abs(b.signed_distance(foot.opposite[None])[0][0]) < 1e-12
    else:
        assert a2.gap_to(b2).gap < 1e-12


@settings(max_examples=25, deadline=None)
@given(shape=st.sampled_from(EVERY), factor=st.floats(1e-3, 1e3), start=st.floats(0.0, 1.0))
def test_integrals_scale_and_do_not_depend_on_where_the_curve_begins(
    shape: BodyShape, factor: float, start: float
) -> None:
    """Areas as squares, second moments as fourth powers; the centre stays where it is."""
    outline, formula = shape.outline, shape.curve()
    joints = tuple(sorted((joint - start) % 1.0 for joint in shape.joints))
    moved = Outline.of(lambda t: formula(np.mod(t + start, 1.0)), joints, shape.fewest)
    np.testing.assert_allclose(moved.shift, outline.shift, atol=1e-9 * outline.radius)
    assert moved.area == pytest.approx(outline.area, rel=1e-9)
    assert moved.second_moment == pytest.approx(outline.second_moment, rel=1e-9)
    scaled = outline.scaled(factor)
    assert scaled.area == pytest.approx(factor**2 * outline.area, rel=1e-12)
    assert scaled.second_moment == pytest.approx(factor**4 * outline.second_moment, rel=1e-12)
    assert scaled.radius == pytest.approx(factor * outline.radius, rel=1e-12)


def test_the_long_axis_is_that_of_the_largest_second_moment() -> None:
    """Of a rod along x, of one at 30 degrees given by its corners; squares have none."""
    assert ELLIPSE.outline.long_axis == pytest.approx(0.0, abs=1e-12)
    c, s = np.cos(np.pi / 6.0), np.sin(np.pi / 6.0)
    corners = tuple(
        (c * x - s * y, s * x + c * y) for x, y in ((0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0))
    )
    slanted = Polygon(kind="polygon", corners=corners, rounding=0.2)
    assert slanted.outline.long_axis == pytest.approx(np.pi / 6.0, abs=1e-12)
    even = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    assert Polygon(kind="polygon", corners=even, rounding=0.2).outline.long_axis is None
    assert Outline.disc(1.0).long_axis is None
