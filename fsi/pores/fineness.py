"""How many modes the necks of a flow have, handed on from one flow to the next while bodies move.

Necks come and go, those to circles of fluid in every step: a neck takes the modes of that which was nearest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fsi.arrays import Array, Indices
from fsi.meshes.geometry.lattice import Lattice
from fsi.pores.regions import PoreShapes, shapes_of
from fsi.pores.system import PoreSystem
from fsi.pores.topology import Pores


@dataclass(frozen=True, slots=True, eq=False)
class Fineness:
    """Modes by place.

    Attributes:
        places: middles of the necks of some flow, (K, 2).
        modes: how many each has, (K,).
    """

    places: Array
    modes: Indices

    @classmethod
    def even(cls, modes: int) -> Fineness:
        """The same everywhere."""
        return cls(np.zeros((1, 2)), np.array([modes]))

    @classmethod
    def of(cls, system: PoreSystem) -> Fineness:
        """That of a system."""
        return cls(_middles(system.pores, system.shapes), system.assembly.numbering.modes)

    def at(self, pores: Pores) -> Indices:
        """Modes of the necks of other pores, (K,)."""
        if np.all(self.modes == self.modes[0]):
            return np.full(len(pores.necks), self.modes[0])
        lattice, middles = Lattice(pores.surfaces.periods), _middles(pores, shapes_of(pores))
        if lattice.dimension == 0:
            return np.asarray(self.modes[cKDTree(self.places).query(middles)[1]])
        shifts = lattice.shift(lattice.near())
        images = (lattice.wrapped(self.places) + shifts[:, None]).reshape(-1, 2)
        nearest = cKDTree(images).query(lattice.wrapped(middles))[1]
        return np.asarray(self.modes[nearest % len(self.modes)])


def _middles(pores: Pores, shapes: PoreShapes) -> Array:
    """Middles of necks, (K, 2)."""
    middles, there = np.zeros((len(pores.necks), 2)), pores.sides >= 0
    middles[pores.sides[there]] = shapes.foot.mean(axis=2)[there]
    return middles
