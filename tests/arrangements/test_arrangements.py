"""What every arrangement must have: the asked gaps, to images and walls too, and the exact area fraction."""

from __future__ import annotations

import itertools
from math import pi, sqrt
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrangements import kinds, packing
from fsi.arrangements.arrangement import Arrangement, Wanted
from fsi.arrangements.cell import SimulationCell
from fsi.arrangements.kinds import KINDS, radii_of
from fsi.arrangements.packing import largest_fraction, proposal, random_arrangement
from fsi.errors import InputError

CELLS = ["channel", "periodic", "box"]


def random_discs(
    number: int, fraction: float, gap: float, cell: str = "channel", seed: int = 1
) -> Arrangement:
    return random_arrangement(np.ones(number), Wanted(number, fraction, gap, cell=cell, seed=seed))


def gaps_by_brute_force(a: Arrangement) -> tuple[float, float]:
    """Smallest gap over all pairs and all neighbouring images, and to the walls, from the definitions."""
    d = len(a.cell.sides)
    images = [
        s
        for s in itertools.product((-1, 0, 1), repeat=d)
        if all(p or k == 0 for p, k in zip(a.cell.periodic, s, strict=True))
    ]
    pairs, walls = [np.inf], [np.inf]
    for s in images:
        moved = a.centres + np.array(s) * a.cell.sides
        distance = np.linalg.norm(a.centres[:, None] - moved[None], axis=2)
        gap = distance - a.radii[:, None] - a.radii[None]
        pairs.append(
            float(gap[~np.eye(len(gap), dtype=bool)].min(initial=np.inf) if not any(s) else gap.min())
        )
    for k in range(d):
        if not a.cell.periodic[k]:
            walls += [
                float((a.centres[:, k] - a.radii).min()),
                float((a.cell.sides[k] - a.centres[:, k] - a.radii).min()),
            ]
    return min(pairs), min(walls)


def check(a: Arrangement, fraction: float, gap: float) -> None:
    pair, wall = gaps_by_brute_force(a)
    assert pair >= gap - 1e-9
    assert wall >= gap - 1e-9
    assert a.smallest_gap() == pytest.approx(pair, abs=1e-12)
    assert a.smallest_wall_gap() == pytest.approx(wall, abs=1e-12)
    area = {2: pi * (a.radii**2).sum(), 3: 4 / 3 * pi * (a.radii**3).sum()}[len(a.cell.sides)]
    assert area / np.prod(a.cell.sides) == pytest.approx(fraction, rel=1e-13)
    inside = (a.centres >= 0.0) & (a.centres < a.cell.sides)
    assert inside.all()


@settings(max_examples=10)
@given(
    number=st.integers(10, 30),
    fraction=st.floats(0.05, 0.7),
    gap=st.floats(0.0, 0.05),
    cell=st.sampled_from(CELLS),
    sizes=st.sampled_from(["equal", "bidisperse", "lognormal"]),
    seed=st.integers(0, 2**32),
)
def test_random(number: int, fraction: float, gap: float, cell: str, sizes: str, seed: int) -> None:
    """Either it is right, or it is refused near the largest fraction or above it."""
    spread = {"equal": 0.0, "bidisperse": 1.4, "lognormal": 0.2}[sizes]
    wanted = Wanted(number, fraction, gap, cell=cell, seed=seed, sizes=sizes, spread=spread)
    try:
        with patch.object(packing, "MOVES", 100):  # enough to see a move that makes an overlap
            found = KINDS["random"].arranged(wanted)
    except InputError as error:
        largest = largest_fraction(radii_of(wanted), wanted.periodic, 1.0, gap)
        assert fraction > 0.85 * largest, error  # noqa: PT017
    else:
        check(found, fraction, gap)


@settings(max_examples=100)
@given(
    kind=st.sampled_from(["square", "hexagonal", "rows", "chains", "columns"]),
    rows=st.integers(1, 5), abreast=st.integers(1, 5), length=st.integers(1, 6), angle=st.floats(1.0, 179.0),
    fraction=st.floats(0.01, 0.9), gap=st.floats(0.0, 0.3), radius=st.floats(0.1, 10.0),
    cell=st.sampled_from(CELLS),
)  # fmt: skip
def test_ordered(
    kind: str, rows: int, abreast: int, length: int, angle: float, fraction: float, gap: float, radius: float,
    cell: str,
) -> None:  # fmt: skip
    number = abreast * (rows if kind != "columns" else 1) * (length if kind in ("chains", "columns") else 1)
    gap = gap * radius
    wanted = Wanted(number, fraction, gap, radius, cell, rows=rows, length=length, angle=angle)
    try:
        found = KINDS[kind].arranged(wanted)
    except InputError as error:
        assert any(word in str(error) for word in ("largest possible", "walls", "odd"))  # noqa: PT017
    else:
        check(found, fraction, gap)


@pytest.mark.parametrize("cell", ["periodic", "channel"])
def test_square_arrays_touch_at_pi_over_4(cell: str) -> None:
    full = kinds.square_array(Wanted(16, pi / 4, 0.0, cell=cell, rows=4))
    assert full.smallest_gap() == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InputError, match=r"the largest possible is 0\.7853"):
        kinds.square_array(Wanted(16, pi / 4 + 1e-4, 0.0, cell=cell, rows=4))


def test_chains_stand_half_their_distance_from_the_walls() -> None:
    """Upright ones, of three touching discs of area fraction 0.2: pi 3 = 0.2 (2 + c) (6 + c)."""
    stood = kinds.oblique_chains(Wanted(12, 0.2, 0.0, cell="channel", rows=2, length=3, angle=90.0))
    room = -4.0 + sqrt(4.0 + 15.0 * pi)
    assert stood.smallest_wall_gap() == pytest.approx(0.5 * room, rel=1e-12)
    assert np.unique(stood.centres[:, 0].round(9)) == pytest.approx((2.0 + room) * np.array([0.5, 1.5]))


def test_hexagonal_arrays_touch_at_pi_over_two_sqrt3() -> None:
    full = kinds.hexagonal_array(Wanted(16, pi / (2 * sqrt(3)), 0.0, cell="periodic", rows=4))
    assert full.smallest_gap() == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InputError, match=r"the largest possible is 0\.9068"):
        kinds.hexagonal_array(Wanted(16, 0.907, 0.0, cell="periodic", rows=4))


def test_columns_reach_from_wall_to_wall() -> None:
    found = kinds.wall_to_wall_columns(Wanted(12, 0.4, 0.01, length=4, angle=60.0))
    to_walls = found.cell.wall_distances(found.centres) - 1.0
    assert np.sort(to_walls.ravel())[:6] == pytest.approx(0.01)  # both ends of three columns
    first = found.centres[:4]
    np.testing.assert_allclose(np.linalg.norm(np.diff(first, axis=0), axis=1), 2.01)
    slopes = np.degrees(np.arctan2(*np.diff(first, axis=0).T[::-1]))
    np.testing.assert_allclose(slopes, 60.0)


def test_the_same_seed_gives_the_same_arrangement_and_another_another() -> None:
    one, same, other = (random_discs(20, 0.4, 0.02, seed=seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one.centres, same.centres)
    assert np.abs(one.centres - other.centres).max() > 0.1


@pytest.mark.slow
def test_a_thousand_discs_at_seven_tenths() -> None:
    found = random_discs(1000, 0.7, 0.02, "periodic")
    check(found, 0.7, 0.02)


def test_spheres() -> None:
    with patch.object(packing, "TRIES_IN_SPACE", 60):
        found = random_arrangement(np.ones(100), Wanted(100, 0.4, 0.02, aspect=1.5, dimension=3))
    assert found.cell.sides[0] == pytest.approx(1.5 * found.cell.sides[2])
    check(found, 0.4, 0.02)


@settings(max_examples=100)
@given(
    kind=st.sampled_from(["simple-cubic", "body-centred", "face-centred", "close-packed"]),
    number=st.integers(1, 60), fraction=st.floats(0.01, 0.8), gap=st.floats(0.0, 0.3),
    radius=st.floats(0.1, 10.0), cell=st.sampled_from(CELLS),
)  # fmt: skip
def test_crystals(kind: str, number: int, fraction: float, gap: float, radius: float, cell: str) -> None:
    wanted = Wanted(number, fraction, gap * radius, radius, cell, dimension=3)
    try:
        found = KINDS[kind].arranged(wanted)
    except InputError as error:
        assert any(word in str(error) for word in ("largest possible", "no multiple"))  # noqa: PT017
    else:
        check(found, fraction, gap * radius)
        assert len(found.radii) == number


@pytest.mark.parametrize(
    ("kind", "number", "densest", "neighbours", "next_ones"),
    [
        ("simple-cubic", 27, pi / 6, 6, 2.0),
        ("body-centred", 54, sqrt(3) * pi / 8, 8, 4 / 3),
        ("face-centred", 108, pi / sqrt(18), 12, 2.0),
        ("close-packed", 96, pi / sqrt(18), 12, 2.0),
    ],
)
def test_crystals_touch_where_they_are_densest(
    kind: str, number: int, densest: float, neighbours: int, next_ones: float
) -> None:
    """Kittel, Introduction to Solid State Physics, chapter 1: neighbours, the square of the next distance.

    Of face-centred cubic and close-packed arrays the third distances differ: s^2 = 3 and 8/3.
    """
    full = KINDS[kind].arranged(Wanted(number, densest, 0.0, cell="periodic", dimension=3))
    between = full.cell.separation(full.centres[1:], full.centres[0])
    squares = np.sort((between**2).sum(axis=1) / 4.0).round(9)
    assert np.sum(squares == 1.0) == neighbours
    assert squares[neighbours] == pytest.approx(next_ones)
    assert (np.any(squares == round(8.0 / 3.0, 9))) == (kind in ("body-centred", "close-packed"))
    with pytest.raises(InputError, match="the largest possible is"):
        KINDS[kind].arranged(Wanted(number, densest + 1e-4, 0.0, cell="periodic", dimension=3))


def test_too_large_a_fraction_is_refused_with_the_largest() -> None:
    largest = largest_fraction(np.ones(100), (True, True), 1.0, 0.02)
    assert largest == pytest.approx(0.78 / 1.01**2)  # the grown discs fill 0.78
    with pytest.raises(InputError, match=r"area_fraction = 0.8: .* the largest possible is 0.7646"):
        random_discs(100, 0.8, 0.02, "periodic")


@pytest.mark.slow
def test_random_is_the_hard_disc_fluid() -> None:
    """Pairs near contact, against g = (1 - 7 phi/16)/(1 - phi)^2 (D. Henderson, Mol. Phys. 30 (1975) 971).

    Within 2 % of the diameter g falls by some 3 %, and 1800 pairs are counted: 15 % are five deviations.
    The same discs with overlaps removed but not shaken give more than twice as many.
    """
    phi, width, counted, expected = 0.4, 0.02, 0, 0.0
    for seed in range(12):
        a = random_discs(400, phi, 0.0, "periodic", seed)
        counted += len(a.cell.near_pairs(a.centres, 2.0 * (1.0 + width)))
        shell = 4.0 * pi * ((1.0 + width) ** 2 - 1.0)
        expected += 0.5 * 400 * 399 * shell / a.cell.volume * (1.0 - 7.0 * phi / 16.0) / (1.0 - phi) ** 2
    assert counted == pytest.approx(expected, rel=0.15)


def test_a_separation_is_that_of_the_nearest_image() -> None:
    cell = SimulationCell((4.0, 3.0), (True, False))
    between = cell.separation(np.array([[3.9, 2.9]]), np.array([[0.1, 0.1]]))
    np.testing.assert_allclose(between, [[-0.2, 2.8]])
    assert cell.near_pairs(np.array([[-0.1, 1.0], [4.1, 1.0], [2.0, 1.0]]), 0.3).tolist() == [[0, 1]]


@settings(max_examples=50)
@given(number=st.integers(1, 40), mean=st.floats(0.1, 10.0), seed=st.integers(0, 100))
def test_radii_have_their_mean(number: int, mean: float, seed: int) -> None:
    for sizes, spread in (("equal", 0.0), ("bidisperse", 1.4), ("lognormal", 0.3)):
        radii = radii_of(Wanted(number, 0.4, 0.0, mean, seed=seed, sizes=sizes, spread=spread))
        assert len(radii) == number
        assert radii.min() > 0.0
        assert radii.mean() == pytest.approx(mean, rel=1e-13)


def test_lognormal_radii_have_their_deviation() -> None:
    """So wide that the deviation of the logarithm, 0.55, is another: as 0.6 it would give 0.66 instead."""
    radii = radii_of(Wanted(20000, 0.4, 0.0, seed=0, sizes="lognormal", spread=0.6))
    assert radii.std() == pytest.approx(0.6, rel=0.05)  # standard error 1.2 %
    assert np.log(radii).std() == pytest.approx(sqrt(np.log1p(0.36)), rel=0.02)  # 0.5 %


@pytest.mark.parametrize("cell", ["channel", "box"])
def test_a_channel_so_low_that_the_chequerboard_is_one_square_high(cell: str) -> None:
    """Laid across it, two squares of one colour met there, and of their bodies both moved."""
    check(random_arrangement(np.ones(30), Wanted(30, 0.4, 0.02, cell=cell, aspect=20.0)), 0.4, 0.02)


def test_bodies_at_random_do_not_stand_at_the_smallest_gap() -> None:
    """Where overlaps are just removed and nothing is shaken, most have a neighbour at the gap itself.

    In the fluid of hard discs some 2 phi g (dr / a) = 2 * 0.5 * 3.1 * 1e-3 neighbours a disc are so near.
    """
    found = random_discs(200, 0.5, 0.02, "periodic")
    nearest = len(found.cell.near_pairs(found.centres, 2.0 + 0.021))
    assert nearest <= 5


def test_bodies_that_move_at_once_never_meet() -> None:
    """Each stays in its square, and squares of one colour are so far apart, whatever the move.

    Eight squares on a side are exactly as wide as is asked for: a body that leaves its own comes nearer.
    """
    found, random = random_discs(200, 0.4, 0.02, "periodic"), np.random.default_rng(0)
    width, length = found.cell.sides[0] / 8.0 * (1.0 - 1e-12), 1.0
    for _ in range(50):
        moved, trying = proposal(found.cell, found.centres, width, length, random)
        assert trying.any()
        assert len(found.cell.near_pairs(moved[trying], width * (1.0 - 1e-12))) == 0
