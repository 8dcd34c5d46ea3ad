"""Walls that slide so well that everything between them moves along, or turns, almost freely."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fsi
from fsi.arrays import Array
from fsi.errors import SolveError
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

DISC = {"name": "disc", "radius": 1.0, "position": [0.3, 0.2], "force": [1.0, 0.0]}
LENGTH, RADIUS = 5.0, 3.0


def solved(domain: dict[str, Any], disc: dict[str, Any]) -> StokesSolution:
    """Every identity holds to 1e-9."""
    case = fsi.make_case(name="slippery", fluid={"viscosity": 1.0}, domain=domain, bodies=[disc])
    solution = StokesModel(case)(case.configuration(), 0.0)
    assert max(solution.checks.values()) < 1e-9
    return solution


def moved(domain: dict[str, Any]) -> Array:
    """(V, omega) of a free disc under the force 1."""
    velocity: Array = solved(domain, DISC).U[0]
    return velocity


def channel(b: float, **flow: float) -> dict[str, Any]:
    walls = {wall: {"slip_length": b} for wall in ("bottom", "top")}
    return {"lower": [0.0, -2.0], "upper": [LENGTH, 2.0], "periodic": ["x"], "walls": walls, **flow}


def test_a_disc_between_ever_better_sliding_walls_has_a_limit() -> None:
    """Friction mu / b changes V by A / b + O(1 / b^2), so that each decade changes it by a tenth of the last.

    Flows of size b cancel for the net flux: an error of 1e-7 in V would change the ratio by a third of it.
    """
    V = np.array([moved(channel(b, net_flux=0.0))[0] for b in (1e3, 1e4, 1e5)])
    assert_allclose(np.diff(V)[0] / np.diff(V)[1], 10.0, rtol=2e-3)


def test_what_friction_alone_holds_in_a_channel_slides() -> None:
    """All moves by V, and the walls' friction is the force: 2 L (mu / b) V = 1; the rest is 1.2e-5 of it."""
    assert_allclose(moved(channel(1e5))[0], 1e5 / (2.0 * LENGTH), rtol=2e-5)


def test_what_friction_alone_holds_in_a_round_container_turns() -> None:
    """By 2 pi R^3 (mu / b) omega = r x F; the rest is 1e-4 of it."""
    walls = {"far": {"slip_length": 1e4}}
    omega = moved({"shape": "round", "radius": RADIUS, "walls": walls})[2]
    assert_allclose(omega, -0.2 * 1e4 / (2.0 * np.pi * RADIUS**3), rtol=2e-4)


@pytest.mark.parametrize("flow", [{}, {"net_flux": 0.0}])
def test_where_rounding_outweighs_the_friction_the_slip_length_is_to_blame(flow: dict[str, float]) -> None:
    with pytest.raises(SolveError, match=r"nothing but the friction .* lower slip_length in domain\.walls"):
        moved(channel(1e9, **flow))


def test_a_held_disc_between_free_surfaces_has_a_force_without_mean_flow() -> None:
    """As it holds the fluid, friction need not: with 1e9 as with 1e6, to the 1e-6 that this leaves of it."""
    held = {key: value for key, value in DISC.items() if key != "force"} | {"velocity": [1.0, 0.0]}
    F = [solved(channel(b, net_flux=0.0), held).F[0, 0] for b in (1e6, 1e9)]
    assert_allclose(F[1], F[0], rtol=1e-6)
