"""Gaps of any width and fractions of any smallness: an arrangement in a moment, or a refusal that helps."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from fsi.arrangements.arrangement import Wanted
from fsi.arrangements.cell import SimulationCell
from fsi.arrangements.kinds import arrange
from fsi.arrangements.packing import largest_fraction, proposal
from fsi.errors import InputError

pytestmark = pytest.mark.filterwarnings("error")


@pytest.mark.parametrize("gap", [0.02, 1e3, 1e10, 1e50])
def test_the_largest_fraction_of_gaps_of_any_width(gap: float) -> None:
    """The discs grown by half the gap fill 0.78: 0.78 / (1 + g/2)^2. It was looked for above 1e-9 only."""
    largest = largest_fraction(np.ones(100), (True, True), 1.0, gap)
    assert largest == pytest.approx(0.78 / (1.0 + 0.5 * gap) ** 2, rel=1e-9, abs=0.0)


@pytest.mark.parametrize(
    ("kind", "dimension", "gap", "largest"),
    [
        ("random", 2, 2.2e6 - 2.0, "6.446e-13"),  # 0.78 / 1.1e6^2
        ("square", 2, 1e6 - 2.0, "3.141e-12"),  # pi / s^2, s = 1e6
        ("hexagonal", 2, 1e6 - 2.0, "3.627e-12"),  # 2 pi / (sqrt3 s^2)
        ("simple-cubic", 3, 1e6 - 2.0, "4.188e-18"),  # 4 pi / (3 s^3)
    ],
)
def test_the_refusal_of_a_wide_gap_has_a_fraction_and_the_gap(
    kind: str, dimension: int, gap: float, largest: str
) -> None:
    """Rounded to four decimals the largest fraction was 0."""
    with pytest.raises(InputError) as caught:
        arrange(kind, Wanted(64, 0.4, gap, cell="periodic", dimension=dimension, rows=8))
    assert f"gaps of {gap:g} radii; the largest possible is {largest}; lower it, or the gap" in str(
        caught.value
    )


@pytest.mark.parametrize("fraction", [1e-20, 1e-40])
@pytest.mark.parametrize("cell", ["channel", "periodic", "box"])
def test_dilute_discs_take_no_room_for_empty_squares(fraction: float, cell: str) -> None:
    """A chequerboard was laid out in memory, of 1e20 squares and more."""
    found = arrange("random", Wanted(30, fraction, 0.02, cell=cell))
    assert found.fraction() == pytest.approx(fraction, rel=1e-13, abs=0.0)
    assert min(found.smallest_gap(), found.smallest_wall_gap()) >= 0.02


@pytest.mark.parametrize("seed", range(5))
def test_of_each_square_the_last_in_a_random_order_tries(seed: int) -> None:
    """Body by body, drawn as `proposal` draws; seeded arrangements keep their places by it.

    Squares are 1 wide, four on a side, with some seven bodies in each.
    """
    cell, random = SimulationCell((4.0, 4.0), (True, True)), np.random.default_rng(seed)
    x = 4.0 * random.random((100, 2))
    _, trying = proposal(cell, x, 1.0, 0.0, np.random.default_rng(seed))
    again = np.random.default_rng(seed)
    shift, colour = 4.0 * again.random(2), again.integers(2, size=2)
    square = np.floor(x + shift).astype(int) % 4
    last = {tuple(square[k]): k for k in again.permutation(100).tolist()}
    expected = {last[s] for s in itertools.product(range(4), repeat=2) if s in last and s[0] % 2 == colour[0]}
    expected &= {k for k in expected if square[k, 1] % 2 == colour[1]}
    assert set(np.flatnonzero(trying).tolist()) == expected
