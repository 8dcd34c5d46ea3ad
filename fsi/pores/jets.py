"""Real functions of z = x + i y at a point with their first and second derivatives: jets.

A jet is (f, f_z, f_zz, f_zzb), zb the conjugate of z:

    f_z = (f_x - i f_y) / 2,    f_zz = (f_xx - f_yy - 2 i f_xy) / 4,    f_zzb = (f_xx + f_yy) / 4.

Products follow Leibniz' rule, so that trial functions are written as in a textbook and their strain rates
are exact. Complex numbers are multiplied and added by functions of their parts: in `*` and `+` Numba makes
complex numbers of real factors, and keeps to the order of roundings. Loops run over the points of a pore,
always AT_ONCE of them, whose jets stay in the processor's cache. A function's jets there are one row, its six
numbers one after the other AT_ONCE times each: of known distances a compiler sees that nothing overlaps, and
takes several points at once.
"""

from fsi.arrays import Array
from fsi.machine.compiled import inlined, vectorised
from fsi.machine.heap import aligned

AT_ONCE = 32  # points

type Jet = tuple[float, complex, complex, float]


def room(functions: int) -> Array:
    """Place for the jets of functions, (functions, 6 AT_ONCE)."""
    return aligned(functions * 6 * AT_ONCE).reshape(functions, 6 * AT_ONCE)


@inlined
def load(f: Array, w: int) -> Jet:
    """The jet of a function at point w, of its row, (6 AT_ONCE,)."""
    first = complex(f[AT_ONCE + w], f[2 * AT_ONCE + w])
    second = complex(f[3 * AT_ONCE + w], f[4 * AT_ONCE + w])
    return f[w], first, second, f[5 * AT_ONCE + w]


@inlined
def store(f: Array, w: int, jet: Jet) -> None:
    """Make it the jet of a function at point w."""
    f[w], f[5 * AT_ONCE + w] = jet[0], jet[3]
    f[AT_ONCE + w], f[2 * AT_ONCE + w] = jet[1].real, jet[1].imag
    f[3 * AT_ONCE + w], f[4 * AT_ONCE + w] = jet[2].real, jet[2].imag


@inlined
def scaled(alpha: float, z: complex) -> complex:
    """alpha z."""
    return complex(alpha * z.real, alpha * z.imag)


@inlined
def combined(alpha: float, z: complex, beta: float, w: complex) -> complex:
    """alpha z + beta w."""
    return complex(alpha * z.real + beta * w.real, alpha * z.imag + beta * w.imag)


@inlined
def times(z: complex, w: complex) -> complex:
    """z w."""
    return complex(z.real * w.real - z.imag * w.imag, z.real * w.imag + z.imag * w.real)


@inlined
def product(f: Jet, g: Jet) -> Jet:
    """f g."""
    mixed = f[1].real * g[1].real + f[1].imag * g[1].imag
    return (
        f[0] * g[0],
        combined(f[0], g[1], g[0], f[1]),
        combined(1.0, combined(f[0], g[2], g[0], f[2]), 2.0, times(f[1], g[1])),
        f[0] * g[3] + g[0] * f[3] + 2.0 * mixed,
    )


@inlined
def plus(alpha: float, f: Jet, beta: float, g: Jet) -> Jet:
    """alpha f + beta g."""
    return (
        alpha * f[0] + beta * g[0],
        combined(alpha, f[1], beta, g[1]),
        combined(alpha, f[2], beta, g[2]),
        alpha * f[3] + beta * g[3],
    )


@inlined
def shifted(alpha: float, f: Jet, beta: float) -> Jet:
    """alpha f + beta."""
    return alpha * f[0] + beta, scaled(alpha, f[1]), scaled(alpha, f[2]), alpha * f[3]


@inlined
def reciprocal(f: Jet) -> Jet:
    """1 / f."""
    v = 1.0 / f[0]
    d, dd = -v * v, 2.0 * v * v * v
    mixed = f[1].real * f[1].real + f[1].imag * f[1].imag
    return v, scaled(d, f[1]), combined(d, f[2], dd, times(f[1], f[1])), d * f[3] + dd * mixed


@vectorised
def legendre(P: Array, number: int) -> None:
    """P_0, P_1, ... of f, |f| <= 1; P_1, which is f, is there.

    (j + 1) P_j+1 = (2 j + 1) f P_j - j P_j-1.
    """
    _one(P[0])
    for j in range(1, number - 1):
        _next_legendre(P[j - 1], P[j], P[1], float(j), P[j + 1])


@vectorised
def _one(out: Array) -> None:
    """1."""
    for w in range(AT_ONCE):
        store(out, w, (1.0, 0j, 0j, 0.0))


@vectorised
def _next_legendre(before: Array, last: Array, f: Array, j: float, out: Array) -> None:
    """P_j+1 of P_j-1, P_j and P_1."""
    alpha, beta = (2.0 * j + 1.0) / (j + 1.0), -j / (j + 1.0)
    for w in range(AT_ONCE):
        store(out, w, plus(alpha, product(load(f, w), load(last, w)), beta, load(before, w)))
