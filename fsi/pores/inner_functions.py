"""The trial functions of necks and of pores: modes and bubbles."""

from fsi.bodies.configuration import Array
from fsi.pores.compiled import vectorised
from fsi.pores.jets import legendre, load, plus, product, shifted, store
from fsi.pores.pore_data import ACROSS, FIRST, MIDDLE, SIZE, TURN, Complex
from fsi.pores.quadrature import ROOT, X, Y
from fsi.pores.target import Target, put
from fsi.pores.weights import BUBBLE, PAIR, SUM, VERTEX, WEIGHTS, affine

ALONG = 12  # where the second list of polynomials begins


@vectorised
def modes(pore: Complex, v: int, number: int, to: Target, k: int) -> int:
    """The modes of side v: P_0, e P_0, P_1, e P_1, P_2, e P_2 ...; the next k.

    Beside a fluid disc, where the number is negative, P_1 is the second. They belong to the neck: seen
    against its direction both l_j - l_i and e change their signs.
    """
    turn, foot, x, y, root = pore[v, TURN].real, pore[v, FIRST], to.points[X], to.points[Y], to.points[ROOT]
    slope, pair, P = turn * pore[v, ACROSS], to.room[PAIR + v], to.room[WEIGHTS:]
    _differences(v, turn, abs(number) // 2 + 2, to)
    for m in range(abs(number)):
        odd, degree = m % 2, m // 2
        if number < 0 and (m == 1 or m == 2):
            odd, degree = 1 - odd, 1 - degree
        out, polynomial = to.out[k + m], P[degree]
        if odd:
            for w in range(len(x)):
                f = product(load(pair, w), affine(x[w] - foot.real, y[w] - foot.imag, slope, 0.0))
                put(out, root, w, product(f, load(polynomial, w)))
        else:
            for w in range(len(x)):
                put(out, root, w, product(load(pair, w), load(polynomial, w)))
    return k + abs(number)


@vectorised
def _differences(v: int, turn: float, number: int, to: Target) -> None:
    """P_0, P_1 ... of turn (l_j - l_i) of side v."""
    room, n = to.room, to.points.shape[1]
    first, second, difference = room[VERTEX + (v + 1) % 3], room[VERTEX + (v + 2) % 3], room[WEIGHTS + 1]
    for w in range(n):
        store(difference, w, plus(turn, load(second, w), -turn, load(first, w)))
    legendre(room[WEIGHTS:], number, n)


@vectorised
def bubbles(pore: Complex, degree: int, to: Target, k: int) -> int:
    """l_1 l_2 l_3 P_i(x) P_j(y), i + j <= degree, x and y 1 at the farthest arc; the next k."""
    h, root, n = 0.5 / pore[0, SIZE].real, to.points[ROOT], to.points.shape[1]
    bubble, base, of_x, of_y = (
        to.room[BUBBLE],
        to.room[SUM],
        to.room[WEIGHTS:],
        to.room[WEIGHTS + degree + 1 :],
    )
    middle = pore[0, MIDDLE]
    _polynomials(to.points[X], middle.real, 2.0 * h, degree, of_x)
    _polynomials(to.points[Y], middle.imag, 2.0 * h, degree, of_y)
    for i in range(degree + 1):
        P = of_x[i]
        for w in range(n):
            x = (P[0, w], complex(h * P[1, w], 0.0), complex(h * h * P[2, w], 0.0), h * h * P[2, w])
            store(base, w, product(load(bubble, w), x))
        for j in range(degree + 1 - i):
            P, out = of_y[j], to.out[k]
            for w in range(n):
                y = (P[0, w], complex(0.0, -h * P[1, w]), complex(-h * h * P[2, w], 0.0), h * h * P[2, w])
                put(out, root, w, product(load(base, w), y))
            k += 1
    return k


@vectorised
def _polynomials(x: Array, middle: float, scale: float, degree: int, P: Array) -> None:
    """Legendre's of scale (x - middle), up to a degree, with two derivatives, three rows of each."""
    one, t = P[0], P[1]
    for w in range(len(x)):
        one[0, w], one[1, w], one[2, w] = 1.0, 0.0, 0.0
        t[0, w], t[1, w], t[2, w] = scale * (x[w] - middle), 1.0, 0.0
    for j in range(1, degree):
        a, b, new, c = P[j - 1], P[j], P[j + 1], 2 * j + 1
        for w in range(len(x)):
            new[0, w] = (c * t[0, w] * b[0, w] - j * a[0, w]) / (j + 1)
            new[1, w] = a[1, w] + c * b[0, w]
            new[2, w] = a[2, w] + c * b[1, w]


@vectorised
def neck_bubbles(pore: Complex, v: int, number: int, to: Target, k: int) -> int:
    """l_i^2 l_j^2 e^2 P_c(2 e - 1) P_d(l_j - l_i) of side v; the next k."""
    slope, foot, x, y = pore[v, ACROSS], pore[v, FIRST], to.points[X], to.points[Y]
    pair, base, root, n = to.room[PAIR + v], to.room[SUM], to.points[ROOT], to.points.shape[1]
    over, along = to.room[WEIGHTS:], to.room[WEIGHTS + ALONG :]
    _differences(v, 1.0, max(number, 2), to)
    twice = along[1]
    for w in range(n):
        line = affine(x[w] - foot.real, y[w] - foot.imag, slope, 0.0)
        store(twice, w, shifted(2.0, line, -1.0))
    legendre(along, max(number, 2), n)
    for c in range(number):
        P = along[c]
        for w in range(n):
            line = affine(x[w] - foot.real, y[w] - foot.imag, slope, 0.0)
            store(base, w, product(product(load(pair, w), product(line, line)), load(P, w)))
        for d in range(number):
            P, out = over[d], to.out[k]
            for w in range(n):
                put(out, root, w, product(load(base, w), load(P, w)))
            k += 1
    return k
