"""The convex program of a step, `min_u 1/2 |u - u*|_M^2 + sum_k E_k(b_k + (J u)_k)`, and its solution."""

from __future__ import annotations

from dataclasses import dataclass

import scipy.sparse as sp

from fsi.bodies.configuration import Array


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
