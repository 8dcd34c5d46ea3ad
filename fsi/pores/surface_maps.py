"""The conformal maps w = t + i s that lay surfaces on s = 0, the fluid above, with t = 0 at a foot A.

    wall: w = conj(e) (z - A), e along it;     circle: w = i a log((z - z_v) / (A - z_v)),

a negative of a container. To first order s is the distance, and t the length from A.
"""

import numpy as np

from fsi.arrays import Array
from fsi.machine.compiled import inlined, vectorised
from fsi.pores.jets import AT_ONCE, scaled, times
from fsi.pores.pore_data import CENTRE, IS_WALL, NORMAL, RADIUS, SIGN, Complex
from fsi.pores.quadrature import Y

type Ends = tuple[complex, complex]


@vectorised
def lay_flat(surface: Complex, ends: Ends, points: Array, d: Array, out: tuple[Array, Array]) -> float:
    """t, d and the derivatives of w at points with distances d; returns t of the second end."""
    if surface[IS_WALL].real > 0.0:
        n = surface[NORMAL]
        return _of_wall(complex(n.imag, -n.real), ends, points, d, out)
    return _of_circle(surface[CENTRE], surface[SIGN].real * surface[RADIUS].real, ends, points, d, out)


@vectorised
def _of_wall(e: complex, ends: Ends, points: Array, d: Array, out: tuple[Array, Array]) -> float:
    (foot, other), (at, mapped) = ends, out
    for w in range(AT_ONCE):
        x, y = points[w] - foot.real, points[Y * AT_ONCE + w] - foot.imag
        at[w], at[AT_ONCE + w] = x * e.real + y * e.imag, d[w]
        _store(mapped, w, (complex(e.real, -e.imag), 0j, 0j))
    return float((other.real - foot.real) * e.real + (other.imag - foot.imag) * e.imag)


@vectorised
def _of_circle(
    centre: complex, a: float, ends: Ends, points: Array, d: Array, out: tuple[Array, Array]
) -> float:
    (foot, other), (at, mapped) = ends, out
    A = foot - centre
    for w in range(AT_ONCE):
        r = complex(points[w] - centre.real, points[Y * AT_ONCE + w] - centre.imag)
        at[w], at[AT_ONCE + w] = -a * _angle(A, r), d[w]
        square = r.real * r.real + r.imag * r.imag
        inverse = complex(r.real / square, -r.imag / square)
        first = scaled(a, complex(-inverse.imag, inverse.real))  # i a / z
        second = scaled(-1.0, times(first, inverse))
        _store(mapped, w, (first, second, scaled(-2.0, times(second, inverse))))
    return float(-a * _angle(A, other - centre))


@inlined
def _angle(A: complex, B: complex) -> float:
    """From A to B, anticlockwise."""
    return float(np.arctan2(A.real * B.imag - A.imag * B.real, A.real * B.real + A.imag * B.imag))


@inlined
def _store(mapped: Array, w: int, derivatives: tuple[complex, complex, complex]) -> None:
    """w', w'' and w''' at point w."""
    for m in range(3):
        mapped[2 * m * AT_ONCE + w] = derivatives[m].real
        mapped[(2 * m + 1) * AT_ONCE + w] = derivatives[m].imag


@inlined
def bend_of(surface: Complex) -> float:
    """Its curvature 1 / a, 0 of a wall."""
    if surface[IS_WALL].real > 0.0:
        return 0.0
    return float(surface[SIGN].real / surface[RADIUS].real)
