"""The dissipation of the trial functions of pores, without their bubbles.

For psi with u = (psi_y, -psi_x) and viscosity 1

    2 e:e = 4 psi_xy^2 + (psi_yy - psi_xx)^2,   K = int of the products of these two numbers of two functions.

The bubbles of a pore meet no other; they are eliminated, which minimises the dissipation over them.
"""

from typing import NamedTuple

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.compiled import compiled
from fsi.pores.elimination import least_bubbles, squares, take_off
from fsi.pores.jets import AT_ONCE
from fsi.pores.orders import Orders
from fsi.pores.pore_data import Complex, pore_data
from fsi.pores.quadrature import ROOT, ROWS, WEIGHT, Points, Rule, fill_pore, most_points, pore_points
from fsi.pores.regions import PoreShapes
from fsi.pores.target import Target
from fsi.pores.trial import room_for, take_functions


class PoreForms(NamedTuple):
    """Of n pores.

    Attributes:
        K: dissipation of their shared functions, (n, m, m).
        area: of each, (n,).
        least: smallest weight of quadrature, (n,); not positive where a pore is no region.
    """

    K: Array
    area: Array
    least: Array


def pore_forms(shapes: PoreShapes, rule: Rule, orders: Orders) -> PoreForms:
    """The forms of pores of the same orders."""
    data, n, m = pore_data(shapes), len(shapes.gap), orders.shared
    forms = PoreForms(np.empty((n, m, m)), np.empty(n), np.empty(n))
    Q = most_points(data, rule)
    rates = np.empty(orders.total * 2 * Q)
    work = Work(np.empty((ROWS, Q)), rates, rates.view(complex), room_for(orders), orders.total)
    _take_forms(data, rule, orders, work, forms)
    return forms


def with_bubbles(shapes: PoreShapes, rule: Rule, orders: Orders, x: Array) -> Array:
    """The numbers of all functions of pores, (n, total), from those of the shared ones, (n, shared)."""
    data = pore_data(shapes)
    rates = strain_rates(data, orders, pore_points(data, rule))
    numbers = np.empty((len(x), orders.total))
    _take_bubbles(rates.reshape(*rates.shape[:2], -1), x, numbers)
    return numbers


def strain_rates(data: Complex, orders: Orders, points: Points) -> Array:
    """2 psi_xy and psi_yy - psi_xx times roots of weights, (n, functions, 2, Q)."""
    psi, root = values(data, orders, points), points.rows[:, None, ROOT]
    return np.stack([2.0 * root * psi[:, :, 4], root * (psi[:, :, 5] - psi[:, :, 3])], axis=2)


def values(data: Complex, orders: Orders, points: Points) -> Array:
    """The functions with their derivatives, psi ... psi_yy, (n, functions, 6, Q)."""
    out = np.zeros((len(data), orders.total, 6, points.rows.shape[2]))
    _take_values(data, orders, points.rows, room_for(orders), out)
    return out


class Work(NamedTuple):
    """Room for one pore.

    Attributes:
        points: its points.
        rates: of all functions, rows of 2 Q, one after the other.
        pairs: the same as complex numbers, rows of Q.
        room: to make them.
        total: how many functions there are.
    """

    points: Array
    rates: Array
    pairs: Complex
    room: Array
    total: int


@compiled
def _take_forms(data: Complex, rule: Rule, orders: Orders, work: Work, forms: PoreForms) -> None:
    """The forms of all pores, one after the other."""
    shared, ends = forms.K.shape[1], np.empty(4, np.int64)
    for e in range(len(data)):
        fill_pore(data[e], rule, work.points, ends)
        Q = ends[3]
        pairs = work.pairs[: work.total * Q].reshape((work.total, Q))
        for q in range(0, Q, AT_ONCE):
            last = min(q + AT_ONCE, Q)
            take_functions(data[e], orders, Target(work.points[:, q:last], work.room, pairs[:, q:last]))
        rates = work.rates[: work.total * 2 * Q].reshape((work.total, 2 * Q))
        S, B = rates[:shared], rates[shared:]
        # Whatever X is, this is the dissipation of flows: positive, an upper bound, off by X's error squared.
        take_off(S, least_bubbles(S, B), B)
        squares(S, forms.K[e])
        forms.area[e], forms.least[e] = work.points[WEIGHT, :Q].sum(), work.points[WEIGHT, :Q].min()


@compiled
def _take_bubbles(rates: Array, x: Array, numbers: Array) -> None:
    """The numbers of all functions from x, those of the shared ones."""
    shared = x.shape[1]
    for e in range(len(x)):
        X = least_bubbles(rates[e, :shared], rates[e, shared:])
        numbers[e, :shared] = x[e]
        for b in range(len(X)):
            numbers[e, shared + b] = -(X[b] * x[e]).sum()


@compiled
def _take_values(data: Complex, orders: Orders, points: Array, room: Array, out: Array) -> None:
    """All functions at all points of all pores."""
    Q = out.shape[3]
    for e in range(len(out)):
        for q in range(0, Q, AT_ONCE):
            last = min(q + AT_ONCE, Q)
            take_functions(data[e], orders, Target(points[e, :, q:last], room, out[e, :, :, q:last]))
