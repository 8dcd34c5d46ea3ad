"""What the trial functions of a pore are made of, at its points (see `fsi.pores.trial`).

Each weight is one of the functions in an array of jets, under the name and number given here.
"""

import numpy as np

from fsi.arrays import Array
from fsi.machine.compiled import inlined, vectorised
from fsi.pores.jets import AT_ONCE, Jet, load, plus, product, reciprocal, scaled, shifted, store, times
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
from fsi.pores.quadrature import DISTANCE, Y

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
    """All weights of a pore at some points, as in `Target`.

    Each loop is a function of its rows: of rows of one array a compiler would not see that they are apart.
    """
    q0, q1, q2, bubble = jets[VERTEX], jets[VERTEX + 1], jets[VERTEX + 2], jets[BUBBLE]
    for v in range(3):
        _distance(pore[v], points, points[(DISTANCE + v) * AT_ONCE :], jets[DISTANCES + v])
        _square(pore[v], points, jets[SQUARE + v])
    for v in range(3):
        i, j = (v + 1) % 3, (v + 2) % 3
        squares = jets[SQUARE + v], jets[SQUARE + i], jets[SQUARE + j]
        _unscaled(squares, jets[DISTANCES + i], jets[DISTANCES + j], jets[VERTEX + v])
    _one_over_sum(q0, q1, q2, jets[SUM])
    for v in range(3):
        _scale(jets[VERTEX + v], jets[SUM])
    _triple(q0, q1, q2, bubble)
    for v in range(3):
        i, j = (v + 1) % 3, (v + 2) % 3
        _blend(jets[VERTEX + v], bubble, jets[BLEND + v])
        _pair(jets[VERTEX + i], jets[VERTEX + j], jets[PAIR + v])
        _wide(jets[DISTANCES + i], jets[DISTANCES + j], jets[PAIR + v], jets[WIDE + v])
    for v in range(3):  # side j leads away from vertex v, side i towards it
        i, j = (v + 1) % 3, (v + 2) % 3
        a, b, towards, away = pore[i, DIRECTION], pore[j, DIRECTION], jets[WIDE + i], jets[WIDE + j]
        _slope(a.real, towards, -b.real, away, jets[SLOPE_X + v])
        _slope(a.imag, towards, -b.imag, away, jets[SLOPE_Y + v])


@inlined
def affine(x: float, y: float, slope: complex, constant: float) -> Jet:
    """constant + slope . (x, y)."""
    value = constant + slope.real * x + slope.imag * y
    return value, complex(0.5 * slope.real, -0.5 * slope.imag), 0j, 0.0


@vectorised
def _distance(surface: Complex, points: Array, d: Array, out: Array) -> None:
    """The distance to a surface, whose values are given."""
    x, y, centre, normal = points, points[Y * AT_ONCE :], surface[CENTRE], surface[NORMAL]
    wall, sign = surface[IS_WALL].real, surface[SIGN].real
    for w in range(AT_ONCE):
        rx, ry = x[w] - centre.real, y[w] - centre.imag
        bend = (1.0 - wall) * sign / np.sqrt(rx * rx + ry * ry + wall)
        slope = complex(0.5 * (normal.real + bend * rx), -0.5 * (normal.imag + bend * ry))
        store(out, w, (d[w], slope, scaled(-bend, times(slope, slope)), 0.25 * bend))


@vectorised
def _square(side: Complex, points: Array, out: Array) -> None:
    """e_v^2."""
    x, y, slope, foot, one = points, points[Y * AT_ONCE :], side[LINE], side[FIRST], side[IS_CORNER].real
    for w in range(AT_ONCE):
        line = affine(x[w] - foot.real, y[w] - foot.imag, slope, one)
        store(out, w, product(line, line))


@vectorised
def _unscaled(squares: tuple[Array, Array, Array], d: Array, f: Array, out: Array) -> None:
    """q_v = s_v d_i d_j, s_v = e_v^2 / (e_v^2 + e_i^2 e_j^2), in the place of l_v."""
    own, one, other = squares
    for w in range(AT_ONCE):
        square = load(own, w)
        s = product(square, reciprocal(plus(1.0, square, 1.0, product(load(one, w), load(other, w)))))
        store(out, w, product(s, product(load(d, w), load(f, w))))


@vectorised
def _one_over_sum(q0: Array, q1: Array, q2: Array, out: Array) -> None:
    """1 / (q_1 + q_2 + q_3)."""
    for w in range(AT_ONCE):
        q = plus(1.0, load(q0, w), 1.0, load(q1, w))
        store(out, w, reciprocal(plus(1.0, q, 1.0, load(q2, w))))


@vectorised
def _scale(q: Array, total: Array) -> None:
    """l_v in the place of q_v."""
    for w in range(AT_ONCE):
        store(q, w, product(load(q, w), load(total, w)))


@vectorised
def _triple(a: Array, b: Array, c: Array, out: Array) -> None:
    """l_1 l_2 l_3."""
    for w in range(AT_ONCE):
        store(out, w, product(product(load(a, w), load(b, w)), load(c, w)))


@vectorised
def _blend(vertex: Array, bubble: Array, out: Array) -> None:
    """l^2 (3 - 2 l) + 2 l_1 l_2 l_3."""
    for w in range(AT_ONCE):
        own = load(vertex, w)
        cubic = product(product(own, own), shifted(-2.0, own, 3.0))
        store(out, w, plus(1.0, cubic, 2.0, load(bubble, w)))


@vectorised
def _pair(a: Array, b: Array, out: Array) -> None:
    """l_i^2 l_j^2."""
    for w in range(AT_ONCE):
        two = product(load(a, w), load(b, w))
        store(out, w, product(two, two))


@vectorised
def _wide(d: Array, f: Array, pair: Array, out: Array) -> None:
    """The pair of a side times twice its width."""
    for w in range(AT_ONCE):
        store(out, w, product(load(pair, w), plus(2.0, load(d, w), 2.0, load(f, w))))


@vectorised
def _slope(alpha: float, f: Array, beta: float, g: Array, out: Array) -> None:
    """alpha f + beta g."""
    for w in range(AT_ONCE):
        store(out, w, plus(alpha, load(f, w), beta, load(g, w)))
