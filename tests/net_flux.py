"""What is told of the pressure gradient of a channel whose net flux is given."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

import fsi


def require_told(solution: fsi.Solution, gradient: float, rel: float, to_json: Callable[..., Any]) -> None:
    """That it is this one, in Python, in a row of steps.csv and in JSON, with its bar."""
    assert solution.errors is not None
    assert solution.dp_dx == pytest.approx(gradient, rel=rel)
    assert solution.instant.record["pressure_gradient"] == solution.dp_dx
    data = json.loads(json.dumps(to_json(solution.case, solution.instant, solution.errors, None)))
    assert data["pressure_gradient"] == solution.dp_dx
    assert data["pressure_gradient_error"] == solution.errors.dp_dx
