"""Rigid bodies: where they are, what moves or holds them.

Planar bodies are discs. Their modes, the columns of every array over modes, are
`(V_x, V_y, omega)`; the conjugate loads are `(F_x, F_y, T)`. `omega` and `T` are positive
counterclockwise. F and T are the EXTERNAL force and torque (per unit length in the plane).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PLANAR_MODES = ("V_x", "V_y", "omega")


@dataclass(frozen=True, slots=True)
class Configuration:
    """Where the bodies are.

    centres: q_i, shape (N, 2); angles: rotation of each body since the start, radians, shape (N,);
    radii: a_i > 0, shape (N,).
    """

    centres: Array
    angles: Array
    radii: Array

    def __len__(self) -> int:
        """Number of bodies N."""
        return len(self.radii)

    def moved(self, displacement: Array) -> Configuration:
        """The configuration after displacements (N, 3) along the modes (x, y, angle)."""
        return Configuration(self.centres + displacement[:, :2], self.angles + displacement[:, 2], self.radii)


@dataclass(frozen=True, slots=True)
class Motion:
    """What drives the bodies at one instant.

    held: which modes are prescribed, bool, shape (N, 3);
    U: their prescribed velocities (0 where free); F: the external loads on the free modes
    (0 where held, where the load is a result). Shapes (N, 3).
    """

    held: NDArray[np.bool_]
    U: Array
    F: Array


@dataclass(frozen=True, slots=True)
class Inertia:
    """Inertia of the bodies in an implicit step: the load on each mode becomes `F - D (U - U0)`.

    D: mass over the step's own time, `m / (gamma h)` and `I / (gamma h)`, shape (N, 3), >= 0;
    U0: the velocity that inertia alone would give, shape (N, 3).
    """

    D: Array
    U0: Array
