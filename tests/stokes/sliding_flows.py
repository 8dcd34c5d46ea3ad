"""Bodies in round containers, along which fluid slides, and flows whose identities hold."""

from __future__ import annotations

from typing import Any

import fsi
from fsi.stokes.adapt import Solved, solve_with_errors

COARSE = {"cells_per_circle": 24, "growth": 0.4}


def body(centre: Any = (0.0, 0.0), **given: Any) -> dict[str, Any]:
    return {"name": "body", "radius": 1.0, "position": centre, **given}


def in_ball(geometry: str, c: float, *bodies: Any, R: float = 3.0, **sizes: Any) -> fsi.Case:
    """Bodies in a round container with this slip length."""
    domain = {"shape": "round", "radius": R, "walls": {"far": {"slip_length": c}} if c else {}}
    return fsi.make_case(
        name="round", geometry=geometry, fluid={"viscosity": 0.7}, domain=domain, bodies=bodies,
        discretisation=sizes,
    )  # fmt: skip


def balanced(case: fsi.Case) -> Solved:
    """The solution; every identity holds to 1e-10, the power of friction and of swimming among them."""
    solved = solve_with_errors(case)
    assert max(solved.solution.checks.values()) < 1e-10
    return solved
