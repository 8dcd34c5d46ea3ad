"""A Stokes problem, fluid around rigid bodies at one instant, and the options of its numerical solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.channel import gradient_between, wall_heights
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import unit_shear
from fsi.stokes.pair_laws import PairLaws

type Field = Callable[[Array], Array]
type Formulation = Literal["eliminated", "multiplier"]


@dataclass(frozen=True, slots=True)
class Boundary:
    """What holds on the walls, each in exactly one of the first two, and what drives the fluid.

    Attributes:
        velocities: u(x) of the walls with a given velocity, (n, d) -> (n, d).
        pressures: p of the open walls, where the traction is sigma n = -p n.
        body_force: f(x), or None.
        pressure_gradient: the mean dp/dx along a periodic channel, None where the net flux is given.
        net_flux: of fluid and bodies along such a channel.
        mean_stress: Sigma of a cell, along x on planes across the last axis; None where its rate is given.
        stresses: the tangential traction of walls of such a channel on the fluid, along x; what they have in
            `velocities` is without what this drives.
        slip_lengths: b > 0 of those walls with a given velocity that fluid does not stick to.
        shear_rate: of a cell, what its mean stress has added to the mean flow of the container.
    """

    velocities: Mapping[str, Field]
    pressures: Mapping[str, float]
    body_force: Field | None = None
    pressure_gradient: float | None = 0.0
    net_flux: float | None = None
    mean_stress: float | None = None
    stresses: Mapping[str, float] = field(default_factory=dict)
    slip_lengths: Mapping[str, float] = field(default_factory=dict)
    shear_rate: float = 0.0

    @property
    def outside_level(self) -> float:
        """What the pressures of all open walls have in common: the least in size, 0 if signs differ.

        It drives nothing, so that flows are solved without it and have it put back into p alone.
        """
        outside = self.pressures.values()
        return min(max(0.0, min(outside)), max(outside)) if outside else 0.0

    def faster(self, speeds: Mapping[str, float], rate: float) -> Boundary:
        """The same with walls that slide along x, and a cell that is sheared, so much faster."""
        walls = {wall: _sliding(self.velocities[wall], speed) for wall, speed in speeds.items()}
        return replace(self, velocities={**self.velocities, **walls}, shear_rate=self.shear_rate + rate)


def _sliding(u: Field, speed: float) -> Field:
    return lambda x: u(x) + speed * np.eye(x.shape[1])[0]


@dataclass(frozen=True, slots=True)
class SurfaceConditions:
    """Bodies that fluid does not stick to, or whose surface moves along itself, by their numbers.

    With the velocity w of a surface, n out of the fluid, and a slip length b (Navier 1823),

        u.n = w.n,      t.sigma n = - (mu / b) t.(u - w)      for every tangent t.

    Attributes:
        slip_lengths: b > 0 of those that have one.
        swimming: B_1, B_2, ... of those that swim (see `fsi.stokes.swimming`).
    """

    slip_lengths: Mapping[int, float] = field(default_factory=dict)
    swimming: Mapping[int, Array] = field(default_factory=dict)

    @property
    def still(self) -> SurfaceConditions:
        """The same without what moves along them."""
        return SurfaceConditions(self.slip_lengths)


@dataclass(frozen=True, slots=True)
class StokesProblem:
    """Stokes flow around rigid bodies at one instant.

    Attributes:
        fluid: mesh of the fluid around the bodies at q.
        container: what encloses the fluid.
        q: the bodies.
        motion: held modes, their velocities, loads on the free modes.
        boundary: walls and body force.
        viscosity: mu.
        inertia: of an implicit step; None: quasi-static.
        interaction: sum of r (x) F of forces between bodies, (d, d), for the mean stress; None: zero.
        laws: of pairs, on top of what is resolved; None: no law acts anywhere.
        surfaces: those of bodies; at rest on the bodies, and fluid sticks to them, if not given.
    """

    fluid: FluidMesh
    container: Container
    q: Configuration
    motion: Motion
    boundary: Boundary
    viscosity: float = 1.0
    inertia: Inertia | None = None
    interaction: Array | None = None
    surfaces: SurfaceConditions = field(default_factory=SurfaceConditions)
    laws: PairLaws | None = None

    def at_rest(self, motion: Motion) -> StokesProblem:
        """The same with this motion and nothing else that moves bodies, for a flow to be added to others."""
        inertia = self.inertia and replace(self.inertia, U0=np.zeros_like(self.inertia.U0))
        laws = self.laws and self.laws.at_rest()
        return replace(self, motion=motion, inertia=inertia, interaction=None, laws=laws)

    @property
    def periodic(self) -> bool:
        """Whether the domain has periods."""
        return len(self.container.periods) > 0

    @property
    def sliding(self) -> bool:
        """Whether fluid slides along a body or a wall."""
        return bool(self.surfaces.slip_lengths or self.boundary.slip_lengths)

    @property
    def mean_gradient(self) -> Array:
        """E of the mean flow of a cell, rows of du_i/dx_j, (d, d); zero elsewhere."""
        return self.container.mean_gradient + self.boundary.shear_rate * unit_shear(self.container.dimension)

    @property
    def flow_gradient(self) -> Array:
        """W of the mean flow of a periodic domain, (d, d); between walls gammadot = (u_top - u_bottom) / H.

        Zero elsewhere, and in a channel whose walls have no given velocity.
        """
        walls = self.boundary.velocities
        if not self.periodic or len(walls) != 2:
            return self.mean_gradient
        across = np.eye(self.container.dimension)[-1:]
        moves = {wall: walls[wall](h * across)[0] for wall, h in wall_heights(self.container).items()}
        return gradient_between(self.container, moves)

    @property
    def mean_strain_rate(self) -> Array:
        """E of a periodic flow, the symmetric part of its gradient, (d, d)."""
        W = self.flow_gradient
        E: Array = 0.5 * (W + W.T)
        return E


@dataclass(frozen=True, slots=True)
class SolverOptions:
    """How a problem is solved.

    Attributes:
        degree: of the velocity, at least the order of the mesh; the pressure has one less.
        formulation: "eliminated" (P^T M P) or "multiplier" (the saddle-point system); they agree to rounding.
        solver: of the eliminated form, "direct", "iterative" (in space), or "automatic" by size.
    """

    degree: int = 3
    formulation: Formulation = "eliminated"
    solver: Literal["automatic", "direct", "iterative"] = "automatic"


def wall_area(channel: Container) -> float:
    """Of the wall of a channel within one period, in the plane its length."""
    return float(abs(np.linalg.det(channel.periods[:, :-1])))
