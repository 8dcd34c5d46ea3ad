"""Which gap is the narrowest, and where it is."""

import numpy as np
import pytest

from fsi.bodies.configuration import Configuration
from fsi.bodies.surface_gap import narrowest_gap
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import Round
from fsi.meshes.geometry.tube import Tube
from fsi.meshes.geometry.unbounded import Unbounded


def test_two_discs_far_apart_are_narrower_than_to_the_walls() -> None:
    """4 apart in a box whose walls are 16 away."""
    q = Configuration.unturned(np.array([[-3.0, 0.0], [3.0, 0.0]]), np.ones(2))
    found = narrowest_gap(q, Box((-20.0, -20.0), (20.0, 20.0)))
    assert found is not None
    assert (found.width, found.sides) == (4.0, (0, 1))
    np.testing.assert_array_equal(found.middle, [0.0, 0.0])
    np.testing.assert_array_equal(found.opposite, [2.0, 0.0])  # on the second disc


def test_the_point_opposite_lies_on_the_wall() -> None:
    """0.5 below a disc at height 1.5."""
    q = Configuration.unturned(np.array([[3.0, 1.5]]), np.ones(1))
    found = narrowest_gap(q, Box((0.0, 0.0), (20.0, 20.0)))
    assert found is not None
    np.testing.assert_allclose([*found.middle, *found.opposite], [3.0, 0.25, 3.0, 0.0], atol=1e-15)


@pytest.mark.parametrize(
    ("container", "towards"),
    [
        (Round(1.5), [1.0, 0.0]),
        (Round(1.5, axisymmetric=True), [0.0, 1.0]),
        (Round(1.5, dimension=3), [1.0, 0.0, 0.0]),
        (Tube(1.5, 8.0), [1.0, 0.0, 0.0]),
    ],
    ids=["round", "with an axis", "ball", "tube"],
)
def test_in_the_middle_of_a_round_wall_one_of_its_gaps_is_told(
    container: Container, towards: list[float]
) -> None:
    """They are as wide all around; with an axis the one on it."""
    q = Configuration.unturned(np.zeros((1, container.dimension)), np.ones(1))
    found = narrowest_gap(q, container)
    assert found is not None
    assert found.width == 0.5
    np.testing.assert_array_equal(found.normal, towards)
    np.testing.assert_array_equal(found.opposite, 1.5 * np.array(towards))


def test_a_lone_body_without_walls_has_no_gap() -> None:
    q = Configuration.unturned(np.zeros((1, 2)), np.ones(1))
    assert narrowest_gap(q, Unbounded()) is None


def test_without_bodies_there_is_no_gap() -> None:
    """Also in a channel, whose images would be looked for ever farther away."""
    q = Configuration.unturned(np.zeros((0, 2)), np.zeros(0))
    assert narrowest_gap(q, Box((0.0, 0.0), (4.0, 4.0), periodic=("x",))) is None
