"""Estimated errors of an instant, and of a step of a run as its tables show them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fsi.bodies.configuration import LOADS, MODES, Array

# The names of velocities and loads by their number, 3 in the plane and 6 in space.
NAMES = {len(MODES[d]): (*MODES[d], *LOADS[d]) for d in MODES}


@dataclass(frozen=True, slots=True)
class ErrorEstimate:
    """Estimated errors, absolute.

    Attributes:
        U: of the velocities where they are free, else 0, (N, M).
        F: of the loads where U is held, else 0, (N, M).
        dissipation: of `2 mu int e:e`.
        apparent_viscosity: of that of a periodic flow, not a number without a strain rate.
    """

    U: Array
    F: Array
    dissipation: float = 0.0
    apparent_viscosity: float | None = None


@dataclass(frozen=True, slots=True)
class StepErrors:
    """The errors of a step: absolute, and relative as by `relative_change`, with "viscosity" besides."""

    errors: ErrorEstimate
    relative: Mapping[str, float]

    @property
    def columns(self) -> Mapping[str, float]:
        """Of steps.csv: the relative errors err_U and err_F, and that of the apparent viscosity, absolute."""
        columns = {"err_U": self.relative.get("velocity", 0.0), "err_F": self.relative.get("force", 0.0)}
        if self.errors.apparent_viscosity is not None:
            columns["err_apparent_viscosity"] = self.errors.apparent_viscosity
        return columns

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """Of bodies.csv: the error of each velocity and load, absolute, 0 where it is given; (N,) each."""
        names = NAMES[self.errors.U.shape[1]]
        values = np.hstack([self.errors.U, self.errors.F]).T
        return {f"err_{name}": value for name, value in zip(names, values, strict=True)}


class Results(Protocol):
    """What a model computes."""

    @property
    def U(self) -> Array:
        """Velocities of the bodies, shape (N, M)."""

    @property
    def F(self) -> Array:
        """External loads `int sigma n`, shape (N, M)."""


class Measured(Results, Protocol):
    """The same with the dissipation, and what only some flows have."""

    @property
    def dissipation(self) -> float:
        """`2 mu int e:e`."""

    @property
    def apparent_viscosity(self) -> float | None:
        """Over the viscosity of the fluid, of a periodic flow with a mean strain rate."""
