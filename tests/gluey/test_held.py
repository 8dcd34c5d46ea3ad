"""Gaps that what is held closes: one line says so; what is held and opens gaps, or stands still, runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fsi
from fsi.errors import SolveError
from tests.gluey.test_system import case_of

HELD = {"angular_velocity": 0.0, "velocity": [0.0, 0.0]}
COMES = HELD | {"velocity": [1.0, 0.0]}
GAP = "a gap between bodies or walls that are all held is closed by their motion"
ROOM = "a body has no room left between others or walls that are held"
VARIANTS = [
    {"variant": "shifted"},
    {"variant": "cone"},
    {"variant": "film", "eps": 0.01, "reference_gap": 0.05},
]


def beside(x: float, **body: Any) -> dict[str, Any]:
    """A disc of radius 1/2 at (x, 0)."""
    return {"position": [x, 0.0]} | body


@pytest.mark.parametrize("gluey", VARIANTS)
@pytest.mark.parametrize(
    ("others", "cause"),
    [
        ([beside(1.25, **HELD)], GAP),  # a gap of 0.25
        ([beside(1.05), beside(2.25, **HELD)], ROOM),  # of 0.05 and 0.2, and what is free has nowhere to go
    ],
)
def test_the_line_says_what_held_bodies_close(
    others: list[dict[str, Any]], cause: str, gluey: dict[str, Any], tmp_path: Path
) -> None:
    """At the speed 1 they have come 0.25 near after 0.25: the third step, to 0.3, is the one that fails."""
    case = case_of(beside(0.0, **COMES), *others, gluey=gluey)
    with pytest.raises(SolveError, match=f"^{cause} in the step to t = 0.3; change how they move$"):
        fsi.run(case, tmp_path / "run")


def test_the_line_names_held_bodies_that_run_into_a_wall(tmp_path: Path) -> None:
    """A gap of 0.25 to a plane, along y, at the speed 1."""
    walls = [{"name": "floor", "point": [0.0, -0.75], "normal": [0.0, 2.0]}]
    case = case_of(beside(0.0, **(HELD | {"velocity": [0.0, -1.0]})), gluey={"walls": walls})
    with pytest.raises(SolveError, match=f"^{GAP} in the step to t = 0.3"):
        fsi.run(case, tmp_path / "run")


@pytest.mark.parametrize("gluey", VARIANTS)
def test_held_bodies_that_keep_or_open_their_gap_leave_others_alone(
    gluey: dict[str, Any], tmp_path: Path
) -> None:
    """One pair at rest 0.02 apart, one that parts; a free disc comes to rest against the first one."""
    case = case_of(
        beside(0.0, **HELD), beside(1.02, **HELD), beside(-5.0, **HELD), beside(-3.98, **COMES),
        beside(2.22, initial_velocity=[-1.0, 0.0]), gluey=gluey,
    )  # fmt: skip
    bodies = fsi.run(case, tmp_path / "run").bodies
    at_end = bodies[bodies["step"] == bodies["step"].max()]
    np.testing.assert_allclose(at_end["x"][:4], [0.0, 1.02, -5.0, -2.98], atol=1e-12)
    # Films begin at a gap of 0.05 and let it fall below that, by and by.
    assert 2.02 - 1e-9 < at_end["x"].iloc[4] < (2.07 if gluey["variant"] == "film" else 2.02 + 1e-9)
