"""One solved instant of the model of pores: what tables, files and reports take from it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import isnan
from pathlib import Path

import numpy as np

from fsi.arrays import Array, Indices
from fsi.errors import InputError, SolveError, apart
from fsi.observables.bars import DrivenBodies
from fsi.observables.bulk_stress import VISCOSITY_CHECKS, BulkStress
from fsi.observables.quantities import stress_driven
from fsi.parallel import on_root
from fsi.pores.bars import other_modes
from fsi.pores.complement import MOST, LeastStresses
from fsi.pores.fields import FlowFields
from fsi.pores.force_series import ForceSeries
from fsi.pores.narrow import narrowness
from fsi.pores.necks import Necks, necks_of
from fsi.pores.point_forces import PointForces
from fsi.pores.pressure import PressureField
from fsi.pores.solve import PoreFlow
from fsi.pores.stress import (
    bulk_stress,
    is_force_free,
    mean_strain_rate,
    viscosity_checks,
)
from fsi.pores.vtu import write_flow, write_necks

FEW = 500  # bodies: a bound takes 11 ms each, five times what bars do, and a pressure some 0.1 s
# Narrowest necks with stresses in equilibrium: at half of it rounding leaves several per cent of a pressure.
NARROWEST = 5e-4
FEWER_THAN_MOST = 8  # modes, with which the most are compared
# Of itself, how far apart pressures with two numbers of modes may be; the better one is off by a part of it.
APART = 0.1
NO_PRESSURE = (
    'model = "pores": has a pressure only where no neck is narrow (a gap times half the curvature of both '
    f"surfaces at least {NARROWEST:g}) and those with two numbers of modes come within {APART:g} of it; give "
    "more pores.modes if that is why, use Solution.velocity, or the resolved model"
)
# Of each relative defect; a flow beyond it is refused. Most cancels where discs stand in columns: 2e-8.
BOUND = 1e-6


@dataclass(frozen=True)
class PoreInstant:
    """The flow in the pores between bodies at one instant.

    Attributes:
        bodies: where they are and what drives them.
        flow: the solution.
        seconds: CPU seconds of this process by phase.
    """

    bodies: DrivenBodies = field(repr=False)
    flow: PoreFlow = field(repr=False)
    seconds: dict[str, float]

    @property
    def modes(self) -> int:
        """The most that an edge has."""
        return int(self.flow.system.assembly.numbering.modes.max(initial=0))

    @property
    def U(self) -> Array:
        """Velocities, (N, 3)."""
        return self.flow.U

    @property
    def F(self) -> Array:
        """External loads, those that hold bodies too, (N, 3)."""
        return self.flow.F

    @property
    def dissipation(self) -> float:
        """`2 mu int e:e`."""
        return self.flow.dissipation

    @cached_property
    def bulk(self) -> BulkStress | None:
        """The mean stress of a periodic flow and its parts, less their traces."""
        return bulk_stress(self.bodies, self.flow)

    @property
    def apparent_viscosity(self) -> float | None:
        """Over the viscosity of the fluid, of a periodic flow with a mean strain rate."""
        return None if self.bulk is None else self.bulk.apparent_viscosity

    @property
    def wall_speeds(self) -> Mapping[str, float]:
        """Along x, of the walls that a stress moves."""
        case, walls = self.bodies.case, self.flow.loading.walls
        names = case.container().walls
        return {name: float(walls[names.index(name), 0]) for name in case.wall_stress(self.bodies.t)}

    @property
    def shear_rate(self) -> float | None:
        """Of a cell that a stress shears, else None."""
        sheared = self.bodies.case.domain.mean_drive().mean_stress is not None
        return float(self.flow.loading.gradient[0, 1]) if sheared else None

    @property
    def dp_dx(self) -> float | None:
        """The mean pressure gradient along a channel whose net flux is given, else None."""
        given = self.flow.loading.pressure_gradient is not None
        return None if given else self.flow.pressure_gradient

    @property
    def flux(self) -> float | None:
        """The net flux along a channel whose mean pressure gradient is given, else None."""
        channel = len(self.flow.system.pores.surfaces.periods) == 1
        return self.flow.flux if channel and self.dp_dx is None else None

    @property
    def force_free(self) -> bool:
        """Whether walls or mean flow alone do work: then dissipation and viscosity are upper bounds."""
        return is_force_free(self.bodies, self.flow)

    @cached_property
    def stresses(self) -> LeastStresses:
        """In equilibrium, with the modes that tell the error; one solve."""
        return LeastStresses.of(self.flow.system.pores, self._others, self._forces)

    @property
    def few(self) -> bool:
        """Whether reports and files have what stresses tell: of more bodies it takes too long."""
        return len(self.U) <= FEW

    @cached_property
    def lower_bound(self) -> float | None:
        """Of the apparent viscosity, of bodies without loads, where there are points enough to have it below.

        None where necks are so narrow that rounding would tell.
        """
        most = self.apparent_viscosity
        if most is None or not self.force_free or narrowness(self.flow.system.pores).min() < NARROWEST:
            return None
        least = self.stresses.viscosity(self._mean_strain_rate)
        return least if least <= most else None

    @cached_property
    def pressure(self) -> PressureField | None:
        """Of the stress in equilibrium with most modes, where it is near one with fewer; one more solve.

        None where necks are so narrow that rounding would tell.
        """
        pores, modes = self.flow.system.pores, self.flow.system.assembly.numbering.modes
        if narrowness(pores).min() < NARROWEST:
            return None
        own = np.where(modes < MOST, modes, FEWER_THAN_MOST)
        both = [(self._others.sum(), self.stresses)]
        both += [(own.sum(), LeastStresses.of(pores, own, self._forces))]
        fewer, more = sorted(both, key=lambda pair: pair[0])
        other, found = (self._pressure(stresses) for _, stresses in (fewer, more))
        return found if found.apart(other) <= APART else None

    def _pressure(self, stresses: LeastStresses) -> PressureField:
        """That of the best of these stresses."""
        stress = stresses.stress(self._mean_strain_rate, self.bodies.case.fluid.viscosity)
        return PressureField(stress, self._middle)

    @property
    def _middle(self) -> Array:
        """x_m, (2,): of a domain with walls its middle."""
        container = self.bodies.case.container()
        return container.middle if container.walls else np.zeros(2)

    @cached_property
    def _forces(self) -> ForceSeries | None:
        """Loads on bodies, those that hold them too, and what drives a channel; None of flows without."""
        if self.force_free:
            return None
        system, F = self.flow.system, self.flow.F
        surfaces, loaded = system.pores.surfaces, F.any(axis=1)
        dp_dx = self.flow.pressure_gradient if len(surfaces.periods) == 1 else 0.0
        at = surfaces.centre[: len(F)][loaded]
        forces = PointForces(at, F[loaded], surfaces.periods, dp_dx, self._middle)
        return ForceSeries.of(forces, system.shapes, surfaces)

    @property
    def _others(self) -> Indices:
        """The modes of the flow that tells the error, (K,)."""
        return other_modes(self.flow.system)[0]

    @property
    def _mean_strain_rate(self) -> Array:
        """Of a periodic flow; else 0."""
        if not len(self.flow.system.pores.surfaces.periods):
            return np.zeros((2, 2))
        return mean_strain_rate(self.bodies, self.flow.loading)

    @cached_property
    def checks(self) -> dict[str, float]:
        """The relative defects of the identities."""
        if self.bulk is None:
            return dict(self.flow.checks)
        return self.flow.checks | viscosity_checks(self.bodies, self.flow, self.bulk)

    def require_sound(self) -> None:
        """Raise SolveError for the first identity that is violated."""
        for name, defect in self.checks.items():
            if defect > BOUND or (isnan(defect) and name not in VISCOSITY_CHECKS):
                raise SolveError(
                    f'model = "pores" at t = {self.bodies.t:.9g}: {name} is violated by '
                    f"{apart(defect, BOUND)}, more than {BOUND:g}; widen the narrowest gaps, give other "
                    'pores.modes, or model = "resolved"'
                )

    @property
    def dofs(self) -> int:
        """Unknowns."""
        return self.flow.system.unknowns

    @property
    def pores(self) -> int:
        """Their number."""
        return len(self.flow.system.pores)

    @property
    def mesh_instead(self) -> str:
        """Nothing: there is no mesh."""
        return ""

    @cached_property
    def necks(self) -> Necks:
        """Those between bodies, and bodies and walls."""
        return necks_of(self.flow)

    @property
    def record(self) -> Mapping[str, float]:
        """Columns of steps.csv: sizes, checks, then CPU seconds."""
        record: dict[str, float] = {"dofs": self.dofs, "pores": self.pores, "modes": self.modes}
        record["dissipation"] = self.dissipation
        if self.bulk is not None:
            record |= self.bulk.record
        record |= stress_driven(self)
        return record | self.checks | {f"cpu_{phase}": spent for phase, spent in self.seconds.items()}

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """Columns of bodies.csv: stresslets."""
        return {} if self.bulk is None else self.bulk.body_columns

    @cached_property
    def fields(self) -> FlowFields:
        """Stream function and velocity at points."""
        return FlowFields(self.flow)

    def velocity(self, x: Array) -> Array:
        """u (n, 2) at points x (n, 2); NaN outside the fluid."""
        return self.fields.at(x).u

    def evaluate(self, x: Array) -> tuple[Array, Array]:
        """u (n, 2) and p (n,) at points x (n, 2); NaN outside the fluid. Raises InputError: there is no p."""
        if self.pressure is None:
            raise InputError(NO_PRESSURE)
        return self.velocity(x), self.pressure.at(x)

    def write(self, folder: Path, step: int) -> dict[str, list[str]]:
        """Write "fluid", the flow in curved cells, and "necks", lines between bodies."""
        return on_root(lambda: self._write(folder, step))

    def _write(self, folder: Path, step: int) -> dict[str, list[str]]:
        fluid, necks = f"fluid_{step:06d}.vtu", f"necks_{step:06d}.vtu"
        pressure = self.pressure if self.few else None
        write_flow(self.bodies, self.fields, pressure, folder / fluid)
        write_necks(self.bodies, self.necks, folder / necks)
        return {"fluid": [fluid], "necks": [necks]}
