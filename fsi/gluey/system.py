"""What moves in the gluey model, and its state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, turned
from fsi.gluey.contacts import Room
from fsi.gluey.film import Film, Shape

type Variant = Literal["shifted", "cone", "film"]


@dataclass(frozen=True, slots=True)
class Law:
    """What happens between two surfaces that touch.

    variant: "shifted", in which release costs no step, or "cone", the set C_q of the slides; "film" is the
        model before the limit, with a viscosity.
    gamma_min: the memory at which roughness stops the film from draining, `eps ln(delta/delta0)`, <= 0, or
        -inf for smooth bodies; at it the contact is solid.
    friction: Coulomb's coefficient mu_f at solid contact, >= 0.
    tangential: c in the viscous force `-c |gamma| slip / a` with `a = a_i a_j/(a_i + a_j)`, >= 0: the film
        gives gamma resists slip as well, and both resistances grow as ln D. Two equal spheres have c = 1/3.
    eps, delta0: of films, `gamma = eps Psi'(D)` below the gap delta0 (`fsi.gluey.film`), > 0 for "film".
    """

    variant: Variant = "shifted"
    gamma_min: float = -np.inf
    friction: float = 0.0
    tangential: float = 0.0
    eps: float = 0.0
    delta0: float = 0.0


@dataclass(frozen=True, slots=True)
class System:
    """The bodies and what acts on them.

    radii: shape (N,); mass: `(m, .., I, ..)` of each body's modes, shape (N, modes); room: walls and periods;
    impulse: `(t0, t1) -> int (F, T) dt`, shape (N, modes).
    """

    radii: Array
    mass: Array
    room: Room
    impulse: Callable[[float, float], Array]
    law: Law

    def film(self, h: float) -> Film | None:
        """What the rows answer in a step h: None in the limit, where gamma says it all."""
        shape: Shape = "disc" if self.dimension == 2 else "sphere"
        return Film(self.law.eps, self.law.delta0, h, shape) if self.law.variant == "film" else None

    @property
    def dimension(self) -> int:
        """The number d of coordinates of a centre."""
        return len(self.room.period)


@dataclass(frozen=True, slots=True)
class GlueyState:
    """All that the next step depends on.

    centres: (N, d); angles: turned since the start, (N, r), in space rotation vectors; U: velocities, (N,
    d + r);
    key, gamma: the pairs that remember, by `Contacts.key`, increasing, and what: gamma < 0, an impulse.
    """

    centres: Array
    angles: Array
    U: Array
    key: NDArray[np.int64]
    gamma: Array

    @classmethod
    def at(cls, centres: Array, U: Array) -> GlueyState:
        """Bodies that have not met yet."""
        spins = U.shape[1] - centres.shape[1]
        return cls(centres, np.zeros((len(centres), spins)), U, np.empty(0, dtype=np.int64), np.empty(0))

    def remembered(self, key: NDArray[np.int64]) -> Array:
        """gamma of the pairs with these keys; 0 for those that have not met, or have parted."""
        if len(self.key) == 0:
            return np.zeros(len(key))
        at = np.minimum(np.searchsorted(self.key, key), len(self.key) - 1)
        return np.where(self.key[at] == key, self.gamma[at], 0.0)

    def moved(self, U: Array, h: float, key: NDArray[np.int64], gamma: Array) -> GlueyState:
        """The state after a step h at the velocities U; pairs with gamma = 0 are forgotten."""
        d, kept = self.centres.shape[1], gamma != 0.0
        angles = turned(self.angles, h * U[:, d:])
        return GlueyState(self.centres + h * U[:, :d], angles, U, key[kept], gamma[kept])
