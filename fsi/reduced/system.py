"""The system of one instant, `zeta (U - u_inf) + D (U - U0) + A U = F_ext` on free modes; its balances.

Every instant satisfies identities, as relative defects: one above the bound stops a run.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.errors import SolveError
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.network import GapNetwork, make_network
from fsi.reduced.pairs import Pairs
from fsi.reduced.stress import LubricationStress
from fsi.reduced.tangential import TangentialRows


@dataclass(frozen=True, slots=True)
class Surroundings:
    """All but the gaps at one instant.

    Attributes:
        enclosure: walls, periods and the flow without bodies.
        motion: what holds and drives the bodies.
        zeta: drag coefficients of all modes, (N, modes).
        background: u_inf and its rotation, (N, modes).
    """

    enclosure: Enclosure
    motion: Motion
    zeta: Array
    background: Array


@dataclass(frozen=True, slots=True)
class SolvedSystem:
    """A solved system.

    Attributes:
        ambient: all but the gaps.
        Z: `zeta + D`, (N, modes).
        network: the gaps.
        U: velocities, (N, modes).
        force: lambda of the rows of the network, (R,).
        F: what balances drag and lubrication, `zeta (U - u_inf) + G^T lambda`, (N, modes).
        applied: that and inertia, `F + D (U - U0)`, F_ext on free modes, (N, modes).
        alone: the velocities that there would be without lubrication, to which rounding relates, (N, modes).
    """

    ambient: Surroundings
    Z: Array
    network: GapNetwork
    U: Array
    force: Array
    F: Array
    applied: Array
    alone: Array

    @property
    def rates(self) -> Array:
        """`G U - b` by the laws, lambda / kappa, (R,)."""
        rates: Array = self.network.compliance * self.force
        return rates

    @property
    def dissipation(self) -> float:
        """`sum lambda^2 / kappa + sum zeta |U - u_inf|^2`, the first `sum kappa D'^2`."""
        slip = self.U - self.ambient.background
        return float(np.sum(self.force**2 * self.network.compliance) + np.sum(self.ambient.zeta * slip**2))

    @property
    def outer_power(self) -> float:
        """Power of moving walls and images, `-lambda.b`, and of the background, `-zeta (U - u_inf).u_inf`."""
        ambient = self.ambient
        dragged = np.sum(ambient.zeta * (self.U - ambient.background) * ambient.background)
        return float(-self.force @ self.network.own - dragged)

    @property
    def power_scale(self) -> float:
        """The power of the loads at the velocities that there would be without lubrication."""
        return float(np.sum(np.abs(self.applied * self.alone) + np.abs(self.F * self.alone)))

    def balances(self) -> dict[str, float]:
        """Relative defects: power of loads, walls, background less the dissipation; balance of the loads."""
        loads, outer, lost = float(np.sum(self.F * self.U)), self.outer_power, self.dissipation
        off = np.abs(self.applied - self.ambient.motion.F)[~self.ambient.motion.held].max(initial=0.0)
        largest = float(np.abs(self.F).max(initial=0.0) + np.abs(self.Z * self.alone).max(initial=0.0))
        return {
            "power": relative(loads + outer - lost, loads, outer, lost, self.power_scale),
            "balance": relative(off, largest, float(np.abs(self.ambient.motion.F).max(initial=0.0))),
        }

    def stress_defect(self, stress: LubricationStress) -> float:
        """Of the dissipation by drag and gaps from `|Omega| Sigma_L:E + F.(U - u_inf)`, relative."""
        power = stress.volume * float(np.sum(stress.mean * self.ambient.enclosure.strain_rate))
        loads, lost = float(np.sum(self.F * (self.U - self.ambient.background))), self.dissipation
        return relative(power + loads - lost, power, loads, lost, self.power_scale)

    def energy(self, masses: Array, before: Array, h: float) -> float:
        """By how much a step h from velocities `before` violates the energy inequality, or 0.

        `1/2 |U|^2_M + h dissipation <= 1/2 |before|^2_M + h (applied.U + outer power)`, relative: where
        bodies coast, all but both energies is their rounding.
        """
        now, old = (0.5 * float(np.sum(masses * velocity**2)) for velocity in (self.U, before))
        gain = now - old
        work = h * (float(np.sum(self.applied * self.U)) + self.outer_power)
        lost = h * self.dissipation
        return relative(max(gain + lost - work, 0.0), now, old, lost, work, h * self.power_scale)


def solve_system(
    ambient: Surroundings,
    pairs: Pairs,
    kappa: Array,
    inertia: Inertia | None,
    tangential: TangentialRows | None = None,
    stored: bool = False,
) -> SolvedSystem:
    """Solve for the velocities, with resistances kappa (P,) of the gaps, and those of sliding and rolling.

    stored: as in `GapNetwork`. Raises SolveError if the velocities are not determined, or lost in rounding.
    """
    motion, d = ambient.motion, pairs.n.shape[1]
    zero = np.zeros_like(ambient.zeta)
    D, U0 = (inertia.D, inertia.U0) if inertia else (zero, zero)
    Z = ambient.zeta + D
    if np.any((Z <= 0.0) & ~motion.held):
        remedy = "give it drag, or in a run a mass" if inertia is None else "give it drag or a mass"
        raise SolveError(f"reduced.drag = 0: only lubrication resists a free body; {remedy}")
    applied = motion.F + ambient.zeta * ambient.background + D * U0
    Z_inverse = np.where(motion.held, 0.0, 1.0 / np.where(Z > 0.0, Z, 1.0))
    alone = np.where(motion.held, motion.U, Z_inverse * applied)
    m = d if tangential is None else Z.shape[1]  # rotations do not enter the rates of gaps
    network = make_network(pairs, kappa, Z_inverse[:, :m], tangential, stored)
    u, force = network.solve(alone[:, :m], Z_inverse[:, :m])
    U = np.column_stack([u, alone[:, m:]])
    F = ambient.zeta * (U - ambient.background)
    F[:, :m] += network.loads(force)
    return SolvedSystem(ambient, Z, network, U, force, F, F + D * (U - U0), alone)


BOUND = 1e-12
_TINY = np.finfo(float).tiny


def identities(
    network: GapNetwork, q: Configuration, U: Array, alone: Array, force: Array
) -> dict[str, float]:
    """Relative defects of the forces of the rows, (R,), at velocities U (N, modes).

    Returns:
        momentum: the forces of the gaps between bodies and of the walls sum to zero, over sum |lambda|;
        angular_momentum: so do their moments and couples, 0 if any pair is periodic;
        kernel: a rigid motion of each cluster of bodies changes none of its rates, in units of its speed;
        residual: of the law `D' = lambda / kappa`, over the largest speed there is, or would be without
        lubrication (alone).
    """
    pairs, d = network.pairs, q.centres.shape[1]
    # What walls do across their normals has no point of attack: those rows are left out.
    from_gaps, balanced = force[: len(pairs)], np.where(network.beside_wall, 0.0, force)
    loads = network.loads(balanced)
    from_walls = from_gaps[pairs.is_wall, None] * pairs.n[pairs.is_wall]
    total = float(np.abs(force).sum()) + _TINY
    sums = loads[:, :d].sum(axis=0) - from_walls.sum(axis=0)
    defects: dict[str, float] = {"momentum": float(np.abs(sums).max()) / total}
    defects["angular_momentum"] = 0.0
    if not np.any(pairs.across_period):
        arm = q.centres - q.centres.mean(axis=0)
        moments = _moments(arm, loads[:, :d]).sum(axis=0)
        if network.modes > d:
            moments = moments + loads[:, d:].sum(axis=0)
        moments = moments - _moments(arm[pairs.i[pairs.is_wall]], from_walls).sum(axis=0)
        size = float(np.abs(arm).max()) + float(q.radii.max())
        defects["angular_momentum"] = float(np.abs(moments).max()) / (total * size)
    defects["kernel"] = _kernel(network, q)
    rates = network.rates(U[:, : network.modes])
    speed = float(np.abs(U).max() + np.abs(alone).max() + np.abs(network.own).max(initial=0.0)) + _TINY
    defects["residual"] = float(np.abs(rates - network.compliance * force).max(initial=0.0)) / speed
    return defects


def _kernel(network: GapNetwork, q: Configuration) -> float:
    """Largest |G U| over the largest |U|, for a rigid motion U of each cluster of gaps `between` bodies.

    A cluster that closes on itself through a period can only be translated.
    """
    pairs, N, d = network.pairs, len(q), q.dimension
    between = ~pairs.is_wall
    i, j = pairs.i[between], pairs.j[between]
    starts = np.append(0, np.cumsum(np.bincount(i, minlength=N)))  # pairs are in the order of i
    graph = sp.csr_matrix((np.ones(len(i)), j, starts), (N, N))
    clusters, label = connected_components(graph, directed=False)
    size = np.bincount(label, minlength=clusters)
    middle = np.column_stack([np.bincount(label, x) / size for x in q.centres.T])
    arm = q.centres - middle[label]
    turns = np.ones(clusters)
    turns[label[pairs.i[between & pairs.across_period]]] = 0.0
    squares = np.einsum("nk,nk->n", arm, arm)
    spin = turns / np.maximum(np.sqrt(np.bincount(label, squares) / size), q.radii.max())
    turning = np.zeros_like(arm)
    turning[:, 0], turning[:, 1] = -spin[label] * arm[:, 1], spin[label] * arm[:, 0]
    U = np.zeros((N, network.modes))
    U[:, :d] = 1.0 + turning
    if network.modes > d:
        U[:, -1] = spin[label]  # about z, in the plane and in space
    rates = (network.G @ U.ravel())[np.append(between, network.between)]
    return float(np.abs(rates).max(initial=0.0) / np.abs(U).max())


def _moments(arm: Array, force: Array) -> Array:
    """arm x force, shape (n, 1) in the plane, (n, 3) in space."""
    if arm.shape[1] == 2:
        return (arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])[:, None]
    moments: Array = np.cross(arm, force)
    return moments


def relative(defect: float, *terms: float) -> float:
    """|defect| over the sum of the sizes of its terms."""
    return abs(defect) / (sum(map(abs, terms)) + _TINY)


def require(
    checks: Mapping[str, float], t: float, remedy: str = "shorten reduced.cutoff or give the bodies more drag"
) -> None:
    """Raise SolveError, with the remedy, for the first defect above the bound."""
    for name, defect in checks.items():
        if not defect <= BOUND:
            raise SolveError(
                f"reduced model at t = {t:.9g}: {name} is violated by {defect:.1e}, more than {BOUND:g}; "
                + remedy
            )
