"""Steps that carry bodies past each other: refused where what never meets is pushed, kept where it meets."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import fsi
from fsi.arrays import Array, Indices
from fsi.case.case import Case
from fsi.errors import SolveError
from fsi.gluey.contacts import Contacts, Room, find_contacts
from fsi.gluey.passing import nearest
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.lattice import Lattice
from tests.gluey.test_system import case_of

# Radii 1/2, centres 2.6 apart across the way: the true gap is 1.6 or more. Apart by 3 along it, the normal is
# (3, 2.6) / 3.97, and the linear gap of 2.97 closes after a way of 3.93.
REST, ACROSS, CLOSED_BY = [3.0, 2.6], 1.6, 3.93
VARIANTS = [
    {"variant": "shifted"},
    {"variant": "cone"},
    {"variant": "film", "eps": 0.01, "reference_gap": 0.05},
]


def passing(speed: float, way: float, **more: Any) -> Case:
    """A held disc that goes a way along x in each step past one at rest, which is free."""
    held = {"position": [0.0, 0.0], "velocity": [speed, 0.0], "angular_velocity": 0.0}
    step = way / speed
    return case_of(held, {"position": REST}, time={"end": 2.0 * step, "step": step}, **more)


@pytest.mark.parametrize("gluey", VARIANTS)
def test_a_step_that_pushes_what_is_never_met_is_refused(gluey: dict[str, Any], tmp_path: Path) -> None:
    """The second disc got a speed near that of the first one, across a gap of 1.6; nothing told."""
    with pytest.raises(
        SolveError, match=r"^bodies that come no nearer to .* than 1\.\d+ .*; lower time\.step$"
    ):
        fsi.run(passing(1e3, 1.05 * CLOSED_BY, gluey=gluey), tmp_path / "run")
    kept = fsi.open_run(tmp_path / "run")
    assert kept.end == 0.0
    assert_allclose(kept.bodies[kept.bodies["body"] == "b1"][["x", "y"]], [REST])


@pytest.mark.parametrize("gluey", VARIANTS)
@pytest.mark.parametrize("way", [0.1, 0.5])
def test_shorter_steps_leave_it_at_rest(way: float, gluey: dict[str, Any], tmp_path: Path) -> None:
    """By a way of 0.5, half a diameter, the linear gap never closes: the normal has turned before."""
    case = passing(1e3, way, gluey=gluey)
    whole = case.model_copy(update={"time": case.timing.model_copy(update={"end": 8e-3})})
    bodies = fsi.run(whole, tmp_path / "run").bodies
    ends = bodies[bodies["step"] == bodies["step"].max()]
    assert_allclose(ends["x"], [8.0, REST[0]], rtol=1e-12)
    assert_allclose(ends[ends["body"] == "b1"][["V_x", "V_y"]], [[0.0, 0.0]])


def test_a_long_step_that_meets_head_on_is_kept(tmp_path: Path) -> None:
    """In one step 4 diameters long: a gap of 2 closes, and the free disc is pushed 2 along."""
    held = {"position": [0.0, 0.0], "velocity": [1e3, 0.0], "angular_velocity": 0.0}
    case = case_of(held, {"position": [3.0, 0.0]}, time={"end": 4e-3, "step": 4e-3})
    assert_allclose(fsi.run(case, tmp_path / "run").bodies["x"].iloc[-2:], [4.0, 5.0], rtol=1e-9)


@pytest.mark.parametrize(
    ("way", "gap"),
    [
        ((3.0, 0.0), 2.0),  # it passes at (0, 3), half way
        ((0.0, -1.0), np.hypot(1.5, 2.0) - 1.0),  # at the end
        ((-1.0, 1.0), np.hypot(1.5, 3.0) - 1.0),  # parts: at the start
        ((0.0, 0.0), np.hypot(1.5, 3.0) - 1.0),
    ],
)
def test_the_nearest_of_a_straight_way(way: tuple[float, float], gap: float) -> None:
    """Of a disc of radius 0.4 at (-1.5, 3) past one of 0.6 at the origin, by hand."""
    distance = np.hypot(1.5, 3.0)
    normal = np.array([[-1.5, 3.0]]) / distance
    pair = Contacts(np.array([0]), np.array([1]), normal, np.array([distance - 1.0]), np.array([1]))
    assert_allclose(nearest(pair, np.array([0.6, 0.4]), np.array([[0.0, 0.0], way])), [gap], rtol=1e-14)


@pytest.mark.parametrize(("speed", "refused"), [(9.9, False), (10.1, True), (20.0, True)])
def test_a_step_of_half_a_period_may_pass_an_image(speed: float, refused: bool, tmp_path: Path) -> None:
    """Of 20, in steps of 1: a held disc 8 apart, by a whole period, passed through the other unnoticed."""
    held = {"position": [-4.0, 0.0], "velocity": [-speed, 0.0], "angular_velocity": 0.0}
    domain = {"lower": [-10.0, -10.0], "upper": [10.0, 10.0], "periodic": ["x"]}
    case = case_of(held, {"position": [4.0, 0.0]}, domain=domain, time={"end": 1.0, "step": 1.0})
    if not refused:
        assert fsi.run(case, tmp_path / "run").end == 1.0
        return
    with pytest.raises(SolveError, match=r"^bodies go .* periods past each other .*; lower time\.step$"):
        fsi.run(case, tmp_path / "run")


def test_images_are_not_sought_beyond_the_room(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of each pair the nearest image counts, within a diagonal: a reach of 1e7 periods took hours."""
    sought, images = [], Lattice.images

    def spied(lattice: Lattice, x: Array, distance: float) -> tuple[NDArray[np.intp], Indices]:
        sought.append(distance)
        return images(lattice, x, distance)

    monkeypatch.setattr(Lattice, "images", spied)
    room = Room(np.empty((0, 2)), np.empty((0, 2)), Box((0.0, 0.0), (5.0, 4.0), periodic=("x", "y")))
    found = find_contacts(np.array([[1.0, 1.0], [3.0, 2.5]]), np.full(2, 0.2), room, 1e3)
    assert_allclose(found.D, [2.5 - 0.4], rtol=1e-14)  # (2, 1.5), not across an end
    assert sought == [pytest.approx(np.hypot(5.0, 4.0) + 0.4)]
