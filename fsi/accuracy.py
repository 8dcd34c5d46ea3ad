"""How accurate U and F of an instant are: bounds of their errors, and the one number that sums them up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fsi.bodies import Array


@dataclass(frozen=True, slots=True)
class ErrorEstimate:
    """Estimated errors, absolute: of U where it is free, of F where U is held; else 0. Shapes (N, M).

    apparent_viscosity: the error of that of a periodic flow.
    """

    U: Array
    F: Array
    apparent_viscosity: float | None = None


class Results(Protocol):
    """What a model computes."""

    @property
    def U(self) -> Array:
        """Velocities of the bodies, shape (N, M)."""

    @property
    def F(self) -> Array:
        """External loads `int sigma n`, shape (N, M)."""


class Measured(Results, Protocol):
    """The same with what only some flows have."""

    @property
    def apparent_viscosity(self) -> float | None:
        """Over the viscosity of the fluid, of a periodic flow with a mean strain rate."""


def relative_change(
    results: Results, change: Results, held: NDArray[np.bool_], arm: Array
) -> dict[str, float]:
    """A change of the results over the largest result.

    Results are the loads on held components and the velocities of free ones.

    Args:
        results: U and F.
        change: their changes or errors, of any sign.
        held: which velocities are prescribed, shape (N, M).
        arm: 1 for translations, the radius for rotations, shape (N, M).

    Returns:
        "force" and "velocity": largest |change| / largest |result|, each only if there is such a result.
    """
    pairs = {
        "force": ((results.F / arm)[held], (change.F / arm)[held]),
        "velocity": ((results.U * arm)[~held], (change.U * arm)[~held]),
    }
    return {
        name: float(np.abs(changed).max() / np.abs(values).max())
        for name, (values, changed) in pairs.items()
        if np.any(values)
    }
