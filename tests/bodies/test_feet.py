"""All gaps of a pair of surfaces: those of rods in circles and of peanuts, each one followed on its way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.feet import Feet, feet_between, find_feet
from fsi.bodies.gaps import find_gaps
from fsi.case.profiles.wave import Wave
from fsi.case.shapes.ellipse import Ellipse
from fsi.case.shapes.fourier import FourierShape
from fsi.case.shapes.stadium import Stadium
from fsi.integration.gap_limiter import LEAST_ROOM, greatest_approach
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.feet import Foot
from fsi.meshes.geometry.outline import Outline
from fsi.meshes.geometry.round import Round
from fsi.meshes.geometry.shaped import ShapedWalls
from fsi.meshes.geometry.unbounded import Unbounded

PEANUT = FourierShape(kind="fourier", radius=1.0, orders=(2,), cosines=(0.4,)).outline
ROD = Stadium(kind="stadium", length=2.0, radius=0.25).outline  # between the ends' centres
FAR = 10.0
BOX = Box((-3.0, 0.0), (3.0, 9.0))
BOTTOM = BOX.walls.index("bottom")


def standing(*bodies: tuple[Outline, tuple[float, float], float]) -> Configuration:
    outlines = tuple(outline for outline, _, _ in bodies)
    radii = np.array([outline.radius for outline in outlines])
    centres, angles = np.array([x for _, x, _ in bodies]), np.array([angle for *_, angle in bodies])
    return Configuration(centres, angles, radii, outlines)


def widths(feet: Feet, *between: int) -> Array:
    return np.sort(feet.gaps[(feet.sides == between).all(axis=1)])


@pytest.mark.parametrize("off", [0.0, 0.1, -0.3])
def test_a_rod_in_a_circle_has_a_gap_at_either_end(off: float) -> None:
    """Its ends are 1.25 from its centre, the circle 2."""
    feet = find_feet(standing((ROD, (off, 0.0), 0.0)), Round(2.0), FAR)
    np.testing.assert_allclose(widths(feet, 0, 1), [0.75 - abs(off), 0.75 + abs(off)], atol=1e-12)


def test_a_rod_along_a_wall_has_one_gap() -> None:
    feet = find_feet(standing((ROD, (0.0, 0.35), 0.0)), BOX, FAR)
    np.testing.assert_allclose(widths(feet, 0, 1 + BOTTOM), [0.1], rtol=1e-12)


def test_a_peanut_lies_on_its_two_lobes() -> None:
    """r = 1 + 0.4 cos 2 theta dips lowest where d(r sin theta) = 0: sin^2 theta = (1 + 0.4) / (6 0.4)."""
    sine = np.sqrt(1.4 / 2.4)
    depth = (1.0 + 0.4 * (1.0 - 2.0 * sine**2)) * sine
    q = standing((PEANUT, (0.0, 2.0), 0.0))
    feet = find_feet(q, BOX, FAR)
    np.testing.assert_allclose(widths(feet, 0, 1 + BOTTOM), [2.0 - depth] * 2, rtol=1e-12)


@settings(max_examples=8, deadline=None)
@example(angle=1.40625, turn=1.0, lobes=8, gap=-1.0)
@given(
    angle=st.floats(0.0, 6.3), turn=st.floats(0.0, 6.3), lobes=st.integers(2, 9), gap=st.floats(-4.0, -0.5)
)
def test_gaps_of_a_pair_are_the_same_from_both_sides_the_narrowest_first(
    angle: float, turn: float, lobes: int, gap: float
) -> None:
    """A shape with lobes beside a peanut. One that is only just a gap may be none from the other side.

    In the example the third, 0.9265, is none from the star, whose nearest point of the peanut is 0.9224 away.
    """
    star = FourierShape(kind="fourier", radius=1.0, orders=(lobes,), cosines=(0.2,)).outline
    away = star.radius + PEANUT.radius + 10.0**gap
    bodies = ((star, (0.0, 0.0), turn), (PEANUT, (away, 0.0), angle))
    one, other = standing(*bodies), standing(*bodies[::-1])
    reach = 2.0  # beyond the gap between the waists of both
    feet, back = (find_feet(q, Unbounded(), reach) for q in (one, other))
    pair = find_gaps(one, Unbounded(), reach).pair_gaps
    assert feet.gaps[0] == pair[0]
    assert feet.gaps.min() >= pair[0] * (1.0 - 1e-12)
    assert back.gaps[0] == pytest.approx(pair[0], rel=1e-9)
    for foot in feet.feet:
        distance, normal = one.placed[1].signed_distance(foot.x[None])
        from_there = one.placed[0].signed_distance(foot.opposite[None])[0]
        assert max(distance[0], from_there[0]) == pytest.approx(foot.gap, rel=1e-9, abs=1e-12)
        if distance[0] == pytest.approx(foot.gap, rel=1e-9, abs=1e-12):
            np.testing.assert_allclose(normal[0], foot.normal, atol=1e-6)


def test_a_gap_that_is_not_the_narrowest_closes_unseen_by_the_narrowest_alone() -> None:
    """A rod 0.1 and 1.4 off both sides of a circle goes 1.2 to the wider one: that loses 6/7 of itself."""
    q = standing((ROD, (0.65, 0.0), 0.0))
    approach = greatest_approach(q, Round(2.0), np.array([[-1.2, 0.0, 0.0]]), 0.5)
    assert approach.gap == pytest.approx(1.4, rel=1e-12)
    assert 0.5 < approach.loss <= 6.0 / 7.0 + 1e-9
    whole = greatest_approach(q, Round(2.0), np.array([[-1.2, 0.0, 0.0]]), 0.9)
    assert whole.loss == pytest.approx(6.0 / 7.0, rel=1e-9)


ELLIPSE = Ellipse(kind="ellipse", axes=(1.0, 0.5)).outline
CROWD = standing(*((ELLIPSE, (2.4 * i, 2.3 * j), 0.3 * i - 0.5 * j) for i in range(3) for j in range(3)))


@settings(max_examples=15, deadline=None)
@given(way=st.lists(st.floats(-1.5, 1.5), min_size=9, max_size=9))
def test_no_gap_of_ellipses_is_smaller_on_the_way_than_said(way: list[float]) -> None:
    """Seen at 21 places: where the way is allowed none is below its limit, but for LEAST_ROOM of a gap."""
    q = standing(*((ELLIPSE, (2.4 * k, 0.4 * k), 1.1 * k) for k in range(3)))
    displacement = np.reshape(way, (3, 3))
    pairs = find_gaps(q, Unbounded(), np.inf)
    before, seen = Feet.at(q, Unbounded(), pairs, np.inf).gaps, -np.inf
    for part in np.linspace(0.0, 1.0, 21):
        after = Feet.at(q.moved(part * displacement), Unbounded(), pairs, np.inf).gaps
        seen = max(seen, float(np.max(1.0 - after / before)))
    said = greatest_approach(q, Unbounded(), displacement, 0.5)
    if said.loss <= 0.5:
        assert seen <= 0.5 + LEAST_ROOM
    if seen > 0.5:
        assert said.loss > 0.5 - LEAST_ROOM


def test_few_gaps_of_a_crowd_are_looked_at_on_the_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """One body comes near to another; all gaps at each place of the way, 4 times as many, tell the same."""
    displacement, asked = np.random.default_rng(1).uniform(-0.3, 0.3, (9, 3)), [0]
    displacement[4] = [0.4, 0.05, 0.3]

    def counted(q: Configuration, i: int, j: int, away: Array, reach: float) -> list[Foot]:
        asked[0] += 1
        return feet_between(q, i, j, away, reach)

    monkeypatch.setattr("fsi.bodies.feet.feet_between", counted)
    few = greatest_approach(CROWD, Unbounded(), displacement, 0.9)
    looked_at, asked[0] = asked[0], 0
    monkeypatch.setattr("fsi.integration.gap_limiter.SOON", np.inf)
    every = greatest_approach(CROWD, Unbounded(), displacement, 0.9)
    assert few.between == every.between == (4, 7)
    assert few.loss == pytest.approx(every.loss, rel=1e-9)
    assert looked_at < asked[0] / 3


def test_pairs_that_are_not_looked_at_stay_as_they_were() -> None:
    """Of later places those of two bodies and of a wall, whose narrowest are followed."""
    q = standing((PEANUT, (0.0, 2.0), 0.0), (ROD, (0.0, 5.0), 0.4))
    later, gaps = q.moved(np.full((2, 3), 0.05)), find_gaps(q, BOX, FAR)
    before, after = Feet.at(q, BOX, gaps, FAR), Feet.at(later, BOX, gaps, FAR)
    wanted = np.array([0, 1 + BOTTOM])
    some = Feet.at(later, BOX, gaps, FAR, wanted)
    assert set(some.of.tolist()) == set(wanted.tolist())
    for pair in wanted:
        assert np.array_equal(some.gaps[some.of == pair], after.gaps[after.of == pair])
        assert np.array_equal(some.sides[some.of == pair], after.sides[after.of == pair])
    ways = np.full(len(before.feet), FAR)
    followed, asked = before.followed(some, ways), np.isin(before.of, wanted)
    assert np.array_equal(followed[asked], before.followed(after, ways)[asked])
    assert np.array_equal(followed[~asked], before.gaps[~asked])


def test_a_gap_that_vanishes_is_not_taken_for_its_neighbour() -> None:
    """A peanut on its lobes, rolls until the higher one is none."""
    q = standing((PEANUT, (0.0, 2.0), 0.0))
    gaps = find_gaps(q, BOX, FAR)
    feet = Feet.at(q, BOX, gaps, FAR)
    for angle, left in ((0.2, 2), (0.9, 1)):
        turned = replace(q, angles=np.array([angle]))
        later = Feet.at(turned, BOX, gaps, FAR)
        assert len(widths(later, 0, 1 + BOTTOM)) == left
    ways = np.full(len(feet.feet), 1e-3)  # too short to make the one of the other
    followed = feet.followed(Feet.at(replace(q, angles=np.array([0.9])), BOX, gaps, FAR), ways)
    of_wall = (feet.sides == (0, 1 + BOTTOM)).all(axis=1)
    narrowest, other = followed[of_wall]
    assert narrowest != feet.gaps[of_wall][0]
    assert other == feet.gaps[of_wall][1]


@pytest.mark.parametrize(("length", "height"), [(0.02, 0.004), (0.1, 0.02)])
def test_a_disc_over_waves_finer_than_its_sample_is_nearest_to_a_crest(length: float, height: float) -> None:
    """Against points every 2e-6; from the sample alone the gap was 1.2e-3 and 3e-6 too wide."""
    wave = Wave(kind="wave", height=height, length=length, number=round(3.0 / length), start=-1.5)
    container, y = ShapedWalls.of(BOX, {"bottom": wave.heights()}), 1.0 + height + 1e-3
    q = standing((Outline.disc(1.0), (0.0, y), 0.0))
    s = np.linspace(-1.0, 1.0, 1_000_001)
    h = 0.5 * height * (1.0 - np.cos(2.0 * np.pi * (s + 1.5) / length))
    gap = find_gaps(q, container).wall_gaps[0, BOTTOM]
    assert gap == pytest.approx(float(np.hypot(s, h - y).min()) - 1.0, abs=1e-9)
    feet = find_feet(q, container, 1e-2)
    assert widths(feet, 0, 1 + BOTTOM)[0] == pytest.approx(gap, abs=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.007, 1.0])
def test_a_disc_beside_a_rough_one_is_nearest_to_a_bump(angle: float) -> None:
    """r = 1 + 0.005 cos 100 theta against 2e5 points; from the disc's sample it was 3e-3 too wide."""
    rough = FourierShape(kind="fourier", radius=1.0, orders=(100,), cosines=(0.005,)).outline
    q = standing((Outline.disc(1.0), (0.0, 0.0), 0.0), (rough, (2.006, 0.0), angle))
    true = float(np.hypot(*q.placed[1].at(np.linspace(0.0, 1.0, 200_001)).x.T).min()) - 1.0
    assert find_gaps(q, Unbounded()).pair_gaps[0] == pytest.approx(true, abs=1e-8)
