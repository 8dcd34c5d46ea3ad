"""The system of one instant, `zeta (U - u_inf) + D (U - U0) + A U = F_ext` on free modes; its balances."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.bodies.configuration import Array, Inertia, Motion
from fsi.errors import SolveError
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.identities import relative
from fsi.reduced.network import GapNetwork, make_network
from fsi.reduced.pairs import Pairs


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
        force: lambda of the gaps, (P,).
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
    def dissipation(self) -> float:
        """`sum lambda^2 / kappa + sum zeta |U - u_inf|^2`, the first `sum kappa D'^2`."""
        slip = self.U - self.ambient.background
        return float(np.sum(self.force**2 * self.network.compliance) + np.sum(self.ambient.zeta * slip**2))

    @property
    def outer_power(self) -> float:
        """Power of moving walls and images, `-lambda.b`, and of the background, `-zeta (U - u_inf).u_inf`."""
        ambient = self.ambient
        dragged = np.sum(ambient.zeta * (self.U - ambient.background) * ambient.background)
        return float(-self.force @ self.network.pairs.b - dragged)

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

    def energy(self, masses: Array, before: Array, h: float) -> float:
        """By how much a step h from velocities `before` violates the energy inequality, or 0.

        `1/2 |U|^2_M + h dissipation <= 1/2 |before|^2_M + h (applied.U + outer power)`, relative.
        """
        gain = 0.5 * float(np.sum(masses * (self.U**2 - before**2)))
        work = h * (float(np.sum(self.applied * self.U)) + self.outer_power)
        lost = h * self.dissipation
        return relative(max(gain + lost - work, 0.0), gain, lost, work, h * self.power_scale)


def solve_system(ambient: Surroundings, pairs: Pairs, kappa: Array, inertia: Inertia | None) -> SolvedSystem:
    """Solve for the velocities, with resistances kappa (P,).

    Raises:
        SolveError: the motion is not determined.
    """
    motion, d = ambient.motion, pairs.n.shape[1]
    zero = np.zeros_like(ambient.zeta)
    D, U0 = (inertia.D, inertia.U0) if inertia else (zero, zero)
    Z = ambient.zeta + D
    if np.any((Z <= 0.0) & ~motion.held):
        raise SolveError("reduced.drag = 0: only lubrication resists a free body; give it drag or a mass")
    applied = motion.F + ambient.zeta * ambient.background + D * U0
    Z_inverse = np.where(motion.held, 0.0, 1.0 / np.where(Z > 0.0, Z, 1.0))
    alone = np.where(motion.held, motion.U, Z_inverse * applied)
    network = make_network(pairs, kappa, Z_inverse[:, :d])
    u, force = network.solve(alone[:, :d], Z_inverse[:, :d])
    U = np.column_stack([u, alone[:, d:]])
    F = ambient.zeta * (U - ambient.background)
    F[:, :d] += network.loads(force)
    return SolvedSystem(ambient, Z, network, U, force, F, F + D * (U - U0), alone)
