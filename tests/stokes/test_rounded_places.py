"""Lengths have 15 digits where flows are solved: narrow gaps are known to that, and bars tell so."""

from __future__ import annotations

import numpy as np
import pytest

import fsi
from fsi.case.load import parse_case
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.resistance import resistance_with_error

Y, NEAR = 1.000000010000004, 1.00000001  # sixteen digits, and nine


def disc_at(y: float) -> fsi.Case:
    body = {"name": "disc", "radius": 1.0, "position": [0.0, y], "velocity": [0.0, -1.0]}
    data = {"name": "x", "fluid": {"viscosity": 1.0}, "domain": {"shape": "half-plane", "radius": 500.0}}
    return parse_case(data | {"bodies": [body | {"angular_velocity": 0.0}]})


def test_a_force_is_known_to_the_digits_of_a_gap() -> None:
    """The gap to the power -3/2: both gaps are solved as 1e-8, and the force was ten bars off."""
    found, other = fsi.solve(disc_at(Y)), fsi.solve(disc_at(NEAR))
    assert found.errors is not None
    force, bar = found.instant.F[0, 1], found.errors.F[0, 1]
    expected = other.instant.F[0, 1] * ((NEAR - 1.0) / (Y - 1.0)) ** 1.5
    eps = float(np.finfo(float).eps)
    assert 5.0 * 2.5 * eps * 1e8 * abs(force) < abs(force - expected) < bar
    assert bar < 3.0 * abs(force - expected)


def test_an_entry_of_the_resistance_is_known_to_them_too() -> None:
    found, other = (resistance_with_error(disc_at(y)) for y in (Y, NEAR))
    expected = other.resistance.R[1, 1] * ((NEAR - 1.0) / (Y - 1.0)) ** 1.5
    off = abs(found.resistance.R[1, 1] - expected)
    assert 1e-7 * expected < off < found.errors.R[1, 1] < 3.0 * off


@pytest.mark.parametrize("y", [1.1, NEAR])
def test_decimals_are_kept(y: float) -> None:
    case = disc_at(y)
    assert CaseMeshes(case).rounded(case.configuration(), 0.0) == 0.0
