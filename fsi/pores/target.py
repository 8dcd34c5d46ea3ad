"""Where the trial functions of a pore go."""

from typing import NamedTuple

from fsi.arrays import Array
from fsi.machine.compiled import inlined, vectorised
from fsi.pores.jets import AT_ONCE, Jet, load, product
from fsi.pores.quadrature import ROOT

RATES, JETS = 2, 6  # numbers at a point


class Target(NamedTuple):
    """AT_ONCE points of a pore, and where its functions go.

    Attributes:
        points: the rows of `fsi.pores.quadrature` up to ROOT, one after the other, (6 AT_ONCE,).
        room: where they are made, (., 6 AT_ONCE): the weights, then two lists of Legendre polynomials; in
            place of these also powers, and polynomials of x and y.
        out: of RATES (functions, .), of JETS (functions, 1, .): a row for each function, its RATES or JETS
            numbers one after the other AT_ONCE times each.
        at: where these points begin in the rows, of JETS 0.
    """

    points: Array
    room: Array
    out: Array
    at: int


@inlined
def put(out: Array, points: Array, w: int, f: Jet) -> None:
    """What comes out of a function at point w, in its row from these points on."""
    if out.ndim == 1:
        root = 4.0 * points[ROOT * AT_ONCE + w]
        out[w], out[AT_ONCE + w] = root * f[2].real, root * f[2].imag
    else:
        out[0, w], out[0, 5 * AT_ONCE + w] = f[0], 2.0 * (f[3] - f[2].real)
        out[0, AT_ONCE + w], out[0, 2 * AT_ONCE + w] = 2.0 * f[1].real, -2.0 * f[1].imag
        out[0, 3 * AT_ONCE + w], out[0, 4 * AT_ONCE + w] = 2.0 * (f[3] + f[2].real), -2.0 * f[2].imag


@vectorised
def put_product(f: Array, g: Array, points: Array, out: Array) -> None:
    """What comes out of a product of two functions."""
    for w in range(AT_ONCE):
        put(out, points, w, product(load(f, w), load(g, w)))
