"""Narrow necks: the flux through each and the speed at which its surfaces part are numbers of their own.

What a flux pushes back grows like gap^-5/2, what parts or comes together like gap^-3/2. As differences of the
numbers of two surfaces both would be known to 1e-16 of these, and pressures to 1e-16 gap^-5/2. So in a neck
from a foot F_b on its first surface b to F_o on the other o, of direction n, two numbers more,

    q = Psi_o(F_o) - Psi_b(F_o),   v = n . (U_o - U_b),   Psi_b a translation of b,

stand for them in the strips along the neck. There psi is counted from F_b and F_o, and from the translation
of b: the strain rates of q and v are those of c_o and n . U_o, all others are small. That q and v are what
bodies do is a constraint, B x = 0. Its multipliers are the pressure that drives the flux and the force that
presses the surfaces together: a balance of forces gives them, not products of large numbers and small ones.
A body that is strained translates near its foot as psi and its gradient there say, so that its stresslet has
the moments of these forces.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.pores.orders import RIGID, TIED, Orders, numbers_of
from fsi.pores.pore_data import FIRST, REFERENCE, SECOND, Complex, planar, pore_data
from fsi.pores.regions import NEXT, OTHER, PoreShapes
from fsi.pores.surfaces import CONTAINER, WALL
from fsi.pores.topology import Pores

# Of the gap times half the curvature of both surfaces. Rounding leaves of the power of 1800
# discs, many of them a little further apart than 1e-3, 3e-8 with that limit and 2e-10 with this.
NARROW = 3e-3
ZONES = 4  # of a pore: its three strips, and its triangle


class Ties(NamedTuple):
    """Constraints of the narrow necks that some pores of a batch tell, t of them.

    Attributes:
        row: their numbers, of q; that of v follows, (t,).
        pore: places of the pores in the batch, (t,).
        coefficients: of all numbers of the pore, in the constraints of q and v, (t, TIED, m).
    """

    row: Indices
    pore: Indices
    coefficients: Array


def narrow_necks(pores: Pores) -> NDArray[np.bool_]:
    """Which necks are narrow, of surfaces that move as bodies, (K,)."""
    rigid = ~pores.surfaces.free[pores.necks].any(axis=1)
    return np.asarray(rigid & (narrowness(pores) < NARROW))


def narrowness(pores: Pores) -> Array:
    """Gaps times half the curvature of both surfaces, (K,); infinite beside circles of fluid."""
    surfaces, necks = pores.surfaces, pores.necks
    size = np.where(surfaces.radius > 0.0, surfaces.radius, 1.0)
    bent = np.where(surfaces.kind == WALL, 0.0, np.where(surfaces.kind == CONTAINER, -1.0, 1.0) / size)
    of_fluid = surfaces.fluid[necks].any(axis=1)
    return np.asarray(np.where(of_fluid, np.inf, 0.5 * pores.neck_gap * bent[necks].sum(axis=1)))


def functions_of(orders: Orders) -> Indices:
    """Which of the numbers of a pore are those of its shared functions, (shared,)."""
    return np.delete(np.arange(orders.numbers), np.concatenate([*_tied(orders), []]).astype(np.int64))


def _tied(orders: Orders) -> list[Indices]:
    """Where q and v of each side stand among the numbers of a pore: before those of its modes."""
    k, places = sum(numbers_of(order) for order in orders.fluid), list[Indices]()
    for v in range(3):
        places.append(k + np.arange(TIED * orders.narrow[v]))
        k += len(places[v]) + orders.modes[v] + orders.knots[v]
    return places


class _Directed(NamedTuple):
    """Side v of those pores in which its neck runs from vertex b to vertex o.

    Attributes:
        v, b, o: the vertex opposite, and the two.
        pore: which pores, (n,).
        n: direction of the neck, (n, 2).
        arm: to the foot on o, from the references of b and of o, and from the reference of b to that of v,
            (n, 3, 2).
        strains: of b and of o, what Re and Im of z^2 are at their feet, as U_x, U_y and psi, (n, 2, 2, 3).
        between: from the foot on b to that on o, and to the reference of v, (n, 2, 2).
    """

    v: int
    b: int
    o: int
    pore: Indices
    n: Array
    arm: Array
    strains: Array
    between: Array


def _directed(shapes: PoreShapes, orders: Orders) -> Iterator[_Directed]:
    """All narrow sides of pores."""
    for v in np.flatnonzero(orders.narrow).tolist():
        for turn, b, o in ((1.0, NEXT[v], OTHER[v]), (-1.0, OTHER[v], NEXT[v])):
            pore = np.flatnonzero(shapes.turn[:, v] == turn)
            own, at = shapes.of(pore), shapes.reference[pore]
            start, foot = own.foot[:, v, 0 if turn > 0.0 else 1], own.foot[:, v, 1 if turn > 0.0 else 0]
            arm = np.stack([foot - at[:, b], foot - at[:, o], at[:, v] - at[:, b]], axis=1)
            strains = np.stack([_strains(own, b, start), _strains(own, o, foot)], axis=1)
            between = np.stack([foot - start, at[:, v] - start], axis=1)
            yield _Directed(v, b, o, pore, turn * own.direction[:, v], arm, strains, between)


def _strains(shapes: PoreShapes, vertex: int, foot: Array) -> Array:
    """Of psi = Re and Im of z^2, z = (x + i y) / a around the centre: U_x, U_y, psi at feet, (n, 2, 3)."""
    a = np.where(shapes.radius[:, vertex] > 0.0, shapes.radius[:, vertex], 1.0)
    z = planar(foot - shapes.centre[:, vertex]) / a
    f, slope = np.stack([z * z, -1j * z * z], axis=1), np.stack([z, -1j * z], axis=1) * (2.0 / a)[:, None]
    return np.stack([-slope.imag, -slope.real, f.real], axis=2)


def seen_from_necks(shapes: PoreShapes, orders: Orders) -> tuple[Complex, Array]:
    """The columns of n pores in each of their zones, and what numbers their shared functions have there.

    In the strips along narrow necks psi of their surfaces is counted from their feet. Functions have there
    the numbers T x of all numbers x of the pore, T (n, ZONES, shared, numbers).
    """
    plain = pore_data(shapes)
    data = np.repeat(plain[:, None], ZONES, axis=1)
    T = np.zeros((len(plain), ZONES, orders.shared, orders.numbers))
    T[:, :, np.arange(orders.shared), functions_of(orders)] = 1.0
    for v in np.flatnonzero(orders.narrow).tolist():
        data[:, v, NEXT[v], REFERENCE] = plain[:, v, FIRST]
        data[:, v, OTHER[v], REFERENCE] = plain[:, v, SECOND]
    for side in _directed(shapes, orders):
        T[side.pore, side.v] = _counted(T[side.pore, side.v], side, orders)
    return data, T


def _counted(T: Array, side: _Directed, orders: Orders) -> Array:
    """T of the strip along a narrow side, from that of other zones, (n, shared, numbers)."""
    first = np.cumsum([0, *map(numbers_of, orders.fluid)])
    b, o, k = first[[side.b, side.o, side.v]]
    q, v = _tied(orders)[side.v]
    t = np.stack([-side.n[:, 1], side.n[:, 0]], axis=1)
    along, arm = t[:, :, None] * t[:, None], side.arm[:, 2]
    T[:, [b, b + 1, b + 3, o, o + 1, o + 3]] = 0.0
    T[:, o : o + 2, v], T[:, o + 3, q] = side.n, 1.0
    T[:, o : o + 2, o : o + 2], T[:, o : o + 2, b : b + 2] = along, -along
    for i, lever in ((0, -arm[:, 1]), (1, arm[:, 0])):
        T[:, k + i, b + i], T[:, k + 3, b + i] = -1.0, lever
    T[:, k + 3, b + 3] = -1.0
    for f in range(numbers_of(orders.fluid[side.b]) - RIGID):
        U, psi = side.strains[:, 0, f, :2], side.strains[:, 0, f, 2]
        T[:, b : b + 2, b + RIGID + f], T[:, b + 3, b + RIGID + f] = -U, -psi
        T[:, o : o + 2, b + RIGID + f] = -np.einsum("nij,nj->ni", along, U)
        T[:, k : k + 2, b + RIGID + f] = -U
        T[:, k + 3, b + RIGID + f] = -psi - _carried(U, side.between[:, 1])
    for f in range(numbers_of(orders.fluid[side.o]) - RIGID):
        U, psi = side.strains[:, 1, f, :2], side.strains[:, 1, f, 2]
        T[:, o : o + 2, o + RIGID + f] = np.einsum("nij,nj->ni", along, U) - U
        T[:, o + 3, o + RIGID + f] = -psi
    return T


def _carried(U: Array, arm: Array) -> Array:
    """By how much psi of a translation rises along an arm, (n,)."""
    return np.asarray(U[:, 0] * arm[:, 1] - U[:, 1] * arm[:, 0])


def ties_of(shapes: PoreShapes, orders: Orders, row: Indices) -> Ties:
    """The constraints that n pores tell, those of their sides with a row, (n, 3); -1 for none."""
    first = np.cumsum([0, *map(numbers_of, orders.fluid)])
    parts = [(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, TIED, orders.numbers)))]
    for side in _directed(shapes, orders):
        told = row[side.pore, side.v] >= 0
        (b, o), (q, v) = first[[side.b, side.o]], _tied(orders)[side.v]
        of = np.zeros((len(side.pore), TIED, orders.numbers))
        of[:, 0, q] = of[:, 1, v] = 1.0
        for surface, sign, arm in ((o, -1.0, side.arm[:, 1]), (b, 1.0, side.arm[:, 0])):
            of[:, 0, surface] = sign * arm[:, 1]
            of[:, 0, surface + 1] = -sign * arm[:, 0]
            of[:, 0, surface + 3] = sign
            of[:, 1, surface : surface + 2] = sign * side.n
        arms = side.between[:, 0], np.zeros_like(side.n)
        for end, (surface, vertex) in enumerate(((b, side.b), (o, side.o))):
            sign = 1.0 - 2.0 * end
            for f in range(numbers_of(orders.fluid[vertex]) - RIGID):
                U, psi = side.strains[:, end, f, :2], side.strains[:, end, f, 2]
                of[:, 0, surface + RIGID + f] = sign * (psi + _carried(U, arms[end]))
                of[:, 1, surface + RIGID + f] = sign * np.sum(side.n * U, axis=1)
        parts.append((row[side.pore[told], side.v], side.pore[told], of[told]))
    return Ties._make(np.concatenate(part) for part in zip(*parts, strict=True))
