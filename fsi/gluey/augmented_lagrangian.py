"""One convex program for all eps >= 0, by an augmented Lagrangian and Newton's method with sparse factors.

    min_u  1/2 |u - u*|_M^2  +  sum_k  E_k(b_k + (J u)_k)

with convex E_k: the film energy `eps Psi`, `Psi' = ln` (`fsi.gluey.film`), or, as eps -> 0, the wall `r >=
0`. With impulses `p = -E'(r)` the optimum is `M (u - u*) = J^T p`. Each outer step keeps p near the last one,

    p(r) = argmin_p  E*(-p) + p.r + |p - p_old|^2 / (2 sigma),          M (u - u*) = J^T p(b + J u)

which is a smooth convex minimisation for any sigma > 0, also where E is a wall: R. T. Rockafellar, Math.
Oper. Res. 1 (1976) 97. It is solved for the change y that the last impulses still miss,

    M y = J^T (p(r_old + J y) - p_old),       u_old = u* + M^-1 J^T p_old,    r_old = b + J u_old,

since sigma multiplies r: rounding of u would cost 1e-16 sigma u, that of y vanishes with y. So sigma may be
as large as a crowd needs whose contacts all but hold each other (where `J M^-1 J^T` has an eigenvalue lambda
near 0, an outer step leaves 1/(1 + sigma lambda) of the error). The Newton matrix `M + J^T (-dp/dr) J` is
sparse, symmetric and positive definite. A factor is kept as preconditioner of conjugate gradients while few
contacts change.
"""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, SuperLU, cg, splu

from fsi.arrays import Array


@dataclass(frozen=True, slots=True)
class Program:
    """The program but for its energies E_k, or which impulses they allow: these are the rows' response.

    Attributes:
        J: rows, shape (rows, modes).
        b: `r = b + J u` are the rates of the rows, (rows,).
        mass: diagonal of M, > 0, (modes,).
        u_star: the velocity without impulses, (modes,).
    """

    J: sp.csr_matrix
    b: Array
    mass: Array
    u_star: Array

    @property
    def weight(self) -> Array:
        """The rate of each row that its own unit impulse makes, the diagonal of `J M^-1 J^T`, (rows,)."""
        diagonal: Array = self.J.multiply(self.J) @ (1.0 / self.mass)
        return diagonal

    def velocity(self, p: Array) -> Array:
        """`u = u* + M^-1 J^T p`, (modes,), after the impulses p, (rows,)."""
        u: Array = self.u_star + (self.J.T @ p) / self.mass
        return u

    def rate(self, u: Array) -> Array:
        """`r = b + J u`, (rows,)."""
        r: Array = self.b + self.J @ u
        return r


@dataclass(frozen=True, slots=True)
class Impulses:
    """A solution, as good as rounding and patience allow.

    Attributes:
        p: impulses, shape (rows,).
        u: velocities, (modes,).
        kkt: the residual of the rows' response, a rate.
        iterations: of the gradient.
        steps: of Newton's method.
    """

    p: Array
    u: Array
    kkt: float
    iterations: int
    steps: int


OUTER, INNER, SEARCHES = 25, 60, 40
ROUNDING = 2.0**-53
# Conjugate gradients: how well they solve, and after how many iterations a new factor is cheaper.
ACCURACY, PATIENCE = 1e-6, 8
# The penalty sigma in units of the mass that a row feels. It grows only where an outer step leaves more than
# a part ENOUGH of the residual, as Newton's method finds what touches more easily when it is small.
FIRST, GROWTH, LARGEST, ENOUGH = 1e3, 100.0, 1e9, 0.3


class Response(Protocol):
    """What the rows answer to their rates."""

    def scales(self, weight: Array) -> Array:
        """By what rows are scaled, positive, of the rates that their unit impulses make, (rows,) both."""

    def impulse(self, r: Array, p_old: Array, sigma: Array) -> tuple[Array, sp.spmatrix]:
        """p(r) and `-dp/dr >= 0`, symmetric, (rows, rows)."""

    def residual(self, r: Array, p: Array, weight: Array) -> float:
        """How far p is from -E'(r), as a rate; weight: as `scales` gives it, (rows,)."""


@dataclass(slots=True)
class _Solver:
    """Solves with `M + J^T D J`, keeping a factor as long as it helps."""

    J: sp.csr_matrix
    mass: Array
    lu: SuperLU | None = field(default=None)

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
        return np.asarray(self.lu.solve(rhs))


@dataclass(frozen=True, slots=True)
class _Point:
    """Where Newton's method is: y, the gradient `g = M y - J^T (p - p_old)`, the impulses p, `D = -dp/dr`."""

    y: Array
    g: Array
    p: Array
    D: sp.spmatrix


@dataclass(frozen=True, slots=True)
class _Proximal:
    """One outer step: the program, the rows' response, and p_old, r_old, sigma, each of shape (rows,)."""

    program: Program
    response: Response
    p_old: Array
    r_old: Array
    sigma: Array

    def at(self, y: Array) -> _Point:
        """The gradient at y."""
        J = self.program.J
        p, D = self.response.impulse(self.r_old + J @ y, self.p_old, self.sigma)
        return _Point(y, self.program.mass * y - J.T @ (p - self.p_old), p, D)

    def rounding(self, here: _Point) -> Array:
        """Of g: that of p, which is sigma times that of the rate where p feels it, and of the sums."""
        size = abs(self.program.J)
        of_rate = abs(here.D) @ (np.abs(self.r_old) + size @ np.abs(here.y))
        noise = of_rate + np.abs(here.p) + np.abs(self.p_old)
        of_sums: Array = ROUNDING * (size.T @ noise + self.program.mass * np.abs(here.y))
        return of_sums


def minimise(program: Program, p: Array, response: Response, tolerance: float) -> Impulses:
    """Solve the program from impulses p, (rows,), to a residual, a rate, below the tolerance.

    The best that rounding allows: its residual may exceed the tolerance, which is the caller's to judge.
    """
    weight = response.scales(program.weight)
    sigma = FIRST / weight
    solver = _Solver(program.J, program.mass)
    steps, inner, before, best = 0, 0, np.inf, Impulses(p, program.u_star, np.inf, 0, 0)
    for outer in range(OUTER + 1):
        u = program.velocity(p)
        r = program.rate(u)
        residual = response.residual(r, p, weight)
        if residual < best.kkt:
            best = Impulses(p, u, residual, 0, steps)
        if residual <= tolerance or outer == OUTER:
            break
        if residual > ENOUGH * before and inner < INNER:
            sigma = np.minimum(GROWTH * sigma, LARGEST / weight)
        before = residual
        p, inner = _inner(_Proximal(program, response, p, r, sigma), solver, 0.1 * tolerance)
        steps += inner
    return best


def _inner(problem: _Proximal, solver: _Solver, tolerance: float) -> tuple[Array, int]:
    """The impulses of an outer step, and the number of Newton steps to them."""
    mass = problem.program.mass
    here = problem.at(np.zeros_like(mass))
    for step in range(INNER):
        if np.all(np.abs(here.g) <= np.maximum(tolerance * mass, problem.rounding(here))):
            return here.p, step
        here = _search(problem, here, solver(here.D, -here.g))
    return here.p, INNER


def _search(problem: _Proximal, here: _Point, dy: Array) -> _Point:
    """A point on the ray with at most half the slope: bisection, as the slope of a convex function grows."""
    slope = float(here.g @ dy)
    low, t, high = 0.0, 1.0, np.inf
    for _ in range(SEARCHES):
        new = problem.at(here.y + t * dy)
        ahead = float(new.g @ dy)
        if abs(ahead) <= 0.5 * abs(slope):
            break
        low, high = (low, t) if ahead > 0.0 else (t, high)
        t = 0.5 * (low + high) if np.isfinite(high) else 2.0 * t
    return new
