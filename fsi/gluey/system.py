"""What moves in the gluey model, and its state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, turned
from fsi.case.gluey import ContactLaw
from fsi.gluey.contacts import Room
from fsi.gluey.film import Film, Shape


@dataclass(frozen=True, slots=True)
class Held:
    """What is prescribed.

    Attributes:
        modes: which modes of which bodies, bool, shape (N, modes).
        velocity: `(t0, t1) -> int U dt / (t1 - t0)`, shape (N, modes), 0 where free.
    """

    modes: NDArray[np.bool_]
    velocity: Callable[[float, float], Array]


@dataclass(frozen=True, slots=True)
class System:
    """The bodies and what acts on them.

    Attributes:
        radii: shape (N,).
        mass: `(m, .., I, ..)` of each body's modes, shape (N, modes).
        room: walls and periods.
        impulse: `(t0, t1) -> int (F, T) dt` of the loads that depend on time alone, shape (N, modes).
        law: what happens where surfaces touch.
        held: what is prescribed; nothing if None.
        forces: F of the bodies at centres (N, d) and a time, shape (N, d); none if None.
        film_shape: of the surfaces between which films are; by the dimension if None.
    """

    radii: Array
    mass: Array
    room: Room
    impulse: Callable[[float, float], Array]
    law: ContactLaw
    held: Held | None = None
    forces: Callable[[Array, float], Array] | None = None
    film_shape: Shape | None = None

    def film(self, h: float) -> Film | None:
        """What the rows answer in a step h: None in the limit, where gamma says it all."""
        shape: Shape = self.film_shape or ("disc" if self.dimension == 2 else "sphere")
        return Film(self.law.eps, self.law.delta0, h, shape) if self.law.variant == "film" else None

    def load(self, centres: Array, t0: float, t1: float) -> Array:
        """`int (F, T) dt` over a step, forces between bodies taken where it begins, shape (N, modes)."""
        load = self.impulse(t0, t1)
        if self.forces is not None:
            load[:, : self.dimension] += (t1 - t0) * self.forces(centres, t0)
        return load

    @property
    def dimension(self) -> int:
        """The number d of coordinates of a centre."""
        return self.room.container.dimension


@dataclass(frozen=True, slots=True)
class GlueyState:
    """All that the next step depends on.

    Attributes:
        centres: shape (N, d).
        angles: turned since the start, shape (N, r), in space rotation vectors.
        U: velocities, shape (N, d + r).
        key: the pairs that remember, by `Contacts.key`, increasing.
        gamma: what they remember, an impulse < 0.
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
