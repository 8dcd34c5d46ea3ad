"""Laws of pairs below a gap: which rates of relative motion they resist, and what follows from their forces.

For where they come from see `fsi.lubrication.below`, for how they are solved with the flow `fsi.stokes.laws`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import MODES
from fsi.errors import SolveError

if TYPE_CHECKING:  # laws take long to load, and most flows have none
    from fsi.lubrication.below import OpenedGaps, PairRates

# Of a resistance, in the units of the model: more of it stands beside the matrix (see `fsi.stokes.laws`).
STIFF = 1e5
# Of the largest: what velocities that are alike may differ by.
SAME = 1e-12


@dataclass(frozen=True, slots=True)
class PairLaws:
    """Rates of relative motion, G U - b, that laws resist on top of what is resolved (see `fsi.stokes.laws`).

    Attributes:
        G: over the modes of all bodies, (R, N M).
        own: b, what walls and images move by themselves, (R,).
        resistance: kappa, force over rate, (R,).
        strains: S, the rates by a mean gradient W are S : W, (R, d, d).
        leaning: what the pressure of a pair adds to the stresslet of i and takes from that of j, (R, d, d).
        along: what a rate has of the other side's velocity, (R, d).
        wall: the number of the wall, -1 of two bodies, (R,).
        body: i and j, twice i beside a wall, (R, 2).
        meshed: whether a rate is that of the bodies where they are meshed, (R,).
        carried: how much faster than U the mean flow makes bodies move there, (N, M).
        share: of a stresslet on either body, as their radii are to their sum, (R, 2).
        gap: the part that the gap has in the distance of the centres, beside a wall from it, (R,).
        shut_in: whether gaps where laws act shut fluid in, whose pressure no law knows.
    """

    G: Array
    own: Array
    resistance: Array
    strains: Array
    leaning: Array
    along: Array
    wall: NDArray[np.intp]
    body: NDArray[np.intp]
    meshed: NDArray[np.bool_]
    carried: Array
    share: Array
    gap: Array
    shut_in: bool = False

    def at_rest(self) -> PairLaws:
        """The same between walls and images at rest, without a mean flow."""
        return replace(self, own=np.zeros_like(self.own), carried=np.zeros_like(self.carried))

    @property
    def in_matrix(self) -> Array:
        """What of kappa stands in the matrix of the flow, not beyond STIFF, (R,)."""
        return np.clip(self.resistance, -STIFF, STIFF)

    @property
    def K(self) -> scipy.sparse.csr_array:
        """G^T kappa G with that, (N M, N M)."""
        G = scipy.sparse.csr_array(self.G)
        return scipy.sparse.csr_array(G.T @ (G * self.in_matrix[:, None]))

    def rates(self, U: Array) -> Array:
        """G U - b of velocities (N, M), (R,)."""
        return np.asarray(self.G @ U.ravel() - self.own)

    def loads(self, forces: Array, shape: tuple[int, ...]) -> Array:
        """G^T f, what the forces add to the loads of the bodies, (N, M)."""
        return np.asarray((self.G.T @ forces).reshape(shape))

    def dissipation(self, forces: Array, U: Array) -> float:
        """f.(G U - b)."""
        return float(forces @ self.rates(U))

    def stresslets(self, forces: Array, bodies: int) -> Array:
        """f S on the bodies, (N, d, d)."""
        S, f = np.zeros((bodies, *self.strains.shape[1:])), forces[:, None, None]
        for body, share, sign in zip(self.body.T, self.share.T, (1.0, -1.0), strict=True):
            np.add.at(S, body, f * (share[:, None, None] * self.strains + sign * self.leaning))
        return S

    def in_gaps(self, forces: Array, bodies: int) -> Array:
        """What that has too much as loads are spread along gaps, (N, d, d): laws of loads do not tell it.

        The pressure of a squeezed gap d of the plane goes with h^(-2), h = d + x^2 / (2 a_r): its mean x^2 is
        2 a_r d. With the load F the normal stresslet on disc i is a_i F - a_r d F / a_i, d F less than its
        share of the lever, 2 d F less beside a wall. The one along the gap, with the shear stress h p' / 2,
        is - 2 a_i d F / (a_i + a_j), zero beside a wall: where it is more, so much is taken for both.
        """
        spread = replace(self, share=np.maximum(1.0, 2.0 * self.share), leaning=np.zeros_like(self.leaning))
        return spread.stresslets(self.gap * forces, bodies)

    def wall_force(self, forces: Array, wall: int) -> Array:
        """What moves a wall against these forces, along it, (d - 1,)."""
        here = self.wall == wall
        return np.asarray(-forces[here] @ self.along[here, :-1])

    def carrying_power(self, forces: Array, load: Array) -> float:
        """What it takes to carry bodies with these loads of the flow, (N, M), past where they are."""
        on_meshed = self.loads(np.where(self.meshed, forces, 0.0), load.shape)
        return float(np.sum((load + on_meshed) * self.carried))

    def defect(self, forces: Array, U: Array) -> float:
        """By how much rates differ from f / kappa, over the largest parts of a rate."""
        if not len(forces):
            return 0.0
        parts = np.abs(self.G) @ np.abs(U.ravel()) + np.abs(self.own)
        defect = np.abs(self.rates(U) - forces / self.resistance).max()
        return float(defect / max(float(parts.max()), float(np.finfo(float).tiny)))


def pair_laws(gaps: OpenedGaps, walls: Mapping[str, Callable[[Array], Array]], W: Array) -> PairLaws:
    """The laws of opened gaps between bodies and walls with these velocities, in a mean flow W x, (d, d).

    Raises SolveError: as `OpenedGaps.rates`, or a wall turns or stretches beside a gap.
    """
    rates, q = gaps.rates(), gaps.q
    names, E = gaps.container.walls, gaps.container.mean_gradient
    own = np.einsum("rk,rk->r", rates.along, rates.place @ E.T)
    for k in np.unique(rates.wall[rates.wall >= 0]):
        here = rates.wall == k
        velocity = walls[names[k]]
        _require_rigid(velocity, rates.place[here], rates.apart[here], names[k])
        own[here] = np.einsum("rk,rk->r", rates.along[here], velocity(rates.place[here]))
    carried = np.zeros_like(q.arms)
    carried[:, : q.dimension] = (gaps.meshed.centres - q.centres) @ W.T
    a, apart = q.radii[rates.body], np.linalg.norm(rates.apart, axis=1)
    share = a / a.sum(axis=1)[:, None]
    own -= np.where(rates.meshed, rates.G @ carried.ravel(), 0.0)
    return PairLaws(
        G=rates.G, own=own, resistance=rates.resistance, strains=_strains(rates), along=rates.along,
        wall=rates.wall, body=rates.body, meshed=rates.meshed, carried=carried, share=share,
        leaning=_leaning(rates, share[:, 0]),
        gap=1.0 - np.where(rates.wall < 0, a.sum(axis=1), a[:, 0]) / apart,
    )  # fmt: skip


def _require_rigid(velocity: Callable[[Array], Array], place: Array, apart: Array, wall: str) -> None:
    """Raise SolveError unless the linear velocity of a wall is the same all around points on it, (n, d).

    apart: from there along the normals. A wall that turns or stretches drives fluid into a gap or out of it.
    """
    at, size = velocity(place), np.linalg.norm(apart, axis=1)[:, None]
    for axis in np.eye(place.shape[1]):
        along = axis - (apart @ axis)[:, None] * apart / size**2
        if np.abs(velocity(place + size * along) - at).max() > SAME * np.abs(at).max():
            raise SolveError(
                f"lubrication.below: no law is known beside wall {wall!r}, whose velocity varies along it; "
                "drop it, or give the wall one velocity"
            )


def _strains(rates: PairRates) -> Array:
    """S of each rate, the symmetric tensor of its values by the gradients e_k (x) e_l, k <= l, (R, d, d)."""
    R, d = rates.apart.shape
    M = len(MODES[d])
    turns = rates.G.reshape(R, rates.G.shape[1] // M, M)[:, :, d:].sum(axis=1)
    S = np.zeros((R, d, d))
    for k in range(d):
        for m in range(k, d):
            W = np.zeros((d, d))
            W[k, m] = 1.0
            spin = 0.5 * (W.T - W)
            omega = [spin[0, 1]] if d == 2 else [spin[1, 2], spin[2, 0], spin[0, 1]]
            S[:, k, m] = S[:, m, k] = np.einsum("rk,rk->r", rates.along, rates.apart @ W.T) + turns @ omega
    return S


def _leaning(rates: PairRates, share: Array) -> Array:
    """What of the stresslet of i the pressure between two round bodies adds to its share, (R, d, d).

    It has no torque about their centres. So the moment m = T + l n x F of the loads F and T about the middle
    of the gap, at the part `share` of the way from i to j, l away, is that of the pressure p x along the gap:
    on the one side x p n is v n with v = n x m, and - v n on the other.
    """
    R, d = rates.apart.shape
    M, one = len(MODES[d]), np.arange(R)
    loads = rates.G.reshape(R, rates.G.shape[1] // M, M)[one, rates.body[:, 0]]
    n = rates.apart / np.linalg.norm(rates.apart, axis=1)[:, None]
    arm, F, T = share[:, None] * rates.apart, loads[:, :d], loads[:, d:]
    if d == 2:
        m = T[:, 0] + arm[:, 0] * F[:, 1] - arm[:, 1] * F[:, 0]
        v = np.stack([n[:, 1] * m, -n[:, 0] * m], axis=1)
    else:
        v = np.cross(n, T + np.cross(arm, F))
    both = v[:, :, None] * n[:, None, :]
    between = (rates.wall < 0)[:, None, None]
    return np.where(between, -0.5 * (both + both.swapaxes(1, 2)), 0.0)
