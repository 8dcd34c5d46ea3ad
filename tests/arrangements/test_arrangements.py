"""What every arrangement must have: the asked gaps, to images and walls too, and the exact area fraction."""

from __future__ import annotations

import itertools
from math import pi, sqrt
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrangements import ordered, shaking
from fsi.arrangements.arrangement import Arrangement, Cell
from fsi.arrangements.packing import largest_fraction, random_arrangement
from fsi.arrangements.sizes import bidisperse, lognormal, monodisperse
from fsi.errors import InputError

CHANNEL, PERIODIC, BOX = (True, False), (True, True), (False, False)


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
    periodic=st.sampled_from([CHANNEL, PERIODIC, BOX]),
    kind=st.sampled_from(["equal", "bidisperse", "lognormal"]),
    seed=st.integers(0, 2**32),
)
def test_random(
    number: int, fraction: float, gap: float, periodic: tuple[bool, ...], kind: str, seed: int
) -> None:
    """Either it is right, or it is refused near the largest fraction or above it."""
    radii = {
        "equal": monodisperse(number, 1.0),
        "bidisperse": bidisperse(number, 1.0, 1.4),
        "lognormal": lognormal(number, 1.0, 0.2, np.random.default_rng(seed)),
    }[kind]
    try:
        with patch.object(shaking, "_MOVES", 100):  # enough to see a move that makes an overlap
            found = random_arrangement(radii, fraction, periodic, 1.0, gap, seed)
    except InputError as error:
        assert fraction > 0.85 * largest_fraction(radii, periodic, 1.0, gap), error  # noqa: PT017
    else:
        check(found, fraction, gap)


@settings(max_examples=100)
@given(
    kind=st.sampled_from(["square", "hexagonal", "rows", "chains", "columns"]),
    rows=st.integers(1, 5), abreast=st.integers(1, 5), length=st.integers(1, 6), angle=st.floats(1.0, 179.0),
    fraction=st.floats(0.01, 0.9), gap=st.floats(0.0, 0.3), radius=st.floats(0.1, 10.0),
    periodic=st.sampled_from([CHANNEL, PERIODIC, BOX]),
)  # fmt: skip
def test_ordered(
    kind: str, rows: int, abreast: int, length: int, angle: float, fraction: float, gap: float, radius: float,
    periodic: tuple[bool, ...],
) -> None:  # fmt: skip
    gap = gap * radius
    try:
        match kind:
            case "square":
                found = ordered.square_array(rows * abreast, rows, radius, fraction, gap, periodic)
            case "hexagonal":
                found = ordered.hexagonal_array(rows * abreast, rows, radius, fraction, gap, periodic)
            case "rows":
                found = ordered.flow_aligned_rows(rows * abreast, rows, radius, fraction, gap, periodic)
            case "chains":
                n = rows * length * abreast
                found = ordered.oblique_chains(n, rows, length, angle, radius, fraction, gap, periodic)
            case _:
                n = length * abreast
                found = ordered.wall_to_wall_columns(n, length, angle, radius, fraction, gap, periodic)
    except InputError as error:
        assert any(word in str(error) for word in ("largest possible", "walls", "odd"))  # noqa: PT017
    else:
        check(found, fraction, gap)


@pytest.mark.parametrize(
    ("periodic", "largest"),
    [(PERIODIC, pi / 4), (CHANNEL, pi / 4)],
)
def test_square_arrays_touch_at_pi_over_4(periodic: tuple[bool, ...], largest: float) -> None:
    full = ordered.square_array(16, 4, 1.0, largest, 0.0, periodic)
    assert full.smallest_gap() == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InputError, match=r"the largest possible is 0\.7853"):
        ordered.square_array(16, 4, 1.0, largest + 1e-4, 0.0, periodic)


def test_hexagonal_arrays_touch_at_pi_over_two_sqrt3() -> None:
    full = ordered.hexagonal_array(16, 4, 1.0, pi / (2 * sqrt(3)), 0.0, PERIODIC)
    assert full.smallest_gap() == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InputError, match=r"the largest possible is 0\.9068"):
        ordered.hexagonal_array(16, 4, 1.0, 0.907, 0.0, PERIODIC)


def test_columns_reach_from_wall_to_wall() -> None:
    found = ordered.wall_to_wall_columns(12, 4, 60.0, 1.0, 0.4, 0.01, CHANNEL)
    to_walls = found.cell.wall_distances(found.centres) - 1.0
    assert np.sort(to_walls.ravel())[:6] == pytest.approx(0.01)  # both ends of three columns
    first = found.centres[:4]
    np.testing.assert_allclose(np.linalg.norm(np.diff(first, axis=0), axis=1), 2.01)
    slopes = np.degrees(np.arctan2(*np.diff(first, axis=0).T[::-1]))
    np.testing.assert_allclose(slopes, 60.0)


def test_the_same_seed_gives_the_same_arrangement_and_another_another() -> None:
    one, same, other = (random_arrangement(np.ones(20), 0.4, CHANNEL, 1.0, 0.02, seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one.centres, same.centres)
    assert np.abs(one.centres - other.centres).max() > 0.1


def test_a_thousand_discs_at_seven_tenths() -> None:
    found = random_arrangement(np.ones(1000), 0.7, PERIODIC, 1.0, 0.02, 1)
    check(found, 0.7, 0.02)


def test_spheres() -> None:
    found = random_arrangement(np.ones(100), 0.4, (True, True, False), 1.5, 0.02, 1)
    assert found.cell.sides[0] == pytest.approx(1.5 * found.cell.sides[2])
    check(found, 0.4, 0.02)


def test_too_large_a_fraction_is_refused_with_the_largest() -> None:
    largest = largest_fraction(np.ones(100), PERIODIC, 1.0, 0.02)
    assert largest == pytest.approx(0.78 / 1.01**2)  # the grown discs fill 0.78
    with pytest.raises(InputError, match=r"area fraction = 0.8: .* the largest possible is 0.7646"):
        random_arrangement(np.ones(100), 0.8, PERIODIC, 1.0, 0.02, 1)


@pytest.mark.slow
def test_random_is_the_hard_disc_fluid() -> None:
    """Pairs near contact, against g = (1 - 7 phi/16)/(1 - phi)^2 (D. Henderson, Mol. Phys. 30 (1975) 971).

    Within 2 % of the diameter g falls by some 3 %, and 1800 pairs are counted: 15 % are five deviations.
    The same discs with overlaps removed but not shaken give more than twice as many.
    """
    phi, width, counted, expected = 0.4, 0.02, 0, 0.0
    for seed in range(12):
        a = random_arrangement(np.ones(400), phi, PERIODIC, 1.0, 0.0, seed)
        counted += len(a.cell.near_pairs(a.centres, 2.0 * (1.0 + width)))
        shell = 4.0 * pi * ((1.0 + width) ** 2 - 1.0)
        expected += 0.5 * 400 * 399 * shell / a.cell.volume * (1.0 - 7.0 * phi / 16.0) / (1.0 - phi) ** 2
    assert counted == pytest.approx(expected, rel=0.15)


def test_a_separation_is_that_of_the_nearest_image() -> None:
    cell = Cell((4.0, 3.0), CHANNEL)
    between = cell.separation(np.array([[3.9, 2.9]]), np.array([[0.1, 0.1]]))
    np.testing.assert_allclose(between, [[-0.2, 2.8]])
    assert cell.near_pairs(np.array([[-0.1, 1.0], [4.1, 1.0], [2.0, 1.0]]), 0.3).tolist() == [[0, 1]]


@settings(max_examples=50)
@given(number=st.integers(1, 40), mean=st.floats(0.1, 10.0), seed=st.integers(0, 100))
def test_radii_have_their_mean(number: int, mean: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for radii in (
        monodisperse(number, mean),
        bidisperse(number, mean, 1.4),
        lognormal(number, mean, 0.3, rng),
    ):
        assert len(radii) == number
        assert radii.min() > 0.0
        assert radii.mean() == pytest.approx(mean, rel=1e-13)


def test_lognormal_radii_have_their_deviation() -> None:
    radii = lognormal(20000, 1.0, 0.3, np.random.default_rng(0))
    assert radii.std() == pytest.approx(0.3, rel=0.03)  # standard error 0.7 %
    assert np.log(radii).std() == pytest.approx(sqrt(np.log1p(0.09)), rel=0.03)


@pytest.mark.parametrize("periodic", [CHANNEL, BOX])
def test_a_channel_so_low_that_the_chequerboard_is_one_square_high(periodic: tuple[bool, ...]) -> None:
    """Laid across it, two squares of one colour met there, and of their bodies both moved."""
    radii = monodisperse(30, 1.0)
    check(random_arrangement(radii, 0.4, periodic, 20.0, 0.02, 1), 0.4, 0.02)
