"""The network of lubricated gaps: `A = sum kappa(D) G (x) G` with `G = grad_q D`, and its linear system.

With the force lambda of each gap the system `Z u + A u = f + sum kappa b G` reads

    Z u + G^T lambda = f                momentum, Z diagonal: drag, and mass over the step
    lambda = kappa (G u - b)            the law; b: how fast walls and images move by themselves

and eliminating u leaves one unknown for each gap, `(1/kappa + G Z^-1 G^T) lambda = G Z^-1 f - b`. This matrix
is sparse, symmetric and positive definite like Z + A, but stays well conditioned as kappa grows without
bound, and momentum is balanced to rounding whatever is left of the residual. What is held has Z^-1 = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import cg, splu

from fsi.bodies import Array
from fsi.errors import SolveError
from fsi.reduced.pairs import Pairs

# A gap is no stiffer than this times the mobility of its two sides: they are rigid to this precision, and
# where there are more such gaps than freedoms the forces are still determined.
_RIGID = 1e-13
# The compliance of a gap without lubrication: its force is 0 to rounding.
_SLACK = 1e200
# In the plane the network is nearly planar and its factors are sparse at any size; in space they are not.
_LARGEST_DIRECT = 5000
_CG_TOLERANCE, _CG_ITERATIONS = 1e-14, 5000


def gradient(pairs: Pairs, bodies: int) -> sp.csr_matrix:
    """The rows G = grad_q D, shape (P, N d): n for body i, -n for body j, nothing for a wall."""
    P, d = pairs.n.shape
    sides = np.stack([pairs.i, np.where(pairs.is_wall, 0, pairs.j)], axis=1)
    columns = (d * sides[:, :, None] + np.arange(d)).reshape(P, 2 * d)
    entries = np.concatenate([pairs.n, -pairs.n], axis=1)
    there = (np.arange(2 * d) < d) | ~pairs.is_wall[:, None]
    starts = np.concatenate([[0], np.cumsum(there.sum(axis=1))])
    return sp.csr_matrix((entries[there], columns[there], starts), shape=(P, bodies * d))


def own_mobility(G: sp.csr_matrix, Z_inverse: Array) -> Array:
    """`g = G.Z^-1 G` of each gap, (P,)."""
    g: Array = G.multiply(G) @ Z_inverse.ravel()
    return g


@dataclass(frozen=True, slots=True)
class Network:
    """The gaps with their laws at one instant.

    pairs: P of them between N bodies; G: (P, N d); compliance: 1/kappa > 0, (P,).
    """

    pairs: Pairs
    G: sp.csr_matrix
    compliance: Array

    def rates(self, u: Array) -> Array:
        """`D' = G u - b` of velocities (N, d), shape (P,)."""
        rates: Array = self.G @ u.ravel() - self.pairs.b
        return rates

    def loads(self, force: Array) -> Array:
        """`G^T lambda`, the external loads (N, d) that balance forces (P,) of the gaps."""
        loads: Array = (self.G.T @ force).reshape(-1, self.pairs.n.shape[1])
        return loads

    def solve(self, u0: Array, Z_inverse: Array) -> tuple[Array, Array]:
        """Velocities and forces of the gaps.

        Args:
            u0: the velocities without lubrication, `Z^-1 f`; where held, the prescribed ones; (N, d).
            Z_inverse: 0 where held, (N, d).

        Returns:
            u (N, d) and lambda (P,), positive where a gap opens.

        Raises:
            SolveError: the system cannot be solved.
        """
        if len(self.pairs) == 0:
            return u0, np.empty(0)
        mobility = self.G.multiply(Z_inverse.ravel()).tocsr() @ self.G.T
        S = (mobility + sp.diags(self.compliance)).tocsc()
        force = _solve_spd(S, self.rates(u0), direct=u0.shape[1] == 2 or len(self.pairs) <= _LARGEST_DIRECT)
        return u0 - Z_inverse * self.loads(force), force


def make_network(pairs: Pairs, kappa: Array, Z_inverse: Array) -> Network:
    """The network of pairs with resistances kappa (P,), 0 and infinite ones within reach of numbers."""
    G = gradient(pairs, len(Z_inverse))
    own = own_mobility(G, Z_inverse)
    with np.errstate(divide="ignore"):
        compliance = np.clip(1.0 / kappa, _RIGID * np.where(own > 0.0, own, 1.0), _SLACK)
    return Network(pairs, G, compliance)


def _solve_spd(S: sp.csc_matrix, right: Array, *, direct: bool) -> Array:
    """Solve S x = right, S symmetric positive definite, scaled to the unit diagonal."""
    scale = 1.0 / np.sqrt(S.diagonal())
    D = sp.diags(scale)
    scaled = (D @ S @ D).tocsc()
    if direct:
        try:
            factors = splu(
                scaled, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError as error:
            raise SolveError(
                f"the forces in the gaps are not determined ({error}); give the bodies more drag or mass"
            ) from None
        x: Array = factors.solve(scale * right)
    else:
        x, unfinished = cg(scaled, scale * right, rtol=_CG_TOLERANCE, maxiter=_CG_ITERATIONS)
        if unfinished:
            raise SolveError(
                f"the forces in the gaps were not found in {_CG_ITERATIONS} iterations; shorten "
                "reduced.cutoff or give the bodies more drag"
            )
    found: Array = scale * x
    return found
