"""Pores that a stress shears: how fast a wall of a channel slides, or at what rate a cell is sheared.

The flow is linear in that speed s: with the stress of the flow at s = 0, under all other loads, and that of
the flow that the unit of s drives alone,

    stress = stress_0 + s stress_1
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Inertia, Motion
from fsi.meshes.geometry.lattice import unit_shear
from fsi.pores.solve import PoreFlow, PoreLoading, solve_pores
from fsi.pores.stress import viscous_stress
from fsi.pores.system import PoreSystem


@dataclass(frozen=True, slots=True)
class StressedLoading:
    """A loading with a stress in place of a speed.

    Attributes:
        loading: all but what the stress drives.
        stress: on a wall of a channel along x, or mean shear stress of the fluid and stresslets of a cell.
        wall: which wall, in the order of `loading.walls`; None of a cell.
        volume: of the periodic domain, of fluid and bodies.
    """

    loading: PoreLoading
    stress: float
    wall: int | None
    volume: float

    def on(self, system: PoreSystem) -> PoreLoading:
        """The loading with the speed that has this stress in a system; two solves. Raises SolveError."""
        unit = self._faster(self._unloaded(), 1.0)
        stress_0, stress_1 = (self._of(solve_pores(system, each)) for each in (self.loading, unit))
        return self._faster(self.loading, (self.stress - stress_0) / stress_1)

    def _of(self, flow: PoreFlow) -> float:
        """The stress of a flow."""
        if self.wall is None:
            return float(viscous_stress(flow, self.volume)[0, 1])
        return float(flow.wall_forces[self.wall, 0] / abs(flow.system.pores.surfaces.periods[0, 0]))

    def _unloaded(self) -> PoreLoading:
        """What is held and given as it is, but at rest, and no other load."""
        loading = self.loading
        motion, zero = loading.motion, np.zeros_like(loading.motion.U)
        inertia = loading.inertia and Inertia(loading.inertia.D, zero)
        flux_is_given = loading.net_flux is not None
        return replace(
            loading, motion=Motion(motion.held, zero, zero), walls=np.zeros_like(loading.walls),
            pressure_gradient=None if flux_is_given else 0.0, net_flux=0.0 if flux_is_given else None,
            inertia=inertia,
        )  # fmt: skip

    def _faster(self, loading: PoreLoading, speed: float) -> PoreLoading:
        if self.wall is None:
            return replace(loading, gradient=loading.gradient + speed * unit_shear(2))
        walls: Array = loading.walls.copy()
        walls[self.wall, 0] += speed
        return replace(loading, walls=walls)
