"""The trial functions of necks and of pores: modes and bubbles."""

from fsi.arrays import Array
from fsi.machine.compiled import vectorised
from fsi.pores.jets import AT_ONCE, legendre, load, plus, product, shifted, store
from fsi.pores.pore_data import ACROSS, FIRST, MIDDLE, SIZE, TURN, Complex
from fsi.pores.quadrature import Y
from fsi.pores.target import Target, put, put_product
from fsi.pores.weights import BUBBLE, PAIR, SUM, VERTEX, WEIGHTS, affine

ALONG = 12  # where the second list of polynomials begins


@vectorised
def modes(pore: Complex, v: int, number: int, to: Target, k: int) -> int:
    """The modes of side v: P_0, e P_0, P_1, e P_1, P_2, e P_2 ...; the next k.

    Beside a fluid disc, where the number is negative, P_1 is the second. They belong to the neck: seen
    against its direction both l_j - l_i and e change their signs.
    """
    turn, even, odd, P = pore[v, TURN].real, to.room[PAIR + v], to.room[SUM], to.room[WEIGHTS:]
    _differences(v, turn, abs(number) // 2 + 2, to)
    if abs(number) > 1:
        _times_line(even, pore[v, FIRST], turn * pore[v, ACROSS], to.points, odd)
    for m in range(abs(number)):
        part, degree = m % 2, m // 2
        if number < 0 and (m == 1 or m == 2):
            part, degree = 1 - part, 1 - degree
        put_product(odd if part else even, P[degree], to.points, to.out[k + m, to.at :])
    return k + abs(number)


@vectorised
def _differences(v: int, turn: float, number: int, to: Target) -> None:
    """P_0, P_1 ... of turn (l_j - l_i) of side v."""
    _difference(to.room[VERTEX + (v + 1) % 3], to.room[VERTEX + (v + 2) % 3], turn, to.room[WEIGHTS + 1])
    legendre(to.room[WEIGHTS:], number)


@vectorised
def _difference(first: Array, second: Array, turn: float, out: Array) -> None:
    """turn (l_j - l_i)."""
    for w in range(AT_ONCE):
        store(out, w, plus(turn, load(second, w), -turn, load(first, w)))


@vectorised
def _times_line(f: Array, foot: complex, slope: complex, points: Array, out: Array) -> None:
    """f e, e of a slope from a foot on."""
    for w in range(AT_ONCE):
        e = affine(points[w] - foot.real, points[Y * AT_ONCE + w] - foot.imag, slope, 0.0)
        store(out, w, product(load(f, w), e))


@vectorised
def bubbles(pore: Complex, degree: int, to: Target, k: int) -> int:
    """l_1 l_2 l_3 P_i(x) P_j(y), i + j <= degree, x and y 1 at the farthest arc; the next k."""
    h, middle, bubble, base = 0.5 / pore[0, SIZE].real, pore[0, MIDDLE], to.room[BUBBLE], to.room[SUM]
    of_x, of_y = to.room[WEIGHTS:], to.room[WEIGHTS + degree + 1 :]
    _polynomials(to.points, middle.real, 2.0 * h, degree, of_x)
    _polynomials(to.points[Y * AT_ONCE :], middle.imag, 2.0 * h, degree, of_y)
    for i in range(degree + 1):
        _times_x(bubble, of_x[i], h, base)
        for j in range(degree + 1 - i):
            _put_times_y(base, of_y[j], h, to.points, to.out[k, to.at :])
            k += 1
    return k


@vectorised
def _times_x(f: Array, P: Array, h: float, out: Array) -> None:
    """f P(x), P with its derivatives by 2 h x."""
    for w in range(AT_ONCE):
        slope, bend = h * P[AT_ONCE + w], h * h * P[2 * AT_ONCE + w]
        store(out, w, product(load(f, w), (P[w], complex(slope, 0.0), complex(bend, 0.0), bend)))


@vectorised
def _put_times_y(f: Array, P: Array, h: float, points: Array, out: Array) -> None:
    """What comes out of f P(y), P with its derivatives by 2 h y."""
    for w in range(AT_ONCE):
        slope, bend = h * P[AT_ONCE + w], h * h * P[2 * AT_ONCE + w]
        put(out, points, w, product(load(f, w), (P[w], complex(0.0, -slope), complex(-bend, 0.0), bend)))


@vectorised
def _polynomials(x: Array, middle: float, scale: float, degree: int, P: Array) -> None:
    """Legendre's of scale (x - middle), up to a degree, with two derivatives."""
    _first_polynomials(x, middle, scale, P[0], P[1])
    for j in range(1, degree):
        _next_polynomial(P[j - 1], P[j], P[1], float(j), P[j + 1])


@vectorised
def _first_polynomials(x: Array, middle: float, scale: float, one: Array, t: Array) -> None:
    """P_0 and P_1."""
    for w in range(AT_ONCE):
        one[w], one[AT_ONCE + w], one[2 * AT_ONCE + w] = 1.0, 0.0, 0.0
        t[w], t[AT_ONCE + w], t[2 * AT_ONCE + w] = scale * (x[w] - middle), 1.0, 0.0


@vectorised
def _next_polynomial(a: Array, b: Array, t: Array, j: float, out: Array) -> None:
    """P_j+1 of P_j-1, P_j and P_1."""
    c, inverse = 2.0 * j + 1.0, 1.0 / (j + 1.0)
    for w in range(AT_ONCE):
        out[w] = inverse * (c * t[w] * b[w] - j * a[w])
        out[AT_ONCE + w] = a[AT_ONCE + w] + c * b[w]
        out[2 * AT_ONCE + w] = a[2 * AT_ONCE + w] + c * b[AT_ONCE + w]


@vectorised
def neck_bubbles(pore: Complex, v: int, number: int, to: Target, k: int) -> int:
    """l_i^2 l_j^2 e^2 P_c(2 e - 1) P_d(l_j - l_i) of side v; the next k."""
    slope, foot, pair, base = pore[v, ACROSS], pore[v, FIRST], to.room[PAIR + v], to.room[SUM]
    over, along = to.room[WEIGHTS:], to.room[WEIGHTS + ALONG :]
    _differences(v, 1.0, max(number, 2), to)
    _twice_line(foot, slope, to.points, along[1])
    legendre(along, max(number, 2))
    for c in range(number):
        _times_square(pair, (foot, slope), to.points, along[c], base)
        for d in range(number):
            put_product(base, over[d], to.points, to.out[k, to.at :])
            k += 1
    return k


@vectorised
def _twice_line(foot: complex, slope: complex, points: Array, out: Array) -> None:
    """2 e - 1."""
    for w in range(AT_ONCE):
        e = affine(points[w] - foot.real, points[Y * AT_ONCE + w] - foot.imag, slope, 0.0)
        store(out, w, shifted(2.0, e, -1.0))


@vectorised
def _times_square(f: Array, line: tuple[complex, complex], points: Array, P: Array, out: Array) -> None:
    """f e^2 P, e of a slope from a foot on."""
    foot, slope = line
    for w in range(AT_ONCE):
        e = affine(points[w] - foot.real, points[Y * AT_ONCE + w] - foot.imag, slope, 0.0)
        store(out, w, product(product(load(f, w), product(e, e)), load(P, w)))
