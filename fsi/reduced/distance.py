"""The distance of each pair by itself: `D'' = -g kappa(D) D' + f`, `g = G.M^-1 G`, in steps that keep D > 0.

The unknown is x = ln D, which does not underflow where D does. Source: A. Lefebvre and B. Maury, Direct
simulation of dense suspensions (2008).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.errors import SolveError

# (x) -> K and dK/dx, of an antiderivative K of kappa in D, for some of the pairs.
type Integral = Callable[[Array, NDArray[np.intp]], tuple[Array, Array]]

_ROUNDING = 4.0 * float(np.finfo(float).eps)
_ITERATIONS = 200
_LAST_STEP = 1e-8  # of Newton's method in x: the error after it is about its square
_LEAST = float(np.finfo(float).tiny)


def first_integral_step(x0: Array, w: Array, h: float, g: Array, integral: Integral) -> Array:
    """One implicit step of `D' = w - g K(D)`, by which `w = D' + g K(D)` is kept, `w' = f`.

    Solves `(e^x - e^x0) / h + g K(x) = w` for x = ln D at the end of the step. The left side increases, so
    that there is one root; g K is the gamma of the slides, which stores the push.

    Args:
        x0: ln D at the beginning, (P,).
        w: the first integral at the end, (P,).
        h: the step.
        g: >= 0, (P,).
        integral: K and dK/dx at x for the pairs of an index.

    Raises:
        SolveError: a gap between two bodies that are both held is closed by their motion.
    """
    D0, active = np.exp(x0), np.arange(len(x0))
    if np.any((g == 0.0) & (D0 + h * w <= 0.0)):
        raise SolveError("a gap between bodies or walls that are all held is closed by their motion")
    F, _, _ = _residual(x0, active, D0, w, h, g, integral)
    # K increases, so that e^x <= e^x0 - h F(x0) if the gap opens: the start is never left of the root.
    x = np.where(F < 0.0, np.log(D0 - h * np.minimum(F, 0.0) + _LEAST), x0)
    low, high = np.full(len(x), -np.inf), x.copy()
    for _ in range(_ITERATIONS):
        at = x[active]
        F, slope, size = _residual(at, active, D0, w, h, g, integral)
        high[active] = np.where(F >= 0.0, at, high[active])
        low[active] = np.where(F < 0.0, at, low[active])
        to = at - F / slope
        beyond = (to > high[active]) | (to < low[active])
        to = np.where(beyond, 0.5 * (low[active] + high[active]), to)
        solved = np.abs(F) <= _ROUNDING * size
        x[active] = np.where(solved, at, to)
        active = active[~(solved | (~beyond & (np.abs(to - at) <= _LAST_STEP)))]
        if len(active) == 0:
            return x
    raise SolveError("the distance of a pair was not found; shorten reduced.step")


def first_integral_defect(x: Array, x0: Array, w: Array, h: float, g: Array, integral: Integral) -> float:
    """How far `D' + g K(D)` is from w after a step, at most, over the size of its terms.

    Rounding of x = ln D, which is that of D and of K, counts among them.
    """
    F, slope, size = _residual(x, np.arange(len(x)), np.exp(x0), w, h, g, integral)
    size = size + slope * np.abs(x) + _LEAST
    return float(np.max(np.abs(F) / size, initial=0.0))


def _residual(
    x: Array, index: NDArray[np.intp], D0: Array, w: Array, h: float, g: Array, integral: Integral
) -> tuple[Array, Array, Array]:
    """The equation of `first_integral_step`, its derivative, and the size of its terms."""
    K, slope = integral(x, index)
    D = np.exp(x)
    F = (D - D0[index]) / h + g[index] * K - w[index]
    size = (D + D0[index]) / h + np.abs(g[index] * K) + np.abs(w[index])
    return F, D / h + g[index] * slope, size


def backward_euler_step(x0: Array, V: Array, f: Array, h: float, g_mu: Array) -> tuple[Array, Array]:
    """The literal step for kappa = mu/D: the root D > 0 of `D^2 + p D = h g mu D0`.

    Here `p = h g mu - D0 - h V - h^2 f`. Positive, but it keeps the push only in the gap itself, which is
    lost once h |f| is not small against g mu.

    Returns:
        x = ln D and D' = (D - D0) / h.
    """
    D0 = np.exp(x0)
    p = h * g_mu - D0 - h * V - h**2 * f
    root = np.sqrt(p**2 + 4.0 * h * g_mu * D0)
    with np.errstate(divide="ignore"):
        shrinking = np.log(2.0 * h * g_mu) + x0 - np.log(np.abs(p) + root)
        x = np.where(p > 0.0, shrinking, np.log(0.5 * (np.abs(p) + root)))
    return x, (np.exp(x) - D0) / h
