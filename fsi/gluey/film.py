"""Films of fluid at eps > 0: `gamma = eps Psi'(D)`, and the answer of a pair to its gap.

Spheres: `Psi' = ln(D/delta0)`; discs: `Psi' = 2 (1 - (D/delta0)^{-1/2})`. Both vanish at delta0, where a
film begins. The unknown is gamma, as D underflows.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.sparse as sp
from scipy.special import wrightomega

from fsi.bodies.configuration import Array

type Shape = Literal["sphere", "disc"]


@dataclass(frozen=True, slots=True)
class Film:
    """Rows with viscosity, in a step h: `D + h G.u = s`, `p = -eps Psi'(s)`.

    Attributes:
        eps: of a pair, > 0, an impulse.
        delta0: where films begin.
        h: the step.
        shape: of the bodies.
    """

    eps: float
    delta0: float
    h: float
    shape: Shape

    def gamma(self, D: Array) -> Array:
        """The memory of gaps D > 0, which is at most 0."""
        with np.errstate(divide="ignore"):
            return self.eps * gamma_over_eps(np.minimum(D / self.delta0, 1.0), self.shape)

    def gap(self, gamma: Array) -> Array:
        """D of memories gamma <= 0; 0 where it underflows."""
        y = gamma / self.eps
        D: Array = self.delta0 * (np.exp(y) if self.shape == "sphere" else (1.0 - 0.5 * y) ** -2.0)
        return D

    def impulse(self, r: Array, p_old: Array, sigma: Array) -> tuple[Array, sp.spmatrix]:
        """The solution of `D(-p)/h - p/sigma = r - p_old/sigma`, and `-dp/dr`; 0 for pairs beyond delta0."""
        z = r - p_old / sigma
        p = self._solve(z, sigma)
        # dp/dr = -1/(dD/dgamma / h + 1/sigma)
        slope = 1.0 / (self._mobility(-p) / self.h + 1.0 / sigma)
        near = z < self.delta0 / self.h
        return np.where(near, p, 0.0), sp.diags(np.where(near, slope, 0.0)).tocsr()

    def _solve(self, z: Array, sigma: Array) -> Array:
        """p >= 0 with `D(-p)/h = z + p/sigma`."""
        c = self.eps * self.h / (sigma * self.delta0)
        R = self.h * z / self.delta0
        if self.shape == "sphere":  # exp(y) + c y = R, y = -p/eps
            w = wrightomega(R / c - np.log(c))
            with np.errstate(divide="ignore"):
                y = np.where(w > 1.0, np.log(c * w), R / c - w)
        else:  # x^2 + 2c (1 - 1/x) = R, x = sqrt(D/delta0), y = 2 (1 - 1/x)
            y = 2.0 * (1.0 - 1.0 / _positive_root(R - 2.0 * c, 2.0 * c))
        p: Array = np.maximum(-self.eps * y, 0.0)
        return p

    def _mobility(self, gamma: Array) -> Array:
        """dD/dgamma."""
        y = gamma / self.eps
        slope: Array = np.exp(y) if self.shape == "sphere" else (1.0 - 0.5 * y) ** -3.0
        return slope * self.delta0 / self.eps

    def scales(self, weight: Array) -> Array:
        """Each row by itself."""
        return weight

    def residual(self, r: Array, p: Array, weight: Array) -> float:
        """The largest of `r - D(-p)/h` where films are, of `delta0/h - r` beyond, and of p's own error."""
        answer, _ = self.impulse(r, p, 1.0 / weight)
        beyond = np.maximum(self.delta0 / self.h - r, 0.0)
        in_gap = np.where(p > 0.0, np.abs(r - self.gap(-p) / self.h), beyond)
        return float(np.maximum(in_gap, np.abs(answer - p) * weight).max(initial=0.0))


def gamma_over_eps(x: Array, shape: Shape) -> Array:
    """Psi' at the gaps x delta0, 0 <= x <= 1, shape of x; minus infinity at 0."""
    psi: Array = np.log(x) if shape == "sphere" else 2.0 * (1.0 - x**-0.5)
    return psi


def _positive_root(R: Array, k: Array) -> Array:
    """The positive root of `x^3 - R x - k = 0`, k > 0 (it is the only one), by Newton from the right."""
    x = np.sqrt(np.maximum(R, 0.0)) + np.cbrt(k)
    for _ in range(60):
        step = (x * x * x - R * x - k) / (3.0 * x * x - R)
        x = x - step
        if np.all(np.abs(step) <= 1e-15 * x):
            break
    return x
