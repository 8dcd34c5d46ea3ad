"""Velocities of bodies between pores: the least dissipation less the power of what drives them.

    1/2 x^T K x - b . x -> min     over the numbers x that are free,

K x = b. What is held gives the forces that hold it, (K x)_held. Narrow necks have numbers of their own, tied
to those of surfaces (see `narrow`): then K x + B^T p = b, B x = 0. The dissipation x^T K x is that of a flow
that satisfies all but the momentum equation, so at given velocities, or for bodies free of force between
moving walls, it is never less than that of Stokes flow: an upper bound of the apparent viscosity.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Inertia, Motion
from fsi.pores.assembly import Batch
from fsi.pores.carrier import Carrier, carried, mean_flow, product
from fsi.pores.forms import applied, rates_of_numbers, with_bubbles
from fsi.pores.orders import RIGID, TIED
from fsi.pores.system import PoreSystem

_TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, slots=True)
class PoreLoading:
    """What drives the bodies and the fluid.

    Attributes:
        motion: of the N bodies, modes (U_x, U_y, omega).
        walls: U_x, U_y, omega of the surfaces that are no discs, in their order, (W, 3).
        gradient: mean velocity gradient, by which periods change, (2, 2), trace 0.
        pressure_gradient: dp/dx along a channel; None where the net flux is given.
        net_flux: through such a channel, of fluid and bodies.
        inertia: of an implicit step.
    """

    motion: Motion
    walls: Array
    gradient: Array
    pressure_gradient: float | None = 0.0
    net_flux: float | None = None
    inertia: Inertia | None = None

    def on(self, system: PoreSystem) -> PoreLoading:  # noqa: ARG002
        """The same in any system; where a stress is given it takes a system to know the speed."""
        return self


class PoreDrive(Protocol):
    """What becomes a loading in a system."""

    def on(self, system: PoreSystem) -> PoreLoading:
        """The loading there. Raises SolveError."""


@dataclass(frozen=True, eq=False)
class PoreFlow:
    """A flow through pores.

    Attributes:
        system: whose numbers these are.
        loading: what drives it.
        x: all numbers, those of the images of surfaces less the mean flow, (n,).
        y: what they have more than surfaces carried along (`Carrier`), (n,): small in a large domain.
        U: velocities of bodies, (N, 3).
        F: loads on them less their inertia, those that hold them too, (N, 3): minus those of the fluid.
        multipliers: of the constraints of narrow necks, (t,): of each minus the pressure that drives the flux
            through it, then minus the force that parts its surfaces.
        reactions: mu K x + B^T p with the mean flow, (n,): the power that a unit of each number takes.
        dissipation: in the fluid, mu x^T K x with the mean flow.
        checks: relative defects: residual, power, momentum.
    """

    system: PoreSystem
    loading: PoreLoading
    x: Array
    y: Array
    U: Array
    F: Array
    multipliers: Array
    reactions: Array
    dissipation: float
    checks: dict[str, float]

    @property
    def carrier(self) -> Carrier:
        """The flow that carries all along."""
        return Carrier.of(self.system, self.loading.gradient, self.loading.walls)

    @property
    def gradient(self) -> Array:
        """Mean velocity gradient, by which periods change, (2, 2)."""
        return self.loading.gradient

    @property
    def wall_forces(self) -> Array:
        """On the walls, as F, (W, 3)."""
        system = self.system
        first = system.assembly.numbering.surface[system.pores.surfaces.discs : -1]
        return np.asarray(self.reactions[first[:, None] + np.arange(3)])

    @property
    def pressure_gradient(self) -> float:
        """dp/dx along a channel: a unit of flux takes the power -dp/dx times the length of a period."""
        top, length = _driven(self.system)
        return -_flux_sign(self.system) * float(self.reactions[top]) / length

    @property
    def flux(self) -> float:
        """Along a channel, of fluid and bodies: psi of its second wall, as that of the first is 0."""
        top, _ = _driven(self.system)
        return _flux_sign(self.system) * float(self.x[top])

    @property
    def stresslets(self) -> Array:
        """Of the bodies of a periodic flow, less their traces, (N, 2, 2).

        To strain the surface of body i alone by E' takes the power -S_i : E'; psi = Re z^2 and Im z^2,
        z = (r_x + i r_y) / a, have E' = -(2 / a^2) [[0, 1], [1, 0]] and (2 / a^2) diag(1, -1).
        """
        bodies = np.arange(self.system.bodies)
        power = self.reactions[self.system.strains] * self.system.pores.surfaces.radius[bodies, None] ** 2
        xy, xx = 0.25 * power[:, 0], -0.25 * power[:, 1]
        return np.stack([xx, xy, xy, -xx], axis=1).reshape(-1, 2, 2)

    def numbers(self, batch: Batch) -> Array:
        """Of the pores of a batch, with the mean flow of their images, (n, m)."""
        found: Array = self.x[batch.unknown] + mean_flow(self.system, batch, self.loading.gradient)
        return found

    def functions(self, batch: Batch) -> Array:
        """Of all functions of the pores of a batch, (n, total)."""
        rates, _ = rates_of_numbers(self.system.shapes.of(batch.pore), batch.rule, batch.orders)
        return batch.of_functions(with_bubbles(rates, self.numbers(batch)))

    def local_numbers(self, batch: Batch) -> Array:
        """The same but for a translation of each pore, which costs nothing: few digits cancel in them."""
        found: Array = self.y[batch.unknown] + carried(self.system, batch, self.carrier.G)
        return found

    def power_of(self, numbers: Callable[[Batch], Array]) -> float:
        """That of numbers of pores, (n, m) of each batch."""
        of_pores = zip(self.system.assembly.batches, self._local_products, strict=True)
        total = sum(float(np.vdot(numbers(batch), Kx)) for batch, Kx in of_pores)
        return self.system.viscosity * total + float(self.multipliers @ tied(self.system, numbers))

    def power_of_mean(self, gradient: Array) -> float:
        """That of a mean gradient, by which the periods and all images change: |cell| Sigma_sides : G."""
        return self.power_of(lambda batch: mean_flow(self.system, batch, gradient))

    def dissipation_of_pores(self) -> Array:
        """Of each pore, (E,); fluid discs have theirs besides."""
        lost = np.empty(len(self.system.pores.vertices))
        for batch, Kx in zip(self.system.assembly.batches, self._local_products, strict=True):
            lost[batch.pore] = np.sum(self.local_numbers(batch) * Kx, axis=1)
        return self.system.viscosity * lost

    @cached_property
    def _local_products(self) -> list[Array]:
        """K times the local numbers of the pores of each batch, of viscosity 1, (n, m)."""
        batches = self.system.assembly.batches
        return [applied(batch.forms.K, self.local_numbers(batch)) for batch in batches]


def solve_pores(system: PoreSystem, loading: PoreLoading) -> PoreFlow:
    """The flow that a loading drives. Raises SolveError: bodies overlap, or the motion is not determined."""
    mu, n, N = system.viscosity, system.size, system.bodies
    body = system.assembly.numbering.surface[:N, None] + np.arange(3)
    carrier = Carrier.of(system, loading.gradient, loading.walls)
    base = carrier.numbers(system)
    given, held = _prescribed(system, loading)
    y = np.where(held, given - base, 0.0)
    if not len(loading.walls):
        y[system.assembly.numbering.surface[0] + 3] = 0.0  # a constant, with which no other number need grow
    b, D = _loads(system, loading), np.zeros(n)
    if loading.inertia is not None:
        D[body] = loading.inertia.D
        b[body] += loading.inertia.D * loading.inertia.U0
    of_base, base_power = carrier.power(system)
    free, B = ~held, system.assembly.ties
    B_base = tied(system, lambda batch: carried(system, batch, carrier.G))
    p = np.zeros(len(B_base))

    def left(Ky: Array) -> Array:
        """Of the equations of free numbers, over mu, and of the constraints."""
        of_numbers = b - of_base - Ky - D * (y + base) - B.T @ p
        return np.concatenate([of_numbers[free] / mu, -B_base - B @ y])

    Ky = mu * product(system, y)
    rhs = defect = left(Ky)
    factors = system.factors.of(system.assembly.lower, free, D / mu, B)
    for _ in range(2):
        of_y, of_p = np.split(factors.solve(defect), [len(rhs) - len(p)])
        y[free] += of_y
        p += mu * of_p
        Ky = mu * product(system, y)
        defect = left(Ky)
    x = y + base
    if not len(loading.walls):
        first = system.assembly.numbering.surface[:-1]
        x[first + 3] -= x[first[0] + 3]
    U = x[body]
    reactions = Ky + of_base + B.T @ p
    # On free modes what they are given, less what inertia takes; what holds the others is found.
    inertia = D[body] * (U - loading.inertia.U0) if loading.inertia else np.zeros_like(U)
    F = np.where(loading.motion.held, reactions[body], loading.motion.F - inertia)
    dissipation = float(y @ Ky + 2.0 * of_base @ y + base_power)
    residual = factors.residual(defect, rhs, dissipation / mu)
    flow = PoreFlow(system, loading, x, y, U, F, p, reactions, dissipation, {})
    flow.checks.update(residual=residual, power=_power(flow, flow.power_of_mean(loading.gradient)))
    flow.checks.update(_translations(flow))
    return flow


def tied(system: PoreSystem, numbers: Callable[[Batch], Array]) -> Array:
    """What numbers of pores, (n, m) of each batch, leave in the constraints of narrow necks, (t,)."""
    found = np.zeros(system.assembly.ties.shape[0])
    for batch in system.assembly.batches:
        row, pore, B = batch.ties
        if len(row):
            found[row[:, None] + np.arange(TIED)] = np.einsum("tij,tj->ti", B, numbers(batch)[pore])
    return found


def _prescribed(system: PoreSystem, loading: PoreLoading) -> tuple[Array, NDArray[np.bool_]]:
    """Numbers that are given, (n,), 0 elsewhere, and which."""
    first, surfaces, motion = system.assembly.numbering.surface, system.pores.surfaces, loading.motion
    x, held = np.zeros(system.size), np.zeros(system.size, bool)
    body = first[: system.bodies, None] + np.arange(3)
    x[body], held[body], held[system.strains] = motion.U, motion.held, True
    bounds = first[surfaces.discs : len(surfaces)]
    walls = bounds[:, None] + np.arange(RIGID)
    held[walls] = True
    x[walls[:, :3]] = loading.walls
    if len(bounds) == 0:
        held[first[0] + 3] = True  # psi of a cell is determined up to a constant
    if len(bounds) == 2:
        held[bounds[1] + 3] = loading.net_flux is not None
        x[bounds[1] + 3] = _flux_sign(system) * (loading.net_flux or 0.0)
    return x, held


def _flux_sign(system: PoreSystem) -> float:
    """+1 where the second wall of a channel is the one on the left of its period: flux = c_2 - c_1."""
    surfaces = system.pores.surfaces
    p, n = surfaces.periods[0], surfaces.normal[-1]
    return float(np.sign(p[1] * n[0] - p[0] * n[1]))


def _driven(system: PoreSystem) -> tuple[int, float]:
    """Which number is the flux of a channel, but for its sign, and the length of a period."""
    surfaces = system.pores.surfaces
    first = system.assembly.numbering.surface
    return int(first[len(surfaces) - 1]) + 3, float(np.linalg.norm(surfaces.periods[0]))


def _loads(system: PoreSystem, loading: PoreLoading) -> Array:
    """What has power on each number: loads on free modes, the pressure gradient on the flux."""
    b, first = np.zeros(system.size), system.assembly.numbering.surface
    body = first[: system.bodies, None] + np.arange(3)
    b[body] = np.where(loading.motion.held, 0.0, loading.motion.F)
    if loading.pressure_gradient:
        top, length = _driven(system)
        b[top] = -loading.pressure_gradient * length * _flux_sign(system)
    return b


def _power(flow: PoreFlow, mean: float) -> float:
    """Power of bodies, walls and mean flow on the fluid less the dissipation, over their sizes."""
    loading, x = flow.loading, flow.x
    bodies, walls, driven = flow.F * flow.U, flow.wall_forces * loading.walls, 0.0
    if len(loading.walls) == 2:
        top = int(flow.system.assembly.numbering.surface[-1]) - 1
        driven = float(flow.reactions[top] * x[top])
    total = float(bodies.sum() + walls.sum()) + mean + driven
    sizes = float(np.abs(bodies).sum() + np.abs(walls).sum()) + abs(mean) + abs(driven)
    return abs(total - flow.dissipation) / (sizes + abs(flow.dissipation) + _TINY)


def _translations(flow: PoreFlow) -> dict[str, float]:
    """The largest net force of the fluid on all that bounds it: a translation of all costs nothing."""
    system, reactions, periods = flow.system, flow.reactions, flow.system.pores.surfaces.periods
    first, sums = system.assembly.numbering.surface[:-1], []
    arm = system.reference - system.reference[-1]
    for axis in range(2):
        if np.any(periods[:, 1 - axis] != 0.0):
            continue  # its stream function is not periodic
        t = np.zeros(system.size)
        t[first + axis], t[first + 3] = 1.0, (arm[:, 1], -arm[:, 0])[axis]
        sums.append(abs(float(t @ reactions)))
    scale = float(np.abs(reactions).max(initial=0.0)) + _TINY
    return {"momentum": max(sums, default=0.0) / scale}
