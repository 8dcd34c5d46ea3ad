from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import Gaps, find_gaps
from fsi.integration.gap_limiter import greatest_approach, limited_step, lost_in_rounding
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane
from tests.exact_model import plane_case

BOX = Box((-10.0, -10.0), (10.0, 10.0))
THREE = Configuration(
    np.array([[-4.0, 0.0], [0.0, 1.0], [5.0, -2.0]]), np.zeros(3), np.array([1.0, 2.0, 0.5])
)
displacements = st.lists(st.floats(-20.0, 20.0), min_size=9, max_size=9).map(
    lambda values: np.array(values).reshape(3, 3)
)


@given(displacement=displacements)
def test_no_gap_on_the_way_is_smaller_than_said(displacement: Array) -> None:
    """Sampled along the way: bodies that jump through each other are seen."""
    said = greatest_approach(THREE, BOX, displacement, 0.2)
    before = find_gaps(THREE, BOX, reach=np.inf)
    seen = -np.inf
    for part in np.linspace(0.0, 1.0, 41):
        after = find_gaps(THREE.moved(part * displacement), BOX, reach=np.inf)
        lost = [1.0 - after.wall_gaps / before.wall_gaps, 1.0 - after.pair_gaps / before.pair_gaps]
        seen = max(seen, *(float(loss.max()) for loss in lost))
    if max(seen, said.loss) > 0.2:
        assert seen <= said.loss + 1e-12
        # Between samples a gap of at least 1 changes by 2 |d| / 40 at most.
        assert said.loss <= seen + 2.0 * 30.0 / 40.0


@given(velocity=displacements, h=st.floats(1e-3, 10.0))
def test_the_limited_step_is_safe_and_not_timid(velocity: Array, h: float) -> None:
    limited, approach = limited_step(THREE, BOX, velocity, h, 0.2)
    assert approach.loss <= 0.2
    assert greatest_approach(THREE, BOX, limited * velocity, 0.2) == approach
    if limited < h:
        assert approach.loss >= 0.5 * 0.9 * 0.2


def test_a_step_towards_a_wall_loses_what_safety_says() -> None:
    """Nine tenths of the fifth that a gap may lose: stages differ a little from the velocity at the start."""
    velocity = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    limited, approach = limited_step(THREE, BOX, velocity, 100.0, 0.2)
    assert limited == pytest.approx(0.9 * 0.2 * 7.0, rel=1e-14)
    # The bodies are 0, 1, 2, the walls left, right, bottom, top follow.
    assert (approach.between, approach.gap) == ((1, 6), 7.0)


def test_names_the_pair_that_closes() -> None:
    velocity = np.array([[1.0, 0.25, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert limited_step(THREE, BOX, velocity, 1.0, 0.2)[1].between == (0, 1)


def test_a_fast_body_does_not_jump_through_another() -> None:
    """Far apart and far on the other side after the displacement, in contact on the way."""
    two = Configuration(np.array([[-300.0, 50.0], [300.0, 50.0]]), np.zeros(2), np.ones(2))
    displacement = np.array([[600.5, 1.5, 0.0], [0.0, 0.0, 0.0]])
    approach = greatest_approach(two, HalfPlane(1000.0), displacement, 0.2)
    assert approach.loss > 1.0
    assert approach.between == (0, 1)


def test_spinning_or_nothing_at_all_loses_nothing() -> None:
    spin = np.array([[0.0, 0.0, 5.0]] * 3)
    assert limited_step(THREE, BOX, spin, 10.0, 0.2)[0] == 10.0


SHEAR, EXTENSION = ((0.0, 1.0), (0.0, 0.0)), ((1.0, 0.0), (0.0, -1.0))


@pytest.mark.parametrize(
    ("image", "gradient", "strain", "left"),
    [
        ((-2.0, 2.5), SHEAR, 0.8, 0.5),
        ((-3.0, 3.0), SHEAR, 1.0, 1.0),
        ((0.0, 5.0), EXTENSION, 0.4, 5.0 * np.exp(-0.4) - 2.0),
    ],
    ids=["gap 1.2", "gap 2.24", "gap 3"],
)
def test_images_of_a_sheared_cell_come_nearer_though_bodies_rest(
    image: tuple[float, float],
    gradient: tuple[tuple[float, float], tuple[float, float]],
    strain: float,
    left: float,
) -> None:
    """Discs of radius 1 with their images, which shear puts above them and extension brings down."""
    cell = Cell(((9.0, 0.0), image), gradient)
    one, still = Configuration.unturned(np.array([[0.5, 0.5]]), np.ones(1)), np.zeros((1, 3))
    said = greatest_approach(one, cell, still, 0.5, strain)
    assert said.loss == pytest.approx(1.0 - left / (np.hypot(*image) - 2.0))
    assert said.between == (0, 0)
    assert greatest_approach(one, cell, still, 0.5, 0.0).loss <= 1e-14


def test_bodies_that_the_mean_flow_carries_are_sought_no_farther(monkeypatch: pytest.MonkeyPatch) -> None:
    """However far from the origin of the shear, and so however fast: what they need is one diameter."""
    reaches: list[float] = []

    def found(q: Configuration, container: Container, reach: float) -> Gaps:
        reaches.append(reach)
        return find_gaps(q, container, reach)

    monkeypatch.setattr("fsi.integration.gap_limiter.find_gaps", found)
    cell = Cell(((90.0, 0.0), (0.0, 90.0)), SHEAR)
    carried = Configuration.unturned(np.array([[0.0, 3.0], [0.0, 9e3]]), np.full(2, 10.0))
    displacement = np.array([[0.06, 0.0, 0.0], [180.0, 0.0, 0.0]])
    still = greatest_approach(carried, cell, displacement, 0.2, 0.02)
    assert reaches == [20.0]
    assert still.loss < 0.2


@pytest.mark.parametrize("periods", [0, 300])
def test_the_limited_step_is_that_of_any_images_in_an_extension(periods: int) -> None:
    """A gap 2.4 exp(-h) - 2 may lose a fifth of 0.4; straight ways far away lost it at once."""
    cell = Cell(((9.0, 0.0), (0.0, 5.0)), EXTENSION)
    places = np.array([[0.5, 0.3], [0.5, 2.7 + 5.0 * periods]])
    q = Configuration.unturned(places, np.ones(2))
    velocity = np.column_stack([cell.mean_velocity(places), np.zeros(2)])
    limited, approach = limited_step(q, cell, velocity, 1.0, 0.2)
    assert approach.loss == pytest.approx(1.0 - (2.4 * np.exp(-limited) - 2.0) / 0.4, rel=1e-9)
    assert 0.17 < approach.loss <= 0.2


def test_the_limited_step_of_shapes_is_that_of_any_images_in_an_extension() -> None:
    """On the way images far away were sought off the straight ways of their bodies: a third of the step."""
    cell = Cell(((6.0, 0.0), (0.0, 5.0)), EXTENSION)
    shape = {"shape": {"kind": "ellipse", "axes": [1.0, 0.5]}}
    bodies = [{"name": f"b{k}", "position": [x, 2.0]} | shape for k, x in enumerate((2.0, 6.0))]
    begun, own, steps = plane_case(bodies, 1.0).configuration(), np.array([[0.1, 0.05], [-0.2, 0.1]]), []
    for periods in (0.0, 30.0):
        places = np.array([[1.0, 1.0], [3.1 + 6.0 * periods, 1.6 - 5.0 * periods]])
        turned = np.column_stack([places - begun.centres, [0.3, -0.4]])
        velocity = np.column_stack([cell.mean_velocity(places) + own, [-0.2, 0.3]])
        steps.append(limited_step(begun.moved(turned), cell, velocity, 1.0, 0.2)[0])
    assert steps[1] == pytest.approx(steps[0], rel=1e-9)
    assert steps[0] < 1.0


@pytest.mark.parametrize(
    ("before", "after", "lost"), [(2, 2, True), (2, 1, True), (1, 2, False), (9, 4, False)]
)
def test_only_gaps_that_do_not_open_are_lost_in_rounding(before: int, after: int, lost: bool) -> None:
    """Of units of places in [2, 4), 4.4e-16; the limit is 1e3 eps (2 + 1), 1500 of them."""
    places = []
    for units in (before, after):
        gap = 500 * units * 2.0**-51
        places.append(Configuration.unturned(np.array([[0.0, 0.0], [2.0 + gap, 0.0]]), np.ones(2)))
    found = lost_in_rounding((places[0], BOX), (places[1], BOX))
    assert (found is not None) == lost
    if found is not None:
        assert (found.gap, found.between) == (500 * after * 2.0**-51, (0, 1))
