"""A free disc that nearly touches the round wall around it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import fsi
from fsi.case.load import parse_case


def solved(radius: float, gap: float, **sections: Any) -> fsi.Solution:
    body = {"name": "d", "radius": 1.0, "position": [radius - 1.0 - gap, 0.0]}
    data = {"name": "x", "fluid": {"viscosity": 1.0}, "domain": {"shape": "round", "radius": radius}}
    return fsi.solve(parse_case(data | {"bodies": [body | {"force": [1.0, -0.5], "torque": 0.3}]} | sections))


@pytest.mark.parametrize("radius", [1.25, 1.3])
def test_bars_of_laws_hold_where_there_is_little_room(radius: float) -> None:
    """With half the gap below which laws act alone the velocity along the wall was 4.2 bars off at 1.3."""
    found, resolved = solved(radius, 1e-3, lubrication={"below": 0.1}), solved(radius, 1e-3)
    assert found.errors is not None
    ratio = (np.abs(found.instant.U - resolved.instant.U) / found.errors.U).max()
    assert 0.5 < ratio < 1.0


@pytest.mark.parametrize(("radius", "gap"), [pytest.param(3.0, 1e-5, marks=pytest.mark.slow), (1.05, 1e-3)])
def test_the_form_with_multipliers_has_room_for_its_pivots(radius: float, gap: float) -> None:
    """It was refused for want of memory. Both forms are the same discrete flow."""
    found = solved(radius, gap, discretisation={"formulation": "multiplier"})
    other = solved(radius, gap)
    np.testing.assert_allclose(found.instant.U, other.instant.U, rtol=1e-9)
