"""Solutions whose factors have lost digits, mended by a few steps of GMRES on the factors.

Refinement `x += K (b - M x)`, K the factors' solve, gains a factor |I - K M| a step. Fluid that narrow gaps
shut in, in a corner or between three bodies, holds a pressure that only the flow through them determines: M
has one direction in which it is a part (q/a)^(5/2) of the rest, below rounding at q/a = 1e-6. There K is
wrong by a factor, and refinement creeps or stays; all other directions are right, so that the z with the
smallest |K (b - M (x + z))| in span{d, (K M) d, ...}, d = K (b - M x), is found in two steps (Saad and
Schultz 1986, SIAM J. Sci. Stat. Comput. 7:856).
"""

from collections.abc import Callable

import numpy as np

from fsi.arrays import Array

STEPS = 3

type Map = Callable[[Array], Array]


def correction(operator: Map, d: Array, total: Map) -> Array:
    """The z in span{d, K M d, ...} for which |d - K M z| is smallest; collective.

    operator: K M on this rank's rows. d: K (b - M x), (rows,). total: sums over ranks, of arrays.
    """
    size = np.sqrt(total(d @ d))
    if size == 0.0:  # nothing is missed, as of a part of a flow that rests
        return np.zeros_like(d)
    basis, H = [d / size], np.zeros((STEPS + 1, STEPS))
    for j in range(STEPS):
        w = operator(basis[j])
        V = np.column_stack(basis)
        for _ in range(2):  # twice, as rounding leaves it oblique
            h = total(V.T @ w)
            H[: j + 1, j] += h
            w = w - V @ h
        H[j + 1, j] = np.sqrt(total(w @ w))
        if H[j + 1, j] <= np.finfo(float).eps * np.abs(H[: j + 1, j]).max():
            break
        basis.append(w / H[j + 1, j])
    known, used = min(len(basis), STEPS), len(basis)
    right = np.zeros(used)
    right[0] = size
    y = np.linalg.lstsq(H[:used, :known], right, rcond=None)[0]
    z: Array = np.column_stack(basis[:known]) @ y
    return z
