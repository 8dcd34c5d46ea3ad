"""A solved instant: velocities and loads of the bodies, the flow, and the checks that it passed."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import nan
from pathlib import Path

import numpy as np

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.bodies.configuration import MODES
from fsi.observables.bulk_stress import VISCOSITY_CHECKS
from fsi.observables.quantities import stress_driven
from fsi.observables.solved_flow import SolvedFlow
from fsi.stokes import fields
from fsi.stokes.fields import Flow, Surface, values_at
from fsi.stokes.problem import StokesProblem
from fsi.stokes.traction import traction


@dataclass(frozen=True, slots=True)
class StokesSolution(SolvedFlow):
    """Stokes flow around the bodies at one instant.

    Attributes:
        problem: what was solved; its mesh may have been moved on since.
        flow: velocity and pressure, of this rank.
        surface: the bodies' surfaces, on root.
        mean_pressure_gradient: G of a periodic flow, (d,).
    """

    problem: StokesProblem = field(repr=False)
    flow: Flow = field(repr=False)
    surface: Surface = field(repr=False)
    mean_pressure_gradient: Array | None = None

    @property
    def dp_dx(self) -> float | None:
        """The mean pressure gradient along a channel whose net flux is given, else None."""
        if self.mean_pressure_gradient is None or self.problem.boundary.pressure_gradient is not None:
            return None
        return float(self.mean_pressure_gradient[0])

    @property
    def mesh_instead(self) -> str:
        """The size that was taken as those of the case gave no valid mesh, "" where they did."""
        return self.problem.fluid.instead

    def evaluate(self, x: Array) -> tuple[Array, Array]:
        """u (n, d) and p (n,) at points x (n, d), the same on all ranks; NaN outside the fluid; collective.

        The values are the finite element's own. A periodic flow has them at every image,

            u(x + e) = u(x) + E e,    p(x + e) = p(x) + G.e
        """
        values = values_at(self.flow, x)
        if self.mean_pressure_gradient is not None:
            # The domain was opened along a cut that winds around bodies: the image that is nearest to its
            # middle may lie across the cut, but then one of its neighbours does not.
            lattice = self.problem.fluid.lattice
            low, high = (np.array(parallel.gather(f(self.flow.x, axis=0))) for f in (np.min, np.max))
            nearest = lattice.nearest(x - 0.5 * (low.min(axis=0) + high.max(axis=0)))
            jump = np.vstack([self.problem.mean_gradient, self.mean_pressure_gradient])
            for m in lattice.near():
                outside = np.isnan(values[:, 0])
                e = lattice.shift(nearest[outside] + m)
                values[outside] = values_at(self.flow, x[outside] - e) + e @ jump.T
        return values[:, :-1], values[:, -1]

    def velocity(self, x: Array) -> Array:
        """u (n, d) at points x (n, d), as `evaluate`."""
        return self.evaluate(x)[0]

    @property
    def record(self) -> Mapping[str, float]:
        """The model's columns of steps.csv, at every instant the same: sizes, checks, then CPU seconds."""
        record = {"dofs": self.dofs, "cells": self.cells, "worst_cell": self.problem.fluid.quality}
        record["mesh_instead"] = int(bool(self.mesh_instead))
        record["dissipation"] = self.dissipation
        if self.law_dissipation is not None:
            record["law_dissipation"] = self.law_dissipation
        if self.problem.laws is not None:
            record["shut_in"] = int(self.problem.laws.shut_in)
        if self.slip_dissipation is not None:
            record["slip_dissipation"] = self.slip_dissipation
        if self.U.shape[1] == len(MODES[3]):
            record["iterations"] = self.iterations
        if self.bulk is not None:
            record |= self.bulk.record
        record |= stress_driven(self)
        record |= self.checks
        if self.bulk is not None:
            record |= {name: self.checks.get(name, nan) for name in VISCOSITY_CHECKS}
        return record | {f"cpu_{phase}": seconds for phase, seconds in self.seconds.items()}

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
        surface = fields.write_surface(self.surface, self.traction, folder, step)
        return {"fluid": fields.write_flow(self.flow, folder, step), "surface": surface}
