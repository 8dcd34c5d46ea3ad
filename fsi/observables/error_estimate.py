"""How accurate U and F of an instant are: bounds of their errors, and the one number that sums them up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import LOADS, MODES, Array
from fsi.case.case import Case

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


@dataclass(frozen=True, slots=True)
class FlowScales:
    """Rate of shear times the largest radius; force over velocity, mu in the plane and mu a for spheres."""

    velocity: float
    resistance: float


def flow_scales(case: Case, t: float) -> FlowScales:
    """What walls and mean flow do at time t; a wall shears at its speed over the size of the container."""
    radius = max((body.radius for body in case.bodies), default=0.0)
    container = case.container()
    size, walls = container.size(), case.wall_velocity(t).values()
    rates = [float(np.linalg.norm(wall.velocity)) / size + abs(wall.shear) for wall in walls]
    rate = max([*rates, float(np.abs(container.mean_gradient).max())])
    return FlowScales(rate * radius, case.fluid.viscosity * (radius if case.spheres else 1.0))


# A result that is smaller than this part of what drives the flow may be zero by symmetry.
LEAST = 0.01


def relative_change(
    results: Results, change: Results, held: NDArray[np.bool_], arm: Array, scales: FlowScales
) -> dict[str, float]:
    """A change of the results over the largest result: loads on held components, velocities of free ones.

    Gives "force" and "velocity", largest |change| / largest |result|, each only if there is such a result.
    Where symmetry makes all of a kind zero, what is computed is an error itself: a hundredth of what drives
    the flow is the least that a change counts over. arm: 1 for translations, the radius for rotations, (N,
    M).
    """
    F, V = results.F / arm, results.U * arm
    speed = max(float(np.abs(V).max(initial=0.0)), scales.velocity)
    force = max(float(np.abs(F).max(initial=0.0)), scales.resistance * speed)
    relative = {}
    for name, of_kind, values, changed, scale in (
        ("force", held, F, change.F / arm, force),
        ("velocity", ~held, V, change.U * arm, speed),
    ):
        if np.any(values[of_kind]):
            largest = max(float(np.abs(values[of_kind]).max()), LEAST * scale)
            relative[name] = float(np.abs(changed[of_kind]).max()) / largest
    return relative
