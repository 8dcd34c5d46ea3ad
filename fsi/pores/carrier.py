"""The flow that carries all along: u = U + G (x - place), of which no digits need cancel.

In a cell it is the mean flow. In a channel with sliding walls, along which periods have no mean gradient,
it is the shear between them. What is solved for is what surfaces have more than it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fsi.arrays import Array, Indices
from fsi.machine.compiled import compiled, internal, vectorised
from fsi.pores.assembly import Batch
from fsi.pores.forms import applied
from fsi.pores.orders import numbers_of
from fsi.pores.system import PoreSystem


class Carrier(NamedTuple):
    """u = U + G (x - place).

    Attributes:
        G: gradient of trace 0, (2, 2).
        place: (2,).
        U: velocity there, (2,).
    """

    G: Array
    place: Array
    U: Array

    @classmethod
    def of(cls, system: PoreSystem, gradient: Array, walls: Array) -> Carrier:
        """The flow with a mean gradient, or that between the walls of a channel with velocities (W, 3)."""
        surfaces = system.pores.surfaces
        if len(walls) != 2:
            return cls(gradient, np.zeros(2), np.zeros(2))
        place, other = surfaces.centre[-2:]
        n, slip = surfaces.normal[-2], walls[1, :2] - walls[0, :2]
        return cls(np.outer(slip, n) / float(n @ (other - place)), place, walls[0, :2])

    def numbers(self, system: PoreSystem) -> Array:
        """Those of all surfaces that it carries along, (n,)."""
        base, first = np.zeros(system.size), system.assembly.numbering.surface[:-1]
        centre = system.pores.surfaces.centre - self.place
        arm = system.reference - system.pores.surfaces.centre
        U, c = _carried(centre, arm, self.G)
        base[first], base[first + 1] = (self.U + U).T
        at = centre + arm
        base[first + 3] = c + self.U[0] * at[:, 1] - self.U[1] * at[:, 0]
        return base

    def power(self, system: PoreSystem) -> tuple[Array, float]:
        """mu K q of these numbers q, (n,), and mu q^T K q."""
        reactions, power = np.zeros(system.size), 0.0
        if np.any(self.G):
            for batch in system.assembly.batches:
                q = carried(system, batch, self.G)
                Kq = system.viscosity * applied(batch.forms.K, q)
                np.add.at(reactions, batch.unknown.ravel(), Kq.ravel())
                power += float(np.sum(q * Kq))
        return reactions, power


def product(system: PoreSystem, y: Array) -> Array:
    """K y, of viscosity 1: pore by pore, less a translation, which costs nothing.

    Large motions that bodies have in common would else cancel in K y, and leave their rounding.
    """
    found = system.assembly.inside(y)
    for batch in system.assembly.batches:
        places = np.cumsum([0, *map(numbers_of, batch.orders.fluid[:2])])
        size = system.shapes.reach[batch.pore].max(axis=1)
        pores = Seen(batch.unknown, places, system.shapes.reference[batch.pore], size)
        add_products(found, y, pores, batch.forms.K)
    return found


class Seen(NamedTuple):
    """What says how pores move as a whole.

    Attributes:
        unknown: of each function of each pore, (n, m).
        places: where the numbers of each vertex begin among them, (3,).
        reference: of the vertices, (n, 3, 2).
        size: a length of each pore, (n,).
    """

    unknown: Indices
    places: Indices
    reference: Array
    size: Array


@compiled
def add_products(found: Array, y: Array, pores: Seen, K: Array) -> None:
    """Add what K (n, m, m) makes of the numbers y of pores to `found`."""
    q, Kq = np.empty(pores.unknown.shape[1]), np.empty(pores.unknown.shape[1])
    for e in range(len(pores.unknown)):
        for i in range(len(q)):
            q[i] = y[pores.unknown[e, i]]
        _rest(q, pores.places, pores.reference[e], pores.size[e])
        _times(K[e], q, Kq)
        for i in range(len(q)):
            found[pores.unknown[e, i]] += Kq[i]


@vectorised
def _times(K: Array, q: Array, Kq: Array) -> None:
    """K q of one pore."""
    for i in range(len(q)):
        total = 0.0
        for j in range(len(q)):
            total += K[i, j] * q[j]
        Kq[i] = total


@internal
def _rest(q: Array, places: Indices, reference: Array, size: float) -> None:
    """Take off the translation of that surface, if of any, without which the numbers of a pore are least."""
    motion, least, chosen = np.zeros((4, 3)), np.inf, 0
    for v in range(4):  # the last: none
        if v < 3:
            motion[v, 0], motion[v, 1], motion[v, 2] = q[places[v]], q[places[v] + 1], q[places[v] + 3]
        left = 0.0
        for w in range(3):
            U_x, U_y, c = _seen(q, places[w], motion[v], reference[w] - reference[v % 3])
            left += abs(U_x) + abs(U_y) + abs(c) / size
        if left <= least:
            least, chosen = left, v
    for w in range(3):
        k = places[w]
        q[k], q[k + 1], q[k + 3] = _seen(q, k, motion[chosen], reference[w] - reference[chosen % 3])


@internal
def _seen(q: Array, k: int, motion: Array, arm: Array) -> tuple[float, float, float]:
    """U_x, U_y and c of the surface whose numbers begin at k, less a translation, from an arm away."""
    c = q[k + 3] - motion[2] - motion[0] * arm[1] + motion[1] * arm[0]
    return q[k] - motion[0], q[k + 1] - motion[1], c


def mean_flow(system: PoreSystem, batch: Batch, gradient: Array) -> Array:
    """What images of surfaces have more than the surfaces in u = G x + periodic, (n, m).

    Their velocities, and as c the flux of G x between the surface and its image.
    """
    pores = system.pores
    periods = np.zeros((2, 2))
    periods[: len(pores.surfaces.periods)] = pores.surfaces.periods
    shift = pores.image[batch.pore] @ periods
    image = system.shapes.reference[batch.pore]
    U, c = shift @ gradient.T, stream(gradient, image) - stream(gradient, image - shift)
    return _of_surfaces(system, batch, U, c)


def carried(system: PoreSystem, batch: Batch, gradient: Array) -> Array:
    """The numbers of surfaces that u = G x carries along, seen from the first of each pore, (n, m).

    A surface v moves with the velocity G x_v of its centre; psi there is that of the flow.
    """
    centre, reference = system.shapes.centre[batch.pore], system.shapes.reference[batch.pore]
    U, c = _carried(centre - centre[:, :1], reference - centre, gradient)
    return _of_surfaces(system, batch, U, c)


def _of_surfaces(system: PoreSystem, batch: Batch, U: Array, c: Array) -> Array:
    """The numbers (n, m) of pores, of whose surfaces each moves with U (n, 3, 2), psi there c (n, 3)."""
    q, at = np.zeros(batch.unknown.shape), 0
    first = system.assembly.numbering.surface
    for v in range(3):
        body = system.pores.vertices[batch.pore, v]
        q[:, at], q[:, at + 1], q[:, at + 3] = U[:, v, 0], U[:, v, 1], c[:, v]
        at += int(first[body[0] + 1] - first[body[0]])
    return q


def _carried(centre: Array, arm: Array, G: Array) -> tuple[Array, Array]:
    """Velocities (..., 2) of surfaces, and psi (...) at their references, at arms from their centres."""
    U = centre @ G.T
    return U, stream(G, centre) + U[..., 0] * arm[..., 1] - U[..., 1] * arm[..., 0]


def stream(G: Array, x: Array) -> Array:
    """psi of u = G x, G of trace 0."""
    psi: Array = G[0, 0] * x[..., 0] * x[..., 1] + 0.5 * (G[0, 1] * x[..., 1] ** 2 - G[1, 0] * x[..., 0] ** 2)
    return psi
