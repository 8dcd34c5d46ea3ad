"""Spheres at random in space are shaken until they are the fluid of hard spheres."""

from __future__ import annotations

from math import pi
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from numpy.typing import NDArray

from fsi.arrangements import packing
from fsi.arrangements.arrangement import Arrangement, Wanted
from fsi.arrangements.packing import proposal, random_arrangement
from fsi.arrays import Array

PHI, NUMBER = 0.45, 300


def spheres(seed: int) -> Arrangement:
    wanted = Wanted(NUMBER, PHI, 0.0, cell="periodic", seed=seed, dimension=3)
    return random_arrangement(np.ones(NUMBER), wanted)


def test_every_sphere_tries_as_often_as_is_said() -> None:
    """Not so many moves, of however few: 1000, once, were 25 tries of each of these spheres."""
    tries = []

    def counted(*of: Any) -> tuple[Array, NDArray[np.bool_]]:
        moved, trying = proposal(*of)
        tries.append(np.count_nonzero(trying))
        return moved, trying

    with patch.object(packing, "TRIES_IN_SPACE", 60), patch.object(packing, "proposal", counted):
        spheres(0)
    assert 60 * NUMBER <= sum(tries) < 60 * NUMBER + max(tries)


@pytest.mark.slow
def test_random_is_the_hard_sphere_fluid() -> None:
    """Pairs near contact, against g = (1 - phi/2)/(1 - phi)^3 (Carnahan and Starling 1969).

    Within 2 % of the diameter g falls by some 8 %, and 600 pairs are counted: 15 % are four deviations. With
    25 tries of each sphere there are 2.2 times as many.
    """
    width, counted, expected = 0.02, 0, 0.0
    for seed in range(4):
        a = spheres(seed)
        counted += len(a.cell.near_pairs(a.centres, 2.0 * (1.0 + width)))
        shell = 32.0 * pi / 3.0 * ((1.0 + width) ** 3 - 1.0)
        contact = (1.0 - 0.5 * PHI) / (1.0 - PHI) ** 3
        expected += 0.5 * NUMBER * (NUMBER - 1) * shell / a.cell.volume * contact
    assert counted == pytest.approx(expected, rel=0.15)
