"""The trial functions of surfaces: rigid motions, and flows of fluid discs."""

import numpy as np

from fsi.arrays import Array
from fsi.machine.compiled import inlined, vectorised
from fsi.pores.jets import AT_ONCE, Jet, combined, load, plus, product, scaled, times
from fsi.pores.orders import CUBIC
from fsi.pores.pore_data import CENTRE, IS_WALL, RADIUS, REFERENCE, SIGN, Complex
from fsi.pores.quadrature import DISTANCE, Y
from fsi.pores.target import Target, put
from fsi.pores.weights import BLEND, SLOPE_X, SLOPE_Y, WEIGHTS


@vectorised
def rigid(pore: Complex, v: int, to: Target, k: int) -> None:
    """U_x, U_y, omega and c of surface v, from function k on; walls do not turn."""
    weights = to.room[BLEND + v], to.room[SLOPE_X + v], to.room[SLOPE_Y + v]
    _translations(
        pore[v, REFERENCE],
        weights,
        to.points,
        (to.out[k, to.at :], to.out[k + 1, to.at :], to.out[k + 3, to.at :]),
    )
    _rotation(pore[v], weights, to.points, to.points[(DISTANCE + v) * AT_ONCE :], to.out[k + 2, to.at :])


type Three = tuple[Array, Array, Array]


@vectorised
def _translations(reference: complex, weights: Three, points: Array, out: Three) -> None:
    """U_x, U_y and c of a surface."""
    (b, sx, sy), (U_x, U_y, c) = weights, out
    for w in range(AT_ONCE):
        blend, x, y = load(b, w), points[w] - reference.real, points[Y * AT_ONCE + w] - reference.imag
        put(U_x, points, w, plus(1.0, product(blend, (y, -0.5j, 0j, 0.0)), 1.0, load(sy, w)))
        put(U_y, points, w, plus(-1.0, product(blend, (x, 0.5 + 0j, 0j, 0.0)), -1.0, load(sx, w)))
        put(c, points, w, blend)


@vectorised
def _rotation(surface: Complex, weights: Three, points: Array, d: Array, out: Array) -> None:
    """omega of a surface with distances d."""
    (b, sx, sy), centre, sign, a = weights, surface[CENTRE], surface[SIGN].real, surface[RADIUS].real
    turns = 1.0 - surface[IS_WALL].real
    for w in range(AT_ONCE):
        # (|r|^2 - a^2) / 2 by the distance: its digits near the surface
        x, y = turns * (points[w] - centre.real), turns * (points[Y * AT_ONCE + w] - centre.imag)
        value = 0.5 * turns * sign * d[w] * (np.sqrt(x * x + y * y) + a)
        half = (value, complex(0.5 * x, -0.5 * y), 0j, 0.5 * turns)
        across = product(load(sx, w), (x, complex(0.5 * turns, 0.0), 0j, 0.0))
        upwards = product(load(sy, w), (y, complex(0.0, -0.5 * turns), 0j, 0.0))
        slopes = plus(1.0, across, 1.0, upwards)
        put(out, points, w, plus(-1.0, product(load(b, w), half), -1.0, slopes))


@vectorised
def fluid(pore: Complex, v: int, order: int, to: Target, k: int) -> int:
    """The functions of a fluid disc beyond the rigid ones, from k on, z = (x + i y) / a; the next k.

    They are Re and Im of phi + zb chi, phi = A z^n, chi = B z^(n + 1). Inside they are those of
    `inner_powers`. Only value and slope on the circle count outside, so that those from m = 4 on, which would
    grow, are continued by decaying ones of the same value and slope: with w = 1 / zb

        A w^m + B |z|^2 w^m,  A + B = 1,  2 B - m = slope,

    whose real part is that of z^-m (A + B |z|^2), and whose imaginary part that of it times i.
    """
    powers, lowest = to.room[WEIGHTS:], order + 3 if order > CUBIC else 2
    _make_powers(pore[v], lowest, to.points, powers)
    _biharmonic(pore, v, (2, 1.0, 0.0), (to, powers[lowest - 1 :], k))
    k += 2
    if order >= CUBIC:
        _biharmonic(pore, v, (3, 1.0, 0.0), (to, powers[lowest:], k))
        _biharmonic(pore, v, (1, 0.0, 1.0), (to, powers[lowest - 2 :], k + 2))
        k += 4
    for m in range(CUBIC + 1, order + 1):
        for n in (m, m - 2):
            B = 0.5 * (m + n)
            _biharmonic(pore, v, (-n, 1.0 - B, B), (to, powers[lowest - n - 3 :], k))
            k += 2
    return k


@vectorised
def _make_powers(surface: Complex, lowest: int, points: Array, powers: Array) -> None:
    """z^n of a surface, n = -lowest ... 4, two numbers at each point."""
    up, down = powers[lowest + 1], powers[lowest - 1]
    _first_powers(surface, points, (powers[lowest], up, down))
    for n in range(2, 5):
        _multiply(powers[lowest + n - 1], up, powers[lowest + n])
    for n in range(2, lowest + 1):
        _multiply(powers[lowest - n + 1], down, powers[lowest - n])


@vectorised
def _first_powers(surface: Complex, points: Array, out: Three) -> None:
    """1, z, 1 / z."""
    (one, up, down), centre, inverse = out, surface[CENTRE], 1.0 / surface[RADIUS].real
    for w in range(AT_ONCE):
        x, y = inverse * (points[w] - centre.real), inverse * (points[Y * AT_ONCE + w] - centre.imag)
        square = x * x + y * y
        one[w], one[AT_ONCE + w] = 1.0, 0.0
        up[w], up[AT_ONCE + w] = x, y
        down[w], down[AT_ONCE + w] = x / square, -y / square


@inlined
def _at(f: Array, w: int) -> complex:
    """A power at point w."""
    return complex(f[w], f[AT_ONCE + w])


@vectorised
def _multiply(f: Array, g: Array, out: Array) -> None:
    for w in range(AT_ONCE):
        power = times(_at(f, w), _at(g, w))
        out[w], out[AT_ONCE + w] = power.real, power.imag


@vectorised
def _biharmonic(pore: Complex, v: int, of: tuple[int, float, float], at: tuple[Target, Array, int]) -> None:
    """The functions Re and Im of phi + zb chi, of n, A and B, k and k + 1; powers from z^(n - 3) on."""
    to, powers, k = at
    weights = to.room[BLEND + v], to.room[SLOPE_X + v], to.room[SLOPE_Y + v]
    rows = powers[0], powers[1], powers[2], powers[3], powers[4]
    _both_parts(pore[v], of, (to.points, rows), weights, (to.out[k, to.at :], to.out[k + 1, to.at :]))


type Five = tuple[Array, Array, Array, Array, Array]


@vectorised
def _both_parts(
    surface: Complex,
    of: tuple[int, float, float],
    at: tuple[Array, Five],
    weights: Three,
    out: tuple[Array, Array],
) -> None:
    """The same at points, of powers z^(n - 3) ... z^(n + 1)."""
    (n, A, B), (points, powers), (b, sx, sy), (re, im) = of, at, weights, out
    centre, inverse = surface[CENTRE], 1.0 / surface[RADIUS].real
    second, third = inverse * inverse, inverse * inverse * inverse
    # Im f = Re (-i f); of decaying functions it is that of the conjugate.
    sign = 1.0 if n < 0 else -1.0
    a1, a2, a3 = n * A, n * (n - 1) * A, n * (n - 1) * (n - 2) * A
    b1, b2, b3 = (n + 1) * B, (n + 1) * n * B, (n + 1) * n * (n - 1) * B
    q3, q2, q1, q0, q = powers
    for w in range(AT_ONCE):
        zb = complex(inverse * (points[w] - centre.real), -inverse * (points[Y * AT_ONCE + w] - centre.imag))
        p, p0, p1, p2, p3 = _at(q, w), _at(q0, w), _at(q1, w), _at(q2, w), _at(q3, w)
        # phi^(j) + zb chi^(j), then chi^(j)
        g0, g1 = combined(A, p0, B, times(zb, p)), combined(inverse * a1, p1, inverse * b1, times(zb, p0))
        g2 = combined(second * a2, p2, second * b2, times(zb, p1))
        g3 = combined(third * a3, p3, third * b3, times(zb, p2))
        c0, c1, c2 = scaled(inverse * B, p), scaled(second * b1, p0), scaled(third * b2, p1)
        f, made = (g0, g1, g2, g3, c0, c1, c2), (load(b, w), load(sx, w), load(sy, w))
        put(re, points, w, _extended(made, f))
        put(im, points, w, _extended(made, _turned(f, sign)))


type Goursat = tuple[complex, complex, complex, complex, complex, complex, complex]


@inlined
def _turned(f: Goursat, sign: float) -> Goursat:
    """These times i, or -i."""
    g0, g1, g2, g3, c0, c1, c2 = f
    a0, a1, a2, a3 = _times_i(g0, sign), _times_i(g1, sign), _times_i(g2, sign), _times_i(g3, sign)
    return a0, a1, a2, a3, _times_i(c0, sign), _times_i(c1, sign), _times_i(c2, sign)


@inlined
def _times_i(z: complex, sign: float) -> complex:
    return complex(-sign * z.imag, sign * z.real)


@inlined
def _extended(weights: tuple[Jet, Jet, Jet], f: Goursat) -> Jet:
    """The trial function of F = Re (phi + zb chi) on a surface."""
    g0, g1, g2, g3, c0, c1, c2 = f
    first = complex(0.5 * (g1.real + c0.real), 0.5 * (g1.imag - c0.imag))
    return extended(weights, (g0.real, first, scaled(0.5, g2), c1.real, scaled(0.5, g3), scaled(0.5, c2)))


type ThirdJet = tuple[float, complex, complex, float, complex, complex]
"""F, F_z, F_zz, F_zzb, F_zzz, F_zzzb of a real function."""


@inlined
def extended(weights: tuple[Jet, Jet, Jet], f: ThirdJet) -> Jet:
    """The trial function of F on a surface: blend F + slope . grad F."""
    (blend, slope_x, slope_y), (value, first, second, mixed, third, beside) = weights, f
    F = (value, first, second, mixed)
    F_x = (
        2.0 * first.real,
        complex(second.real + mixed, second.imag),
        combined(1.0, third, 1.0, beside),
        2.0 * beside.real,
    )
    over, up = complex(second.real - mixed, second.imag), combined(1.0, third, -1.0, beside)
    F_y = (-2.0 * first.imag, _times_i(over, 1.0), _times_i(up, 1.0), -2.0 * beside.imag)  # i (F_z - F_zb)
    return plus(1.0, product(blend, F), 1.0, plus(1.0, product(slope_x, F_x), 1.0, product(slope_y, F_y)))
