"""Coulomb's friction where modes are held: along the slip, in space too, or nothing where none moves it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import fsi
from fsi.case.load import load_case
from tests.gluey.test_system import case_of

CASES = Path(__file__).parents[2] / "cases"
MU, H, INERTIA = 0.1, 0.01, 0.4


def test_a_ball_that_may_turn_about_one_axis_is_rubbed_against_its_slip(tmp_path: Path) -> None:
    """m = a = g = 1, v = (1, 1): p = -mu h slip / |slip| at the end, slip = (v_x - omega_y, v_y).

    Rows of their own scales gave an impulse along (1, 3.5), with all checks passed.
    """
    ball = {
        "position": [0.0, 0.0, 1.0], "radius": 1.0, "mass": 1.0, "moment_of_inertia": INERTIA,
        "initial_velocity": [1.0, 1.0, 0.0], "angular_velocity": [0.0, "free", 0.0],
    }  # fmt: skip
    case = case_of(
        ball,
        domain={"shape": "half-plane", "radius": 1000.0},
        forces=[{"kind": "gravity", "acceleration": [0.0, 0.0, -1.0]}],
        gluey={"gamma_min": 0.0, "friction": MU},
        time={"end": 2 * H, "step": H},
    )
    last = fsi.run(case, tmp_path / "run").bodies.iloc[-1]
    v, omega = np.array([1.0, 1.0]), 0.0
    for _ in range(2):
        p = np.zeros(2)
        for _ in range(50):  # the slip at the end depends on p by a hundredth
            slip = np.array([v[0] + p[0] - (omega - p[0] / INERTIA), v[1] + p[1]])
            p = -MU * H * slip / np.linalg.norm(slip)
        v, omega = v + p, omega - p[0] / INERTIA
    assert [last["V_x"], last["V_y"], last["omega_y"]] == pytest.approx([*v, omega], rel=1e-9)


def test_friction_does_nothing_where_all_slip_is_given(tmp_path: Path) -> None:
    """Discs that move along their line of centres alone: as without it. It divided by zero, for ever."""
    changes = ['model="gluey"', "gluey.gamma_min=-0.1", "time.end=1.0", "time.step=0.02"]
    rubbed, smooth = (
        fsi.run(load_case(CASES / "levels.toml", [*changes, f"gluey.friction={mu}"]), tmp_path / str(mu))
        for mu in (0.3, 0.0)
    )
    assert rubbed.steps["solid_contacts"].max() > 0
    for name in ("x", "V_x"):
        np.testing.assert_array_equal(rubbed.bodies[name], smooth.bodies[name])


def test_a_disc_that_is_drawn_along_a_floor_costs_no_search_for_its_friction(tmp_path: Path) -> None:
    """It slides at 1e-6 as given, whatever rubs it: of 30 discs such a one left friction unsettled."""
    disc = {
        "position": [0.0, 0.5], "mass": 1.0, "moment_of_inertia": INERTIA, "force": [0.0, -1.0],
        "velocity": [1e-6, "free"], "angular_velocity": 0.0,
    }  # fmt: skip
    floor = {"shape": "half-plane", "radius": 1000.0}
    run = fsi.run(case_of(disc, domain=floor, gluey={"gamma_min": 0.0, "friction": 0.3}), tmp_path / "run")
    assert run.steps["solid_contacts"].iloc[-1] == 1
    assert run.steps["iterations"].max() <= 20  # 260 where they go on to its bound
