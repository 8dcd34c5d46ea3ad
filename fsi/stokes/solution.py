"""A solved instant: velocities and loads of the bodies, the flow, and the checks that it passed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import nan
from pathlib import Path

from fsi.bodies.configuration import MODES, Array
from fsi.observables.bulk_stress import BulkStress
from fsi.stokes.fields import write as fields
from fsi.stokes.fields.traction import Surface, traction
from fsi.stokes.stress import VISCOSITY_CHECKS


@dataclass(frozen=True, slots=True)
class StokesSolution:
    """Stokes flow around the bodies at one instant.

    U: velocities of the bodies, (N, M); F: loads = int sigma n, n out of the fluid, from the reactions,
    (N, M): in balance the external load; the fluid exerts -F on the body; traction_F: the same from the
    traction integral of sigma_h n, less accurate, a cross-check; dissipation: int 2 mu e : e; checks: the
    relative defects of the identities; dofs: unknowns (u, p) before constraints; cells: their number;
    iterations: of the linear solver, 0 of the direct one; quality: worst scaled Jacobian; seconds: CPU
    seconds of this process by phase; flow, surface: for output; bulk: mean stress of a
    periodic flow.
    """

    U: Array
    F: Array
    traction_F: Array
    dissipation: float
    checks: dict[str, float]
    dofs: int
    cells: int
    iterations: int
    quality: float
    seconds: dict[str, float]
    flow: fields.Flow = field(repr=False)
    surface: Surface = field(repr=False)
    bulk: BulkStress | None = None

    @property
    def record(self) -> Mapping[str, float]:
        """The model's columns of steps.csv, at every instant the same: sizes, checks, then CPU seconds."""
        sizes = {
            "dofs": self.dofs,
            "cells": self.cells,
            "worst_cell": self.quality,
            "dissipation": self.dissipation,
        }
        if self.U.shape[1] == len(MODES[3]):
            sizes["iterations"] = self.iterations
        return {
            **sizes,
            **({} if self.bulk is None else self.bulk.record),
            **self.checks,
            **({} if self.bulk is None else {name: self.checks.get(name, nan) for name in VISCOSITY_CHECKS}),
            **{f"cpu_{phase}": seconds for phase, seconds in self.seconds.items()},
        }

    @property
    def apparent_viscosity(self) -> float | None:
        """Over the viscosity of the fluid, of a periodic flow with a mean strain rate."""
        return None if self.bulk is None else self.bulk.apparent_viscosity

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """The model's columns of bodies.csv, (N,) each."""
        return {} if self.bulk is None else self.bulk.body_columns

    @property
    def traction(self) -> Array:
        """Traction sigma n at the nodes of `surface`, (n, d), on root."""
        return traction(self.surface)

    def write(self, folder: Path, step: int) -> dict[str, list[str]]:
        """Write this instant's VTU files; collective. Gives the file names of each series, for all ranks."""
        return {
            "fluid": fields.write_flow(self.flow, folder, step),
            "surface": fields.write_surface(self.surface, self.traction, folder, step),
        }
