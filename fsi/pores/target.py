"""Where the trial functions of a pore go."""

from typing import NamedTuple

from fsi.bodies.configuration import Array
from fsi.pores.compiled import inlined
from fsi.pores.jets import Jet


class Target(NamedTuple):
    """Some points of a pore, n <= AT_ONCE, and where its functions go.

    Attributes:
        points: rows of `fsi.pores.quadrature`, (ROWS, n).
        room: where they are made, (., 6, AT_ONCE): the weights, then two lists of Legendre polynomials; in
            place of these also powers, and polynomials of x and y, fewer rows of each.
        out: of strain rates as one complex number, (functions, n); else (functions, 6, n).
    """

    points: Array
    room: Array
    out: Array


@inlined
def put(out: Array, root: Array, w: int, f: Jet) -> None:
    """What comes out of a function at point w, (n,) or (6, n)."""
    if out.ndim == 1:
        out[w] = 4.0 * root[w] * f[2]
    else:
        out[0, w], out[1, w], out[2, w] = f[0], 2.0 * f[1].real, -2.0 * f[1].imag
        out[3, w] = 2.0 * (f[3] + f[2].real)
        out[4, w] = -2.0 * f[2].imag
        out[5, w] = 2.0 * (f[3] - f[2].real)
