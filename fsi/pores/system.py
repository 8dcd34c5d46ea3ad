"""The dissipation of the fluid between bodies as a quadratic form of few numbers, at one configuration."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import process_time

import numpy as np

from fsi.arrays import Array, Indices
from fsi.machine.heap import keep_freed
from fsi.pores.assembly import Assembly, assemble
from fsi.pores.fluid_discs import pores_without_wide
from fsi.pores.orders import RIGID
from fsi.pores.regions import PoreShapes, shapes_of
from fsi.pores.surfaces import DISC, BoundingSurfaces, NoPoresError
from fsi.pores.tied import LastFactors
from fsi.pores.topology import Pores


@dataclass(frozen=True, slots=True, eq=False)
class PoreSystem:
    """The pores of a configuration and their dissipation.

    Attributes:
        bodies: how many of the surfaces, the first, are bodies (N).
        pores: the pores, also those around fluid discs.
        shapes: where they lie.
        assembly: the form, for viscosity 1.
        viscosity: mu.
        seconds: of the processor: topology, forms.
        factors: of the last flow.
    """

    bodies: int
    pores: Pores
    shapes: PoreShapes
    assembly: Assembly
    viscosity: float
    seconds: dict[str, float] = field(default_factory=dict)
    factors: LastFactors = field(default_factory=LastFactors, repr=False)

    @classmethod
    def make(cls, surfaces: BoundingSurfaces, modes: int, viscosity: float) -> PoreSystem:
        """With the same number of modes for each neck. Raises NoPoresError: no pores fill the fluid."""
        began = process_time()
        bodies = int(np.count_nonzero(surfaces.kind == DISC))
        pores = pores_without_wide(surfaces)
        between = process_time()
        made = cls.of(bodies, pores, np.full(len(pores.necks), modes), viscosity)
        made.seconds.update(cpu_pores=between - began, cpu_forms=process_time() - between)
        return made

    @classmethod
    def of(cls, bodies: int, pores: Pores, modes: Indices, viscosity: float) -> PoreSystem:
        """With numbers of modes for the necks, (K,). Raises NoPoresError."""
        keep_freed()
        shapes = shapes_of(pores)
        assembly = assemble(pores, shapes, modes)
        _require_regions(pores, assembly)
        return cls(bodies, pores, shapes, assembly, viscosity)

    def with_modes(self, modes: Indices) -> PoreSystem:
        """The same pores with other numbers of modes, (K,). Raises NoPoresError."""
        return PoreSystem.of(self.bodies, self.pores, modes, self.viscosity)

    @property
    def size(self) -> int:
        """How many numbers there are."""
        return self.assembly.numbering.unknowns

    @property
    def unknowns(self) -> int:
        """All numbers but those that strain bodies, and those that others tie; the prescribed ones too."""
        return self.size - self.strains.size - int(self.assembly.ties.shape[0])

    @property
    def strains(self) -> Indices:
        """The numbers that strain the surfaces of bodies, always 0, (N, 2); (N, 0) without a mean stress."""
        first, end = self.assembly.numbering.surface, self.assembly.numbering.surface[1:]
        size = int(np.max(end[: self.bodies] - first[: self.bodies], initial=RIGID)) - RIGID
        return np.asarray(first[: self.bodies, None] + RIGID + np.arange(size))

    @property
    def reference(self) -> Array:
        """Where psi of each surface is its number c, (B, 2)."""
        surfaces, V = self.pores.surfaces, self.pores.vertices
        reference = surfaces.centre.copy()
        offset = (self.shapes.reference - self.shapes.centre).reshape(-1, 2)
        reference[V.ravel()] = surfaces.centre[V.ravel()] + offset
        return reference

    @property
    def area(self) -> Array:
        """Of each pore, (E,)."""
        area = np.empty(len(self.pores.vertices))
        for batch in self.assembly.batches:
            area[batch.pore] = batch.forms.area
        return area


def _require_regions(pores: Pores, assembly: Assembly) -> None:
    """Raise NoPoresError where strips or triangle of a pore overlap."""
    for batch in assembly.batches:
        bad = batch.pore[batch.forms.least <= 0.0]
        if len(bad):
            sides = map(pores.surfaces.side, pores.vertices[bad[0]])
            raise NoPoresError("the fluid between {} is no pore", *sides)
