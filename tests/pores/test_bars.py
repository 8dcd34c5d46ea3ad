"""Bars of velocities between pores hold in random packings, body by body."""

from __future__ import annotations

import numpy as np
import pytest

from bench.pore_packings import Packing, by_pores, over_bars, packings
from fsi.pores.bars import reference_modes

# Of 0.2 to 0.7 of the area, channels in shear; with equal discs.
SEED, PACKINGS = 70, 6
FINEST = 12  # modes of the flow that is taken for the true one: 1e-7 of the viscosity


@pytest.fixture(scope="module")
def flows() -> list[tuple[Packing, np.ndarray]]:
    return [(packing, by_pores(packing, FINEST).U) for packing in packings(PACKINGS, SEED)]


@pytest.mark.parametrize("modes", [0, 1, 2, 4, 6])
def test_each_velocity_is_off_by_less_than_its_bar(
    modes: int, flows: list[tuple[Packing, np.ndarray]]
) -> None:
    """Measured: up to 0.8; told by four modes those with none and one would be up to 1.0 and 2.1."""
    worst = []
    for packing, exact in flows:
        U = {number: by_pores(packing, number).U for number in (modes, reference_modes(modes))}
        worst.append(over_bars(packing, modes, U, exact).max())
    assert 0.5 < max(worst) <= 1.0  # bars are not made to hold by making them long
