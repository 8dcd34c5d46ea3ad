"""The linear system of the gaps, solved until each law holds by itself.

    Z u + G^T lambda = f              momentum, as velocities w = u0 - u - Z^-1 G^T lambda, u0 = Z^-1 f
    G u - b - C lambda = 0            the laws, C = 1/kappa; r is what is left of them

One solve for the forces leaves r of the rounding of u0, in which the rate `C lambda` of a stiff gap is lost:
pressed by f it is f/kappa, and u0 = f/zeta. So (w, r) are solved for again, as corrections of u and lambda,
until they are at the rounding of the rate itself, or of u where bodies move together. w, in which u0 and the
forces cancel, is summed in twice the precision.

The corrections come from the matrix of the forces (`fsi.reduced.network`). It holds C beside G Z^-1 G^T, and
loses it where gaps are much stiffer than drag: harmless, unless there are more such gaps than freedoms, as
beside two walls, whose forces then depend on C. Those are corrected by the whole system, in v = Z^1/2 u and
y = C^1/2 lambda,

    [ I  B^T ] [v]
    [ B  -I  ] [y],      B = C^-1/2 G Z^-1/2,

So are crowds with far more rows than velocities, as without a cutoff, whose matrix of forces is nearly full:
here forces are eliminated first, each from two bodies, and a matrix of the velocities is left. The condition
of it all is the root of the largest kappa over Z (Y. Saad, Iterative Methods for Sparse Linear Systems,
2003, section 8.4; why corrections give small defects of each row: R. D. Skeel, Math. Comp. 35 (1980) 817).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from fsi.arrays import Array
from fsi.bodies.rows import products
from fsi.errors import SolveError
from fsi.reduced.twice_precise import transposed_product, two_product, two_sum

if TYPE_CHECKING:
    from fsi.bodies.row_products import Products

# Gaps whose compliance is below this times the mobility of their two sides are stiff: rounding of u0 may be
# seen in their rates.
_STIFF = 1e-6
# Below this the compliance is rounding in the matrix of the forces, which has this much: more stiff gaps than
# freedoms leave it regular.
SEEN = 1e-13
# Below this the whole system is lost in rounding too: its condition squared.
_LEAST = 1e-28
# What may be left: of a law, over its rate; otherwise as rounding, of single and of doubled precision.
_EPS = float(np.finfo(float).eps)
_LAW, _ROUNDING, _DOUBLED = 1e-9, 8.0 * _EPS, 64.0 * _EPS**2
# By how much rounding of the velocities may change forces, over the largest.
_FORCES = 1e-6
# Corrections by the matrix of the forces, which need one or two, and by the whole system.
_FEW, _MANY = 4, 30
# Up to this many gaps the system is factorised; more are solved by conjugate gradients, a third of the work
# in the plane and far less in space. Chains of stiff gaps take many iterations. In the plane, where the
# network is nearly planar and its factors are sparse at any size, it is then factorised all the same.
LARGEST_DIRECT = 5000
# So many rows for each velocity have a fuller matrix than the velocities, as where no cutoff leaves pairs
# out; up to so many of these.
_CROWDED, _LARGEST_FULL = 3, 2000
_CG_TOLERANCE, _PATIENCE = 1e-14, {2: 300, 3: 5000}
_OF_CORRECTIONS = 1e-6  # the tolerance of theirs

# Defects w (N m,) and r (R,) to corrections of u and lambda.
type Correction = Callable[[Array, Array], tuple[Array, Array]]


@dataclass(frozen=True, slots=True)
class GapSystem:
    """Its data, with R rows of N bodies with m modes in d dimensions.

    Attributes:
        G: (R, N m).
        compliance: C > 0, (R,).
        own: b, (R,).
        mobility: `G.Z^-1 G` of each row, (R,).
        Z_inverse: 0 where held, (N m,).
        u0: (N m,).
        d: dimensions.
    """

    G: sp.csr_matrix
    compliance: Array
    own: Array
    mobility: Array
    Z_inverse: Array
    u0: Array
    d: int

    def first(self) -> tuple[Array, Array]:
        """u and lambda, w and r beside u0 at rounding. Raises SolveError: they are not determined."""
        return self._balanced(self._correction())

    def solve(self) -> tuple[Array, Array]:
        """u and lambda, w and r at rounding. Raises SolveError: not determined, or lost in rounding."""
        correction = self._correction()
        start = self._balanced(correction)
        if correction.one_suffices:
            return start
        found = self._corrected(start, correction, _FEW)
        if found is None and self._may_be_factorised:
            found = self._corrected(start, _ByAll(self), _MANY)
        if found is None:
            raise self._lost("how they move is")
        return found

    def _balanced(self, correction: Correction) -> tuple[Array, Array]:
        """u and lambda of one solve; whatever is left of the laws, momentum balances to rounding."""
        _, force = correction(self.u0, -self.own)
        return self.u0 - self.Z_inverse * (self.G.T @ force), force

    def _correction(self) -> _ByForces | _ByAll:
        """By the smaller factors: of the forces, or of all, whose forces are eliminated first."""
        velocities = len(self.u0)
        crowded = velocities <= _LARGEST_FULL and len(self.own) > _CROWDED * velocities
        return _ByAll(self) if crowded else _ByForces(self)

    @property
    def _may_be_factorised(self) -> bool:
        within = bool(np.all(self.compliance >= _LEAST * self.mobility))
        return within and (self.d == 2 or len(self.own) <= LARGEST_DIRECT)

    def _lost(self, what: str) -> SolveError:
        most = (self.mobility / self.compliance).max()
        return SolveError(
            f"gaps resist {most:.1e} times as much as drag and inertia: {what} lost in rounding; give the "
            "bodies more drag"
        )

    def _corrected(
        self, start: tuple[Array, Array], correction: Correction, most: int
    ) -> tuple[Array, Array] | None:
        """u and lambda, None if so many corrections do not do. Raises SolveError: forces are lost."""
        (u, force), low = start, np.zeros_like(start[1])
        for _ in range(most):
            w, r = self._defects(u, force, low)
            if self._settled(u, force, w, r):
                self._require_forces(u, force, correction)
                return u, force
            du, change = correction(w, r)
            u = u + du
            force, lost = two_sum(force, change)
            low = low + lost
            if not np.isfinite(force).all():
                return None
        return None

    def _defects(self, u: Array, force: Array, low: Array) -> tuple[Array, Array]:
        """w and r of u and forces with what rounding took from them."""
        loads, rest = transposed_product(self.G, force, low)
        shift, error = two_product(self.Z_inverse, loads)
        left, lost = two_sum(self.u0, -shift)
        w = (left - u) + (lost - error - self.Z_inverse * rest)
        return w, self.G @ u - self.own - self.compliance * force

    def _settled(self, u: Array, force: Array, w: Array, r: Array) -> bool:
        """Whether w and r are at rounding."""
        doubled = _DOUBLED * (np.abs(self.u0) + self.Z_inverse * (abs(self.G).T @ np.abs(force)))
        of_laws = _LAW * self.compliance * np.abs(force) + _ROUNDING * self._speeds(u)
        return bool(np.all(np.abs(w) <= _ROUNDING * np.abs(u) + doubled) and np.all(np.abs(r) <= of_laws))

    def _speeds(self, u: Array) -> Array:
        """The sizes of what rates are sums of, (R,)."""
        return np.asarray(abs(self.G) @ np.abs(u) + np.abs(self.own))

    def _require_forces(self, u: Array, force: Array, correction: Correction) -> None:
        """Raise SolveError where rounding of rates, of any signs, changes the forces."""
        signs = np.random.default_rng(0).choice([-1.0, 1.0], len(force))
        _, change = correction(np.zeros_like(u), _EPS * signs * self._speeds(u))
        if not np.abs(change).max() <= _FORCES * np.abs(force).max():
            raise self._lost("their forces are")


class _ByForces:
    """Corrections by the matrix of the forces, scaled: `H H^T + slack` of unit diagonal."""

    def __init__(self, system: GapSystem) -> None:
        self.system, self.tolerance = system, _CG_TOLERANCE
        G, compliance = system.G, np.maximum(system.compliance, SEEN * system.mobility)
        self.scale = 1.0 / np.sqrt(system.mobility + compliance)
        self.H = G.copy()
        self.H.data *= np.repeat(self.scale, np.diff(G.indptr)) * np.sqrt(system.Z_inverse)[G.indices]
        self.slack = self.scale**2 * compliance
        self.one_suffices = not np.any(system.compliance < _STIFF * system.mobility)
        self._factors: SuperLU | None = None

    def __call__(self, w: Array, r: Array) -> tuple[Array, Array]:
        """Raises SolveError: the forces are not determined, or not found."""
        G, Z_inverse = self.system.G, self.system.Z_inverse
        force = self.scale * self._solved(self.scale * (G @ w + r))
        self.tolerance = _OF_CORRECTIONS  # of all but the first, which is the solution
        return w - Z_inverse * (G.T @ force), force

    def _solved(self, right: Array) -> Array:
        if self._factors is None and len(right) > LARGEST_DIRECT:
            patience = _PATIENCE[self.system.d]
            found = self._products.solve(right, self.tolerance, patience)
            if found is not None:
                return found
            if self.system.d == 3:
                raise SolveError(
                    f"the forces in the gaps were not found in {patience} iterations; shorten "
                    "reduced.cutoff or give the bodies more drag"
                )
        if self._factors is None:
            self._factors = self._factorised()
        return np.asarray(self._factors.solve(right))

    @cached_property
    def _products(self) -> Products:
        return products(self.H, self.slack)

    def _factorised(self) -> SuperLU:
        try:
            return _symmetric_factors(self.H @ self.H.T.tocsr() + sp.diags_array(self.slack))
        except RuntimeError as error:
            raise SolveError(
                f"the forces in the gaps are not determined ({error}); give the bodies more drag or mass"
            ) from None


def _symmetric_factors(matrix: sp.sparray) -> SuperLU:
    """Of a definite or quasi-definite matrix, which needs no pivots."""
    symmetric = {"SymmetricMode": True}
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric)


class _ByAll:
    """Corrections by the whole system, in v and y; one leaves the rounding of both in the laws."""

    one_suffices = False

    def __init__(self, system: GapSystem) -> None:
        self.G, self.root, self.share = system.G, np.sqrt(system.compliance), np.sqrt(system.Z_inverse)
        B = sp.diags_array(1.0 / self.root) @ system.G @ sp.diags_array(self.share)
        of_bodies, of_rows = sp.eye_array(len(self.share)), sp.eye_array(len(self.root))
        self._factors = _symmetric_factors(sp.block_array([[of_bodies, B.T], [B, -of_rows]]))

    def __call__(self, w: Array, r: Array) -> tuple[Array, Array]:
        """What is held has the velocity w."""
        held = np.where(self.share > 0.0, 0.0, w)
        v = np.divide(w, self.share, out=np.zeros_like(w), where=self.share > 0.0)
        both = self._factors.solve(np.concatenate([v, -(r + self.G @ held) / self.root]))
        return self.share * both[: len(w)] + held, both[len(w) :] / self.root
