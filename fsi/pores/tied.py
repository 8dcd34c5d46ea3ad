"""The form of all numbers under the constraints of narrow necks: a symmetric indefinite system.

    [ K + diag(D)   B^T ] [ x ]   [ r ]
    [ B             0   ] [ p ] = [ s ]

K has entries of up to gap^-5/2, but of numbers of their own: scaled to unit diagonal nothing in it is large.
GMRES solves the system. It is preconditioned by Cholesky's factors of

    K + diag(D) + B^T kappa B,

the matrix of an augmented Lagrangian: they solve the system that has -1/kappa in place of 0. Where
constraints do not depend on each other that is nearly the same, and some five iterations do; those around a
pore that narrow necks shut in nearly depend on each other, and a lattice of such pores takes a hundred.
"""

import numpy as np
import scipy  # its modules load when they are used
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.pores.definite import Cholesky, scaled_residual

# kappa of constraints of unit length, for K of unit diagonal: with 1e5 and more rounding takes iterations.
_AUGMENTED = 1e4
# Residuals go down by this factor in at most so many steps; what is left is refined, and checked.
_REDUCTION, _STEPS = 1e-9, 100
_TINY = float(np.finfo(float).tiny)


class TiedFactors:
    """What solves the system of those rows and columns of K + diag(D) that are free, and all constraints."""

    def __init__(self, lower: sp.csr_matrix, free: NDArray[np.bool_], D: Array, ties: sp.csr_matrix) -> None:
        """The lower triangle of K, D of all n rows, as `Cholesky` has them; B (t, n). Raises as that does."""
        diagonal = lower.diagonal() + D
        inverse = np.where(free, 1.0 / np.maximum(diagonal, _TINY), 0.0)
        length = ties.multiply(ties) @ inverse
        self._kappa = _AUGMENTED / length
        self._scale = np.sqrt(np.concatenate([inverse[free], 1.0 / length]))
        augmented = sp.csr_matrix(lower + sp.tril(ties.T @ sp.diags_array(self._kappa) @ ties))
        augmented.sort_indices()
        self._factors = Cholesky(augmented, free, D)
        self._lower, self._above, self._free = lower, D - lower.diagonal(), free
        self._B = ties[:, free]

    def solve(self, b: Array) -> Array:
        """(x, p); b = (r, s), or one right side a column."""
        if b.ndim == 2:
            return np.stack([self.solve(column) for column in b.T], axis=1)
        operator, scale = scipy.sparse.linalg.LinearOperator, self._scale
        size = (len(b), len(b))
        z, _ = scipy.sparse.linalg.gmres(
            operator(size, lambda z: scale * self._times(scale * z)),
            scale * b,
            rtol=_REDUCTION,
            restart=_STEPS,
            maxiter=1,
            M=operator(size, lambda r: self._nearly_solved(r / scale) / scale),
        )
        return np.asarray(scale * z)

    def residual(self, defect: Array, b: Array, dissipation: Array | float = 0.0) -> float:
        """As that of `Cholesky`, constraints scaled to unit length."""
        return scaled_residual((defect, b), self._scale, dissipation)

    def _times(self, z: Array) -> Array:
        of_free, p = self._parts(z)
        x = np.zeros(len(self._free))
        x[self._free] = of_free
        Kx = self._lower @ x + self._lower.T @ x + self._above * x
        return np.concatenate([Kx[self._free] + self._B.T @ p, self._B @ of_free])

    def _nearly_solved(self, b: Array) -> Array:
        """(x, p) of the system with -1/kappa."""
        r, s = self._parts(b)
        x = self._factors.solve(r + self._B.T @ (self._kappa * s))
        return np.concatenate([x, self._kappa * (self._B @ x - s)])

    def _parts(self, z: Array) -> list[Array]:
        return np.split(z, [len(z) - len(self._kappa)])


type Factors = Cholesky | TiedFactors


def factors_of(lower: sp.csr_matrix, free: NDArray[np.bool_], D: Array, ties: sp.csr_matrix) -> Factors:
    """Those of K + diag(D), with its constraints if there are any; raises as they do."""
    return TiedFactors(lower, free, D, ties) if ties.shape[0] else Cholesky(lower, free, D)


class LastFactors:
    """The factors of the last flow in a system: another with the same numbers free takes them again."""

    def __init__(self) -> None:
        """None are known yet."""
        self._last: tuple[NDArray[np.bool_], Array, Factors] | None = None

    def of(self, lower: sp.csr_matrix, free: NDArray[np.bool_], D: Array, ties: sp.csr_matrix) -> Factors:
        """Those of K + diag(D), always of the same K and constraints; raises as `factors_of`."""
        if self._last is None or not (
            np.array_equal(free, self._last[0]) and np.array_equal(D, self._last[1])
        ):
            self.forget()  # before others take as much memory
            self._last = free, D, factors_of(lower, free, D, ties)
        return self._last[2]

    def forget(self) -> None:
        """Free their memory."""
        self._last = None
