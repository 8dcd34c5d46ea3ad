"""The first instant of bodies with mass: at the velocities that the case gives them, at all levels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fsi.case.load import parse_case
from fsi.models import make_model, make_stepper
from tests.reduced_data import reduced_case


def box(model: str, **body: Any) -> Any:
    """A disc near a wall of a box, and one that is held and turns; bodies of little mass stop in 1e-3."""
    first = {"name": "a", "radius": 1.0, "position": [-1.1, -1.7], "force": [3.0, -1.0]} | body
    second = {"name": "b", "radius": 0.8, "position": [1.1, 0.9], "velocity": [0.0, 0.0]}
    return parse_case(
        {
            "name": "test", "model": model, "fluid": {"viscosity": 1.0}, "time": {"end": 1.0},
            "domain": {"lower": [-3.0, -3.0], "upper": [3.0, 3.0]},
            "bodies": [first, second | {"angular_velocity": 0.4}],
            "reduced": {"law": "exact", "drag": 2.0}, "pores": {"modes": 6},
            "discretisation": {"cells_per_circle": 16, "growth": 0.5},
        }
    )  # fmt: skip


@pytest.mark.parametrize("model", ["reduced", "pores", "resolved"])
def test_a_run_begins_as_if_bodies_were_held_at_their_initial_velocity(model: str) -> None:
    """So velocities are those to the bit, and loads and dissipation those of the flow which they make.

    With a mass of 1e-8 an implicit step of `time.smallest_step`, 1e-9, has lost most of them.
    """
    inertia = {"mass": 1e-8, "moment_of_inertia": 0.5e-8}
    case = box(model, **inertia, initial_velocity=[0.3, -0.2], initial_angular_velocity=0.1)
    held = box(model, force=[0.0, 0.0], velocity=[0.3, -0.2], angular_velocity=0.1)
    found = make_stepper(case, make_model(case)).start(case.configuration()).instant
    expected: Any = make_model(held)(held.configuration(), 0.0)
    np.testing.assert_array_equal(found.U, [[0.3, -0.2, 0.1], [0.0, 0.0, 0.4]])
    np.testing.assert_allclose(found.F, expected.F, rtol=1e-12, atol=1e-12 * np.abs(expected.F).max())
    assert found.record["dissipation"] == pytest.approx(expected.dissipation, rel=1e-12)


@pytest.mark.parametrize("smallest_step", [1e-12, 1e-9, 1e-4])
def test_the_first_row_of_discs_that_meet_is_exact(smallest_step: float) -> None:
    """kappa = 3/2 pi mu (a/D)^(3/2), by the leading term: F = V + 2 kappa V, and 2 V F is dissipated.

    An implicit step of 1e-9 had V = 0.9997 in place of 1, and 595722 in place of 596077.
    """
    bodies = [
        {"name": name, "radius": 1.0, "position": [x, 0.0], "initial_velocity": [V, 0.0], "mass": 1.0}
        | {"moment_of_inertia": 0.5}
        for name, x, V in (("a", 0.0, 1.0), ("b", 2.001, -1.0))
    ]
    time = {"end": 1.0, "smallest_step": smallest_step}
    reduced = {"law": "leading", "drag": 1.0}
    case = reduced_case(bodies, reduced, domain={"shape": "unbounded"}, time=time)
    found = make_stepper(case, make_model(case)).start(case.configuration()).instant
    F = 1.0 + 2.0 * 1.5 * np.pi * 1e-3**-1.5
    np.testing.assert_array_equal(found.U[:, 0], [1.0, -1.0])
    np.testing.assert_allclose(found.F[:, 0], [F, -F], rtol=1e-11)  # the gap 2.001 - 2 has 13 digits
    assert found.record["dissipation"] == pytest.approx(2.0 * F, rel=1e-11)
