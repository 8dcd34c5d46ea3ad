"""What a gluey run writes of its contacts: where their lines end, and which impulses its table has."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fsi
from fsi.arrays import Array
from tests.gluey.test_system import case_of

FILM = {"variant": "film", "eps": 1.0, "reference_gap": 1.0}
FLOOR = [{"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0]}]
PERIODIC = {"lower": [-5.0, -5.0], "upper": [5.0, 5.0], "periodic": ["x"]}


def pushed(x: float, force: float) -> dict[str, Any]:
    """A disc at x, pushed and moving along x by `force`, and up or down."""
    moves = {"force": [force, 0.0], "initial_velocity": [force, 0.8 * force]}
    return {"mass": 1.0, "position": [x, 0.0]} | moves


def lines_after_a_step(case: Any, folder: Path) -> tuple[Array, Array]:
    """The ends (2, 2) of the only contact, and the bodies' centres (N, 2)."""
    run = fsi.run(case, folder)
    return np.asarray(run.mesh(1, "contacts").points)[:, :2], np.asarray(run.mesh(1, "bodies").points)[:, :2]


@pytest.mark.parametrize("more", [{}, {"gluey": FILM}], ids=["limit", "film"])
def test_lines_of_contacts_end_at_the_centres(more: dict[str, Any], tmp_path: Path) -> None:
    """Two discs pushed together that pass each other, so that their normal turns, and with a gap of 0.3.

    By normals at the beginning of the step and radii alone they ended 0.16 and 0.27 from there.
    """
    apart = 0.65 if more else 0.5
    case = case_of(pushed(-apart, 1.0), pushed(apart, -1.0), time={"end": 0.1, "step": 0.1}, **more)
    ends, centres = lines_after_a_step(case, tmp_path / "run")
    assert_allclose(ends, centres[::-1], rtol=0.0, atol=0.0)


def test_lines_of_contacts_end_at_the_nearest_image(tmp_path: Path) -> None:
    """Discs at -4.5 and 4.5 touch across the period 10."""
    bodies = pushed(4.5, 1.0), pushed(-4.5, -1.0)
    case = case_of(*bodies, domain=PERIODIC, time={"end": 0.1, "step": 0.1})
    ends, centres = lines_after_a_step(case, tmp_path / "run")
    assert_allclose(ends, [centres[1], centres[0] - [10.0, 0.0]], atol=1e-14)


def test_lines_of_contacts_end_at_the_foot_on_a_wall(tmp_path: Path) -> None:
    """A disc of radius 1/2 in a film 0.3 above a floor, y = 0, along which it moves."""
    body = {"mass": 1.0, "position": [0.0, 0.8], "force": [0.0, -1.0], "initial_velocity": [2.0, 0.0]}
    case = case_of(body, gluey=FILM | {"walls": FLOOR}, time={"end": 0.1, "step": 0.1})
    ends, centres = lines_after_a_step(case, tmp_path / "run")
    assert_allclose(ends, [centres[0], [centres[0, 0], 0.0]], atol=1e-15)
    assert centres[0, 0] > 0.1


@pytest.mark.parametrize("variant", ["shifted", "cone"])
def test_the_table_of_contacts_has_the_whole_impulse(variant: str, tmp_path: Path) -> None:
    """A disc of mass 3 is pushed onto a floor by 2 until t = 1.5, then off it: 3 V is what all gave.

    Impulses of the cone are net; else a memory is restored in the step after it, and so taken off. The step
    that releases a cone pulls by what was stored, and has no memory after it.
    """
    push = {"times": [0.0, 1.5, 1.5], "values": [-2.0, -2.0, 2.0]}
    body = {"mass": 3.0, "position": [0.0, 1.0], "force": [0.0, push]}
    law = {"variant": variant, "gamma_min": -1.0, "walls": FLOOR}
    run = fsi.run(case_of(body, gluey=law, time={"end": 4.0, "step": 0.13}), tmp_path / "run")
    table, end = run.table("contacts"), run.bodies["V_y"].to_numpy(dtype=float)[-1]
    columns = ("impulse", "solid_impulse", "gamma")
    impulse, solid, gamma = (table[name].to_numpy(dtype=float) for name in columns)
    assert solid.max() > 0.1
    net = impulse.sum() + (0.0 if variant == "cone" else gamma.sum())
    assert 3.0 * end == pytest.approx(-2.0 * 1.5 + 2.0 * 2.5 + net, rel=1e-12)
    if variant == "shifted":
        assert_allclose(impulse, solid - gamma, atol=1e-12)
    else:
        assert gamma[-1] == 0.0
        assert impulse[-1] < -0.1
