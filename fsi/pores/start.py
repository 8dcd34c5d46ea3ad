"""The first pores, between as few discs as a container can have, and the order in which the others come."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.geometry.lattice import reduced
from fsi.pores.links import OPEN, Links
from fsi.pores.surfaces import CONTAINER, DISC, Bodies, BoundingSurfaces, NoPoresError

_HALF_TURN = 0.95 * np.pi  # angle between neighbours around the centre of a container
_IN_THE_MIDDLE = 1e-6  # over the radius of a container: a disc that near to its centre lies in no direction


def first_pores(surfaces: BoundingSurfaces, order: Bodies) -> tuple[Links, Bodies]:
    """The first pores, with room for all, and the discs that are still to come, of those in this order.

    Raises NoPoresError where the discs of a round container do not surround its centre.
    """
    bounds = np.flatnonzero(surfaces.kind != DISC)
    if np.any(surfaces.kind == CONTAINER):
        around = surrounding(surfaces, order)
        if around is None:
            raise NoPoresError("the discs do not surround the centre of the container")
        first = around
        body, image, twin = _in_container(first, int(bounds[0]))
    elif len(bounds) == 0:
        first = order[:1]
        body, image, twin = _in_cell(int(first[0]), surfaces.periods)
    elif len(surfaces.periods):
        first = order[:1]
        body, image, twin = _in_channel(int(first[0]), bounds, surfaces)
    else:
        first = order[:1]
        angles = np.arctan2(surfaces.normal[bounds, 1], surfaces.normal[bounds, 0])
        body, image, twin = _in_box(int(first[0]), bounds[np.argsort(angles)])
    room = len(body) + 2 * (len(order) - len(first))
    links = Links(
        np.zeros((room, 3), np.int64), np.zeros((room, 3, 2), np.int64), np.zeros(3 * room, np.int64)
    )
    links.body[: len(body)], links.image[: len(body)], links.twin[: 3 * len(body)] = (
        body,
        image,
        np.ravel(twin),
    )
    return links, order[~np.isin(order, first)]


type First = tuple[list[list[int]], list[list[tuple[int, int]]], list[list[int]]]


def _in_cell(disc: int, periods: Array) -> First:
    """Two triangles of a disc and its images, by the shortest periods i and j, at 90 degrees or more."""
    i, j = reduced(periods)
    if i @ j > 0.0:
        j = -j
    if i[0] * j[1] - i[1] * j[0] < 0.0:
        i, j = j, i
    m, n = np.rint(np.array([i, j]) @ np.linalg.inv(periods)).astype(int)
    origin, one, other, both = (0, 0), (m[0], m[1]), (n[0], n[1]), (m[0] + n[0], m[1] + n[1])
    return [[disc] * 3] * 2, [[origin, one, both], [origin, both, other]], [[4, 5, 3], [2, 0, 1]]


def _in_channel(disc: int, walls: Bodies, surfaces: BoundingSurfaces) -> First:
    """Two pores between a disc, its image and a wall."""
    (e,), body, image = surfaces.periods, [], []
    for wall in walls:
        n = surfaces.normal[wall]
        forwards = n[0] * e[1] - n[1] * e[0] > 0.0
        body.append([disc, disc, int(wall)])
        image.append([(0, 0), (1, 0), (0, 0)] if forwards else [(1, 0), (0, 0), (0, 0)])
    return body, image, [[1, 0, 5], [4, 3, 2]]


def _in_box(disc: int, walls: Bodies) -> First:
    """Four pores in the corners; walls anticlockwise."""
    n = len(walls)
    body = [[disc, int(walls[k]), int(walls[(k + 1) % n])] for k in range(n)]
    twin = [[OPEN, 3 * ((k + 1) % n) + 2, 3 * ((k - 1) % n) + 1] for k in range(n)]
    return body, [[(0, 0)] * 3] * n, twin


def _in_container(discs: Bodies, container: int) -> First:
    """A triangle of discs, anticlockwise, and three pores between it and the container."""
    a, b, c = (int(disc) for disc in discs)
    body = [[a, b, c], [b, a, container], [c, b, container], [a, c, container]]
    return body, [[(0, 0)] * 3] * 4, [[8, 11, 5], [10, 6, 2], [4, 9, 0], [7, 3, 1]]


def surrounding(surfaces: BoundingSurfaces, order: Bodies) -> Bodies | None:
    """Three discs around the centre of the container, anticlockwise, of those in this order, or None."""
    angle, length, beside = _places_around(surfaces, order)
    for first in np.argsort(-length, kind="stable"):
        behind = np.where(beside, np.mod(angle - angle[first], 2.0 * np.pi), np.nan)
        seconds = np.where(behind < _HALF_TURN, behind, -np.inf)
        thirds = np.where(behind > 2.0 * np.pi - _HALF_TURN, behind, np.inf)
        second, third = int(np.argmax(seconds)), int(np.argmin(thirds))
        if beside[first] and thirds[third] - seconds[second] < _HALF_TURN:
            return order[[first, second, third]]
    return None


def _places_around(surfaces: BoundingSurfaces, order: Bodies) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Angles and distances of discs around the centre of a container, and whether they are beside it."""
    container = surfaces.kind == CONTAINER
    e = surfaces.centre[order] - surfaces.centre[container]
    length = np.hypot(e[:, 0], e[:, 1])
    return np.arctan2(e[:, 1], e[:, 0]), length, length > _IN_THE_MIDDLE * surfaces.radius[container]


def widest_view(surfaces: BoundingSurfaces) -> float:
    """The middle of the widest angle, seen from the centre of a container, with no disc in it."""
    angle, _, beside = _places_around(surfaces, np.arange(surfaces.discs))
    angle = np.sort(angle[beside])
    if len(angle) == 0:
        return 0.0
    width = np.diff(angle, append=angle[0] + 2.0 * np.pi)
    widest = int(np.argmax(width))
    return float(angle[widest] + 0.5 * width[widest])


def order_of_insertion(surfaces: BoundingSurfaces) -> Bodies:
    """All discs, rows (surface, its image in the cell), in ever larger rounds, each along a winding path.

    The cell is that of the first disc, in which its pores stand, wherever that is. Rounds keep pores round
    while they are few, and the path keeps walks short (Amenta, Choi and Rote 2003, Incremental constructions
    con BRIO).
    """
    n = surfaces.discs
    x, image = surfaces.centre[:n], np.zeros((n, 2), np.int64)
    place = np.random.default_rng(0).permutation(n)
    if len(surfaces.periods):
        cell = np.floor(x @ np.linalg.pinv(surfaces.periods)).astype(np.int64)
        image[:, : len(surfaces.periods)] = cell[np.argmin(place)] - cell
        x = x + image[:, : len(surfaces.periods)] @ surfaces.periods
    size = np.maximum(np.ptp(x, axis=0).max(initial=0.0), 1e-300)
    rounds = np.ceil(np.log2(place + 1.0))
    row = np.floor((x[:, 1] - x[:, 1].min(initial=0.0)) / size * np.sqrt(2.0**rounds))
    along = np.where(row % 2 == 0, x[:, 0], -x[:, 0])
    order = np.lexsort((along, row, rounds))
    return np.column_stack([order, image[order]])
