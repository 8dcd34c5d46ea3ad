"""What bounds the fluid, read off containers."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.meshes.geometry.unbounded import Unbounded
from fsi.pores.surfaces import CONTAINER, DISC, WALL, surfaces_of

Q = Configuration.unturned(np.array([[1.0, 2.0]]), np.array([0.5]))


def test_walls_of_a_box_stand_where_they_are() -> None:
    surfaces = surfaces_of(Q, Box((-1.0, 0.0), (3.0, 5.0)))
    assert surfaces.kind.tolist() == [DISC, WALL, WALL, WALL, WALL]
    # left, right, bottom, top: n.x of a point on each.
    assert surfaces.normal[1:].tolist() == [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
    assert (surfaces.normal * surfaces.centre).sum(axis=1)[1:].tolist() == [-1.0, -3.0, 0.0, -5.0]
    assert len(surfaces.periods) == 0


def test_a_channel_has_two_walls_and_a_cell_none() -> None:
    channel = surfaces_of(Q, Box((0.0, 0.0), (4.0, 5.0), periodic=("x",)))
    assert (channel.bounds, channel.periods.tolist()) == (2, [[4.0, 0.0]])
    cell = surfaces_of(Q, Cell(((4.0, 0.0), (0.0, 5.0)), ((0.0, 0.0), (0.0, 0.0))))
    assert (cell.bounds, cell.periods.shape) == (0, (2, 2))


def test_sides_are_bodies_followed_by_walls_and_circles_of_fluid_have_none() -> None:
    surfaces = surfaces_of(Q, Box((0.0, 0.0), (4.0, 5.0), periodic=("x",)))
    more = surfaces.with_fluid(np.array([[3.0, 4.0]]), np.array([0.2]))
    assert [more.side(k) for k in range(4)] == [0, -1, 1, 2]


def test_a_round_container_is_one_circle() -> None:
    surfaces = surfaces_of(Q, Round(7.0))
    assert (surfaces.kind.tolist(), surfaces.radius.tolist()) == ([DISC, CONTAINER], [0.5, 7.0])


@pytest.mark.parametrize("container", [HalfPlane(50.0), Unbounded(), Round(9.0, axisymmetric=True)])
def test_other_containers_are_refused(container: Container) -> None:
    with pytest.raises(InputError, match=type(container).__name__ + r"|planar"):
        surfaces_of(Q, container)
