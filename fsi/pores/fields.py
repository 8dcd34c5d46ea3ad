"""The flow in pores at points: stream function, velocity and its gradient."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.pores.assembly import Batch
from fsi.pores.carrier import stream
from fsi.pores.forms import values
from fsi.pores.inner import inner_flow
from fsi.pores.orders import numbers_of
from fsi.pores.places import in_discs, locate, off_corners
from fsi.pores.pore_data import Complex, gathering, pore_data
from fsi.pores.quadrature import WEIGHT, Points, Rule, points_at, pore_points, uniform
from fsi.pores.regions import NEXT, OTHER
from fsi.pores.system import PoreSystem

_PATCHES = 0.75  # of a strip, for each unit of T by which points gather in it
_ENDS = np.array([[NEXT[v], OTHER[v]] for v in range(3)])  # the vertices between which each side lies
# Powers of the distance by which psi and its derivatives fall towards a corner, from where they are known.
_AT_CORNER = np.array([3, 2, 2, 0, 0, 0])


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
        pores: how many pores there are.
        place: of each patch its pore, or behind them its fluid disc, (P,).
        ends: whether its first row is one point: of triangles, fluid discs, corners, (P,).
        corner: whether that point is a corner of two walls, (P,).
        field: at the points.
    """

    points: Array
    pores: int
    place: Indices
    ends: NDArray[np.bool_]
    corner: NDArray[np.bool_]
    field: FluidField

    @property
    def pore(self) -> Indices:
        """Of each patch, -1 in fluid discs, (P,)."""
        return np.where(self.place < self.pores, self.place, -1)

    @property
    def parts(self) -> list[tuple[Indices, Array]]:
        """Places (n,) and points there (n, k, 2): by pore, then by patch of a fluid disc."""
        in_pore, x = self.place < self.pores, self.points.reshape(len(self.place), -1, 2)
        of_pores = x[in_pore].reshape(self.pores, -1, 2)
        return [(np.arange(self.pores), of_pores), (self.place[~in_pore], x[~in_pore])]


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
                shapes, local = self._shapes.of(pore[here]), numbers[np.searchsorted(batch.pore, pore[here])]
                data, (x, nearer) = pore_data(shapes), off_corners(shapes, place[here])
                of_pores = stream_function(data, points_at(data, x), batch, local)[:, :, 0]
                jet[:, here] = nearer ** _AT_CORNER[:, None] * of_pores
        place = self._in_fluid_discs(jet, np.flatnonzero(pore < 0), points, place)
        return FluidField.of(_carried(jet, place, points, self.flow.gradient))

    def mean(self, of: Callable[[Indices, Array, Array], Array]) -> float:
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

    def _in_fluid_discs(self, jet: Array, missing: Indices, points: Array, place: Array) -> Array:
        """Fill in points that lie in fluid discs; where all points lie then."""
        surfaces, place = self.flow.system.pores.surfaces, place.copy()
        own, at = in_discs(surfaces, np.flatnonzero(surfaces.fluid), points[missing])
        here = missing[own >= 0]
        place[here], own = at[own >= 0], own[own >= 0]
        jet[:, here] = self._inner(own, place[here] - surfaces.centre[own])
        return place

    def _inner(self, disc: Indices, r: Array) -> Array:
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

        A fluid disc has a patch for each that ends on its circle, with the same points there.

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
        pores, patches = len(by_number), 3 * pieces + 3
        ends, corner = _first_rows(system.pores.sides, pieces)
        jet = np.concatenate(jets, axis=1)[:, by_number].reshape(6, -1)
        x = np.concatenate(places)[by_number].reshape(pores, patches, order + 1, order + 1, 2)
        r, disc = self._sectors(x[:, : 3 * pieces].reshape(pores, 3, pieces, order + 1, order + 1, 2))
        own = np.repeat(disc, (order + 1) ** 2)
        place = pores + np.cumsum(system.pores.surfaces.fluid) - 1
        return PoreMesh(
            np.concatenate([x.reshape(-1, 2), system.pores.surfaces.centre[own] + r]),
            pores,
            np.concatenate([np.repeat(np.arange(pores), patches), place[disc]]),
            np.concatenate([ends, np.ones(len(disc), bool)]),
            np.concatenate([corner, np.zeros(len(disc), bool)]),
            FluidField.of(np.concatenate([jet, self._inner(own, r)], axis=1)),
        )

    def _sectors(self, strips: Array) -> tuple[Array, Indices]:
        """Points of sectors of fluid discs, from their centres, (n, 2), and the disc of each sector.

        strips: the patches of each side along and across them, (E, 3, pieces, k, k, 2).
        """
        fluid, k = self._shapes.fluid[:, _ENDS], strips.shape[3]
        arcs = np.stack([strips[..., 0, :], strips[..., -1, :]], axis=2)  # on both surfaces of a side
        r = arcs[fluid] - self._shapes.centre[:, _ENDS][fluid][:, None, None]
        rows = np.linspace(0.0, 1.0, k)[:, None, None] * r[:, :, None]
        disc = self.flow.system.pores.vertices[:, _ENDS][fluid]
        return rows.reshape(-1, 2), np.repeat(disc, strips.shape[2])


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


def _first_rows(sides: Indices, pieces: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which patches begin in one point, and in a corner; of pores with sides (E, 3), 3 pieces + 3 of each."""
    corner = np.zeros((len(sides), 3 * pieces + 3), bool)
    corner[:, : 3 * pieces : pieces] = sides < 0
    ends = corner.copy()
    ends[:, -3:] = True
    return ends.ravel(), corner.ravel()
