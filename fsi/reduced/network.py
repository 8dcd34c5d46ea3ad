"""The network of lubricated gaps: `A = sum kappa(D) G (x) G` with `G = grad_q D`, and its linear system.

With the force lambda of each gap the system `Z u + A u = f + sum kappa b G` reads

    Z u + G^T lambda = f                momentum, Z diagonal: drag, and mass over the step
    lambda = kappa (G u - b)            the law; b: how fast walls and images move by themselves

and eliminating u leaves one unknown for each gap, `(1/kappa + G Z^-1 G^T) lambda = G Z^-1 f - b`. This matrix
is sparse, symmetric and positive definite like Z + A, but stays well conditioned as kappa grows without
bound, and momentum is balanced to rounding whatever is left of the residual. What is held has Z^-1 = 0.
`fsi.reduced.gap_forces` solves it so that rates of narrow gaps are precise.

Where bodies also resist sliding and rolling, G and b have more rows (`fsi.reduced.tangential`), each with its
kappa and lambda, and u has the rotations.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.reduced.gap_forces import SEEN, GapSystem
from fsi.reduced.pairs import Pairs
from fsi.reduced.tangential import TangentialRows

# The compliance of a gap without lubrication: its force is 0 to rounding.
_SLACK = 1e200


@lru_cache(maxsize=2)  # of one step many ask for it
def gradient(pairs: Pairs, bodies: int) -> sp.csr_matrix:
    """The rows G = grad_q D, shape (P, N d): n for body i, -n for body j, zeros for a wall."""
    P, d = pairs.n.shape
    sides = np.stack([pairs.i, np.where(pairs.is_wall, pairs.i, pairs.j)], axis=1).astype(np.int32)
    columns = d * sides[:, :, None] + np.arange(d, dtype=np.int32)
    entries = np.stack([pairs.n, -pairs.n], axis=1)
    entries[pairs.is_wall, 1] = 0.0
    starts = np.arange(0, 2 * d * P + 1, 2 * d, dtype=np.int32)
    return sp.csr_matrix((entries.ravel(), columns.ravel(), starts), shape=(P, bodies * d))


def own_mobility(G: sp.csr_matrix, Z_inverse: Array) -> Array:
    """`g = G.Z^-1 G` of each gap, (P,)."""
    squares = sp.csr_matrix((G.data**2, G.indices, G.indptr), G.shape)
    g: Array = squares @ Z_inverse.ravel()
    return g


@dataclass(frozen=True, slots=True)
class GapNetwork:
    """The gaps with their laws at one instant: R rows of resisted rates, of which the first P are those of D.

    Attributes:
        pairs: P of them between N bodies.
        G: (R, N m), m = d velocities of each body, or all its modes where rows resist rotations.
        compliance: 1/kappa > 0, (R,).
        own: b, the part of the rates that walls and images have by themselves, (R,).
        modes: m.
        between: which of the rows after the first P are of two bodies, (R - P,).
        stored: whether gaps are stored and move by themselves, so that their rates here need only be precise
            beside the velocities without lubrication.
    """

    pairs: Pairs
    G: sp.csr_matrix
    compliance: Array
    own: Array
    modes: int
    between: NDArray[np.bool_]
    stored: bool = False

    @property
    def beside_wall(self) -> NDArray[np.bool_]:
        """Which rows resist sliding and turning beside walls, (R,)."""
        return np.append(np.zeros(len(self.pairs), dtype=bool), ~self.between)

    def rates(self, u: Array) -> Array:
        """`G u - b` of velocities (N, m), shape (R,); the first P are D'."""
        rates: Array = self.G @ u.ravel() - self.own
        return rates

    def loads(self, force: Array) -> Array:
        """`G^T lambda`, the external loads (N, m) that balance forces (R,) of the rows."""
        loads: Array = (self.G.T @ force).reshape(-1, self.modes)
        return loads

    def solve(self, u0: Array, Z_inverse: Array) -> tuple[Array, Array]:
        """Velocities u, (N, m), and forces lambda, (R,), positive where a gap opens.

        u0: the velocities without lubrication, `Z^-1 f`; where held, the prescribed ones, with Z_inverse = 0.
        Raises SolveError: the system cannot be solved.
        """
        if len(self.own) == 0:
            return u0, np.empty(0)
        mobility, d = own_mobility(self.G, Z_inverse), self.pairs.n.shape[1]
        system = GapSystem(self.G, self.compliance, self.own, mobility, Z_inverse.ravel(), u0.ravel(), d)
        u, force = system.first() if self.stored else system.solve()
        return u.reshape(u0.shape), force


def make_network(
    pairs: Pairs,
    kappa: Array,
    Z_inverse: Array,
    tangential: TangentialRows | None = None,
    stored: bool = False,
) -> GapNetwork:
    """The network of pairs with resistances kappa (P,), 0 and infinite ones within reach of numbers.

    Z_inverse: of the m modes that the rows have: of velocities, with `tangential` of all.
    """
    G, own, between = gradient(pairs, len(Z_inverse)), pairs.b, np.empty(0, dtype=bool)
    if tangential is not None:
        G = sp.vstack([_among_modes(G, Z_inverse.shape, pairs.n.shape[1]), tangential.G], "csr")
        own, kappa = np.append(own, tangential.own), np.append(kappa, tangential.resistance)
        between = tangential.between
    mobility = own_mobility(G, Z_inverse)
    # Stored gaps may be stopped, or so narrow that nothing tells them from rigid ones.
    least = SEEN * np.where(mobility > 0.0, mobility, 1.0) if stored else 0.0
    with np.errstate(divide="ignore"):
        compliance = np.clip(1.0 / kappa, np.maximum(least, 1.0 / _SLACK), _SLACK)
    return GapNetwork(pairs, G, compliance, own, Z_inverse.shape[1], between, stored)


def resistance_matrix(
    pairs: Pairs, kappa: Array, shape: tuple[int, int], tangential: TangentialRows | None
) -> sp.csr_matrix:
    """A over all M modes of N bodies, shape = (N, M): sum over the rows of kappa G (x) G, (N M, N M)."""
    G = _among_modes(gradient(pairs, shape[0]), shape, pairs.n.shape[1])
    if tangential is not None:
        G, kappa = sp.vstack([G, tangential.G], "csr"), np.append(kappa, tangential.resistance)
    return sp.csr_matrix(G.T @ sp.diags_array(kappa) @ G)


def _among_modes(G: sp.csr_matrix, shape: tuple[int, ...], d: int) -> sp.csr_matrix:
    """The same rows, of N d velocities, over all M modes of N bodies: shape (P, N M)."""
    body, component = np.divmod(G.indices, d)
    columns = (body * shape[1] + component).astype(G.indices.dtype)
    return sp.csr_matrix((G.data, columns, G.indptr), (G.shape[0], shape[0] * shape[1]))
