"""The bispherical series of two spheres moving along their line of centres, or of one along a plane's normal.

The spheres are the surfaces xi = al and xi = -be, a plane is be = 0. The stream function is a sum of modes n
= 1, 2, ..., each of four exponentials, and no-slip gives four equations a mode. Solved in closed form, with m
= 2n + 1, th = al + be, c = a sinh al, the forces are F_i = R_i1 V_1 + R_i2 V_2,

    R_ij = 2 pi mu c sum_n (m^2 - 1)/(m^2 - 4) N_ij / D,     D = 4 sinh^2(m th/2) - m^2 sinh^2 th
    N_11 = e^(m be) (2 + m sinh 2al + m^2 sinh^2 al) - e^(-m al) (2 - m sinh 2be + m^2 sinh^2 be)
    N_12 = -2 (1 - e^(-m th)) - m (sinh 2al + sinh 2be) - m^2 sinh^2 th - m^3 sinh al sinh be sinh th

and N_22 is N_11 with al and be exchanged. These reduce to the series of H. Brenner, Chem. Eng. Sci. 16 (1961)
242, at be = 0, and for equal spheres to those of A. D. Maude, Br. J. Appl. Phys. 12 (1961) 293, and of M.
Stimson and G. B. Jeffery, Proc. R. Soc. A 111 (1926) 110; tests compare them with all three and with the 4 x
4 systems. Angles al and be have one shape (...), as have the sums; the modes are summed over a last axis.
Differences of nearly equal numbers are removed with `tail(z) = e^z - 1 - z - z^2/2`.

The terms fall off like e^(-(2n+1) al), al ~ sqrt(2 q/a): at q/a = 1e-8 some 2e5 modes count. But a term
hardly changes from one large n to the next, so the modes are taken in blocks n .. 2n - 1 of doubling length,
and each block is summed like an integral: by Gauss's rule for SUMS, whose nodes are the zeros of Gram's
polynomials (orthogonal over the integers 1 .. N, also called discrete Chebyshev polynomials: G. Szego,
"Orthogonal Polynomials", section 2.8). With 24 nodes a block the sum is exact to rounding, and it costs 24
terms more each time the gap is four times smaller.
"""

from functools import cache
from math import ceil, factorial, log2

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array

# tail(z) = z^3 sum_k z^k / (k + 3)!; sixteen terms give 16 digits up to |z| = 1.
_TAIL_SERIES = np.array([1.0 / factorial(k + 3) for k in range(16)])
_FIRST = 48  # modes that are summed one by one
_NODES = 24  # of each later block
_DECAY = 45.0  # e^(-45), with the powers of n before it, is below the rounding of the sum


def sum_self(al: Array, be: Array) -> Array:
    """The sum over n in R_11."""
    m, weight = _modes(al)
    al, be = al[..., None], be[..., None]
    gone = np.exp(-m * (al + be))
    numerator = (
        -2.0 * np.expm1(-m * (al + be))
        + m * (np.sinh(2.0 * al) + gone * np.sinh(2.0 * be))
        + m**2 * (np.sinh(al) ** 2 - gone * np.sinh(be) ** 2)
    )
    return np.asarray((np.exp(-m * al) * numerator / _denominator(m, al + be)) @ weight)


def sum_cross(al: Array, be: Array) -> Array:
    """The sum over n in R_12 = R_21."""
    m, weight = _modes(al + be)
    al, be = al[..., None], be[..., None]
    th = al + be
    numerator = (
        -2.0 * np.expm1(-m * th)
        + m * (np.sinh(2.0 * al) + np.sinh(2.0 * be))
        + (m * np.sinh(th)) ** 2
        + m**3 * np.sinh(al) * np.sinh(be) * np.sinh(th)
    )
    return np.asarray(-(np.exp(-m * th) * numerator / _denominator(m, th)) @ weight)


def sum_common(al: Array, be: Array) -> Array:
    """The sum over n in R_11 + R_12, of fourth order in m al and m be where N_11 is of first.

    `planar` is what is left when every sinh is its argument; `curved` is the rest.
    """
    m, weight = _modes(al)
    al, be = al[..., None], be[..., None]
    th = al + be
    x, y, z = m * al, m * be, m * th
    gone, left = np.exp(-z), np.exp(-x)
    planar = (2.0 * y - y**2) * _tail(-x) - (2.0 * y + y**2) * _tail(-z) - 0.5 * (y * z) ** 2
    planar = gone * planar + (2.0 * x + x**2 - 2.0 * np.expm1(-z)) * _tail(y, z)
    product = (
        _less_argument(al) * np.sinh(be) * np.sinh(th)
        + al * _less_argument(be) * np.sinh(th)
        + al * be * _less_argument(th)
    )
    curved = (
        -left * np.expm1(-y) * m * _less_argument(2.0 * al)
        + gone * np.expm1(-x) * m * _less_argument(2.0 * be)
        + m**2 * (left * _less_square(al) - gone * (left * _less_square(be) + _less_square(th)))
        - gone * m**3 * product
    )
    return np.asarray(((planar + curved) / _denominator(m, th)) @ weight)


def _modes(angle: Array) -> tuple[Array, Array]:
    """m = 2n + 1 and the weights (m^2 - 1)/(m^2 - 4), times those of the rule that sums the modes."""
    n, weight = mode_rule(float(np.min(angle)))
    m = 2.0 * n + 1.0
    return m, weight * (m**2 - 1.0) / (m**2 - 4.0)


def mode_rule(angle: float) -> tuple[Array, Array]:
    """(n, w) such that sum_n f(n) = sum w f(n) for series that fall off like e^(-(2n+1) angle), angle > 0."""
    last = 0.5 * _DECAY / angle
    return _rule(max(0, ceil(log2(last / _FIRST))))


@cache
def _rule(blocks: int) -> tuple[Array, Array]:
    """Nodes and weights for 48 single modes and `blocks` blocks."""
    nodes, weights = [np.arange(1.0, _FIRST + 1.0)], [np.ones(_FIRST)]
    for k in range(blocks):
        length = _FIRST * 2.0**k
        x, w = gram_rule(length)
        nodes.append(1.5 * length + 0.5 + x)
        weights.append(w)
    return np.concatenate(nodes), np.concatenate(weights)


def gram_rule(length: float) -> tuple[Array, Array]:
    """Gauss's rule for the sum over `length` points one apart, centred at 0; exact up to degree 47.

    Nodes and weights are the eigenvalues of the Jacobi matrix of Gram's polynomials, and `length` times the
    squares of the first components of its eigenvectors (Golub and Welsch).
    """
    k = np.arange(1.0, _NODES)
    off_diagonal = 0.5 * k * np.sqrt((length**2 - k**2) / (4.0 * k**2 - 1.0))
    nodes, vectors = scipy.linalg.eigh_tridiagonal(np.zeros(_NODES), off_diagonal)
    return nodes, length * np.square(vectors[0])


def _denominator(m: Array, th: Array) -> Array:
    """e^(-m th) D as the product of its two factors; of the smaller one the first order cancels exactly."""
    half = 0.5 * m * th
    decay = np.exp(-half)
    minus = 2.0 * _less_argument(half, half) - decay * m * _less_argument(th)
    plus = -np.expm1(-2.0 * half) + decay * m * np.sinh(th)
    return minus * plus


def _tail(z: Array, shift: Array | float = 0.0) -> Array:
    """e^(-shift) tail(z), by its series where it is small; the shift keeps large z from overflow."""
    small = np.clip(z, -1.0, 1.0)
    series = small**3 * np.polynomial.polynomial.polyval(small, _TAIL_SERIES)
    decay = np.exp(-shift)
    return np.where(np.abs(z) < 1.0, decay * series, np.exp(z - shift) - decay * (1.0 + z + 0.5 * z**2))


def _less_argument(z: Array, shift: Array | float = 0.0) -> Array:
    """e^(-shift) (sinh z - z) for z >= 0."""
    return 0.5 * (_tail(z, shift) - _tail(-z, shift))


def _less_square(z: Array) -> Array:
    """sinh^2 z - z^2."""
    return _less_argument(z) * (np.sinh(z) + z)
