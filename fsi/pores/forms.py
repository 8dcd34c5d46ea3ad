"""The dissipation of the trial functions of pores, without their bubbles.

For psi with u = (psi_y, -psi_x) and viscosity 1

    2 e:e = 4 psi_xy^2 + (psi_yy - psi_xx)^2,   K = int of the products of these two numbers of two functions.

The bubbles of a pore meet no other; they are eliminated, which minimises the dissipation over them.
"""

from typing import NamedTuple

import numpy as np

from fsi.arrays import Array
from fsi.machine.compiled import compiled, inlined, internal, vectorised
from fsi.machine.heap import aligned
from fsi.pores.elimination import least_bubbles
from fsi.pores.jets import AT_ONCE
from fsi.pores.narrow import ZONES, seen_from_necks
from fsi.pores.orders import Orders
from fsi.pores.pore_data import Complex, pore_data
from fsi.pores.products import squares, take_off
from fsi.pores.quadrature import ROOT, ROWS, WEIGHT, Points, Rule, fill_pore, most_points, pore_points
from fsi.pores.regions import PoreShapes
from fsi.pores.target import JETS, RATES, Target
from fsi.pores.trial import room_for, take_functions

# Numbers that a processor multiplies at once, of both rates: of points so many stay that fill up AT_ONCE.
_SIDE_BY_SIDE = 4


class PoreForms(NamedTuple):
    """Of n pores.

    Attributes:
        K: dissipation of their numbers, (n, m, m).
        area: of each, (n,).
        least: smallest weight of quadrature, (n,); not positive where a pore is no region.
    """

    K: Array
    area: Array
    least: Array


def pore_forms(shapes: PoreShapes, rule: Rule, orders: Orders) -> PoreForms:
    """The forms of pores of the same orders."""
    data, n, m = pore_data(shapes), len(shapes.gap), orders.numbers
    forms = PoreForms(np.empty((n, m, m)), np.empty(n), np.empty(n))
    if any(orders.narrow):
        zones = seen_from_necks(shapes, orders)
        most = most_points(data, rule) + ZONES * AT_ONCE
        _take_narrow_forms(zones, rule, orders, Work.of(most, RATES, orders), forms)
    else:
        _take_forms(data, rule, orders, Work.of(most_points(data, rule), RATES, orders), forms)
    return forms


def applied(K: Array, x: Array) -> Array:
    """K x of each of n pores, K (n, m, m) and x (n, m)."""
    return np.asarray((K @ x[..., None])[..., 0])


def with_bubbles(rates: Array, x: Array) -> Array:
    """Numbers x of pores, (n, m), followed by those of their bubbles, (n, m + bubbles).

    rates: at the points of quadrature, as `rates_of_numbers` has them.
    """
    numbers = np.empty(rates.shape[:2])
    _take_bubbles(rates.reshape(*rates.shape[:2], -1), x, numbers)
    return numbers


def rates_of_numbers(shapes: PoreShapes, rule: Rule, orders: Orders) -> tuple[Array, Points]:
    """`strain_rates` of all numbers of pores, then of bubbles, (n, m + bubbles, 2, Q), and their points."""
    data = pore_data(shapes)
    points = pore_points(data, rule)
    if not any(orders.narrow):
        return strain_rates(data, orders, points), points
    zone = np.sum(np.arange(points.rows.shape[2]) >= points.ends[:, : ZONES - 1, None], axis=1)
    seen, T = seen_from_necks(shapes, orders)
    found = np.zeros((len(data), orders.numbers + orders.total - orders.shared, 2, points.rows.shape[2]))
    for z in range(ZONES):
        rates = strain_rates(seen[:, z], orders, points)
        S = np.einsum("efk,efdq->ekdq", T[:, z], rates[:, : orders.shared])
        found += np.where(
            (zone == z)[:, None, None], np.concatenate([S, rates[:, orders.shared :]], axis=1), 0.0
        )
    return found, points


def strain_rates(data: Complex, orders: Orders, points: Points) -> Array:
    """2 psi_xy and psi_yy - psi_xx times roots of weights, (n, functions, 2, Q)."""
    found = np.zeros((len(data), orders.total, RATES, points.rows.shape[2]))
    _take_rates(data, orders, points.rows, Work.of(0, RATES, orders), found)
    return found


def values(data: Complex, orders: Orders, points: Points) -> Array:
    """The functions with their derivatives, psi ... psi_yy, (n, functions, 6, Q)."""
    found = np.zeros((len(data), orders.total, JETS, points.rows.shape[2]))
    _take_values(data, orders, points.rows, Work.of(0, JETS, orders), found)
    return found


class Work(NamedTuple):
    """Room for one pore.

    Attributes:
        points: its points, (ROWS, .).
        some: AT_ONCE of them.
        out: what comes out of all functions, as in `Target`.
        seen: what comes out of numbers, as `out`, beside narrow necks.
        room: to make them.
        total: how many functions there are.
    """

    points: Array
    some: Array
    out: Array
    seen: Array
    room: Array
    total: int

    @staticmethod
    def of(points: int, numbers: int, orders: Orders) -> "Work":
        """Room for so many points and these numbers at each, of functions of these orders."""
        width, rows = numbers * (points + AT_ONCE), orders.numbers if any(orders.narrow) else 0
        out, seen, some = aligned(orders.total * width), aligned(rows * width), aligned(ROWS * AT_ONCE)
        return Work(np.empty((ROWS, points)), some, out, seen, room_for(orders), orders.total)


@compiled
def _take_forms(data: Complex, rule: Rule, orders: Orders, work: Work, forms: PoreForms) -> None:
    """The forms of all pores, one after the other."""
    shared, ends = forms.K.shape[1], np.empty(4, np.int64)
    for e in range(len(data)):
        fill_pore(data[e], rule, work.points, ends)
        points, width = work.points[:, : ends[3]], RATES * AT_ONCE * blocks(ends[3])
        rates = work.out[: work.total * width].reshape((work.total, width))
        for b in range(blocks(ends[3])):
            take_points(points, b * AT_ONCE, work.some)
            take_functions(data[e], orders, Target(work.some, work.room, rates, RATES * AT_ONCE * b))
        end = _closed_up(rates, width, ends[3])
        _put_form((rates[:shared], rates[shared:], end), points[WEIGHT], e, forms)


@compiled
def _take_narrow_forms(
    zones: tuple[Complex, Array], rule: Rule, orders: Orders, work: Work, forms: PoreForms
) -> None:
    """The forms of all pores with narrow necks, (data, T) as by `seen_from_necks`."""
    (data, T), ends = zones, np.empty(4, np.int64)
    shared, numbers = T.shape[2], T.shape[3]
    for e in range(len(data)):
        fill_pore(data[e, ZONES - 1], rule, work.points, ends)
        width, first = 0, 0
        for z in range(ZONES):
            width += RATES * AT_ONCE * blocks(ends[z] - first)
            first = ends[z]
        rates = work.out[: work.total * width].reshape((work.total, width))
        S = work.seen[: numbers * width].reshape((numbers, width))
        first, end = 0, 0
        for z in range(ZONES):
            points, begin = work.points[:, first : ends[z]], end
            for b in range(blocks(ends[z] - first)):
                take_points(points, b * AT_ONCE, work.some)
                take_functions(data[e, z], orders, Target(work.some, work.room, rates, end))
                end += RATES * AT_ONCE
            end = _closed_up(rates, end, ends[z] - first)
            _take_seen(rates[:shared], T[e, z], S, (begin, end))
            first = ends[z]
        _put_form((S, rates[shared:], end), work.points[WEIGHT, : ends[3]], e, forms)


@internal
def _closed_up(rates: Array, end: int, points: int) -> int:
    """Where rates of so many points end that ended there, once numbers of none at the end are left out."""
    none = (AT_ONCE * blocks(points) - points) // _SIDE_BY_SIDE * _SIDE_BY_SIDE
    if none > 0:
        for f in range(len(rates)):
            for w in range(AT_ONCE - none):
                rates[f, end - AT_ONCE - none + w] = rates[f, end - AT_ONCE + w]
    return end - RATES * none


@internal
def _put_form(rates: tuple[Array, Array, int], weight: Array, e: int, forms: PoreForms) -> None:
    """The form of pore e, of strain rates S of its numbers and B of its bubbles, up to an end; S is lost."""
    S, B, end = rates
    # Whatever X is, this is the dissipation of flows: positive, an upper bound, off by X's error squared.
    take_off(S, least_bubbles(S, B, end), B, end)
    squares(S, forms.K[e], end)
    forms.area[e], forms.least[e] = weight.sum(), weight.min()


@vectorised
def _take_seen(rates: Array, T: Array, S: Array, place: tuple[int, int]) -> None:
    """The rates of numbers in this place: T^T times those of functions."""
    for k in range(len(S)):
        for p in range(place[0], place[1]):
            S[k, p] = 0.0
        for f in range(len(rates)):
            if T[f, k] != 0.0:
                for p in range(place[0], place[1]):
                    S[k, p] += T[f, k] * rates[f, p]


@compiled
def _take_bubbles(rates: Array, x: Array, numbers: Array) -> None:
    """x and the numbers of bubbles."""
    shared = x.shape[1]
    for e in range(len(x)):
        X = least_bubbles(rates[e, :shared], rates[e, shared:], rates.shape[2])
        numbers[e, :shared] = x[e]
        for b in range(len(X)):
            numbers[e, shared + b] = -(X[b] * x[e]).sum()


@compiled
def _take_rates(data: Complex, orders: Orders, points: Array, work: Work, rates: Array) -> None:
    """The strain rates of all functions at all points of all pores, times roots of weights."""
    Q, out = rates.shape[3], work.out.reshape((work.total, RATES * AT_ONCE))
    for e in range(len(rates)):
        for b in range(blocks(Q)):
            take_points(points[e], b * AT_ONCE, work.some)
            take_functions(data[e], orders, Target(work.some, work.room, out, 0))
            for k in range(work.total):
                for q in range(b * AT_ONCE, min((b + 1) * AT_ONCE, Q)):
                    w = q - b * AT_ONCE
                    rates[e, k, 0, q], rates[e, k, 1, q] = -out[k, AT_ONCE + w], -out[k, w]


@compiled
def _take_values(data: Complex, orders: Orders, points: Array, work: Work, values: Array) -> None:
    """All functions at all points of all pores."""
    Q, out = values.shape[3], work.out.reshape((work.total, 1, JETS * AT_ONCE))
    for e in range(len(values)):
        for b in range(blocks(Q)):
            take_points(points[e], b * AT_ONCE, work.some)
            take_functions(data[e], orders, Target(work.some, work.room, out, 0))
            for k in range(work.total):
                for j in range(JETS):
                    for q in range(b * AT_ONCE, min((b + 1) * AT_ONCE, Q)):
                        values[e, k, j, q] = out[k, 0, (j - b) * AT_ONCE + q]


@inlined
def blocks(points: int) -> int:
    """How many times AT_ONCE so many points are."""
    return (points + AT_ONCE - 1) // AT_ONCE


@internal
def take_points(points: Array, first: int, some: Array) -> None:
    """AT_ONCE points from the first on; beyond the last, the first again, without weight."""
    for row in range(ROOT + 1):
        for w in range(AT_ONCE):
            there = first + w < points.shape[1]
            some[row * AT_ONCE + w] = points[row, first + w] if there else points[row, first]
    for w in range(points.shape[1] - first, AT_ONCE):
        some[ROOT * AT_ONCE + w] = 0.0
