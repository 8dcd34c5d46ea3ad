"""What the trial functions of a pore are made of, at its points (see `fsi.pores.trial`).

Each weight is one of the functions in an array of jets, under the name and number given here.
"""

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.compiled import inlined, vectorised
from fsi.pores.jets import Jet, load, plus, product, reciprocal, shifted, store
from fsi.pores.pore_data import (
    CENTRE,
    DIRECTION,
    FIRST,
    IS_CORNER,
    IS_WALL,
    LINE,
    NORMAL,
    SIGN,
    Complex,
)
from fsi.pores.quadrature import DISTANCE, X, Y

# The first of three, one of each vertex or side, but for BUBBLE and SUM.
DISTANCES = 0  # d_v
SQUARE = 3  # e_v^2
VERTEX = 6  # l_v
BLEND = 9  # l^2 (3 - 2 l) + 2 l_1 l_2 l_3
PAIR = 12  # l_i^2 l_j^2 of sides
WIDE = 15  # 2 l_i^2 l_j^2 (d_i + d_j) of sides
SLOPE_X = 18  # what multiplies the x-derivative of Psi_v
SLOPE_Y = 21
BUBBLE = 24  # l_1 l_2 l_3
SUM = 25  # 1 / (q_1 + q_2 + q_3); then free for others
WEIGHTS = 26  # their number


@vectorised
def make_weights(pore: Complex, points: Array, jets: Array) -> None:
    """All weights of a pore at its points, (ROWS, n), n <= AT_ONCE."""
    n, total = points.shape[1], jets[SUM]
    for v in range(3):
        _distance(pore[v], points, points[DISTANCE + v], jets[DISTANCES + v])
        _square(pore[v], points, jets[SQUARE + v])
    for v in range(3):
        _unscaled(n, v, jets)
    q0, q1, q2, bubble = jets[VERTEX], jets[VERTEX + 1], jets[VERTEX + 2], jets[BUBBLE]
    for w in range(n):
        q = plus(1.0, load(q0, w), 1.0, load(q1, w))
        store(total, w, reciprocal(plus(1.0, q, 1.0, load(q2, w))))
    for v in range(3):
        _scale(n, jets[VERTEX + v], total)
    for w in range(n):
        store(bubble, w, product(product(load(q0, w), load(q1, w)), load(q2, w)))
    for v in range(3):
        _blend(n, jets[VERTEX + v], bubble, jets[BLEND + v])
        _pair(n, v, jets)
    for v in range(3):
        _slopes(n, v, pore, jets)


@inlined
def affine(x: float, y: float, slope: complex, constant: float) -> Jet:
    """constant + slope . (x, y)."""
    value = constant + slope.real * x + slope.imag * y
    return value, complex(0.5 * slope.real, -0.5 * slope.imag), 0j, 0.0


@vectorised
def _distance(surface: Complex, points: Array, d: Array, out: Array) -> None:
    """The distance to a surface, whose values are given."""
    x, y, centre, normal = points[X], points[Y], surface[CENTRE], surface[NORMAL]
    wall, sign = surface[IS_WALL].real, surface[SIGN].real
    for w in range(len(x)):
        rx, ry = x[w] - centre.real, y[w] - centre.imag
        bend = (1.0 - wall) * sign / np.sqrt(rx * rx + ry * ry + wall)
        slope = complex(0.5 * (normal.real + bend * rx), -0.5 * (normal.imag + bend * ry))
        store(out, w, (d[w], slope, -bend * (slope * slope), 0.25 * bend))


@vectorised
def _square(side: Complex, points: Array, out: Array) -> None:
    """e_v^2."""
    x, y, slope, foot, one = points[X], points[Y], side[LINE], side[FIRST], side[IS_CORNER].real
    for w in range(len(x)):
        line = affine(x[w] - foot.real, y[w] - foot.imag, slope, one)
        store(out, w, product(line, line))


@vectorised
def _unscaled(n: int, v: int, jets: Array) -> None:
    """q_v = s_v d_i d_j, s_v = e_v^2 / (e_v^2 + e_i^2 e_j^2), in the place of l_v."""
    i, j = (v + 1) % 3, (v + 2) % 3
    d, f, out = jets[DISTANCES + i], jets[DISTANCES + j], jets[VERTEX + v]
    own, one, other = jets[SQUARE + v], jets[SQUARE + i], jets[SQUARE + j]
    for w in range(n):
        square = load(own, w)
        s = product(square, reciprocal(plus(1.0, square, 1.0, product(load(one, w), load(other, w)))))
        store(out, w, product(s, product(load(d, w), load(f, w))))


@vectorised
def _scale(n: int, q: Array, total: Array) -> None:
    """l_v in the place of q_v."""
    for w in range(n):
        store(q, w, product(load(q, w), load(total, w)))


@vectorised
def _blend(n: int, vertex: Array, bubble: Array, out: Array) -> None:
    """l^2 (3 - 2 l) + 2 l_1 l_2 l_3."""
    for w in range(n):
        own = load(vertex, w)
        cubic = product(product(own, own), shifted(-2.0, own, 3.0))
        store(out, w, plus(1.0, cubic, 2.0, load(bubble, w)))


@vectorised
def _pair(n: int, v: int, jets: Array) -> None:
    """The pair of side v, and the same times its width."""
    i, j = (v + 1) % 3, (v + 2) % 3
    a, b, d, f = jets[VERTEX + i], jets[VERTEX + j], jets[DISTANCES + i], jets[DISTANCES + j]
    pair, wide = jets[PAIR + v], jets[WIDE + v]
    for w in range(n):
        two = product(load(a, w), load(b, w))
        square = product(two, two)
        store(pair, w, square)
        store(wide, w, product(square, plus(2.0, load(d, w), 2.0, load(f, w))))


@vectorised
def _slopes(n: int, v: int, pore: Complex, jets: Array) -> None:
    """Of vertex v: side j leads away from it, side i towards it."""
    i, j = (v + 1) % 3, (v + 2) % 3
    a, b = pore[i, DIRECTION], pore[j, DIRECTION]
    towards, away, x, y = jets[WIDE + i], jets[WIDE + j], jets[SLOPE_X + v], jets[SLOPE_Y + v]
    for w in range(n):
        f, g = load(towards, w), load(away, w)
        store(x, w, plus(a.real, f, -b.real, g))
        store(y, w, plus(a.imag, f, -b.imag, g))
