"""One convex program for all eps >= 0, by an augmented Lagrangian and Newton's method with sparse factors.

    min_u  1/2 |u - u*|_M^2  +  sum_k  E_k(b_k + (J u)_k)

with convex E_k: the film energy `eps Psi`, `Psi' = ln` (`fsi.gluey.film`), or, as eps -> 0, the wall `r >=
0`. With impulses `p = -E'(r)` the optimum is `M (u - u*) = J^T p`. Each outer step keeps p near the last one,

    p(r) = argmin_p  E*(-p) + p.r + |p - p_old|^2 / (2 sigma),          M (u - u*) = J^T p(b + J u)

which is a smooth convex minimisation for any sigma > 0, also where E is a wall: R. T. Rockafellar, Math.
Oper. Res. 1 (1976) 97; its Newton matrix `M + J^T (-dp/dr) J` is sparse, symmetric and positive definite. A
factor is kept as preconditioner of conjugate gradients while few contacts change.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, SuperLU, cg, splu

from fsi.bodies import Array

OUTER, INNER, SEARCHES = 25, 60, 40
ROUNDING = 2.0**-53
# Conjugate gradients: how well they solve, and after how many iterations a new factor is cheaper.
ACCURACY, PATIENCE = 1e-6, 8
# The penalty sigma in units of the mass that a row feels: more of it costs digits, by rounding in the gaps.
# So it grows only where an outer step leaves more than a part ENOUGH of the residual.
FIRST, GROWTH, LARGEST, ENOUGH = 1e3, 10.0, 1e6, 0.3


class Response(Protocol):
    """What the rows answer to their rates."""

    def impulse(self, r: Array, p_old: Array, sigma: Array) -> tuple[Array, sp.spmatrix]:
        """p(r) and `-dp/dr >= 0`, symmetric, (rows, rows)."""

    def residual(self, r: Array, p: Array, weight: Array) -> float:
        """How far p is from -E'(r), as a rate; weight: the rate that a unit impulse makes, (rows,)."""


@dataclass(slots=True)
class _Solver:
    """Solves with `M + J^T D J`, keeping a factor as long as it helps."""

    J: sp.csr_matrix
    mass: Array
    lu: SuperLU | None = field(default=None)
    factors: int = 0

    def __call__(self, D: sp.spmatrix, rhs: Array) -> Array:
        J, Jt = self.J, self.J.T
        n = len(rhs)
        if self.lu is not None:
            A = LinearOperator((n, n), matvec=lambda x: self.mass * x + Jt @ (D @ (J @ x)), dtype=float)
            P = LinearOperator((n, n), matvec=self.lu.solve, dtype=float)
            x, unfinished = cg(A, rhs, rtol=ACCURACY, maxiter=PATIENCE, M=P)
            if not unfinished:
                return np.asarray(x)
        H = (sp.diags(self.mass) + Jt @ D @ J).tocsc()
        self.lu = splu(H, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        self.factors += 1
        return np.asarray(self.lu.solve(rhs))


@dataclass(frozen=True, slots=True)
class Optimum:
    """The solution: impulses p (rows,), velocities u (modes,), residual (a rate), steps, factors."""

    p: Array
    u: Array
    residual: float
    steps: int
    factors: int


def minimise(
    J: sp.csr_matrix,
    b: Array,
    mass: Array,
    u_star: Array,
    p: Array,
    response: Response,
    tolerance: float,
) -> Optimum:
    """Solve the program.

    Args:
        J: rows, (rows, modes).
        b: (rows,).
        mass: diagonal of M, > 0, (modes,).
        u_star: (modes,).
        p: where to begin, (rows,).
        response: what the rows answer.
        tolerance: of the residual, a rate.

    Returns:
        the best that rounding allows: its residual may exceed the tolerance, which is the caller's to judge.
    """
    weight = J.multiply(J) @ (1.0 / mass)
    sigma = FIRST / weight
    solver = _Solver(J, mass)
    u = u_star + (J.T @ p) / mass
    steps, before = 0, np.inf
    for _ in range(OUTER):
        u, p, inner = _inner(J, b, mass, u_star, u, p, sigma, response, solver, 0.1 * tolerance)
        steps += inner
        at_p = u_star + (J.T @ p) / mass
        residual = response.residual(b + J @ at_p, p, weight)
        if residual <= tolerance:
            break
        if residual > ENOUGH * before:
            sigma = np.minimum(GROWTH * sigma, LARGEST / weight)
        before = residual
    return Optimum(p, at_p, residual, steps, solver.factors)


def _inner(
    J: sp.csr_matrix,
    b: Array,
    mass: Array,
    u_star: Array,
    u: Array,
    p_old: Array,
    sigma: Array,
    response: Response,
    solver: _Solver,
    tolerance: float,
) -> tuple[Array, Array, int]:
    """u with `M (u - u*) = J^T p(b + J u)`, p there, and the number of Newton steps."""

    def gradient(u: Array) -> tuple[Array, Array, sp.spmatrix]:
        p, D = response.impulse(b + J @ u, p_old, sigma)
        return mass * (u - u_star) - J.T @ p, p, D

    def rounding(u: Array, p: Array) -> Array:
        """Of g: that of p, which is sigma times that of the rate, and of the sums."""
        noise = sigma * (np.abs(b) + size @ np.abs(u)) + np.abs(p)
        of_sums: Array = ROUNDING * (size.T @ noise + mass * np.abs(u - u_star))
        return of_sums

    size = abs(J)
    g, p, D = gradient(u)
    for step in range(INNER):
        if np.all(np.abs(g) <= np.maximum(tolerance * mass, rounding(u, p))):
            return u, p, step
        du = solver(D, -g)
        u, (g, p, D) = _search(gradient, u, du, float(g @ du))
    return u, p, INNER


def _search(
    gradient: Callable[[Array], tuple[Array, Array, sp.spmatrix]], u: Array, du: Array, slope: float
) -> tuple[Array, tuple[Array, Array, sp.spmatrix]]:
    """A point on the ray with at most half the slope: bisection, as the slope of a convex function grows."""
    low, t, high = 0.0, 1.0, np.inf
    for _ in range(SEARCHES):
        new = u + t * du
        found = gradient(new)
        here = float(found[0] @ du)
        if abs(here) <= 0.5 * abs(slope):
            break
        low, high = (low, t) if here > 0.0 else (t, high)
        t = 0.5 * (low + high) if np.isfinite(high) else 2.0 * t
    return new, found
