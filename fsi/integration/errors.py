"""The estimated errors of an instant or a step, and their columns in the tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import LOADS, MODES

# Of velocities and loads by their number, 3 in the plane and 6 in space.
NAMES = {len(MODES[d]): (*MODES[d], *LOADS[d]) for d in MODES}


def components(name: str, T: Array, pressure: bool) -> dict[str, Array]:
    """Components of stresses T (..., d, d) by name; xx and yy count where the model has a pressure."""
    upper = zip(*np.triu_indices(T.shape[-1]), strict=True)
    known = {"xyz"[i] + "xyz"[j]: T[..., i, j] for i, j in upper}
    return {f"{name}_{ij}": known[ij] for ij in (known if pressure else ("xy",))}


@dataclass(frozen=True, slots=True)
class StressErrors:
    """Estimated errors of the stress of a periodic flow, absolute.

    Attributes:
        fluid: of the part of the fluid in the mean stress, (d, d).
        mean: of the mean stress, (d, d).
        stresslets: of each body's, (N, d, d).
        differences: of N_1, in space of N_2 too, by name.
        pressure: as of the stress.
    """

    fluid: Array
    mean: Array
    stresslets: Array
    differences: Mapping[str, float]
    pressure: bool = True

    def __add__(self, other: Self) -> Self:
        """The errors of two causes together."""
        differences = {name: error + other.differences[name] for name, error in self.differences.items()}
        fluid, mean = self.fluid + other.fluid, self.mean + other.mean
        stresslets = self.stresslets + other.stresslets
        return replace(self, fluid=fluid, mean=mean, stresslets=stresslets, differences=differences)

    @property
    def normal_stress_difference(self) -> float:
        """Of N_1."""
        return self.differences["N_1"]

    @property
    def columns(self) -> Mapping[str, float]:
        """Of steps.csv."""
        of_mean = components("err_stress", self.mean, self.pressure)
        between = {f"err_{name}": error for name, error in self.differences.items()}
        return {name: float(part) for name, part in of_mean.items()} | between

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """Of bodies.csv, (N,) each."""
        S = self.stresslets
        between = {} if self.pressure else {"err_S_N_1": S[:, 0, 0] + S[:, 1, 1]}
        return {**components("err_S", S, self.pressure), **between}


@dataclass(frozen=True, slots=True)
class ErrorEstimate:
    """Estimated errors, absolute.

    Attributes:
        U: of the velocities where they are free, else 0, (N, M).
        F: of the loads where U is held, else 0, (N, M).
        dissipation: of `2 mu int e:e`, not a number where that is infinite.
        apparent_viscosity: of that of a periodic flow, not a number without a strain rate.
        stress: of a periodic flow.
        wall_speeds: of the walls that a stress moves, along x.
        shear_rate: of a cell that a stress shears, else None.
        dp_dx: of the mean pressure gradient of a channel whose net flux is given, else None.
        flux: of the net flux of a channel whose mean pressure gradient is given, else None.
    """

    U: Array
    F: Array
    dissipation: float = 0.0
    apparent_viscosity: float | None = None
    stress: StressErrors | None = None
    wall_speeds: Mapping[str, float] = field(default_factory=dict)
    shear_rate: float | None = None
    dp_dx: float | None = None
    flux: float | None = None


@dataclass(frozen=True, slots=True)
class StepErrors:
    """The errors of a step.

    Attributes:
        errors: absolute.
        relative: as by `relative_change`, with "viscosity" besides.
        signs: of those of U and of F, exact less computed, (2, N, M); None where only their size is known.
    """

    errors: ErrorEstimate
    relative: Mapping[str, float]
    signs: Array | None = None

    @property
    def signed(self) -> Array:
        """Those of U and of F with their signs, (2, N, M)."""
        sizes = np.stack([self.errors.U, self.errors.F])
        return sizes if self.signs is None else np.copysign(sizes, self.signs)

    @property
    def columns(self) -> Mapping[str, float]:
        """Of steps.csv: the relative errors err_U and err_F; absolute ones of all that is not for a body."""
        columns = {"err_U": self.relative.get("velocity", 0.0), "err_F": self.relative.get("force", 0.0)}
        columns["err_dissipation"] = self.errors.dissipation
        if self.errors.apparent_viscosity is not None:
            columns["err_apparent_viscosity"] = self.errors.apparent_viscosity
        columns |= {f"err_speed_{wall}": error for wall, error in self.errors.wall_speeds.items()}
        if self.errors.dp_dx is not None:
            columns["err_pressure_gradient"] = self.errors.dp_dx
        if self.errors.flux is not None:
            columns["err_flux"] = self.errors.flux
        stress = self.errors.stress
        return columns if stress is None else {**columns, **stress.columns}

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """Of bodies.csv: errors of velocities, loads (0 where given) and stresslets, absolute; (N,) each."""
        names = NAMES[self.errors.U.shape[1]]
        values = np.hstack([self.errors.U, self.errors.F]).T
        columns = {f"err_{name}": value for name, value in zip(names, values, strict=True)}
        return columns if self.errors.stress is None else {**columns, **self.errors.stress.body_columns}
