"""The trial functions of a pore: stream functions, u = (psi_y, -psi_x), with no slip built in.

A surface v that moves rigidly imposes psi and grad psi through four numbers (U_x, U_y, omega, c),

    Psi_v(x) = c + U_x (y - y_v) - U_y (x - x_v) - omega (|x - x_v|^2 - a_v^2) / 2,

c being psi where the narrowest neck ends (in U_x and U_y x_v is that point: what slides in it makes no flux),
and c_w - c_v is the flux through the neck between v and w. With d_v the distance to surface v and e_v the
distance to the line of side v, 1 at the arc of vertex v, the weights

    l_v = q_v / (q_1 + q_2 + q_3),  q_v = s_v d_i d_j,  s_v = e_v^2 / (e_v^2 + e_i^2 e_j^2)    (i, j the
    others)

are 1 with zero slope on surface v and 0 with zero slope on the two others; on side v they are (0, t, 1 - t),
t = d_j / (d_i + d_j), with slopes that only d_i and d_j determine, hence the same in both pores that share
it. So

    psi = sum_v (l_v^2 (3 - 2 l_v) + 2 l_1 l_2 l_3) Psi_v                       blending; the weights sum to 1
          - 2 sum_{v<w} l_v^2 l_w^2 (d_v + d_w) n_vw . grad(Psi_v - Psi_w)      cubic in necks: Reynolds
          + sum_{sides} l_i^2 l_j^2 P_k(l_j - l_i) (m_k + m'_k e / D)           modes of necks
          + l_1 l_2 l_3 p(x, y) + sum_{sides} l_i^2 l_j^2 e^2 p(e, l_j - l_i)   bubbles

is continuous with its gradient across necks (it lies in H^2 of all the fluid), moves with the bodies on their
surfaces, costs nothing where all move as one rigid body, and is complete as the degrees grow: all functions
are analytic in the pore, and bubbles vanish to second order exactly on its boundary.
"""

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

from fsi.pores.jets import Formulas, Jet, JetProgram, Sum, program
from fsi.pores.pore_data import column
from fsi.pores.regions import NEXT, OTHER

RIGID = 4  # U_x, U_y, omega, c
STRAINED = 2  # the order of bodies whose stresslets are wanted: z^2 is a strain rate
CUBIC = 3  # the least order of fluid discs


class Orders(NamedTuple):
    """Which trial functions pores have.

    Attributes:
        modes: of each of the three sides.
        fluid: order M of the vertices that are discs of fluid, at least CUBIC: psi is a biharmonic
            polynomial of 4 M - 2 numbers there; STRAINED, with Re and Im of z^2, of bodies that are tested by
            a strain rate, 0 of others.
        bubbles: the degree of p(x, y).
        neck_bubbles: degrees + 1 of p(e, l_j - l_i) along and across each neck; 0 for none.
    """

    modes: tuple[int, int, int]
    fluid: tuple[int, int, int]
    bubbles: int
    neck_bubbles: int

    @property
    def shared(self) -> int:
        """How many functions belong to surfaces and necks; those that follow are bubbles."""
        return sum(numbers_of(order) for order in self.fluid) + sum(self.modes)

    @property
    def total(self) -> int:
        """How many functions there are."""
        return self.shared + (self.bubbles + 1) * (self.bubbles + 2) // 2 + 3 * self.neck_bubbles**2


class Weights(NamedTuple):
    """What trial functions are made of, at points.

    Attributes:
        vertex: l of the three vertices.
        blend: l^2 (3 - 2 l) + 2 l_1 l_2 l_3 of the vertices.
        slope: what multiplies the two components of grad Psi_v, of the vertices.
        pair: l_i^2 l_j^2 of the sides.
        across: e / D of the sides, zero there and positive inside, D the distance of the centres.
        bubble: l_1 l_2 l_3.
    """

    vertex: list[Jet]
    blend: list[Jet]
    slope: list[tuple[Jet, Jet]]
    pair: list[Jet]
    across: list[Jet]
    bubble: Jet


def numbers_of(order: int) -> int:
    """How many numbers a fluid disc of that order has, or a surface that is none, of order 0."""
    return 4 * order - 2 if order else RIGID


@cache
def trial_functions(orders: Orders) -> JetProgram:
    """All trial functions of pores of these orders: of surfaces, of sides, bubbles."""
    formulas = Formulas()
    return program(formulas, _functions(formulas, orders))


def _functions(formulas: Formulas, orders: Orders) -> Iterator[Sum]:
    weights = _weights(formulas)
    for v in range(3):
        yield from _surface(formulas, v, orders, weights)
    for v in range(3):
        yield from _modes(v, orders, weights)
    yield from _bubbles(formulas, orders.bubbles, weights)
    for v in range(3):
        yield from _neck_bubbles(v, orders.neck_bubbles, weights)


def _weights(formulas: Formulas) -> Weights:
    """The weights and what is made of them."""
    d = [formulas.distance(v, column("distance", v)) for v in range(3)]
    lines = [formulas.affine(column("line", v)) for v in range(3)]
    squares = [e * e for e in lines]
    q = []
    for v, i, j in zip(range(3), NEXT, OTHER, strict=True):
        s = squares[v] * (squares[v] + squares[i] * squares[j]).reciprocal()
        q.append(s * (d[i] * d[j]))
    total = (q[0] + q[1] + q[2]).reciprocal()
    weight = [q[v] * total for v in range(3)]
    square = [w * w for w in weight]
    bubble = weight[0] * weight[1] * weight[2]
    blend = [square[v] * weight[v].scaled(-2.0).plus(3.0) + bubble.scaled(2.0) for v in range(3)]
    pair = [square[i] * square[j] for i, j in zip(NEXT, OTHER, strict=True)]
    wide = [(pair[v] * (d[NEXT[v]] + d[OTHER[v]])).scaled(2.0) for v in range(3)]
    slope = []
    for i, j in zip(NEXT, OTHER, strict=True):
        # Side j leads away from vertex v, side i towards it.
        x, y = (
            wide[i].by(column("direction", i) + k) - wide[j].by(column("direction", j) + k) for k in (0, 1)
        )
        slope.append((x, y))
    across = [formulas.affine(column("across", v)) for v in range(3)]
    return Weights(weight, blend, slope, pair, across, bubble)


def _surface(formulas: Formulas, v: int, orders: Orders, weights: Weights) -> Iterator[Sum]:
    """The functions of the numbers of surface v."""
    blend, (slope_x, slope_y) = weights.blend[v], weights.slope[v]
    yield [(blend, formulas.affine(column("up", v))), (slope_y, None)]
    yield [(blend, formulas.affine(column("along", v)).scaled(-1.0)), (slope_x.scaled(-1.0), None)]
    turn = [formulas.affine(column(f"turn {axis}", v)).scaled(-1.0) for axis in "xy"]
    half = formulas.half_square(v, column("half square", v)).scaled(-1.0)
    yield [(blend, half), (slope_x, turn[0]), (slope_y, turn[1])]
    yield [(blend, None)]
    if orders.fluid[v]:
        x, y = (formulas.affine(column(f"{axis} / a", v)) for axis in "xy")
        slope_x, slope_y = (slope.by(column("1 / a", v)) for slope in (slope_x, slope_y))
        for f, fx, fy in _fluid(x, y, orders.fluid[v]):
            yield [(blend, f), (slope_x, fx), (slope_y, fy)]


def _fluid(x: Jet, y: Jet, order: int) -> Iterator[tuple[Jet, Jet, Jet]]:
    """f, f_x, f_y of the functions of a fluid disc beyond the rigid ones, z = x + i y, |z| = 1 on its circle.

    Inside they are those of `inner_powers`. Only value and slope on the circle count outside, so that those
    from m = 4 on, which would grow, are continued by decaying ones of the same value and slope,

        A w^m + B |z|^2 w^m,  w = 1 / conj(z);   A + B = 1,  2 B - m = slope.
    """
    square = x * x + y * y
    inverse = square.reciprocal()
    z = _powers(x, y, CUBIC)
    for m in range(2, min(order, CUBIC) + 1):
        for part in range(2):
            yield z[m][part], z[m - 1][part].scaled(m), z[m - 1][1 - part].scaled(m * (2 * part - 1))
    for part, f in enumerate((x, y) if order >= CUBIC else ()):
        fx, fy = (x * f).scaled(2.0), (y * f).scaled(2.0)
        yield square * f, fx + square if part == 0 else fx, fy if part == 0 else fy + square
    w = _powers(x * inverse, y * inverse, order + 1)
    for m in range(4, order + 1):
        for k, slope in ((m, m), (m - 2, m)):
            B = 0.5 * (slope + k)
            weight = square.scaled(B).plus(1.0 - B)
            for part in range(2):
                # d w^k / dx = -k w^(k+1), d w^k / dy = i k w^(k+1)
                f, gx = w[k][part], w[k + 1][part].scaled(-k)
                gy = w[k + 1][1 - part].scaled(-k if part == 0 else k)
                yield (
                    weight * f,
                    weight * gx + (x * f).scaled(2.0 * B),
                    weight * gy + (y * f).scaled(2.0 * B),
                )


def _powers(x: Jet, y: Jet, order: int) -> dict[int, tuple[Jet, Jet]]:
    """Re and Im of (x + i y)^m, m = 1 ... order."""
    powers = {1: (x, y)}
    for m in range(1, order):
        re, im = powers[m]
        powers[m + 1] = (re * x - im * y, re * y + im * x)
    return powers


def _modes(v: int, orders: Orders, weights: Weights) -> Iterator[Sum]:
    """The modes of side v: P_0, e P_0, P_1, e P_1, P_2, e P_2 ...; beside a fluid disc P_1 is the second.

    They belong to the neck: seen against its direction both l_j - l_i and e change their signs.
    """
    number, turn = orders.modes[v], column("turn", v)
    P = (weights.vertex[OTHER[v]] - weights.vertex[NEXT[v]]).by(turn).legendre(number // 2 + 2)
    e = weights.across[v].by(turn)
    order = [(k % 2, k // 2) for k in range(max(number, 3))]
    if max(orders.fluid[NEXT[v]], orders.fluid[OTHER[v]]) >= CUBIC:
        order[1], order[2] = order[2], order[1]
    for odd, degree in order[:number]:
        yield [(weights.pair[v], e * P[degree] if odd else P[degree])]


def _bubbles(formulas: Formulas, degree: int, weights: Weights) -> Iterator[Sum]:
    """l_1 l_2 l_3 P_i(x) P_j(y), i + j <= degree, in coordinates that are 1 at the farthest arc."""
    x, y = (formulas.affine(column(f"{axis} / size")).legendre(degree + 1) for axis in "xy")
    for i in range(degree + 1):
        f = weights.bubble * x[i]
        for j in range(degree + 1 - i):
            yield [(f, y[j])]


def _neck_bubbles(v: int, number: int, weights: Weights) -> Iterator[Sum]:
    """l_i^2 l_j^2 e^2 P_c(2 e - 1) P_d(l_j - l_i) of side v."""
    e = weights.across[v]
    base = weights.pair[v] * (e * e)
    along = e.scaled(2.0).plus(-1.0).legendre(number)
    over = (weights.vertex[OTHER[v]] - weights.vertex[NEXT[v]]).legendre(number)
    for c in range(number):
        f = base * along[c]
        for d in range(number):
            yield [(f, over[d])]
