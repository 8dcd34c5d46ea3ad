"""The trial functions of surfaces: rigid motions, and flows of fluid discs."""

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.compiled import inlined, vectorised
from fsi.pores.jets import Jet, load, plus, product
from fsi.pores.orders import CUBIC
from fsi.pores.pore_data import CENTRE, IS_WALL, RADIUS, REFERENCE, SIGN, Complex
from fsi.pores.quadrature import DISTANCE, ROOT, X, Y
from fsi.pores.target import Target, put
from fsi.pores.weights import BLEND, SLOPE_X, SLOPE_Y, WEIGHTS


@vectorised
def rigid(pore: Complex, v: int, to: Target, k: int) -> None:
    """U_x, U_y, omega and c of surface v, from function k on; walls do not turn."""
    centre, reference, sign = pore[v, CENTRE], pore[v, REFERENCE], pore[v, SIGN].real
    a, turns, root = pore[v, RADIUS].real, 1.0 - pore[v, IS_WALL].real, to.points[ROOT]
    x, y, d = to.points[X], to.points[Y], to.points[DISTANCE + v]
    b, sx, sy = to.room[BLEND + v], to.room[SLOPE_X + v], to.room[SLOPE_Y + v]
    U_x, U_y, omega, c = to.out[k], to.out[k + 1], to.out[k + 2], to.out[k + 3]
    for w in range(len(x)):
        blend = load(b, w)
        up, along = (y[w] - reference.imag, -0.5j, 0j, 0.0), (x[w] - reference.real, 0.5 + 0j, 0j, 0.0)
        put(U_x, root, w, plus(1.0, product(blend, up), 1.0, load(sy, w)))
        put(U_y, root, w, plus(-1.0, product(blend, along), -1.0, load(sx, w)))
        put(c, root, w, blend)
    for w in range(len(x)):
        # (|r|^2 - a^2) / 2 by the distance: its digits near the surface
        rx, ry = turns * (x[w] - centre.real), turns * (y[w] - centre.imag)
        value = 0.5 * turns * sign * d[w] * (np.sqrt(rx * rx + ry * ry) + a)
        half = (value, complex(0.5 * rx, -0.5 * ry), 0j, 0.5 * turns)
        across = product(load(sx, w), (rx, complex(0.5 * turns, 0.0), 0j, 0.0))
        upwards = product(load(sy, w), (ry, complex(0.0, -0.5 * turns), 0j, 0.0))
        slopes = plus(1.0, across, 1.0, upwards)
        put(omega, root, w, plus(-1.0, product(load(b, w), half), -1.0, slopes))


@vectorised
def fluid(pore: Complex, v: int, order: int, to: Target, k: int) -> int:
    """The functions of a fluid disc beyond the rigid ones, from k on, z = (x + i y) / a; the next k.

    They are Re and Im of phi + zb chi, phi = A z^n, chi = B z^(n + 1). Inside they are those of
    `inner_powers`. Only value and slope on the circle count outside, so that those from m = 4 on, which would
    grow, are continued by decaying ones of the same value and slope: with w = 1 / zb

        A w^m + B |z|^2 w^m,  A + B = 1,  2 B - m = slope,

    whose real part is that of z^-m (A + B |z|^2), and whose imaginary part that of it times i.
    """
    powers = to.room[WEIGHTS:]
    _make_powers(pore[v], order + 3, to.points, powers)
    _biharmonic(pore, v, 2, (1.0, 0.0), (to, powers[order + 2 :], k))
    k += 2
    if order >= CUBIC:
        _biharmonic(pore, v, 3, (1.0, 0.0), (to, powers[order + 3 :], k))
        _biharmonic(pore, v, 1, (0.0, 1.0), (to, powers[order + 1 :], k + 2))
        k += 4
    for m in range(CUBIC + 1, order + 1):
        for n in (m, m - 2):
            B = 0.5 * (m + n)
            _biharmonic(pore, v, -n, (1.0 - B, B), (to, powers[order - n :], k))
            k += 2
    return k


@vectorised
def _make_powers(surface: Complex, lowest: int, points: Array, powers: Array) -> None:
    """z^n of a surface, n = -lowest ... 4, two rows of each."""
    x, y, centre, inverse = points[X], points[Y], surface[CENTRE], 1.0 / surface[RADIUS].real
    one, up, down = powers[lowest], powers[lowest + 1], powers[lowest - 1]
    for w in range(len(x)):
        zx, zy = inverse * (x[w] - centre.real), inverse * (y[w] - centre.imag)
        square = zx * zx + zy * zy
        one[0, w], one[1, w] = 1.0, 0.0
        up[0, w], up[1, w] = zx, zy
        down[0, w], down[1, w] = zx / square, -zy / square
    for n in range(2, 5):
        _multiply(len(x), powers[lowest + n - 1], up, powers[lowest + n])
    for n in range(2, lowest + 1):
        _multiply(len(x), powers[lowest - n + 1], down, powers[lowest - n])


@vectorised
def _multiply(n: int, f: Array, g: Array, out: Array) -> None:
    for w in range(n):
        power = complex(f[0, w], f[1, w]) * complex(g[0, w], g[1, w])
        out[0, w], out[1, w] = power.real, power.imag


@vectorised
def _biharmonic(
    pore: Complex, v: int, n: int, of: tuple[float, float], at: tuple[Target, Array, int]
) -> None:
    """The functions Re and Im of phi + zb chi, of A and B, k and k + 1; powers from z^(n - 3) on."""
    (A, B), (to, powers, k), centre, inverse = of, at, pore[v, CENTRE], 1.0 / pore[v, RADIUS].real
    second, third = inverse * inverse, inverse * inverse * inverse
    a1, a2, a3 = n * A, n * (n - 1) * A, n * (n - 1) * (n - 2) * A
    b1, b2, b3 = (n + 1) * B, (n + 1) * n * B, (n + 1) * n * (n - 1) * B
    # Im f = Re (-i f); of decaying functions it is that of the conjugate.
    i = complex(0.0, 1.0 if n < 0 else -1.0)
    x, y, root, re, im = to.points[X], to.points[Y], to.points[ROOT], to.out[k], to.out[k + 1]
    q3, q2, q1, q0, q = powers[0], powers[1], powers[2], powers[3], powers[4]
    b, sx, sy = to.room[BLEND + v], to.room[SLOPE_X + v], to.room[SLOPE_Y + v]
    for w in range(len(x)):
        zb = complex(inverse * (x[w] - centre.real), -inverse * (y[w] - centre.imag))
        p, p0, p1 = complex(q[0, w], q[1, w]), complex(q0[0, w], q0[1, w]), complex(q1[0, w], q1[1, w])
        p2, p3 = complex(q2[0, w], q2[1, w]), complex(q3[0, w], q3[1, w])
        # phi^(j) + zb chi^(j), then chi^(j)
        g0, g1 = A * p0 + B * (zb * p), inverse * (a1 * p1 + b1 * (zb * p0))
        g2, g3 = second * (a2 * p2 + b2 * (zb * p1)), third * (a3 * p3 + b3 * (zb * p2))
        c0, c1, c2 = inverse * B * p, second * b1 * p0, third * b2 * p1
        made = (load(b, w), load(sx, w), load(sy, w))
        put(re, root, w, _extended(made, (g0, g1, g2, g3, c0, c1, c2)))
        put(im, root, w, _extended(made, (i * g0, i * g1, i * g2, i * g3, i * c0, i * c1, i * c2)))


type Goursat = tuple[complex, complex, complex, complex, complex, complex, complex]


@inlined
def _extended(weights: tuple[Jet, Jet, Jet], f: Goursat) -> Jet:
    """The trial function of F = Re (phi + zb chi) on a surface: blend F + slope . grad F."""
    (blend, slope_x, slope_y), (g0, g1, g2, g3, c0, c1, c2) = weights, f
    first, second, mixed = 0.5 * (g1 + c0.conjugate()), 0.5 * g2, c1.real
    third, beside = 0.5 * g3, 0.5 * c2  # F_zzz and F_zzzb
    F = (g0.real, first, second, mixed)
    F_x = (2.0 * first.real, second + mixed, third + beside, c2.real)
    over, up = second - mixed, third - beside  # F_y = i (F_z - F_zb)
    F_y = (-2.0 * first.imag, complex(-over.imag, over.real), complex(-up.imag, up.real), -c2.imag)
    return plus(1.0, product(blend, F), 1.0, plus(1.0, product(slope_x, F_x), 1.0, product(slope_y, F_y)))
