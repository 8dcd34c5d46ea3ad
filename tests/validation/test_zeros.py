"""References that are zero: their errors are relative to the largest load or velocity of the case."""

from __future__ import annotations

from math import inf, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.case.sections import Expected
from fsi.errors import InputError
from fsi.integration.errors import ErrorEstimate
from fsi.validation.resolved import largest_of_kind, rows_at
from fsi.validation.rows import EXACT_DIGITS, Row, reference, sphere_records

MU, A, HEIGHT, RATE = 2.0, 0.2, 0.25, -3.0


def turning(mu: float = MU, **more: Any) -> Case:
    """A disc that turns beside a plane."""
    body = {
        "name": "d",
        "radius": A,
        "position": [0.0, HEIGHT],
        "velocity": [0.0, 0.0],
        "angular_velocity": RATE,
    }
    data = {"name": "a disc", "fluid": {"viscosity": mu}, "domain": {"shape": "half-plane", "radius": 1e4}}
    return parse_case(data | {"bodies": [body]} | more)


def expected(quantity: str, **more: Any) -> dict[str, Any]:
    return {"quantity": quantity, "value": 0.0, "rtol": 1e-3, "source": "Jeffery 1922"} | more


def test_a_force_that_is_zero_is_so_beside_the_torque_in_all_units(tmp_path: Path) -> None:
    """Jeffery: a disc that turns feels no force, and the torque -4 pi mu a^2 omega h / sqrt(h^2 - a^2).

    Over 1 in the units of the case, in place of torque / a = 25 and 0.25, the errors were 100 times as large
    in the first of two fluids as in the second.
    """
    coarse = {"degree": 3, "cells_per_circle": 8, "growth": 1.0}
    found = []
    for mu in (MU, 0.01 * MU):
        case = turning(mu, discretisation=coarse, expected=[expected("d.force.x")])
        found += rows_at("disc", None, case, tmp_path)
        torque = 4.0 * pi * mu * A**2 * abs(RATE) * HEIGHT / (HEIGHT**2 - A**2) ** 0.5
        assert found[-1].scale == pytest.approx(torque / A, rel=1e-3)
        assert found[-1].true_error == abs(found[-1].value) / found[-1].scale
    assert 1e-9 < found[0].true_error < found[0].rtol
    for part in ("true_error", "mesh_error", "truncation"):
        assert getattr(found[1], part) == pytest.approx(getattr(found[0], part), rel=1e-3), part


def test_what_is_largest_is_in_the_unit_of_the_quantity() -> None:
    """Torques count over the radius of the body, rotations times it."""
    loads = ErrorEstimate(np.array([[0.0, 0.0, RATE]]), np.array([[0.0, 1.0, 7.0]]))
    largest = {"force.x": 7.0 / A, "torque": 7.0, "velocity.y": 3.0 * A, "angular_velocity": 3.0}
    for quantity, value in largest.items():
        assert largest_of_kind(turning(), loads, f"d.{quantity}") == pytest.approx(value, rel=1e-12), quantity
    assert np.isnan(largest_of_kind(turning(), loads, "dissipation"))


def test_what_rounding_leaves_of_a_pressure_is_zero() -> None:
    """A pressure of 1e6 on the circle of radius 0.2 pulls by 1e6 2 pi a; 1e-13 of it is no load."""
    walls = {"left": {"pressure": 1e6}, "right": {"pressure": 1e6}}
    domain = {"lower": [-2.0, -2.0], "upper": [2.0, 2.0], "walls": walls}
    body = {"name": "d", "radius": A, "position": [0.0, 0.0], "velocity": [0.0, 0.0], "angular_velocity": 0.0}
    case, left = turning(domain=domain, bodies=[body]), 1e-13 * 1e6 * 2.0 * pi * A
    rest = np.zeros((1, 3))
    assert largest_of_kind(case, ErrorEstimate(rest, np.array([[left, 0.0, 0.0]])), "d.force.x") == inf
    assert largest_of_kind(case, ErrorEstimate(rest, np.array([[1.0, 0.0, 0.0]])), "d.force.x") == 1.0


def test_a_zero_is_known_to_all_digits() -> None:
    """It was known to 0.05, half a unit of the last digit of 0.0, and nothing was said of its error bar."""
    assert reference(turning(), Expected(**expected("d.force.x"))) == (0.0, EXACT_DIGITS)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (expected("dissipation"), r'^value = 0\.0: the tolerance of "dissipation" is relative to it; give'),
        (
            expected("time at gap 0.25", value=None, exact="disc_settling"),
            r'^exact = "disc_settling": is 0 here: the tolerance of "time at gap 0\.25" is .* is not 0, or',
        ),
    ],
)
def test_a_zero_without_others_of_its_kind_is_refused(row: dict[str, Any], words: str) -> None:
    """The disc is at the gap 0.25 when it begins to settle."""
    body = {"name": "d", "radius": 0.5, "position": [0.0, 0.75], "force": [0.0, -1.0]}
    with pytest.raises(InputError, match=words):
        reference(turning(bodies=[body]), Expected(**row))


def test_a_sphere_at_rest_is_compared_with_no_terms() -> None:
    """Its force over the exact one, 0, was a traceback when all else had been solved."""
    row = Row(
        "rest", None, 0.1, "s.force.z", 0.0, 0.0, 0.0, 0.0, 1e-13, 1e-3, "sphere_wall_normal", "by hand"
    )
    assert sphere_records([row]) == []
