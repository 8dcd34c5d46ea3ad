"""The distance of one pair over one step by itself, `D'' = -g kappa(D) D' + f`, in x = ln D."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.errors import SolveError

# (x) -> K and dK/dx, of an antiderivative K of kappa in D, for some of the pairs.
type Some = NDArray[np.intp] | slice
type Integral = Callable[[Array, Some], tuple[Array, Array]]

_ROUNDING = 4.0 * float(np.finfo(float).eps)
_ITERATIONS = 200
_LAST_STEP = 1e-8  # of Newton's method in x: the error after it is about its square
_LEAST = float(np.finfo(float).tiny)
_ALL = slice(None)


@dataclass(frozen=True, slots=True)
class FirstIntegral:
    """One implicit step of `D' = w - g K(D)`, by which `w = D' + g K(D)` is kept, `w' = f`.

    The equation for x = ln D at the end of the step is

        (e^x - e^x0) / h + g K(x) = w

    Its left side increases, so that there is one root; g K is the gamma of the slides, which stores the push.

    Attributes:
        x0: ln D at the beginning, (P,).
        w: the first integral at the end, (P,).
        h: the step.
        g: >= 0, (P,).
        integral: K and dK/dx at x for the pairs of an index.
    """

    x0: Array
    w: Array
    h: float
    g: Array
    integral: Integral

    def solve(self) -> Array:
        """x at the end of the step, (P,). Raises SolveError: two held bodies close their gap."""
        h, D0, active = self.h, np.exp(self.x0), np.arange(len(self.x0))
        if np.any((self.g == 0.0) & (D0 + h * self.w <= 0.0)):
            raise SolveError("a gap between bodies or walls that are all held is closed by their motion")
        F, slope, _ = self._residual(self.x0, _ALL)
        # K increases, so that e^x <= e^x0 - h F(x0) if the gap opens. There Newton's first step is one in D,
        # in which the equation is nearly linear, elsewhere one in x, which keeps D positive.
        opens, ahead = F < 0.0, -np.minimum(F, 0.0)
        x = np.where(opens, np.log(D0 * (1.0 + ahead / slope) + _LEAST), self.x0 - F / slope)
        low = np.where(opens, self.x0, -np.inf)
        high = np.where(opens, np.log(D0 + h * ahead + _LEAST), self.x0)
        x = np.minimum(x, high)
        for _ in range(_ITERATIONS):
            at = x[active]
            F, slope, size = self._residual(at, active)
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
        raise SolveError("the distance of a pair was not found; shorten time.step")

    def defect(self, x: Array) -> float:
        """How far `D' + g K(D)` is from w after a step to x, at most, over the size of its terms.

        Rounding of x = ln D, which is that of D and of K, counts among them.
        """
        F, slope, size = self._residual(x, _ALL)
        size = size + slope * np.abs(x) + _LEAST
        return float(np.max(np.abs(F) / size, initial=0.0))

    def _residual(self, x: Array, index: Some) -> tuple[Array, Array, Array]:
        """Of the equation for some pairs, its derivative, and the size of its terms."""
        K, slope = self.integral(x, index)
        D, D0, g, w = np.exp(x), np.exp(self.x0[index]), self.g[index], self.w[index]
        F = (D - D0) / self.h + g * K - w
        size = (D + D0) / self.h + np.abs(g * K) + np.abs(w)
        return F, D / self.h + g * slope, size


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
