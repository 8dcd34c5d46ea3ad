"""The energy of bodies that coast, without drag and load: nothing but rounding changes it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Inertia
from fsi.errors import SolveError
from fsi.models import make_model, make_stepper
from fsi.reduced.distance_model import DistanceModel
from fsi.reduced.pairs import find_pairs
from fsi.reduced.system import SolvedSystem, require, solve_system
from tests.reduced_data import INERTIA, reduced_case

MASSES = np.array([[1.0, 1.0, 0.5], [1.0, 1.0, 0.5]])
U = np.array([[0.7, 0.1, 0.0], [-0.3, 0.0, 0.0]])
H = 0.03


def coasting(**more: Any) -> Any:
    """Two discs that come near to each other: 4 between them, 2 of which they have left at t = 2."""
    bodies = [
        {"name": f"b{k}", "radius": 1.0, "position": [x, 100.0], "initial_velocity": v[:2].tolist()} | INERTIA
        for k, (x, v) in enumerate(zip((-3.0, 3.0), U, strict=True))
    ]
    reduced = {"drag": 0.0, "cutoff": 0.5, "step": H, "scheme": "distance", "law": "leading"} | more
    return reduced_case(bodies, reduced, fluid={"viscosity": 0.01}, time={"end": 1.5})


@pytest.mark.parametrize("changes", [{}, {"law": "slides", "cutoff": None, "scheme": "backward-euler"}])
def test_bodies_coast_within_the_energy_inequality(changes: dict[str, Any]) -> None:
    """50 steps, at the velocities of the beginning where nothing is near."""
    case = coasting(**changes)
    stepper = make_stepper(case, make_model(case))
    state = stepper.start(case.configuration()).state
    while state.t < 1.5:
        state = stepper.advance(state).state
    if not changes:
        np.testing.assert_allclose(state.U, U, rtol=1e-14, atol=0.0)


def alone() -> SolvedSystem:
    """A step of the discs beyond each other's cutoff."""
    case = coasting()
    model = make_model(case)
    assert isinstance(model, DistanceModel)
    ambient, q = model.surroundings(case.configuration(), 0.0), case.configuration()
    pairs = find_pairs(q, ambient.enclosure, 0.5)
    return solve_system(ambient, pairs, np.empty(0), Inertia(MASSES / H, U))


def faster(by: float) -> tuple[SolvedSystem, Array]:
    """That step, with velocities which a mistake has made larger."""
    solved = alone()
    return replace(solved, U=(1.0 + by) * solved.U), U


@pytest.mark.parametrize("gained", [1e-6, 1e-9])
def test_energy_from_nowhere_stops_a_run(gained: float) -> None:
    """A part of the energy that is gained is a defect of half of it, over the energies before and after."""
    solved, before = faster(0.5 * gained)
    found = solved.energy(MASSES, before, H)
    assert found == pytest.approx(0.5 * gained, rel=1e-3)
    with pytest.raises(SolveError, match=f"energy is violated by {0.5 * gained:.1e}"):
        require({"energy": found}, H)
    require({"energy": alone().energy(MASSES, before, H)}, H)
