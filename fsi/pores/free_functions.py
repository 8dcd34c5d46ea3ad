"""The trial functions of surfaces on which psi is free, walls and bodies, for stresses in equilibrium.

With t along the surface and d off it, A and B the feet of the two necks of a pore there, t = 0 at A,

    Psi = f(t) + d g(t),

which has all linear functions: around a circle r cos(theta) = a cos(t / a) + d cos(t / a). What presses the
surfaces of a narrow neck apart makes phi linear beside it, without stress: were that not exact, it would cost
more than the neck. In the map w = t + i s (`fsi.pores.surface_maps`) d = a (exp(s / a) - 1).

f and g are cubic with values and slopes at A and B, which the pores beside have too, and in between
(1 - x^2)^2 P_k(x), which vanish to second order at both ends. Polynomials gather where necks are narrow, as
the points of `fsi.pores.quadrature` do: with w_A the distance from A at which the gap there is twice as wide,

    x = arsinh(t / w_A) / arsinh(h / w_A) - arsinh((h - t) / w_B) / arsinh(h / w_B),   h = t_B,

which is 2 t / h - 1 where necks are wide.
"""

import numpy as np

from fsi.arrays import Array
from fsi.machine.compiled import inlined, vectorised
from fsi.pores.jets import AT_ONCE, load, scaled, times
from fsi.pores.orders import CORNER
from fsi.pores.pore_data import (
    FIRST,
    GATHERING,
    IS_CORNER,
    NORMAL,
    SECOND,
    TOUCH,
    TURN,
    Complex,
)
from fsi.pores.quadrature import DISTANCE
from fsi.pores.surface_functions import ThirdJet, extended
from fsi.pores.surface_maps import Ends, bend_of, lay_flat
from fsi.pores.target import JETS, RATES, Target, put
from fsi.pores.weights import BLEND, SLOPE_X, SLOPE_Y, WEIGHTS

# Rows of room behind the weights: t and s; w', w'' and w'''; x and its derivatives; then polynomials, one row
# more than there are.
AT, MAPPED, GATHERED, POLYNOMIALS = WEIGHTS, WEIGHTS + 1, WEIGHTS + 2, WEIGHTS + 3


@vectorised
def knots(pore: Complex, v: int, free: tuple[int, int, int], to: Target, k: int) -> int:
    """Of side v: f, f', g, g' at each of its feet on such a surface, from k on; the next k.

    They belong to the neck: the foot at its first surface comes first.
    """
    i, j = (v + 1) % 3, (v + 2) % 3
    along = pore[v, TURN].real > 0.0
    for end in range(2):
        first = along == (end == 0)
        surface = i if first else j
        if free[surface] > 0 and pore[v, IS_CORNER].real == 0.0:
            foot = pore[v, FIRST] if first else pore[v, SECOND]
            other = pore[j, SECOND] if first else pore[i, FIRST]
            k = _knot(pore, surface, (foot, other), to, k)
    return k


@vectorised
def corner(pore: Complex, v: int, to: Target, k: int) -> int:
    """Where both walls of side v meet: psi = 1, its derivatives along the first wall and off it, g' of both.

    Room for three more is taken; the next k.
    """
    i, j = (v + 1) % 3, (v + 2) % 3
    _knot(pore, i, (pore[v, FIRST], pore[j, SECOND]), to, k)
    _knot(pore, j, (pore[v, SECOND], pore[i, FIRST]), to, k + 4)
    n, other = pore[i, NORMAL], pore[j, NORMAL]  # from one to the other e turns as well
    cos, sin = n.real * other.real + n.imag * other.imag, n.real * other.imag - n.imag * other.real
    second, slope, across = to.out[k + 4, to.at :], to.out[k + 5, to.at :], to.out[k + 6, to.at :]
    _add(1.0, second, to.out[k, to.at :])
    _add(cos, slope, to.out[k + 1, to.at :])
    _add(-sin, across, to.out[k + 1, to.at :])
    _add(sin, slope, to.out[k + 2, to.at :])
    _add(cos, across, to.out[k + 2, to.at :])
    _add(-1.0, second, second)
    _add(1.0, to.out[k + 7, to.at :], second)
    return k + CORNER


@vectorised
def _add(factor: float, other: Array, out: Array) -> None:
    """Add so much of what comes out of one function to that of another."""
    if out.ndim == 1:
        for w in range(RATES * AT_ONCE):
            out[w] += factor * other[w]
    else:
        for w in range(JETS * AT_ONCE):
            out[0, w] += factor * other[0, w]


@vectorised
def _knot(pore: Complex, v: int, ends: Ends, to: Target, k: int) -> int:
    """Those at the first end of the arc of surface v."""
    h = lay_flat(
        pore[v], ends, to.points, to.points[(DISTANCE + v) * AT_ONCE :], (to.room[AT], to.room[MAPPED])
    )
    P = to.room[POLYNOMIALS:]
    _cubics(to.room[AT], h, P[0], P[1])
    for m in range(2):
        _put_both(v, bend_of(pore[v]), P[m], to, (k + m, k + 2 + m))
    return k + 4


@vectorised
def arc_bubbles(pore: Complex, v: int, number: int, to: Target, k: int) -> int:
    """Those of f and of g between the feet on surface v, in turns; the next k."""
    i, j = (v + 1) % 3, (v + 2) % 3
    ends, P, x = (pore[j, FIRST], pore[i, SECOND]), to.room[POLYNOMIALS:], to.room[GATHERED]
    h = lay_flat(
        pore[v], ends, to.points, to.points[(DISTANCE + v) * AT_ONCE :], (to.room[AT], to.room[MAPPED])
    )
    _gather(to.room[AT], h, (_width(pore, j), _width(pore, i)), x)
    _polynomials(x, number, P)
    for m in range(number):
        _times_ends(P[m], x, P[number + 1])
        _put_both(v, bend_of(pore[v]), P[number + 1], to, (k + 2 * m, k + 2 * m + 1))
    return k + 2 * number


@inlined
def _width(pore: Complex, side: int) -> float:
    """How far from the foot the gap of a side is twice as wide: T = arsinh(span / width)."""
    first = pore[(side + 1) % 3, TOUCH] - pore[side, FIRST]
    second = pore[(side + 2) % 3, TOUCH] - pore[side, SECOND]
    T = max(pore[side, GATHERING].real, 1e-3)
    return float(0.5 * (_length(first) + _length(second)) / np.sinh(T))


@inlined
def _length(z: complex) -> float:
    return float(np.sqrt(z.real * z.real + z.imag * z.imag))


@vectorised
def _gather(t: Array, h: float, widths: tuple[float, float], out: Array) -> None:
    """x and its three derivatives by t."""
    a, b = h / abs(h) * widths[0], h / abs(h) * widths[1]
    of_a, of_b = np.arcsinh(h / a), np.arcsinh(h / b)
    for w in range(AT_ONCE):
        left, right = t[w] / a, (h - t[w]) / b
        r, q = 1.0 / np.sqrt(1.0 + left * left), 1.0 / np.sqrt(1.0 + right * right)
        value = np.arcsinh(left) / of_a - np.arcsinh(right) / of_b
        first = r / (a * of_a) + q / (b * of_b)
        second = right * q**3 / (b * b * of_b) - left * r**3 / (a * a * of_a)
        third = (2.0 * left * left - 1.0) * r**5 / (a**3 * of_a)
        third += (2.0 * right * right - 1.0) * q**5 / (b**3 * of_b)
        _put_polynomial(out, w, (value, first, second, third))


@inlined
def _put_polynomial(p: Array, w: int, values: tuple[float, float, float, float]) -> None:
    """A polynomial and its three derivatives at point w."""
    for m in range(4):
        p[m * AT_ONCE + w] = values[m]


@vectorised
def _cubics(t: Array, h: float, value: Array, slope: Array) -> None:
    """That with the value 1 and that with the slope 1 at t = 0, both zero to second order at h."""
    for w in range(AT_ONCE):
        x = t[w] / h
        first, second = 6.0 * x * (x - 1.0) / h, (12.0 * x - 6.0) / (h * h)
        _put_polynomial(value, w, (1.0 - x * x * (3.0 - 2.0 * x), first, second, 12.0 / (h * h * h)))
        first, second = (1.0 - x) * (1.0 - 3.0 * x), (6.0 * x - 4.0) / h
        _put_polynomial(slope, w, (h * x * (1.0 - x) * (1.0 - x), first, second, 6.0 / (h * h)))


@vectorised
def _polynomials(x: Array, number: int, P: Array) -> None:
    """P_0, P_1, ... of x and their derivatives by x."""
    _first_two(x, P[0], P[1])
    for j in range(1, number):
        _next(P[j - 1], P[j], x, float(j), P[j + 1])


@vectorised
def _first_two(x: Array, one: Array, same: Array) -> None:
    for w in range(AT_ONCE):
        _put_polynomial(one, w, (1.0, 0.0, 0.0, 0.0))
        _put_polynomial(same, w, (x[w], 1.0, 0.0, 0.0))


@vectorised
def _next(a: Array, b: Array, x: Array, j: float, out: Array) -> None:
    """(j + 1) P_j+1 = (2 j + 1) x P_j - j P_j-1."""
    c, f = (2.0 * j + 1.0) / (j + 1.0), j / (j + 1.0)
    for w in range(AT_ONCE):
        b0, b1, b2, b3 = b[w], b[AT_ONCE + w], b[2 * AT_ONCE + w], b[3 * AT_ONCE + w]
        value, first = c * x[w] * b0 - f * a[w], c * (b0 + x[w] * b1) - f * a[AT_ONCE + w]
        second, third = c * (2.0 * b1 + x[w] * b2), c * (3.0 * b2 + x[w] * b3)
        second, third = second - f * a[2 * AT_ONCE + w], third - f * a[3 * AT_ONCE + w]
        _put_polynomial(out, w, (value, first, second, third))


@vectorised
def _times_ends(p: Array, x: Array, out: Array) -> None:
    """(1 - x^2)^2 p and its derivatives by t."""
    for w in range(AT_ONCE):
        p0, p1, p2, p3 = p[w], p[AT_ONCE + w], p[2 * AT_ONCE + w], p[3 * AT_ONCE + w]
        x0, x1, x2, x3 = x[w], x[AT_ONCE + w], x[2 * AT_ONCE + w], x[3 * AT_ONCE + w]
        u = 1.0 - x0 * x0
        q0, q1, q2, q3 = u * u, -4.0 * x0 * u, 12.0 * x0 * x0 - 4.0, 24.0 * x0
        r1, r2 = q1 * p0 + q0 * p1, q2 * p0 + 2.0 * q1 * p1 + q0 * p2
        r3 = q3 * p0 + 3.0 * q2 * p1 + 3.0 * q1 * p2 + q0 * p3
        third = r3 * x1 * x1 * x1 + 3.0 * r2 * x1 * x2 + r1 * x3
        _put_polynomial(out, w, (q0 * p0, r1 * x1, r2 * x1 * x1 + r1 * x2, third))


@vectorised
def _put_both(v: int, bend: float, p: Array, to: Target, at: tuple[int, int]) -> None:
    """What comes out of Psi = p(t) and of Psi = d p(t) on surface v of curvature bend, as those functions."""
    weights = to.room[BLEND + v], to.room[SLOPE_X + v], to.room[SLOPE_Y + v]
    coordinates = to.room[AT], to.room[MAPPED], p
    _put_extended(weights, coordinates, bend, to.points, (to.out[at[0], to.at :], to.out[at[1], to.at :]))


@vectorised
def _put_extended(
    weights: tuple[Array, Array, Array],
    coordinates: tuple[Array, Array, Array],
    bend: float,
    points: Array,
    out: tuple[Array, Array],
) -> None:
    """The same at points."""
    (b, sx, sy), (at, mapped, p), (f, g) = weights, coordinates, out
    nothing = (0.0, 0.0, 0.0)
    for w in range(AT_ONCE):
        made = load(b, w), load(sx, w), load(sy, w)
        map_ = (
            complex(mapped[w], mapped[AT_ONCE + w]),
            complex(mapped[2 * AT_ONCE + w], mapped[3 * AT_ONCE + w]),
            complex(mapped[4 * AT_ONCE + w], mapped[5 * AT_ONCE + w]),
        )
        p0, p1, p2, p3 = p[w], p[AT_ONCE + w], p[2 * AT_ONCE + w], p[3 * AT_ONCE + w]
        d = at[AT_ONCE + w]
        by_s = 1.0 + d * bend  # dd/ds; its derivatives have one more factor bend each
        by_ss, by_sss = by_s * bend, by_s * bend * bend
        put(f, points, w, extended(made, _function(map_, (p0, p1, p2, p3), nothing, nothing)))
        of_t, of_s = (d * p0, d * p1, d * p2, d * p3), (by_s * p0, by_s * p1, by_s * p2)
        of_ss = (by_ss * p0, by_ss * p1, by_sss * p0)
        put(g, points, w, extended(made, _function(map_, of_t, of_s, of_ss)))


@inlined
def _function(
    map_: tuple[complex, complex, complex],
    of_t: tuple[float, float, float, float],
    of_s: tuple[float, float, float],
    of_ss: tuple[float, float, float],
) -> ThirdJet:
    """F, F_z, F_zz, F_zzb, F_zzz, F_zzzb by F, F_t, F_tt, F_ttt; F_s, F_ts, F_tts; F_ss, F_tss, F_sss."""
    (w1, w2, w3), (value, t, tt, ttt), (s, ts, tts), (ss, tss, sss) = map_, of_t, of_s, of_ss
    first, second = complex(0.5 * t, -0.5 * s), complex(0.25 * (tt - ss), -0.5 * ts)
    third = complex(0.125 * (ttt - 3.0 * tss), 0.125 * (sss - 3.0 * tts))
    beside = complex(0.125 * (ttt + tss), -0.125 * (tts + sss))
    square, mixed = times(w1, w1), 0.25 * (tt + ss)
    size = w1.real * w1.real + w1.imag * w1.imag
    f2 = times(second, square) + times(first, w2)
    f3 = times(third, times(square, w1)) + scaled(3.0, times(second, times(w1, w2))) + times(first, w3)
    back = complex(w1.real, -w1.imag)
    turned = scaled(size, times(beside, w1)) + scaled(mixed, times(w2, back))
    return value, times(first, w1), f2, mixed * size, f3, turned
