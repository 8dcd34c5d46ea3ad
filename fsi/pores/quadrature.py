"""Points and weights in pores: three strips along the necks of each and the triangle that they leave.

A strip is ruled: the point P_i(t) on one surface runs from the foot of the neck to where the inscribed circle
touches, P_j(t) likewise on the other, and the strip is x = (1 - s) P_i(t) + s P_j(t), 0 < s, t < 1. The
points t gather in the neck as sinh(t T), T = arcsinh(span / sqrt(2 gap / (1/a_i + 1/a_j))). The three points
of touching span the triangle. All is smooth in each part, so that Gauss points converge exponentially;
distances to both surfaces of a strip are formed without cancellation, whatever the gap.
"""

from functools import cache
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.machine.compiled import compiled, inlined, internal
from fsi.pores.pore_data import (
    CENTRE,
    DIRECTION,
    FIRST,
    GAP,
    GATHERING,
    IS_WALL,
    MIDDLE,
    NORMAL,
    RADIUS,
    SECOND,
    SIGN,
    TOUCH,
    Complex,
    planar,
)
from fsi.pores.triangle import third

# Rows of points.
X, Y, DISTANCE, ROOT, WEIGHT = 0, 1, 2, 5, 6  # three distances; the root of the weight's size
ROWS = 7
_LONGEST = 60  # T of a gap of 1e-50 radii


class Rule(NamedTuple):
    """Points on (0, 1) and their weights, (2, .).

    Attributes:
        along: strips, (n, 2, .): of the n-th list the first `first + n` are points; a strip takes the list
            that its T times `gathering` asks for.
        first: how many points the first list has.
        gathering: points more for each unit of T.
        across: strips.
        third: points of a third of the triangle, u from its middle outwards and t along its side, and weights
            whose sum is 1/2, (3, .).
    """

    along: Array
    first: int
    gathering: float
    across: Array
    third: Array


class Points(NamedTuple):
    """At most Q points of each of n pores.

    Attributes:
        rows: X, Y, three from DISTANCE on, ROOT, WEIGHT, (n, ROWS, Q); weights are 0 beyond the last point.
        ends: how many are in the strips of sides 0; 0, 1; 0, 1, 2; and in all, (n, 4).
    """

    rows: Array
    ends: NDArray[np.int64]

    @property
    def places(self) -> Array:
        """(x, y), (n, Q, 2)."""
        return np.moveaxis(self.rows[:, [X, Y]], 1, 2)


@cache
def rule(along: int, across: int, inside: int, gathering: float) -> Rule:
    """Gauss points `along` strips, more where they gather, and `across` them; of a degree inside."""
    lists = int(gathering * _LONGEST)
    table = np.zeros((lists, 2, along + lists - 1))
    for n, row in enumerate(table, along):
        row[:, :n] = _gauss(n)
    return Rule(table, along, gathering, _gauss(across), third(inside))


def uniform(along: Array, across: Array, inside: Array) -> Rule:
    """The same points in all strips; without weights."""
    u, t = (x.ravel() for x in np.meshgrid(inside[0], inside[0], indexing="ij"))
    return Rule(along[None], along.shape[1], 0.0, across, np.stack([u, t, np.zeros_like(u)]))


@cache
def _gauss(n: int) -> Array:
    x, w = np.polynomial.legendre.leggauss(n)
    return np.stack([(x + 1.0) / 2.0, w / 2.0])


def pore_points(data: Complex, rule: Rule) -> Points:
    """The points of pores."""
    points = Points(np.zeros((len(data), ROWS, most_points(data, rule))), np.zeros((len(data), 4), np.int64))
    _fill(data, rule, points)
    places, beyond = points.rows[:, :ROOT], np.arange(points.rows.shape[2]) >= points.ends[:, 3:]
    np.copyto(places, places[..., :1].copy(), where=beyond[:, None])  # of fluid, where functions are finite
    return points


def points_at(data: Complex, x: Array) -> Points:
    """One point (x, y), (n, 2), of each pore, of weight 1."""
    r = planar(x)[:, None] - data[..., CENTRE]
    flat = (data[..., NORMAL].conj() * r).real
    bent = data[..., SIGN].real * (np.abs(r) - data[..., RADIUS].real)
    one = np.ones((len(x), 1))
    rows = np.concatenate([x, np.where(data[..., IS_WALL] == 1.0, flat, bent), one, one], axis=1)
    return Points(rows[..., None], np.ones((len(x), 4), np.int64))


def most_points(data: Complex, rule: Rule) -> int:
    """Of any of these pores."""
    asked = ceil(rule.gathering * float(data[..., GATHERING].real.max(initial=0.0)))
    along = rule.first + min(asked, len(rule.along) - 1)
    return int(3 * (along * rule.across.shape[1] + rule.third.shape[1]))


@compiled
def _fill(data: Complex, rule: Rule, points: Points) -> None:
    for e in range(len(data)):
        fill_pore(data[e], rule, points.rows[e], points.ends[e])


@internal
def fill_pore(pore: Complex, rule: Rule, rows: Array, ends: NDArray[np.int64]) -> None:
    """Make the points of a pore, (ROWS, .), and say where parts end, (4,)."""
    q = int(np.int64(0))  # of one type throughout, so that nothing is compiled twice
    for v in range(3):
        q = _strip(pore, v, rule, rows, q)
        ends[v] = q
    for v in range(3):
        q = _triangle(pore, v, rule, rows, q)
    ends[3] = q
    for p in range(q):
        rows[ROOT, p] = np.sqrt(abs(rows[WEIGHT, p]))


@internal
def _strip(pore: Complex, v: int, rule: Rule, rows: Array, q: int) -> int:
    """The strip along side v, from point q on; the next q."""
    i, j = (v + 1) % 3, (v + 2) % 3
    T, first, second = max(pore[v, GATHERING].real, 1e-3), pore[v, FIRST], pore[v, SECOND]
    more = min(int(np.ceil(rule.gathering * pore[v, GATHERING].real)), len(rule.along) - 1)
    for k in range(rule.first + more):
        tau, weight = rule.along[more, 0, k], rule.along[more, 1, k]
        t, dt = np.sinh(tau * T) / np.sinh(T), weight * T * np.cosh(tau * T) / np.sinh(T)
        at_i, along_i = _arc(pore, i, first, t)
        at_j, along_j = _arc(pore, j, second, t)
        # The vector across is formed from what is small in a narrow neck.
        across = pore[v, GAP].real * pore[v, DIRECTION] + (at_j - at_i)
        on_i, on_j = first + at_i, second + at_j
        for m in range(rule.across.shape[1]):
            s = rule.across[0, m]
            x, tangent = on_i + s * across, (1.0 - s) * along_i + s * along_j
            rows[X, q], rows[Y, q] = x.real, x.imag
            rows[WEIGHT, q] = _cross(across, tangent) * dt * rule.across[1, m]
            rows[DISTANCE + i, q] = _off(pore, i, on_i, s * across)
            rows[DISTANCE + j, q] = _off(pore, j, on_j, (s - 1.0) * across)
            rows[DISTANCE + v, q] = _distance(pore, v, x)
            q += 1
    return q


@internal
def _triangle(pore: Complex, v: int, rule: Rule, rows: Array, q: int) -> int:
    """The third of the triangle between points of touching along side v, from point q on; the next q.

    Points gather at its middle, so that no vertex of a pore is before another.
    """
    middle = pore[v, MIDDLE]
    first, second = pore[(v + 1) % 3, TOUCH] - middle, pore[(v + 2) % 3, TOUCH] - middle
    area = _cross(first, second)
    for k in range(rule.third.shape[1]):
        u, t = rule.third[0, k], rule.third[1, k]
        x = middle + u * ((1.0 - t) * first + t * second)
        rows[X, q], rows[Y, q] = x.real, x.imag
        rows[WEIGHT, q] = area * rule.third[2, k]
        for surface in range(3):
            rows[DISTANCE + surface, q] = _distance(pore, surface, x)
        q += 1
    return q


@inlined
def _cross(a: complex, b: complex) -> float:
    """a_x b_y - a_y b_x."""
    return a.real * b.imag - a.imag * b.real


@internal
def _arc(pore: Complex, k: int, foot: complex, t: float) -> tuple[complex, complex]:
    """P(t) - foot on surface k and P'(t); P(1) is the point of touching."""
    if pore[k, IS_WALL].real > 0.0:
        straight = pore[k, TOUCH] - foot
        return t * straight, straight
    f, g = foot - pore[k, CENTRE], pore[k, TOUCH] - pore[k, CENTRE]
    full = np.arctan2(_cross(f, g), f.real * g.real + f.imag * g.imag)
    sine, versine = np.sin(full * t), 2.0 * np.sin(0.5 * full * t) ** 2
    turned = complex(-f.imag, f.real)
    return sine * turned - versine * f, full * ((1.0 - versine) * turned - sine * f)


@inlined
def _off(pore: Complex, k: int, on: complex, step: complex) -> float:
    """Distance to surface k a step away from a point on it.

    |x|^2 - a^2 = (|x| - a) (|x| + a) keeps the digits of small steps.
    """
    if pore[k, IS_WALL].real > 0.0:
        n = pore[k, NORMAL]
        return float(n.real * step.real + n.imag * step.imag)
    a, r = pore[k, RADIUS].real, 2.0 * (on - pore[k, CENTRE]) + step
    square = r.real * step.real + r.imag * step.imag
    return float(pore[k, SIGN].real * square / (a + np.sqrt(max(a * a + square, 0.0))))


@inlined
def _distance(pore: Complex, k: int, x: complex) -> float:
    """Distance of a point to surface k."""
    r, n = x - pore[k, CENTRE], pore[k, NORMAL]
    if pore[k, IS_WALL].real > 0.0:
        return float(n.real * r.real + n.imag * r.imag)
    length = np.sqrt(r.real * r.real + r.imag * r.imag)
    return float(pore[k, SIGN].real * (length - pore[k, RADIUS].real))
