"""The flow in pores at points: stream function, velocity and its gradient."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from math import ceil
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.bodies.configuration import Array
from fsi.pores.assembly import Batch
from fsi.pores.carrier import stream
from fsi.pores.forms import values
from fsi.pores.inner import inner_flow
from fsi.pores.orders import numbers_of
from fsi.pores.pattern import Index
from fsi.pores.pore_data import Complex, gathering, pore_data
from fsi.pores.quadrature import DISTANCE, WEIGHT, Points, Rule, points_at, pore_points, uniform
from fsi.pores.regions import PoreShapes, cross
from fsi.pores.surfaces import BoundingSurfaces
from fsi.pores.system import PoreSystem

_PATCHES = 0.75  # of a strip, for each unit of T by which points gather in it
# Pores near a point, of which one holds it; so many where none of fewer does, as small ones lie beside large.
_CANDIDATES = (8, 64, 512)
_QUARTERS = 4  # of a fluid disc
_ROUNDING = 1e-9  # of the size of a pore: points as far as that outside count as inside


@dataclass(frozen=True, slots=True, eq=False)
class FluidField:
    """Of the fluid at n points.

    Attributes:
        psi: stream function, (n,).
        u: velocity (psi_y, -psi_x), (n, 2).
        gradient: d u_i / d x_j, (n, 2, 2).
    """

    psi: Array
    u: Array
    gradient: Array

    @classmethod
    def of(cls, jet: Array) -> FluidField:
        """From psi and its derivatives, (6, ...)."""
        psi, x, y, xx, xy, yy = jet.reshape(6, -1)
        gradient = np.stack([xy, yy, -xx, -xy], axis=-1).reshape(-1, 2, 2)
        return cls(psi, np.stack([y, -x], axis=-1), gradient)


@dataclass(frozen=True, slots=True, eq=False)
class PoreMesh:
    """Pores as patches of (order + 1)^2 points, row by row, each with points of its own.

    Attributes:
        points: (n, 2), where the pores lie, not brought back into one period.
        pore: of each patch, -1 in fluid discs, (P,).
        ends: whether its first row is one point: of triangles, fluid discs, corners, (P,).
        corner: whether that point is a corner of two walls, (P,).
        field: at the points.
    """

    points: Array
    pore: Index
    ends: NDArray[np.bool_]
    corner: NDArray[np.bool_]
    field: FluidField

    @property
    def parts(self) -> list[Array]:
        """The points by pore, and by fluid disc, (., n, 2)."""
        pores = int(self.pore.max()) + 1
        of_pores, of_discs = np.split(self.points.reshape(len(self.pore), -1, 2), [np.sum(self.pore >= 0)])
        return [of_pores.reshape(pores, -1, 2), of_discs.reshape(-1, _QUARTERS * of_discs.shape[1], 2)]


class Stream(Protocol):
    """The numbers of a stream function."""

    @property
    def system(self) -> PoreSystem:
        """Whose numbers they are."""

    @property
    def x(self) -> Array:
        """All of them, (n,)."""

    @property
    def gradient(self) -> Array:
        """Mean velocity gradient, by which periods change, (2, 2)."""

    def functions(self, batch: Batch) -> Array:
        """Of all functions of the pores of a batch, (n, total)."""


class FlowFields:
    """The fields of a flow; the numbers of its bubbles are found once."""

    def __init__(self, flow: Stream) -> None:
        """Of a flow."""
        self.flow = flow
        self._shapes = flow.system.shapes
        self._numbers = [flow.functions(batch) for batch in flow.system.assembly.batches]

    def at(self, points: Array) -> FluidField:
        """The fields at points (n, 2), in fluid discs too; not a number in bodies and outside."""
        system, jet = self.flow.system, np.full((6, len(points)), np.nan)
        pore, place = locate(system, points)
        for batch, numbers in zip(system.assembly.batches, self._numbers, strict=True):
            here = np.flatnonzero(np.isin(pore, batch.pore))
            if len(here):
                data = pore_data(self._shapes.of(pore[here]))
                local = numbers[np.searchsorted(batch.pore, pore[here])]
                jet[:, here] = stream_function(data, points_at(data, place[here]), batch, local)[:, :, 0]
        place = self._in_fluid_discs(jet, np.flatnonzero(pore < 0), points, place)
        return FluidField.of(_carried(jet, place, points, self.flow.gradient))

    def mean(self, of: Callable[[Index, Array, Array], Array]) -> float:
        """Over the fluid, of what is made of places (E,), points there (E, n, 2) and jets (6, E n).

        Places are pores, then fluid discs, in which it is harmonic, so that its mean is what it is at their
        centres.
        """
        surfaces, total, area = self.flow.system.pores.surfaces, 0.0, 0.0
        for batch, numbers in zip(self.flow.system.assembly.batches, self._numbers, strict=True):
            data = pore_data(self._shapes.of(batch.pore))
            points = pore_points(data, batch.rule)
            jet, weight = stream_function(data, points, batch, numbers), points.rows[:, WEIGHT].ravel()
            total += float(weight @ of(batch.pore, points.places, jet.reshape(6, -1)))
            area += float(weight.sum())
        disc = np.flatnonzero(surfaces.fluid)
        of_discs, jet = np.pi * surfaces.radius[disc] ** 2, self._inner(disc, np.zeros((len(disc), 2)))
        places = len(self.flow.system.pores) + np.arange(len(disc))
        total += float(of_discs @ of(places, surfaces.centre[disc, None], jet))
        return total / (area + float(of_discs.sum()))

    def _in_fluid_discs(self, jet: Array, missing: Index, points: Array, place: Array) -> Array:
        """Fill in points that lie in fluid discs; where all points lie then."""
        surfaces, place = self.flow.system.pores.surfaces, place.copy()
        own, at = _in_discs(surfaces, np.flatnonzero(surfaces.fluid), points[missing])
        here = missing[own >= 0]
        place[here], own = at[own >= 0], own[own >= 0]
        jet[:, here] = self._inner(own, place[here] - surfaces.centre[own])
        return place

    def _inner(self, disc: Index, r: Array) -> Array:
        """psi with its derivatives in fluid discs, (6, n), at r from their centres, (n, 2)."""
        numbering = self.flow.system.assembly.numbering
        radius, psi = self.flow.system.pores.surfaces.radius, np.empty((6, len(disc)))
        for order in np.unique(numbering.order[disc]):
            here = np.flatnonzero(numbering.order[disc] == order)
            numbers = numbering.surface[disc[here], None] + np.arange(numbers_of(order))
            psi[:, here] = inner_flow(r[here], radius[disc[here]], self.flow.x[numbers], int(order))
        return psi

    def mesh(self, order: int) -> PoreMesh:
        """A picture of the flow: strips, in as many patches as their gaps ask for, triangles, fluid discs.

        Pores follow each other by number, so that all flows in the same pores have the same points.
        """
        system, jets, places = self.flow.system, [], []
        narrowest = float(gathering(self._shapes).max(initial=0.0))
        pieces = max(1, ceil(_PATCHES * narrowest))
        for batch, numbers in zip(system.assembly.batches, self._numbers, strict=True):
            data = pore_data(self._shapes.of(batch.pore))
            there = pore_points(data, _even(order, pieces))
            jets.append(stream_function(data, there, batch, numbers))
            places.append(there.places)
        by_number = np.argsort(np.concatenate([batch.pore for batch in system.assembly.batches]))
        patches = 3 * pieces + 3
        ends, corner = _first_rows(system.pores.sides, pieces)
        r, disc = self._quarters(order)
        jet = np.concatenate(jets, axis=1)[:, by_number].reshape(6, -1)
        points = np.concatenate(places)[by_number].reshape(-1, 2)
        quarters = len(disc) // (order + 1) ** 2
        return PoreMesh(
            np.concatenate([points, system.pores.surfaces.centre[disc] + r]),
            np.concatenate([np.repeat(np.arange(len(by_number)), patches), np.full(quarters, -1)]),
            np.concatenate([ends, np.ones(quarters, bool)]),
            np.concatenate([corner, np.zeros(quarters, bool)]),
            FluidField.of(np.concatenate([jet, self._inner(disc, r)], axis=1)),
        )

    def _quarters(self, cells: int) -> tuple[Array, Index]:
        """Points of quarters of fluid discs, from their centres, (n, 2), and the discs, (n,)."""
        surfaces = self.flow.system.pores.surfaces
        disc = np.flatnonzero(surfaces.fluid)
        t = np.linspace(0.0, 1.0, cells + 1)
        angle = 0.5 * np.pi * (np.arange(_QUARTERS)[:, None, None] + t)
        one = (t[:, None] * np.stack([np.cos(angle), np.sin(angle)])).reshape(2, -1).T
        return (surfaces.radius[disc, None, None] * one).reshape(-1, 2), np.repeat(disc, len(one))


def locate(system: PoreSystem, points: Array) -> tuple[Index, Array]:
    """The pore of each point, (n,), -1 where there is none, and its image in that pore, (n, 2).

    A point lies in the pore to whose sides it lies on the left, and in no body.
    """
    shapes, surfaces = system.shapes, system.pores.surfaces
    middle = shapes.touch.mean(axis=1)
    home = _wrapped(middle, surfaces.periods)
    images = _images(surfaces.periods)
    tree = cKDTree((home + images[:, None]).reshape(-1, 2))
    wrapped, pore, place = _wrapped(points, surfaces.periods), np.full(len(points), -1), points.copy()
    missing = np.arange(len(points))
    for most in _CANDIDATES:
        count = min(most, len(tree.data))
        near = tree.query(wrapped[missing], k=count)[1].reshape(len(missing), count)
        for candidate in near.T[::-1]:  # the nearest has the last word
            number = candidate % len(middle)
            x = wrapped[missing] - images[candidate // len(middle)] + middle[number] - home[number]
            inside = _inside(shapes.of(number), x)
            pore[missing[inside]], place[missing[inside]] = number[inside], x[inside]
        missing = missing[pore[missing] < 0]
        discs = np.arange(surfaces.discs)  # what lies in one lies in no pore
        missing = missing[_in_discs(surfaces, discs, wrapped[missing])[0] < 0]
    return pore, place


def _inside(shapes: PoreShapes, x: Array) -> NDArray[np.bool_]:
    """Whether points (n, 2) lie in pores (n)."""
    from_feet = np.moveaxis(x[:, None] - shapes.foot[:, :, 0], -1, 0)
    left = cross(np.moveaxis(shapes.direction, -1, 0), from_feet)
    outside = points_at(pore_data(shapes), x).rows[:, DISTANCE : DISTANCE + 3, 0]
    least = -_ROUNDING * shapes.reach.max(axis=1, keepdims=True)
    return np.asarray(np.all(left >= least, axis=1) & np.all(outside >= least, axis=1))


def _in_discs(surfaces: BoundingSurfaces, discs: Index, points: Array) -> tuple[Index, Array]:
    """Which of some discs holds each point, (n,), -1 for none, and its image in that disc, (n, 2)."""
    own, place = np.full(len(points), -1), points.copy()
    if len(discs) == 0 or len(points) == 0:
        return own, place
    # Balls, not the nearest centres: a small disc may be nearer to what lies in a large one.
    centre, wrapped = surfaces.centre[discs], _wrapped(points, surfaces.periods)
    tree, home = cKDTree(wrapped), _wrapped(centre, surfaces.periods)
    for image in _images(surfaces.periods):
        found = tree.query_ball_point(home + image, surfaces.radius[discs])
        inside = np.concatenate(found).astype(int)
        disc = np.repeat(np.arange(len(discs)), [len(each) for each in found])
        own[inside] = discs[disc]
        place[inside] = wrapped[inside] - image + centre[disc] - home[disc]
    return own, place


def _images(periods: Array) -> Array:
    """From a period to itself and all its neighbours, (3^P, 2)."""
    around = product((-1.0, 0.0, 1.0), repeat=len(periods))
    return np.array([np.array(c) @ periods.reshape(-1, 2) for c in around]).reshape(-1, 2)


def _wrapped(points: Array, periods: Array) -> Array:
    """Images of points in one period, that around the origin."""
    if len(periods) == 0:
        return points
    return np.asarray(points - np.round(points @ np.linalg.pinv(periods)) @ periods)


def _carried(jet: Array, place: Array, points: Array, gradient: Array) -> Array:
    """A jet at images of points, with what the mean flow adds from there to the points."""
    u = (points - place) @ gradient.T
    jet[0] += stream(gradient, points) - stream(gradient, place)
    jet[1] -= u[:, 1]
    jet[2] += u[:, 0]
    return jet


def stream_function(data: Complex, points: Points, batch: Batch, numbers: Array) -> Array:
    """psi with its derivatives, (6, n, Q), from the numbers of all functions, (n, m)."""
    return np.asarray(np.einsum("em,emkq->keq", numbers, values(data, batch.orders, points)))


def _even(order: int, pieces: int) -> Rule:
    """Evenly spread points, hardly off the corners, where distances to two walls vanish."""
    t = np.linspace(1e-7, 1.0 - 1e-7, order + 1)
    along = np.concatenate([(k + t) / pieces for k in range(pieces)])
    even = np.stack([t, np.ones_like(t)])
    return uniform(np.stack([along, np.ones_like(along)]), even, even)


def _first_rows(sides: Index, pieces: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which patches begin in one point, and in a corner; of pores with sides (E, 3), 3 pieces + 3 of each."""
    corner = np.zeros((len(sides), 3 * pieces + 3), bool)
    corner[:, : 3 * pieces : pieces] = sides < 0
    ends = corner.copy()
    ends[:, -3:] = True
    return ends.ravel(), corner.ravel()
